"""Rows of the shortcut sheet: actions and mouse gestures."""

from __future__ import annotations

from typing import NamedTuple

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QFrame, QGridLayout, QHBoxLayout, QLabel, QWidget

from apd_viewer.language import tr, trc
from apd_viewer.ui.preferences.shortcut_editor import ShortcutEditor
from apd_viewer.ui.preferences.shortcuts import ShortcutEntry, native_keys
from apd_viewer.ui.tools.toolbox import SelectionMode, Tool
from apd_viewer.ui.widgets.fields import small_button
from apd_viewer.ui.widgets.icons import ICON_SIZE, icon
from apd_viewer.ui.widgets.theme import LIGHT, Theme

_EDGES = (8, 1, 4, 1)


class ActionRow(QFrame):
    """Icon, title and keys of an action, and the way back to its standard keys.

    Parameters
    ----------
    entry : ShortcutEntry
    title : str
        With the submenu that it is in.

    Attributes
    ----------
    keys : ShortcutEditor
    back : QToolButton
        Gives it its standard keys; there while it has others.
    symbol : QLabel
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
        row = QHBoxLayout(self, spacing=8)
        row.setContentsMargins(*_EDGES)
        row.addWidget(self.symbol)
        row.addWidget(QLabel(title, wordWrap=True), 1)
        row.addWidget(self.back)
        row.addWidget(self.keys)
        self.back.setVisible(entry.is_changed)

    def show_keys(self) -> None:
        """Show the action's current keys."""
        self.keys.show_keys()
        self.back.setVisible(self.entry.is_changed)
        self._draw_back()

    @property
    def search_text(self) -> str:
        """Text for the search."""
        return f"{self.title} {self.entry.tip} {self.entry.keys} {native_keys(self.entry.keys)}"

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icons; the action's own is already redrawn."""
        self._theme = theme
        self.symbol.setPixmap(self.entry.action.icon().pixmap(ICON_SIZE, self.devicePixelRatioF()))
        self._draw_back()

    def _draw_back(self) -> None:
        if self.entry.is_changed:
            self.back.setIcon(icon("undo", self._theme))


class GestureRow(QFrame):
    """Icon and title of a tool, with its mouse gestures below."""

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
        """Text for the search."""
        return " ".join([self._gesture.title, self._gesture.text, tr("mouse")])

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icon."""
        self.symbol.setPixmap(icon(self._gesture.image, theme).pixmap(ICON_SIZE, self.devicePixelRatioF()))


ShortcutRow = ActionRow | GestureRow


class ShortcutGroup(QWidget):
    """Rows under a heading, hidden if all of them are.

    Attributes
    ----------
    rows : list of ActionRow or GestureRow
    """

    def __init__(self, title: str, rows: list[ShortcutRow], column: QWidget) -> None:
        super().__init__(column)
        self.rows = rows
        self._title = title
        grid = QGridLayout(self, verticalSpacing=0)
        grid.setContentsMargins(0, 8, 0, 4)
        heading = QLabel(title, objectName="heading")
        heading.setContentsMargins(8, 0, 0, 4)
        grid.addWidget(heading, 0, 0, Qt.AlignmentFlag.AlignLeft)  # no wider than its words
        for row in rows:
            grid.addWidget(row)

    def filter_rows(self, words: list[str]) -> int:
        """Show the rows matching all words; their number."""
        found = 0
        for row in self.rows:
            said = f"{self._title} {row.search_text}".replace(":", " ").casefold().split()
            fits = all(any(other.startswith(word) for other in said) for word in words)
            row.setVisible(fits)
            found += fits
        self.setVisible(bool(found))
        return found


class MouseGesture(NamedTuple):
    """Mouse gesture of a tool.

    Parameters
    ----------
    title : str
        Of the tool, or of the way to paint.
    image : str
        Name of its icon.
    text : str
    """

    title: str
    image: str
    text: str


# Camera gestures of apd_viewer.ui.scene.navigation, the same with every tool.
_ALWAYS = tr("right drag orbits, middle button or Shift+drag pans, Ctrl+right drag zooms")


def mouse_gestures() -> list[MouseGesture]:
    """All mouse gestures."""
    plain = [tool for tool in Tool if not tool.words.is_brush]
    found = [
        MouseGesture(tr("With any tool"), "view", _ALWAYS),
        *(MouseGesture(tool.words.title, tool.words.icon, tool.words.hint) for tool in plain),
        MouseGesture(tr("While painting"), Tool.HANDLE.words.icon, Tool.HANDLE.modifiers),
        *(MouseGesture(way.words.title, way.words.icon, way.words.hint) for way in SelectionMode),
    ]
    return [gesture._replace(text=gesture.text[:1].upper() + gesture.text[1:]) for gesture in found]
