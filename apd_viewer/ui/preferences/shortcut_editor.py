"""Editor of an action's shortcut, shown as key caps."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QKeyCombination, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QFocusEvent, QKeyEvent, QKeySequence, QPainter, QPaintEvent, QPalette, QPen
from PySide6.QtWidgets import QAbstractButton, QSizePolicy

from apd_viewer.language import tr, trc
from apd_viewer.ui.preferences.shortcuts import ShortcutEntry, native_keys, split_keys

_HEIGHT, _CAP, _PADDING, _GAP = 28, 20, 6, 3
_PROMPT, _NONE, _OR = tr("Press keys…"), trc("keys", "none"), trc("keys", "or")
_ENTER = (Qt.Key.Key_Return, Qt.Key.Key_Enter)
_ALONE = (  # modifiers
    Qt.Key.Key_Control,
    Qt.Key.Key_Shift,
    Qt.Key.Key_Alt,
    Qt.Key.Key_AltGr,
    Qt.Key.Key_Meta,
    Qt.Key.Key_CapsLock,
    Qt.Key.Key_unknown,
)


class ShortcutEditor(QAbstractButton):
    """Keys of one action; click to record, Delete for none, Esc to cancel.

    Parameters
    ----------
    entry : ShortcutEntry

    Attributes
    ----------
    recording_changed : Signal(bool)
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
        """True while recording."""
        return self._waits

    def set_recording(self, on: bool) -> None:
        """Start or stop recording a new shortcut."""
        if on != self._waits:
            self._waits = on
            self.recording_changed.emit(on)
            self.update()

    def sizeHint(self) -> QSize:
        """Room for all caps."""
        caps = sum(width for _, width, _ in self._pieces())
        prompt = self.fontMetrics().horizontalAdvance(_PROMPT)
        return QSize(int(max(caps, prompt)) + 2 * _PADDING, _HEIGHT)

    def minimumSizeHint(self) -> QSize:
        """Size of all key caps, without the prompt for new keys."""
        caps = sum(width for _, width, _ in self._pieces())
        return QSize(int(caps) + 2 * _PADDING, _HEIGHT)

    def event(self, event: QEvent) -> bool:
        """While it waits all keys come here, those of other actions too."""
        if event.type() == QEvent.Type.ShortcutOverride and self._waits:
            event.accept()
            return True
        return super().event(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Take new keys, begin to wait for them, or go to a neighbour."""
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
        """Wait no more."""
        self.set_recording(False)
        super().focusOutEvent(event)

    def _pieces(self) -> list[tuple[str, float, bool]]:
        """Words from left to right, the room for each, and whether it is a cap."""
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
        """Draw the caps, at the right."""
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
    """The single caps of a combination; a plus may be one of them."""
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
