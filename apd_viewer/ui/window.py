"""The main window: pushes what changed to the views, and what the user does to the session."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtCore import QEvent, QSettings, QSize, Qt, QTimer, Signal, Slot
from PySide6.QtGui import QCloseEvent, QDragEnterEvent, QDropEvent, QKeyEvent
from PySide6.QtWidgets import QMainWindow, QPushButton

from apd_viewer.files.samples import SAMPLES
from apd_viewer.language import tr
from apd_viewer.ui.actions.actions import Actions
from apd_viewer.ui.actions.commands import Commands
from apd_viewer.ui.actions.edit_commands import Editing
from apd_viewer.ui.compare.compare_controller import Comparing
from apd_viewer.ui.connections import connect_hand, connect_parts, connect_settings
from apd_viewer.ui.docks import Docks
from apd_viewer.ui.filing import file_dialogs
from apd_viewer.ui.filing.file_commands import Filing
from apd_viewer.ui.filing.recovery_bar import RecoveryBar
from apd_viewer.ui.help.help import Help
from apd_viewer.ui.overlays.display_options import Looks
from apd_viewer.ui.overlays.findings_controller import Health
from apd_viewer.ui.overlays.next_step import NextStep
from apd_viewer.ui.overlays.notice import Empty, Invitation, Notice
from apd_viewer.ui.overlays.selection_mode_bar import WayBar
from apd_viewer.ui.panel.history_list import HistoryList
from apd_viewer.ui.panel.measurements_controller import Measuring
from apd_viewer.ui.panel.panel import Panel
from apd_viewer.ui.panel.statusbar import StatusBar
from apd_viewer.ui.plots.plots import Plots
from apd_viewer.ui.preferences.preferences import Preferences
from apd_viewer.ui.preferences.unit_button import Units
from apd_viewer.ui.sharing.report_controller import Reporting
from apd_viewer.ui.studies.studies import Studies
from apd_viewer.ui.tools.active_parts import ActiveParts
from apd_viewer.ui.tools.canvas import Canvas
from apd_viewer.ui.tools.toolbox import Tool, Way
from apd_viewer.ui.widgets import theme
from apd_viewer.ui.widgets.fit_to_screen import resize_on_screen
from apd_viewer.ui.widgets.icons import application_icon

if TYPE_CHECKING:
    from pathlib import Path

    from apd_viewer.session.model.document import State
    from apd_viewer.session.model.view import View
    from apd_viewer.session.quantities.units import Unit
    from apd_viewer.session.session import Session


class Window(QMainWindow):
    """A canvas in the middle, tools at the left, readings at the right.

    It can be seen before all that it works with is loaded: :meth:`start` makes it work.

    Parameters
    ----------
    settings : QSettings
        Where recent files and the layout are remembered.
    recovery : Path or None
        The folder in which what is done is kept for the case of a crash; None keeps nothing.

    Attributes
    ----------
    docks : Docks
    session : Session
    parts : ActiveParts
        Both from the start on.
    """

    session: Session
    parts: ActiveParts

    _woken = Signal()

    def __init__(self, settings: QSettings, recovery: Path | None = None) -> None:
        super().__init__()
        self._memory = Preferences(settings)
        self._units = Units(self._memory)
        self.filing = Filing(
            self, self._memory, lambda unit: self.measuring.in_view(self.canvas.view(unit)), recovery
        )
        self.setWindowTitle("APD Viewer")
        self.setWindowIcon(application_icon())
        self.setAcceptDrops(True)
        self.setMinimumSize(800, 640)
        self.setContextMenuPolicy(Qt.ContextMenuPolicy.NoContextMenu)  # it would hide the tools for good
        resize_on_screen(self, QSize(1280, 800))
        self._started = self._closed = False
        self.canvas = Canvas(self)
        self.setCentralWidget(self.canvas.viewport)
        self._make_overlays()
        self.looks = Looks(self.canvas, self._memory, (self.invitation, self.recovery, self.health.list))
        self.comparing = Comparing(self.canvas, self.looks, self._memory, self.notice)
        self._make_panel()
        self.reporting = Reporting(self, self.canvas, self.looks, self.measuring, self._memory, self.notice)
        self.editing = Editing(self.canvas, self.panel, self.take)
        self.status = StatusBar(self.health.badge)
        self.setStatusBar(self.status)
        self.studies = Studies(self, self._memory, self._studied, self.notice.fail)
        self.actions_ = Actions(self, self._commands())
        self._next_step = NextStep(self.invitation, self.actions_.tools)
        add_handle, _, add_region = self.actions_.pose.parts
        self.panel.name_keys(add_handle, self.actions_.pose.put_back, add_region)
        self.way_bar = WayBar(self.canvas.viewport, self.actions_.select.groups)
        self.looks.cards.stand_beside(self.way_bar)
        self.actions_.add_panels(self.docks.toggles)
        parts = self.canvas, self.actions_, self.panel
        self.help = Help(self, parts, self._memory, partial(self.filing.open_sample, "bottle"))
        for change in (self.help.tour.began, self.help.tour.ended):
            change.connect(self._invite)
        self.actions_.show_history(None, None)
        self.actions_.file.fill_recent(self._memory.recent)
        self._memory.restore_layout(self)
        self._set_scheme(self._memory.scheme)
        self.choose_way(Way.BRUSH)
        self.take(Tool.MOVE)
        self._show_state(None)

    def start(self) -> None:
        """Begin to work, and open what was asked for in the meantime."""
        if self._closed:
            return
        # Here, because it takes longer to import than all that a first picture of the window needs.
        from apd_viewer.session.listener import Listener
        from apd_viewer.session.session import Session

        self.session = Session(
            Listener(
                wake=self._woken.emit,
                changed=self._changed,
                status_changed=self._status_changed,
                told=self.notice.tell,
                failed=self.notice.fail,
                viewed=self._look_as,
                examined=self.measuring.show,
            )
        )
        self._woken.connect(self._receive, Qt.ConnectionType.QueuedConnection)
        self.parts = ActiveParts(self.session, self)
        self.parts.changed.connect(self._parts_changed)
        self.status.cancel_asked.connect(self.session.jobs.cancel)
        self._connect_canvas()
        self._connect_panel()
        self.plots.start(self.session)
        self.comparing.start(self.session)
        self.reporting.start(self.session)
        self._started = True
        self.filing.start(self.session)
        self.recovery.start()
        self._status_changed()

    # Building

    def _make_overlays(self) -> None:
        view = self.canvas.viewport
        self.notice = Notice(view)
        self.invitation = Invitation(view)
        self.recovery = RecoveryBar(view, self.filing)
        self.health = Health(self.canvas)
        buttons = [QPushButton(tr("Open mesh…"), objectName="primary", clicked=self.filing.ask_for_file)]
        for name, title in SAMPLES.items():
            buttons.append(QPushButton(title, clicked=partial(self.filing.open_sample, name)))
        self._empty = Empty(view, buttons)

    def _make_panel(self) -> None:
        self.panel = Panel()
        self.panel.folded = self._memory.folded
        self.measuring = Measuring(self.panel, self.health, self._memory, self.looks.heat)
        self._history = HistoryList()
        self.docks = Docks(self)
        self.docks.add("readings", tr("Measurements"), self.panel)
        self.docks.add("history", tr("History"), self._history, shown=False)
        self.plots = Plots(self._memory, self.notice)
        below = Qt.DockWidgetArea.BottomDockWidgetArea
        self.docks.add("plots", tr("Plots"), self.plots, below, False).toggleViewAction().setShortcut(
            "Ctrl+P"
        )

    def _commands(self) -> Commands:
        return Commands(
            canvas=self.canvas,
            filing=self.filing,
            editing=self.editing,
            looks=self.looks,
            findings=self.health,
            studies=self.studies,
            comparing=self.comparing,
            reporting=self.reporting,
            take=self.take,
            choose_way=self.choose_way,
            type_motion=self._type_motion,
            set_scheme=self._set_scheme,
            list_shortcuts=lambda: self.help.open_sheet(),
            begin_tour=lambda: self.help.begin_tour(),
            tell_about=partial(file_dialogs.about, self),
            quit=self.close,
        )

    def _connect_canvas(self) -> None:
        canvas = self.canvas
        canvas.stroke_began.connect(self._begin_stroke)
        connect_hand(canvas, self.session, self.parts, self.notice.tell, self.status.showMessage)
        canvas.stroke_ended.connect(self._end_stroke)
        canvas.drag_began.connect(self._next_step.moved)
        canvas.painter.size_changed.connect(self._say_brush)

    def _connect_panel(self) -> None:
        panel, session, parts = self.panel, self.session, self.parts
        connect_settings(panel, session)
        connect_parts(panel, session, parts)
        self.editing.start(session, parts)
        self.looks.cards.stand_above(self.editing.typed.cards)
        self.measuring.start(session)
        self._history.chosen.connect(self.editing.travel)
        panel.area.unit.chosen.connect(self._choose_unit)

    # The user's verbs that need a word with the user

    @property
    def _state(self) -> State | None:
        return self.session.store.state if self._started else None

    def take(self, tool: Tool) -> None:
        """Put a tool into the hand."""
        self.canvas.take(tool)
        self.actions_.tools[tool].setChecked(True)
        self.status.hint(tool.hint(self.canvas.way))
        self.way_bar.show_for(tool.words.is_brush)
        self._invite()

    def choose_way(self, way: Way) -> None:
        """Choose vertices in another way; a tool that paints nothing gives way to one that does."""
        self.canvas.choose_way(way)
        self.actions_.select.ways[way].setChecked(True)
        paints = self.canvas.tool.words.is_brush
        self.take(self.canvas.tool if paints or not self._started else Tool.HANDLE)

    def _begin_stroke(self) -> None:
        if self._state is not None:
            self.session.gestures.begin()
            self.invitation.say("")

    def _end_stroke(self, gesture: str) -> None:
        self.session.painting.end_stroke(gesture)
        self._invite()

    def _type_motion(self) -> None:
        self.docks["readings"].show()
        self.panel.show_motion()

    def _studied(self) -> tuple[State, int, View] | None:
        if self._state is None:
            return None
        return self._state, self.parts.handle, self.canvas.view(self.session.store.unit.value)

    def _choose_unit(self, unit: Unit) -> None:
        if (state := self._state) is not None:
            self._units.choose(state.document.mesh, unit)
            self.session.store.unit = unit
            self.looks.measure_in(unit)
            self.comparing.measure_in(unit)
            self.panel.measure_in(unit, state, self.parts.handle, self.parts.region)
            self.status.show_session(self.session)

    def _say_brush(self) -> None:
        self.status.say_brush(self.canvas.painter, self.session.store.unit)

    # Showing

    @Slot()
    def _receive(self) -> None:
        # A call may still be on its way when the window is closed.
        if not self._closed:
            self.session.receive()

    def _changed(self, old: State | None, new: State) -> None:
        document = new.document
        self.parts.follow(None if old is None else old.document, document)
        self.canvas.show_state(old, new, self.parts.handle, self.parts.region)
        if old is None or old.document.mesh is not document.mesh:
            self.health.show(new.inspection.findings)
            self.looks.follow(new)
            if old is None or old.document.mesh.F is not document.mesh.F:
                self._welcome(new)
        self.panel.show_state(old, new, self.parts.handle, self.parts.region)
        self.plots.follow()
        if old is None or old.document.labels is not document.labels:
            self._invite()

    def _look_as(self, view: View) -> None:
        self.canvas.look_as(view)
        self.measuring.look_as(view)
        self._choose_unit(type(self.session.store.unit)(view.unit))
        self.filing.viewed()
        self.actions_.file.fill_recent(self._memory.recent)

    def _parts_changed(self) -> None:
        self.canvas.choose(self.parts.handle, self.parts.region)
        if self.session.store.state is not None:
            self.panel.show_parts(self.session.store.state, self.parts.handle, self.parts.region)
        self._invite()

    def _welcome(self, state: State) -> None:
        mesh = state.document.mesh
        self.notice.hide()
        self.setWindowFilePath(str(mesh.path or ""))
        self.setWindowTitle(tr("{name} – APD Viewer").format(name=mesh.name))
        self.take(Tool.BASE if state.document.problem else Tool.MOVE)
        self.session.store.unit = self.panel.unit = self._units.of(mesh)
        self.measuring.welcome(mesh)
        self.looks.measure_in(self.session.store.unit)
        self.filing.opened(state)
        self.actions_.file.fill_recent(self._memory.recent)

    def _status_changed(self) -> None:
        session, history = self.session, self.session.gestures.history
        self.actions_.show_history(history.next_undo, history.next_redo)
        self._history.show_steps(history.done, history.undone)
        self._show_state(session.store.state)
        self._empty.setVisible(session.store.state is None and session.jobs.current is None)
        self.status.show_session(session)
        self.recovery.follow(session)
        self.help.follow(session)

    def _show_state(self, state: State | None) -> None:
        """Offer what can be done with what is open, and say what the worker does about it."""
        moved = state is not None and not state.is_at_rest
        for action in self.actions_.of_a_mesh:
            action.setEnabled(state is not None)
        for action in (self.actions_.reset, self.actions_.bake):
            action.setEnabled(moved)
        self.panel.handles.reset.setEnabled(moved)
        self.panel.setEnabled(state is not None)
        if state is None:
            self.panel.area.activity.setText("")
        else:
            self.panel.area.show_activity(state, self.session)

    def _invite(self) -> None:
        state = self._state
        if self.help.tour.active:
            self.invitation.say("")  # the card says it
        elif state is not None:
            self._next_step.say_next(state.document, self.canvas.tool, self.parts.handle)

    def _set_scheme(self, scheme: Qt.ColorScheme) -> None:
        self._memory.scheme = scheme
        self.actions_.view.schemes[scheme].setChecked(True)
        self._dress()

    def _dress(self) -> None:
        colors = theme.theme_for(self._memory.scheme)
        theme.apply(colors)
        over = self.notice, self.recovery, self.health, self.help, self.looks, self.comparing, self.way_bar
        for part in (self.actions_, self.panel, self.plots, self.canvas, self.docks, *over):
            part.set_theme(colors)

    # Events

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Put the tool away on Esc, where nothing was under way that Esc could cancel or close."""
        if event.key() == Qt.Key.Key_Escape and not (self.help.close() or self.health.close()):
            self.take(Tool.ORBIT)
        super().keyPressEvent(event)

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:
        """Take one file, whatever it is; opening says what is wrong with it."""
        if len(event.mimeData().urls()) == 1 and event.mimeData().urls()[0].isLocalFile():
            event.acceptProposedAction()

    def dropEvent(self, event: QDropEvent) -> None:
        """Open the file."""
        self.filing.open_path(event.mimeData().urls()[0].toLocalFile())

    def changeEvent(self, event: QEvent) -> None:
        """Follow the platform from light to dark."""
        if event.type() == QEvent.Type.ThemeChange and self._memory.scheme is Qt.ColorScheme.Unknown:
            QTimer.singleShot(0, self, self._dress)
        super().changeEvent(event)

    def closeEvent(self, event: QCloseEvent) -> None:
        """Ask before a shape is lost; then end the worker, and the view before its window."""
        if not self.filing.may_close():
            event.ignore()
            return
        self._memory.keep_layout(self)
        self._memory.folded = self.panel.folded
        self._closed = True
        self.help.tour.end()
        closing = self.health.close, self.recovery.close_all, self.plots.end, self.looks.close
        for close in (*closing, self.studies.close_all, self.comparing.close):
            close()
        if self._started:
            self.session.close()
        self.canvas.viewport.close()
        super().closeEvent(event)
