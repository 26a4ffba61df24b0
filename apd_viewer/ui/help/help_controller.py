"""Controller of the help over the window: shortcut sheet, search and tour."""

from collections.abc import Callable
from functools import partial

from PySide6.QtCore import QObject, QTimer
from PySide6.QtWidgets import QMainWindow, QWidget

from apd_viewer.files.samples import resource_path
from apd_viewer.language import tr
from apd_viewer.session.model.document_parts import goal_percentages
from apd_viewer.session.session import Session
from apd_viewer.session.state_store import Activity
from apd_viewer.ui.actions.actions import Actions
from apd_viewer.ui.help.command_search import CommandSearch
from apd_viewer.ui.help.context_help import ContextHelp, look_up_in_manual, show_manual
from apd_viewer.ui.help.manual import FIRST_PAGE, ManualPlace
from apd_viewer.ui.help.searchable import menu_entries, searchable_entries
from apd_viewer.ui.help.shortcut_rows import ActionRow, GestureRow, ShortcutGroup, ShortcutRow, mouse_gestures
from apd_viewer.ui.help.shortcut_sheet import ShortcutSheet
from apd_viewer.ui.help.tour import Tour, TourTargets
from apd_viewer.ui.panel.panel import Panel
from apd_viewer.ui.preferences.action_maker import connect_action, without_mnemonic
from apd_viewer.ui.preferences.preferences import Preferences
from apd_viewer.ui.preferences.shortcuts import Shortcuts
from apd_viewer.ui.tools.canvas import Canvas
from apd_viewer.ui.tools.tool_modes import Tool
from apd_viewer.ui.widgets.theme import Theme


