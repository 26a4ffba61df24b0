"""Help over the window: shortcut sheet and tour."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, QTimer
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMainWindow, QMenu, QWidget

from apd_viewer.files.samples import resource
from apd_viewer.language import tr
from apd_viewer.session.model.targets import kept_percentages
from apd_viewer.session.session import Session
from apd_viewer.session.store import Activity
from apd_viewer.ui.actions.action_factory import plain
from apd_viewer.ui.help.mouse_help import gestures
from apd_viewer.ui.help.shortcut_rows import ActionRow, GestureRow, Group, Row
from apd_viewer.ui.help.shortcut_sheet import ShortcutSheet
from apd_viewer.ui.help.tour import Tour
from apd_viewer.ui.help.tour_targets import Places
from apd_viewer.ui.preferences.shortcuts import Shortcuts
from apd_viewer.ui.tools.toolbox import Tool

if TYPE_CHECKING:
    from apd_viewer.ui.actions.actions import Actions
    from apd_viewer.ui.panel.panel import Panel
    from apd_viewer.ui.preferences.preferences import Preferences
    from apd_viewer.ui.tools.canvas import Canvas
    from apd_viewer.ui.widgets.theme import Theme


class Help(QObject):
    """Opens and closes sheet and tour, and keeps them out of each other's way.

    Parameters
    ----------
    window : QMainWindow
    parts : tuple
        The window's canvas, actions and panel.
    memory : Preferences
    open_bottle : callable
        Opens the sample that the tour speaks of.
    session : Session

    Attributes
    ----------
    shortcuts : Shortcuts
    sheet : ShortcutSheet
    tour : Tour
    """

    def __init__(
        self,
        window: QMainWindow,
        parts: tuple[Canvas, Actions, Panel],
        memory: Preferences,
        open_bottle: Callable[[], object],
        session: Session,
    ) -> None:
        super().__init__(window)
        self._window = window
        self._memory = memory
        self._open_bottle = open_bottle
        canvas, actions, panel = parts
        self._canvas = canvas
        self.shortcuts = Shortcuts(actions.entries, _mnemonics(window), memory)
        self.sheet = ShortcutSheet(canvas.viewport, self.shortcuts, self._groups)
        self.tour = Tour(window, canvas, Places(window, *parts))
        self.sheet.dismissed.connect(self.close)
        self.tour.area_wanted.connect(lambda: panel.ensureWidgetVisible(panel.area.percent))
        self.tour.ring_wanted.connect(partial(_show_gizmo, canvas, actions))
        self._session = session
        self._wished = False
        self._mesh: object = None

    def open_sheet(self) -> None:
        """List the shortcuts, or close the list."""
        if not self._close_sheet():
            self.tour.card.hide()
            self.sheet.open()

    def begin_tour(self) -> None:
        """Begin the tour, on the bottle."""
        self._close_sheet()
        self.tour.end()
        if self._can_begin():
            self._begin()
        else:
            self._open_bottle()  # which may ask first
            self._wished = True

    def greet(self, on_bottle: bool) -> None:
        """Start the tour with the bottle, at the first start only."""
        self._wished = on_bottle and not self._memory.toured
        self._memory.toured = True

    def follow(self) -> None:
        """Start a waiting tour with the bottle; end it with another mesh."""
        state = self._session.store.state
        if state is None or self._session.jobs.current is not None:
            return
        if self.tour.active and state.document.mesh is not self._mesh:
            self.tour.end()
        if self._wished:
            self._wished = False
            if self._can_begin():
                QTimer.singleShot(0, self, self._begin)  # the mesh is shown by then

    def close(self) -> bool:
        """Close the sheet, or else end the tour; True if there was one to close."""
        return self._close_sheet() or self.tour.end()

    def set_theme(self, theme: Theme) -> None:
        """Redraw the parts beyond the style sheet's reach."""
        self.sheet.set_theme(theme)
        self.tour.card.set_theme(theme)

    def _can_begin(self) -> bool:
        """True if the bottle is open and its handle can be moved."""
        state = self._session.store.state
        if state is None or state.document.problem:
            return False
        return state.document.mesh.path == resource("bottle.obj")

    def _begin(self) -> None:
        store = self._session.store
        if store.state is not None and self._can_begin():
            self._mesh = store.state.document.mesh
            self.tour.begin(lambda: store.activity is not Activity.REFINING, self._holds_area)

    def _holds_area(self) -> bool:
        state = self._session.store.state
        return state is not None and kept_percentages(state.document)[0] is not None

    def _close_sheet(self) -> bool:
        if self.sheet.isHidden():
            return False
        if self.sheet.isAncestorOf(self._window.focusWidget()):
            self._canvas.viewport.setFocus()
        self.sheet.hide()
        self.tour.card.setVisible(self.tour.active)
        return True

    def _groups(self, parent: QWidget) -> list[Group]:
        """All actions by their menus, and the gestures of the mouse."""
        entries = {entry.action: entry for entry in self.shortcuts.entries}
        groups = []
        for top in self._window.menuBar().actions():
            rows: list[Row] = [
                ActionRow(entries[action], _full(within, entries[action].title))
                for action, within in _leaves(_menu(top))
                if action in entries
            ]
            groups.append(Group(plain(top.text()), rows, parent))
        groups.append(Group(tr("Mouse"), [GestureRow(gesture) for gesture in gestures()], parent))
        return groups


def _show_gizmo(canvas: Canvas, actions: Actions) -> None:
    if not canvas.gizmo.visible:
        actions.tools[Tool.MOVE].trigger()


def _full(within: str, title: str) -> str:
    """Title prefixed by its submenu's, unless they repeat each other."""
    if not within or title.startswith(within):
        return title
    return tr("{menu}: {title}").format(menu=within, title=title)


def _leaves(menu: QMenu, within: str = "") -> Iterator[tuple[QAction, str]]:
    """Actions of a menu with the titles of their submenus."""
    for action in menu.actions():
        if action.menu() is not None:
            yield from _leaves(_menu(action), plain(action.text()))
        elif not action.isSeparator():
            yield action, within


def _menu(action: QAction) -> QMenu:
    menu = action.menu()
    assert isinstance(menu, QMenu)
    return menu


def _mnemonics(window: QMainWindow) -> dict[str, str]:
    """Mnemonics of the menus, and their titles."""
    titles = [top.text() for top in window.menuBar().actions()]
    return {f"Alt+{title.partition('&')[2][:1].upper()}": plain(title) for title in titles if "&" in title}
