"""Rows of the shortcut sheet: actions with a shortcut editor, mouse gestures."""

from typing import NamedTuple

from PySide6.QtCore import QEvent, QKeyCombination, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QFocusEvent, QKeyEvent, QKeySequence, QPainter, QPaintEvent, QPalette, QPen
from PySide6.QtWidgets import QAbstractButton, QFrame, QGridLayout, QLabel, QSizePolicy, QWidget

from apd_viewer.language import tr, trc
from apd_viewer.ui.preferences.shortcuts import ShortcutEntry, native_keys, split_keys
from apd_viewer.ui.scene.navigation_preset import NavigationPreset
from apd_viewer.ui.tools.tool_modes import SelectionMode, Tool
from apd_viewer.ui.widgets.box_layouts import row_layout
from apd_viewer.ui.widgets.fields import small_button
from apd_viewer.ui.widgets.theme import ICON_SIZE, LIGHT, Theme, icon

_EDGES = (8, 1, 4, 1)


class ActionRow(QFrame):
    """Icon, title and shortcut of an action, with a button to restore the default.

    Parameters
    ----------
    title : str
        With the submenu that it is in.

    Attributes
    ----------
    back : QToolButton
        Gives it its standard keys; there while it has others.
    """

    def __init__(self, entry: ShortcutEntry, title: str) -> None:
        super().__init__(objectName="shortcut")
        self._theme = LIGHT
        self.entry = entry
        self.title = title
        self.setToolTip(entry.tip)
        self.symbol = QLabel()
        self.symbol.setFixedSize(ICON_SIZE)
        self.keys = ShortcutEditor(entry)
        standard = native_keys(entry.default_keys) or trc("keys", "none")
        self.back = small_button(
            tr("Restore the default keys of {title}: {standard}").format(
                title=entry.title, standard=standard
            ),
            tr("Restore default: {standard}").format(standard=standard),
        )
        name = QLabel(title, wordWrap=True)
        row_layout(self.symbol, (name, 1), self.back, self.keys, margins=_EDGES, parent=self)
        self.back.setVisible(entry.is_changed)

    def show_keys(self) -> None:
        """Show the action's current keys."""
        self.keys.show_keys()
        self.back.setVisible(self.entry.is_changed)
        self._draw_back()

    @property
    def search_text(self) -> str:
        """Text searched when rows are filtered."""
        return f"{self.title} {self.entry.tip} {self.entry.keys} {native_keys(self.entry.keys)}"

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icons, reusing the updated one of the action."""
        self._theme = theme
        self.symbol.setPixmap(self.entry.action.icon().pixmap(ICON_SIZE, self.devicePixelRatioF()))
        self._draw_back()

    def _draw_back(self) -> None:
        if self.entry.is_changed:
            self.back.setIcon(icon("undo", self._theme))


class MouseGesture(NamedTuple):
    """Title, icon and text of a tool's mouse gestures.

    Parameters
    ----------
    title : str
        Title of the tool, or of the selection mode.
    image : str
        Name of its icon.
    """

    title: str
    image: str
    text: str


class GestureRow(QFrame):
    """Icon and title of a tool, and its mouse gestures below."""

    def __init__(self, gesture: MouseGesture) -> None:
        super().__init__(objectName="gesture")
        self._gesture = gesture
        self.setAccessibleName(tr("{title}: {words}").format(title=gesture.title, words=gesture.text))
        self.symbol = QLabel()
        self.symbol.setFixedSize(ICON_SIZE)
        grid = QGridLayout(self, horizontalSpacing=8, verticalSpacing=1)
        grid.setContentsMargins(8, 4, 4, 4)
        grid.setColumnStretch(1, 1)
        grid.addWidget(self.symbol, 0, 0, Qt.AlignmentFlag.AlignTop)
        grid.addWidget(QLabel(gesture.title), 0, 1)
        grid.addWidget(QLabel(gesture.text, objectName="quiet", wordWrap=True), 1, 1)

    @property
    def search_text(self) -> str:
        """Text searched when rows are filtered."""
        return " ".join([self._gesture.title, self._gesture.text, tr("mouse")])

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icon."""
        self.symbol.setPixmap(icon(self._gesture.image, theme).pixmap(ICON_SIZE, self.devicePixelRatioF()))


ShortcutRow = ActionRow | GestureRow