class HelpController(QObject):
    """Opens and closes shortcut sheet, command search and tour.

    Parameters
    ----------
    widgets : tuple
        The window's canvas, actions and panel.
    open_bottle : callable
        Opens the sample that the tour speaks of.
    open_settings : callable
        Opens the settings at a preference, by its name.
    """

    def __init__(
        self,
        window: QMainWindow,
        widgets: tuple[Canvas, Actions, Panel],
        preferences: Preferences,
        open_bottle: Callable[[], object],
        session: Session,
        open_settings: Callable[[str], object],
    ) -> None:
        super().__init__(window)
        self._window = window
        self._memory = preferences
        self._open_bottle = open_bottle
        canvas, actions, panel = widgets
        self._canvas = canvas
        self.shortcuts = Shortcuts(actions.entries, _mnemonics(window), preferences)
        self.sheet = ShortcutSheet(canvas.viewport, self.shortcuts, self._groups)
        self.tour = Tour(window, canvas, TourTargets(window, *widgets))
        self.search = CommandSearch(
            canvas.viewport,
            partial(searchable_entries, window, self.shortcuts.entries, panel, session.store, open_settings),
            look_up_in_manual,
        )
        self.context = ContextHelp(window, canvas, actions.help["help"], self._marked_place)
        for name, command in (
            ("manual", self.open_manual),
            ("help", self.context.explain_next_click),
            ("find_command", self.toggle_search),
            ("shortcuts", self.toggle_sheet),
            ("tour", self.begin_tour),
        ):
            connect_action(actions.help[name], command)
        for card in (self.sheet, self.search):
            card.dismissed.connect(self.close)
        self.tour.ring_requested.connect(partial(_show_gizmo, canvas, actions))
        self._session = session
        self._wished = False
        self._mesh: object = None

    def toggle_sheet(self) -> None:
        """Open the shortcut sheet, or close it if it is open."""
        if not self._close_sheet():
            self._close_card(self.search)
            self.tour.card.hide()
            self.sheet.open()

    def open_manual(self) -> None:
        """Open the first page of the manual."""
        show_manual(FIRST_PAGE)

    def toggle_search(self) -> None:
        """Open the command search, or close it if it is open."""
        if not self._close_card(self.search):
            self._close_sheet()
            self.search.open()

    def begin_tour(self) -> None:
        """Start the tour on the sample bottle."""
        self._close_sheet()
        self.tour.end()
        if self._can_begin():
            self._begin()
        else:
            self._open_bottle()  # opening may first ask about unsaved work
            self._wished = True

    def plan_first_tour(self, opens_sample: bool) -> None:
        """On the first run, schedule the tour to start when the bottle opens."""
        self._wished = opens_sample and not self._memory.has_seen_tour
        self._memory.has_seen_tour = True

    def refresh(self) -> None:
        """Start a scheduled tour once the sample is open; end it if another mesh is open."""
        state = self._session.store.state
        if state is None or self._session.jobs.current is not None:
            return
        if self.tour.is_active and state.document.mesh is not self._mesh:
            self.tour.end()
        if self._wished:
            self._wished = False
            if self._can_begin():
                QTimer.singleShot(0, self, self._begin)  # delayed until the mesh has been drawn

    def close(self) -> bool:
        """Close an open card, or else the tour; True if anything was closed."""
        return self._close_card(self.search) or self._close_sheet() or self.tour.end()

    def set_theme(self, theme: Theme) -> None:
        """Apply the theme to the parts not covered by the style sheet."""
        self.sheet.set_theme(theme)
        self.search.set_theme(theme)
        self.tour.card.set_theme(theme)

    def _can_begin(self) -> bool:
        """True if the bottle is open and its handle can be moved."""
        state = self._session.store.state
        if state is None or state.document.paint_problem:
            return False
        return state.document.mesh.path == resource_path("bottle.obj")

    def _begin(self) -> None:
        store = self._session.store
        if store.state is not None and self._can_begin():
            self._mesh = store.state.document.mesh
            self.tour.begin(lambda: store.activity is not Activity.REFINING, self._holds_area)

    def _holds_area(self) -> bool:
        state = self._session.store.state
        return state is not None and goal_percentages(state.document)[0] is not None

    def _close_sheet(self) -> bool:
        closed = self._close_card(self.sheet)
        if closed:
            self.tour.card.setVisible(self.tour.is_active)
        return closed

    def _close_card(self, card: QWidget) -> bool:
        if card.isHidden():
            return False
        if card.isAncestorOf(self._window.focusWidget()):
            self._canvas.viewport.setFocus()
        card.hide()
        return True

    def _marked_place(self) -> ManualPlace | None:
        """Location in the manual of the entry selected in the search, if it has the focus."""
        marked = self.search.marked_entry if self.search.isAncestorOf(self._window.focusWidget()) else None
        return None if marked is None else marked.place

    def _groups(self, parent: QWidget) -> list[ShortcutGroup]:
        """Rows of all actions by menu, and of the mouse gestures."""
        entries = {entry.action: entry for entry in self.shortcuts.entries}
        rows: dict[str, list[ShortcutRow]] = {}
        for found in menu_entries(self._window.menuBar()):
            entry = entries.get(found.action)
            if entry is not None:
                rows.setdefault(found.menu, []).append(ActionRow(entry, found.full_title(entry.title)))
        groups = [ShortcutGroup(title, own, parent) for title, own in rows.items()]
        gestures = mouse_gestures(self._canvas.viewport.navigation.preset)
        return [*groups, ShortcutGroup(tr("Gestures"), list(map(GestureRow, gestures)), parent)]


def _show_gizmo(canvas: Canvas, actions: Actions) -> None:
    if not canvas.gizmo.visible:
        actions.tools[Tool.MOVE].trigger()


def _mnemonics(window: QMainWindow) -> dict[str, str]:
    """Menu titles by their mnemonic keys."""
    titles = [top.text() for top in window.menuBar().actions()]
    return {
        f"Alt+{title.partition('&')[2][:1].upper()}": without_mnemonic(title)
        for title in titles
        if "&" in title
    }
