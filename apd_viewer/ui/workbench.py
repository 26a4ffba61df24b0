"""All that works on a session, built on the shell once its libraries are loaded."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from PySide6.QtCore import QObject, Qt, QTimer, Slot
from PySide6.QtGui import QCloseEvent

from apd_viewer.language import tr
from apd_viewer.session.model.state import State
from apd_viewer.session.model.view import View
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.session import Session
from apd_viewer.session.storage.session_picture import PICTURE_SIDE
from apd_viewer.ui.actions.actions import Actions
from apd_viewer.ui.actions.commands import Commands
from apd_viewer.ui.actions.edit_commands import Editing
from apd_viewer.ui.actions.part_commands import PartCommands
from apd_viewer.ui.case_studies.case_studies import CaseStudies
from apd_viewer.ui.compare.compare_controller import Comparing
from apd_viewer.ui.connections import connect_hand, connect_parts, connect_settings, connect_wheel
from apd_viewer.ui.filing import file_dialogs
from apd_viewer.ui.filing.file_commands import Filing
from apd_viewer.ui.filing.recovery_bar import RecoveryBar
from apd_viewer.ui.help.help import Help
from apd_viewer.ui.measuring.measure_controller import MeasureController
from apd_viewer.ui.obstacles.obstacle_controller import ObstacleController
from apd_viewer.ui.overlays.display_options import Looks
from apd_viewer.ui.overlays.findings_controller import Health
from apd_viewer.ui.overlays.next_step import NextStep, leads_on
from apd_viewer.ui.overlays.notice import Empty, Invitation, Notice
from apd_viewer.ui.overlays.selection_mode_bar import WayBar
from apd_viewer.ui.panel.measurements_controller import Measuring
from apd_viewer.ui.panel.target_controller import Targeting
from apd_viewer.ui.plots.plots import Plots
from apd_viewer.ui.posing.motion_preview import MotionPreview
from apd_viewer.ui.posing.pose_controller import PoseController
from apd_viewer.ui.posing.symmetry_controller import SymmetryController
from apd_viewer.ui.preferences.unit_button import Units
from apd_viewer.ui.scene.scene_picture import small_picture
from apd_viewer.ui.session_signals import SessionSignals
from apd_viewer.ui.settings_page.preference_effects import (
    connect_language,
    connect_menu,
    connect_preferences,
)
from apd_viewer.ui.settings_page.preference_table import COLOR_SCHEME, UNIT
from apd_viewer.ui.settings_page.settings_dialog import SettingsPage
from apd_viewer.ui.sharing.report_controller import Reporting
from apd_viewer.ui.shell import Shell
from apd_viewer.ui.studies.studies import Studies
from apd_viewer.ui.tools.active_parts import ActiveParts
from apd_viewer.ui.tools.tool_choice import ToolChoice
from apd_viewer.ui.tools.toolbox import Tool
from apd_viewer.ui.widgets.theme import Theme


class Workbench(QObject):
    """A session, and the controllers and overlays of its window.

    Parameters
    ----------
    shell : Shell
    recovery : Path or None
        Folder for autosaves; None keeps nothing.
    """

    def __init__(self, shell: Shell, recovery: Path | None = None) -> None:
        super().__init__(shell)
        self.shell, self.canvas, self.panel = shell, shell.canvas, shell.panel
        self.memory, self.docks, self.status = shell.memory, shell.docks, shell.status
        self.signals = SessionSignals(self)
        self.session = Session(self.signals.listener())
        self.parts = ActiveParts(self.session, self)
        self.tools = ToolChoice(self.canvas)
        self._agreed = False  # to being closed
        self._make_overlays()
        self._make_controllers(recovery)
        self._make_actions()
        self._connect_session()
        self._connect_canvas()
        self._connect_shell()
        connect_preferences(self.memory.values, self.session, self.tools, self.canvas.painter.size)
        self.tools.take(self.canvas.tool)
        self._show_status()
        self.recovery.restore_asked.connect(self.filing.restore)
        self.recovery.offer(self.filing.leftovers())
        shell.requests.serve(self.filing)

    # Building

    def _make_overlays(self) -> None:
        view = self.canvas.viewport
        self.invitation = Invitation(view)
        self.recovery = RecoveryBar(view)
        self.notice = Notice(view, (self.invitation, self.recovery))
        self.health = Health(self.canvas, self.shell.badge, self.session)
        self.empty = Empty(view, self.shell.requests)
        below = self.invitation, self.recovery, self.notice, self.health.list
        self.looks = Looks(self.canvas, self.memory, below)

    def _make_controllers(self, recovery: Path | None) -> None:
        shell, canvas, memory = self.shell, self.canvas, self.memory
        session, notice = self.session, self.notice
        self.units = Units(memory, lambda: memory.values[UNIT])
        self.settings_page = SettingsPage(shell, memory.values, lambda: self.help.open_sheet())
        self.measuring = Measuring(self.panel, self.health, memory, self.looks.heat, session)
        self.targeting = Targeting(shell, self.panel.target, memory, self.looks.heat, session)
        self.measure = MeasureController(canvas, self.panel.measure, session, self.tools.take, notice.tell)
        self.plots = Plots(memory, notice, session)
        self.docks["plots"].setWidget(self.plots)
        picture = partial(small_picture, canvas.viewport, PICTURE_SIDE)
        self.filing = Filing(shell, memory, session, self.view, picture, recovery)
        self.editing = Editing(canvas, self.panel, session, self.parts, self.tools.take)
        self.obstacles = ObstacleController(
            canvas,
            self.panel.obstacles,
            session,
            self.parts,
            self.tools.take,
            self.editing.give_up,
            self.measuring.wall_thickness,
        )
        self.editing.nudges_obstacle = self.obstacles.nudge
        self.preview = MotionPreview(canvas, self.panel.handles.motion, session, self.parts)
        self.symmetry = SymmetryController(
            self.panel.handles.symmetry, session, self.parts, self.editing.give_up
        )
        self.poses = PoseController(self.panel.poses, session, self.editing.give_up)
        self.looks.cards.stand_above(self.editing.typed.cards)
        self.notice.stand_above(self.editing.typed.cards)
        self.studies = Studies(shell, memory, session, self.filing, self._studied, notice.fail)
        ghost, dock = self.preview.ghost, self.docks["study"]
        self.case_studies = CaseStudies(
            shell, dock, memory, session, self.filing, self._studied, notice, ghost
        )
        self.comparing = Comparing(canvas, self.looks, memory, notice, session.store)
        self.reporting = Reporting(shell, canvas, self.looks, self.measuring, memory, notice, session)

    def _make_actions(self) -> None:
        self.shell.chrome.remove()
        self.actions_ = actions = Actions(self.shell, self._commands())
        actions.add_panels(self.docks.toggles)
        actions.file.fill_recent(self.memory.recent)
        add_handle, _, add_region = actions.pose.parts
        self.panel.name_keys(add_handle, actions.pose.put_back, add_region)
        self.way_bar = WayBar(self.canvas.viewport, tr("Selection tools"), actions.select.groups)
        self.kind_bar = WayBar(
            self.canvas.viewport, tr("Measurements"), [list(actions.measure.kinds.values())]
        )
        for bar in (self.way_bar, self.kind_bar):
            self.looks.cards.stand_beside(bar)
        self.next_step = NextStep(self.invitation, actions.tools)
        self.help = Help(
            self.shell,
            (self.canvas, actions, self.panel),
            self.memory,
            partial(self.filing.open_sample, "bottle"),
            self.session,
            self.settings_page.open_at,
        )

    def _commands(self) -> Commands:
        return Commands(
            canvas=self.canvas,
            requests=self.shell.requests,
            filing=self.filing,
            editing=self.editing,
            parts=PartCommands(self.canvas, self.session, self.parts, self.editing.give_up),
            symmetry=self.symmetry,
            poses=self.poses,
            looks=self.looks,
            measure=self.measure,
            obstacles=self.obstacles,
            findings=self.health,
            studies=self.studies,
            case_studies=self.case_studies,
            comparing=self.comparing,
            reporting=self.reporting,
            targeting=self.targeting,
            take=self.tools.take,
            choose_way=self.tools.choose_way,
            type_motion=self._type_motion,
            pause=self.session.store.pause_or_resume,
            set_scheme=partial(self.memory.values.choose, COLOR_SCHEME),
            open_settings=self.settings_page.open,
            help=lambda: self.help,  # which is made of the actions
            tell_about=partial(file_dialogs.about, self.shell),
            quit=self.shell.close,
        )

    # Connecting

    def _connect_session(self) -> None:
        signals = self.signals
        signals.woken.connect(self._receive, Qt.ConnectionType.QueuedConnection)
        signals.changed.connect(self._show)
        signals.changed.connect(self.preview.follow)
        for change in (signals.changed, signals.status_changed):
            change.connect(self.filing.show_title)
            change.connect(self.targeting.follow)
        signals.status_changed.connect(self._show_status)
        signals.status_changed.connect(self.preview.follow_status)
        signals.told.connect(self.notice.tell)
        signals.failed.connect(self.notice.fail)
        signals.viewed.connect(self._look_as)
        signals.measured.connect(self.measuring.show)
        for change in (signals.changed, signals.measured):
            change.connect(self.measure.follow)
        signals.changed.connect(self.obstacles.follow)
        self.looks.cut.measure_asked.connect(self.measure.add_section)
        self.parts.changed.connect(self._show_parts)
        connect_settings(self.panel, self.session)
        connect_parts(self.panel, self.session, self.parts)
        self.panel.area.unit.chosen.connect(self.choose_unit)
        self.shell.history.chosen.connect(self.editing.travel)
        self.status.cancel_asked.connect(self.session.jobs.cancel)
        self.status.pause_asked.connect(self.session.store.pause_or_resume)
        self.status.restart_asked.connect(self.session.store.restart_solver)

    def _connect_canvas(self) -> None:
        canvas = self.canvas
        connect_hand(canvas, self.session, self.parts, self.notice.tell, self.status.showMessage)
        canvas.strokes.began.connect(lambda: self.invitation.say(""))
        canvas.strokes.ended.connect(self._show_next_step)
        canvas.drag_began.connect(self.next_step.moved)
        self.obstacles.moved.connect(self.next_step.moved)
        self.obstacles.placer.asks.connect(self.status.showMessage)
        connect_wheel(canvas, self.session, self.status)
        self.tools.taken.connect(self._show_tool)
        self.tools.way_chosen.connect(lambda way: self.actions_.select.ways[way].setChecked(True))
        for change in (self.help.tour.began, self.help.tour.ended):
            change.connect(self._show_next_step)

    def _connect_shell(self) -> None:
        self.shell.closing.connect(self._ask_before_closing)
        self.shell.closing.connect(self.case_studies.ask_before_closing)
        self.shell.closed.connect(self._close)
        self.shell.escaped.connect(self._escape)
        self.shell.activated.connect(self.session.saved_work.look)
        connect_menu(self.memory.values, self.actions_.view.schemes)
        connect_language(self.memory.values, self.notice.fail)
        self.shell.themed.connect(self._set_theme)
        self._set_theme(self.shell.theme)

    # Commands

    def _type_motion(self) -> None:
        self.docks["readings"].show()
        self.panel.show_motion()

    def choose_unit(self, unit: Unit) -> None:
        """Read the mesh in a unit of length, and remember it."""
        if (state := self.session.store.state) is not None:
            self.units.choose(state.document.mesh, unit)
            self.session.store.unit = unit
            self.looks.measure_in(unit)
            self.comparing.measure_in(unit)
            self.measure.follow()
            self.obstacles.follow()
            self.panel.measure_in(unit, state, self.parts.handle, self.parts.region)
            self.measuring.keep_distance()
            self.status.show_session(self.session)

    def _escape(self) -> None:
        if not (self.help.close() or self.health.close()):
            self.tools.take(Tool.ORBIT)

    def view(self) -> View:
        """Current look of the window, as a session keeps it."""
        return self.measuring.in_view(self.canvas.view.saved(self.session.store.unit.value))

    def _studied(self) -> tuple[State, int, View] | None:
        store = self.session.store
        if store.state is None:
            return None
        return store.state, self.parts.handle, self.canvas.view.saved(store.unit.value)

    # Showing

    @Slot()
    def _receive(self) -> None:
        # A call may still be on its way when the window is closed.
        if not self.shell.is_closed:
            self.session.receive()

    def _show(self, old: State | None, new: State) -> None:
        document = new.document
        self.parts.follow(None if old is None else old.document, document)
        self.canvas.show_state(old, new, self.parts.handle, self.parts.region)
        self.looks.follow(new)
        if old is None or old.document.mesh is not document.mesh:
            self.health.show(new.inspection.findings)
            if old is None or old.document.mesh.F is not document.mesh.F:
                self._show_opened(new)
        self.panel.show_state(old, new, self.parts.handle, self.parts.region)
        self.symmetry.follow()
        if old is None or old.document is not document:
            self.poses.follow()
            self.actions_.follow(document)
        self.measuring.follow(old, new)
        self.actions_.pose.show_symmetry(document.mirror is not None)
        self.plots.follow()
        self.health.follow()
        before = None if old is None else old.document
        if before is None or leads_on(before, document):
            self._show_next_step()

    def _show_opened(self, state: State) -> None:
        mesh = state.document.mesh
        self.notice.hide()
        self.actions_.view.follow()
        self.tools.take(Tool.BASE if state.document.problem else Tool.MOVE)
        self.session.store.unit = self.panel.unit = self.units.of(mesh)
        self.panel.handles.motion.clear()
        self.measuring.welcome(mesh)
        self.looks.measure_in(self.session.store.unit)
        self.filing.opened(state)
        self.actions_.file.fill_recent(self.memory.recent)

    def _look_as(self, view: View) -> None:
        self.canvas.view.restore(view)
        self.actions_.view.camera.follow()
        self.measuring.look_as(view)
        self.choose_unit(Unit(view.unit))

    def _show_parts(self) -> None:
        self.canvas.choose(self.parts.handle, self.parts.region)
        if self.session.store.state is not None:
            self.panel.show_parts(self.session.store.state, self.parts.handle, self.parts.region)
        self._show_next_step()

    def _show_status(self) -> None:
        session = self.session
        history, state = session.gestures.history, session.store.state
        self.actions_.show_history(history.next_undo, history.next_redo)
        if state is not None:
            first = (history.past or [state])[0].document.mesh
            self.shell.history.show_steps(first.name, history.done, history.undone)
        self.actions_.offer(state is not None, state is None or state.is_at_rest)
        self.panel.show_status(session)
        self.empty.setVisible(state is None and session.jobs.current is None)
        self.status.show_session(session)
        self.next_step.follow(session.store)
        self.notice.hold(session.store.silence)
        self.recovery.follow(session)
        self.help.follow()

    def _show_tool(self, tool: Tool) -> None:
        self.actions_.tools[tool].setChecked(True)
        self.measure.tool.enabled = measures = tool is Tool.MEASURE
        self.status.hint(self.measure.hint if measures else tool.hint(self.canvas.way))
        self.way_bar.show_for(tool.words.is_brush)
        self.kind_bar.show_for(measures)
        self.obstacles.take(tool)
        self._show_next_step()

    def _show_next_step(self) -> None:
        state = self.session.store.state
        if self.help.tour.active:
            self.next_step.rest()  # the card says it
        elif state is not None:
            self.next_step.say_next(state.document, self.canvas.tool, self.parts.handle, self.parts.obstacle)

    def _set_theme(self, theme: Theme) -> None:
        over = self.notice, self.recovery, self.health.list, self.help, self.looks
        bars = self.way_bar, self.kind_bar
        for part in (self.actions_, self.plots, self.comparing, self.case_studies, *over, *bars):
            part.set_theme(theme)

    # Closing

    def _ask_before_closing(self, event: QCloseEvent) -> None:
        if not self._agreed and not self.filing.may_leave(self._close_anyway, closes=True):
            event.ignore()

    def _close_anyway(self) -> None:
        self._agreed = True
        # Later: the session is still delivering what was written.
        QTimer.singleShot(0, self.shell, self.shell.close)

    def _close(self) -> None:
        self.help.tour.end()
        self.health.close()
        self.recovery.close_all()
        self.plots.end()
        self.looks.close()
        self.targeting.close()
        self.studies.close_all()
        self.case_studies.close()
        self.settings_page.close()
        self.comparing.close()
        self.session.close()