class ShortcutGroup(QWidget):
    """Rows under a heading, hidden together if no row matches."""

    def __init__(self, title: str, rows: list[ShortcutRow], column: QWidget) -> None:
        super().__init__(column)
        self.rows = rows
        self._title = title
        grid = QGridLayout(self, verticalSpacing=0)
        grid.setContentsMargins(0, 8, 0, 4)
        heading = QLabel(title, objectName="heading")
        heading.setContentsMargins(8, 0, 0, 4)
        grid.addWidget(heading, 0, 0, Qt.AlignmentFlag.AlignLeft)  # heading as wide as its text
        for row in rows:
            grid.addWidget(row)

    def filter_rows(self, words: list[str]) -> int:
        """Show the rows matching all words; return their number."""
        found = 0
        for row in self.rows:
            said = f"{self._title} {row.search_text}".replace(":", " ").casefold().split()
            fits = all(any(other.startswith(word) for other in said) for word in words)
            row.setVisible(fits)
            found += fits
        self.setVisible(bool(found))
        return found


_WITHOUT_MOUSE = (
    (
        tr("On a touch screen"),
        "touch",
        tr(
            "one finger does what a drag with the left button does; two fingers pan, a pinch zooms, "
            "and turning them turns the mesh"
        ),
    ),
    (
        tr("On a trackpad"),
        "trackpad",
        tr("two sliding fingers are the wheel, a pinch zooms, and turning fingers turn the mesh"),
    ),
    (
        tr("With a pen"),
        "pen",
        tr("pressure widens the brush, the eraser end removes, and the button is the right one of a mouse"),
    ),
)


def mouse_gestures(preset: NavigationPreset) -> list[MouseGesture]:
    """Gestures of all tools, the camera and the selection modes; fingers and pens."""
    plain = [tool for tool in Tool if not tool.traits.is_brush]
    found = [
        MouseGesture(tr("With any tool"), "view", preset.sentence),
        *(MouseGesture(tool.traits.title, tool.traits.icon, tool.traits.hint) for tool in plain),
        MouseGesture(tr("While painting"), Tool.HANDLE.traits.icon, Tool.HANDLE.modifiers),
        *(MouseGesture(way.traits.title, way.traits.icon, way.traits.hint) for way in SelectionMode),
        *(MouseGesture(title, image, text) for title, image, text in _WITHOUT_MOUSE),
    ]
    return [gesture._replace(text=gesture.text[:1].upper() + gesture.text[1:]) for gesture in found]


_HEIGHT, _CAP, _PADDING, _GAP = 28, 20, 6, 3
_PROMPT, _NONE, _OR = tr("Press keys…"), trc("keys", "none"), trc("keys", "or")
_ENTER = (Qt.Key.Key_Return, Qt.Key.Key_Enter)
_ALONE = (  # modifier keys, which are no shortcut by themselves
    Qt.Key.Key_Control,
    Qt.Key.Key_Shift,
    Qt.Key.Key_Alt,
    Qt.Key.Key_AltGr,
    Qt.Key.Key_Meta,
    Qt.Key.Key_CapsLock,
    Qt.Key.Key_unknown,
)


class ShortcutEditor(QAbstractButton):
    """Shortcut of one action; click to record, Delete to clear, Esc to cancel.

    Attributes
    ----------
    keys_chosen : Signal(str)
        Keys that were pressed.
    step_requested : Signal(int)
        The arrow keys ask for the field above, -1, or below, 1.
    """

    recording_changed = Signal(bool)
    keys_chosen = Signal(str)
    step_requested = Signal(int)

    def __init__(self, entry: ShortcutEntry) -> None:
        super().__init__(focusPolicy=Qt.FocusPolicy.StrongFocus)
        self.setAttribute(Qt.WidgetAttribute.WA_Hover)
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Fixed)
        self.entry = entry
        self._waits = False
        self.clicked.connect(lambda: self.set_recording(True))
        self.show_keys()

    def show_keys(self) -> None:
        """Show the action's current keys."""
        keys = native_keys(self.entry.keys) or _NONE
        self.setAccessibleName(tr("Keys of {action}: {keys}").format(action=self.entry.title, keys=keys))
        self.setToolTip(tr("Change the keys of “{action}”").format(action=self.entry.title))
        self.updateGeometry()
        self.update()

    @property
    def is_recording(self) -> bool:
        """True while a new shortcut is being recorded."""
        return self._waits

    def set_recording(self, on: bool) -> None:
        """Start or stop recording a new shortcut."""
        if on != self._waits:
            self._waits = on
            self.recording_changed.emit(on)
            self.update()

    def sizeHint(self) -> QSize:
        """Size of all key caps or of the prompt for new keys, the wider one."""
        caps = sum(width for _, width, _ in self._pieces())
        prompt = self.fontMetrics().horizontalAdvance(_PROMPT)
        return QSize(int(max(caps, prompt)) + 2 * _PADDING, _HEIGHT)

    def minimumSizeHint(self) -> QSize:
        """Size of all key caps, without the prompt for new keys."""
        caps = sum(width for _, width, _ in self._pieces())
        return QSize(int(caps) + 2 * _PADDING, _HEIGHT)

    def event(self, event: QEvent) -> bool:
        """While recording, receive all keys, even shortcuts of other actions."""
        if event.type() == QEvent.Type.ShortcutOverride and self._waits:
            event.accept()
            return True
        return super().event(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Record the keys, start recording, or move to an adjacent row."""
        key = event.key()
        if self._waits:
            self._take(event)
        elif key in _ENTER:
            self.click()
        elif key in (Qt.Key.Key_Up, Qt.Key.Key_Down):
            self.step_requested.emit(-1 if key == Qt.Key.Key_Up else 1)
        else:
            super().keyPressEvent(event)

    def _take(self, event: QKeyEvent) -> None:
        if event.key() in _ALONE:
            return
        self.set_recording(False)
        if event.key() in (Qt.Key.Key_Backspace, Qt.Key.Key_Delete):
            self.keys_chosen.emit("")
        elif event.key() != Qt.Key.Key_Escape:
            self.keys_chosen.emit(_keys_of(event))

    def focusOutEvent(self, event: QFocusEvent) -> None:
        """Stop recording."""
        self.set_recording(False)
        super().focusOutEvent(event)

    def _pieces(self) -> list[tuple[str, float, bool]]:
        """Texts from left to right, their widths, and True for each key cap."""
        metrics = self.fontMetrics()
        pieces = []
        for number, key in enumerate(split_keys(self.entry.keys)):
            if number:
                pieces.append((_OR, float(metrics.horizontalAdvance(_OR) + 2 * _PADDING), False))
            for cap in _caps(native_keys(key)):
                width = max(_CAP, metrics.horizontalAdvance(cap) + 2 * _PADDING)
                pieces.append((cap, float(width + _GAP), True))
        return pieces or [(_NONE, float(metrics.horizontalAdvance(_NONE) + _GAP), False)]

    def paintEvent(self, _: QPaintEvent) -> None:
        """Draw the key caps, aligned right."""
        painter, palette = QPainter(self), self.palette()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        room = QRectF(self.rect()).adjusted(0.5, 0.5, -0.5, -0.5)
        if self._waits or self.hasFocus() or self.underMouse():
            lively = self._waits or self.hasFocus()
            painter.setPen(palette.highlight().color() if lively else palette.mid().color())
            painter.drawRoundedRect(room, 6, 6)
        if self._waits:
            prompt = self.fontMetrics().elidedText(_PROMPT, Qt.TextElideMode.ElideRight, int(room.width()))
            painter.drawText(room, Qt.AlignmentFlag.AlignCenter, prompt)
            return
        pieces = self._pieces()
        x = room.right() - _PADDING + _GAP - sum(width for _, width, _ in pieces)
        for word, width, is_cap in pieces:
            _draw(painter, palette, QRectF(x, (self.height() - _CAP) / 2, width - _GAP, _CAP), word, is_cap)
            x += width


def _draw(painter: QPainter, palette: QPalette, room: QRectF, word: str, is_cap: bool) -> None:
    if is_cap:
        painter.setPen(QPen(palette.mid().color(), 1))
        painter.setBrush(palette.alternateBase())
        painter.drawRoundedRect(room.adjusted(0.5, 0.5, -0.5, -0.5), 4, 4)
        painter.setBrush(Qt.BrushStyle.NoBrush)
    ink = palette.windowText().color()
    ink.setAlphaF(1.0 if is_cap else 0.65)
    painter.setPen(ink)
    painter.drawText(room, Qt.AlignmentFlag.AlignCenter, word)


def _caps(keys: str) -> list[str]:
    """Key caps of a combination; a plus sign may be one of them."""
    if keys.endswith("+") and len(keys) > 1:
        return [*_caps(keys[:-2]), "+"]
    return keys.split("+") if len(keys) > 1 else [keys]


def _keys_of(event: QKeyEvent) -> str:
    """Keys pressed; without Shift if it only selects another character."""
    kept, text = event.modifiers() & ~Qt.KeyboardModifier.KeypadModifier, event.text()
    if text and text.isprintable() and not text.isalnum() and not text.isspace():
        kept &= ~Qt.KeyboardModifier.ShiftModifier
    combination = QKeyCombination(kept, Qt.Key(event.key()))
    return QKeySequence(combination).toString(QKeySequence.SequenceFormat.PortableText)
