"""Controllers needing a session, added to the shell once libraries are loaded."""

from dataclasses import replace
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
from apd_viewer.ui import session_signals
from apd_viewer.ui.actions.actions import Actions
from apd_viewer.ui.actions.commands import Commands
from apd_viewer.ui.actions.edit_controller import EditController, PartController
from apd_viewer.ui.compare.compare_controller import CompareController
from apd_viewer.ui.filing import file_dialogs
from apd_viewer.ui.filing.file_controller import FileController
from apd_viewer.ui.filing.recovery_bar import RecoveryBar
from apd_viewer.ui.help.help_controller import HelpController
from apd_viewer.ui.measuring.measure_controller import MeasureController
from apd_viewer.ui.obstacles.obstacle_controller import ObstacleController
from apd_viewer.ui.overlays.card_stack import ModeBar, spare_mesh
from apd_viewer.ui.overlays.display_options import DisplayOptions
from apd_viewer.ui.overlays.findings_controller import FindingsController
from apd_viewer.ui.overlays.notice import CanvasHint, EmptyState, NextStepHint, Notice, may_change_next_step
from apd_viewer.ui.overlays.region_picture import RegionPicture
from apd_viewer.ui.panel.volume_controller import VolumeController
from apd_viewer.ui.plots.plots import Plots
from apd_viewer.ui.posing.motion_ghost import MotionPreview
from apd_viewer.ui.posing.pose_controller import PoseController, SymmetryController
from apd_viewer.ui.preferences.shortcuts import show_shortcut_in_tooltip
from apd_viewer.ui.preferences.unit_button import Units
from apd_viewer.ui.scene.scene_picture import small_picture
from apd_viewer.ui.settings_page import settings_dialog
from apd_viewer.ui.settings_page.preference_table import COLOR_SCHEME, UNIT
from apd_viewer.ui.settings_page.settings_dialog import SettingsDialogOpener
from apd_viewer.ui.sharing.report_controller import ReportController
from apd_viewer.ui.shell import Shell
from apd_viewer.ui.simulate.press_controller import PressController
from apd_viewer.ui.studies.case_study_controller import CaseStudyController
from apd_viewer.ui.studies.run_controller import RunController
from apd_viewer.ui.target.target_controller import TargetController
from apd_viewer.ui.tools.active_parts import ActiveParts
from apd_viewer.ui.tools.tool_choice import ToolChoice
from apd_viewer.ui.tools.tool_modes import Tool
from apd_viewer.ui.widgets.theme import Theme


class Workbench(QObject):
    """Session of a window, with its controllers and overlays.

    Parameters
    ----------
    recovery : Path or None
        Folder for autosaves; None keeps nothing.
    """

    def __init__(self, shell: Shell, recovery: Path | None = None) -> None:
        super().__init__(shell)
        self.shell, self.canvas, self.panel = shell, shell.canvas, shell.panel
        self.preferences, self.docks, self.status = shell.preferences, shell.docks, shell.status
        self.signals = session_signals.SessionSignals(self)
        self.session = Session(self.signals.listener())
        self.parts = ActiveParts(self.session, self)
        self.tools = ToolChoice(self.canvas)
        self._agreed = False  # True once the user has agreed to close the window
        self._make_overlays()
        self._make_controllers(recovery)
        self._make_actions()
        self._connect_session()
        self._connect_canvas()
        self._connect_shell()
        settings_dialog.connect_preferences(
            self.preferences.values, self.session, self.tools, self.canvas.brush.size
        )
        self.tools.choose_tool(self.canvas.tool)
        self._show_status()
        self.recovery.restore_requested.connect(self.files.restore)
        self.recovery.offer(self.files.recovery_files())
        shell.requests.set_opener(self.files)

    # Construction

    def _make_overlays(self) -> None:
        view = self.canvas.viewport
        self.invitation = CanvasHint(view)
        self.recovery = RecoveryBar(view, self.invitation)
        self.notice = Notice(view, (self.invitation, self.recovery))
        self.proposal = Notice(view, (self.invitation, self.recovery, self.notice))
        say = self.notice.show_message
        self.findings = FindingsController(self.canvas, self.shell.badge, self.session, say)
        self.empty_state = EmptyState(view, self.shell.requests)
        below = self.invitation, self.recovery, self.notice, self.proposal, self.findings.list
        self.display_options = DisplayOptions(self.canvas, self.preferences, below)

    def _make_controllers(self, recovery: Path | None) -> None:
        shell, canvas, memory = self.shell, self.canvas, self.preferences
        session, notice = self.session, self.notice
        self.units = Units(memory, lambda: memory.values[UNIT])
        self.settings_page = SettingsDialogOpener(shell, memory.values, lambda: self.help.toggle_sheet())
        self.volume = VolumeController(
            self.panel, self.findings, memory, self.display_options.overlay, session
        )
        self.target = TargetController(
            shell, self.panel.target, memory, self.display_options.overlay, session
        )
        self.measurements = MeasureController(
            canvas, self.panel.measure, session, self.tools.choose_tool, notice.show_message
        )
        self.region_picture = RegionPicture(
            shell, canvas, self.display_options, memory, notice, session, self.parts
        )
        self.plots = Plots(memory, notice, session)
        self.docks["plots"].setWidget(self.plots)
        picture = partial(small_picture, canvas.viewport, PICTURE_SIDE)
        self.files = FileController(shell, memory, session, self.view, picture, recovery)
        self.edits = EditController(canvas, self.panel, session, self.parts, self.tools.choose_tool)
        self.obstacles = ObstacleController(
            canvas,
            self.panel.obstacles,
            session,
            self.parts,
            self.tools.choose_tool,
            self.edits.cancel_drag,
            self.volume.contact_distance,
            lambda state: self.press.known_wall.newtons_of_displayed(state),
        )
        self.edits.nudge_obstacle = self.obstacles.nudge
        self.edits.stop_placing = self.obstacles.placer.cancel
        self.press = PressController(
            self.docks["timeline"],
            canvas.viewport,
            session,
            self.parts,
            self.tools.choose_tool,
            self.edits.cancel_drag,
            lambda: self.panel.measures.wall_fields.value,
            self.volume.wall_settings,
            memory,
            notice,
        )
        self.edits.show_timeline = self.press.show_timeline
        self.motion_preview = MotionPreview(canvas, self.panel.handles.motion, session, self.parts)
        self.symmetry = SymmetryController(
            self.panel.handles.symmetry, session, self.parts, self.edits.cancel_drag
        )
        self.poses = PoseController(self.panel.poses, session, self.edits.cancel_drag)
        self.display_options.cards.keep_above(self.edits.text_entries.cards)
        for card in (self.notice, self.proposal):
            card.keep_above(self.edits.text_entries.cards)
        self.runs = RunController(shell, memory, session, self.files, self._study_input, notice.show_failure)
        self.panel.measures.wall_fields.entered.connect(self.runs.show_wall)
        for show in (self.press.refresh, self.obstacles.refresh):
            self.panel.measures.wall_fields.entered.connect(show)
        self.runs.motion_played.connect(self.press.show_timeline)
        self.runs.wall_requested.connect(self.docks["readings"].show)
        self.runs.wall_requested.connect(self.panel.focus_wall_fields)
        ghost, dock = self.motion_preview.ghost, self.docks["study"]
        self.case_studies = CaseStudyController(
            shell, dock, memory, session, self.files, self._study_input, notice, ghost
        )
        self.comparison = CompareController(canvas, self.display_options, memory, notice, session.store)
        newtons = self.press.known_wall.newtons_of_displayed
        self.reports = ReportController(
            shell,
            canvas,
            self.display_options,
            self.view,
            memory,
            notice,
            session,
            newtons,
            self.press.report_charts,
            self.runs.pressed_blocks,
        )

    def _make_actions(self) -> None:
        menus = self.shell.menus
        menus.choose_tool = self.tools.choose_tool
        self.actions_ = actions = Actions(menus, self._commands())
        actions.add_panel_actions(self.docks.toggles)
        menus.maker.set_theme(self.shell.theme)
        actions.file.fill_recent(self.preferences.recent_files)
        add_handle, _, add_region = actions.pose.part_actions
        self.panel.parts.add_actions((add_handle, add_region), actions.simulate.obstacles.mesh_actions)
        show_shortcut_in_tooltip(self.panel.handles.reset_handle, actions.pose.reset_handle)
        self.mode_bar = ModeBar(self.canvas.viewport, tr("Selection tools"), actions.select.groups)
        self.kind_bar = ModeBar(
            self.canvas.viewport, tr("Measurements"), [list(actions.measurements.kinds.values())]
        )
        for bar in (self.mode_bar, self.kind_bar):
            self.display_options.cards.stay_clear_of(bar)
        self.next_step = NextStepHint(self.invitation, actions.tools)
        self.help = HelpController(
            self.shell,
            (self.canvas, actions, self.panel),
            self.preferences,
            partial(self.files.open_sample, "bottle"),
            self.session,
            self.settings_page.open_at,
        )

    def _commands(self) -> Commands:
        return Commands(
            canvas=self.canvas,
            requests=self.shell.requests,
            files=self.files,
            edits=self.edits,
            parts=PartController(self.canvas, self.session, self.parts, self.edits.cancel_drag),
            symmetry=self.symmetry,
            poses=self.poses,
            display_options=self.display_options,
            region_picture=self.region_picture,
            measurements=self.measurements,
            obstacles=self.obstacles,
            findings=self.findings,
            press=self.press,
            runs=self.runs,
            case_studies=self.case_studies,
            comparison=self.comparison,
            reports=self.reports,
            target=self.target,
            choose_mode=self.tools.choose_mode,
            type_motion=self._type_motion,
            pause_or_resume=self.session.store.pause_or_resume,
            set_scheme=partial(self.preferences.values.choose, COLOR_SCHEME),
            open_settings=self.settings_page.open,
            show_about_box=partial(file_dialogs.show_about_box, self.shell),
        )

    # Signal connections

    def _connect_session(self) -> None:
        signals = self.signals
        signals.woken.connect(self._receive, Qt.ConnectionType.QueuedConnection)
        signals.changed.connect(self._show)
        signals.changed.connect(self.motion_preview.follow_document)
        for change in (signals.status_changed, self.region_picture.changed):
            change.connect(self.files.show_title)
        self.region_picture.changed.connect(self.session.autosave.follow_state)
        signals.status_changed.connect(self.target.refresh)
        signals.status_changed.connect(self._show_status)
        signals.status_changed.connect(self.motion_preview.show_requested_positions)
        signals.message_sent.connect(self.notice.show_message)
        signals.file_written.connect(self.notice.offer_file)
        self.notice.file_offered.connect(self.preferences.remember_folder)
        for failed in (signals.failed, self.volume.failed):
            failed.connect(self.notice.show_failure)
        signals.view_opened.connect(self._apply_view)
        signals.animation_opened.connect(self.files.remember_animation)
        fill_recent = self.actions_.file.fill_recent
        signals.animation_opened.connect(lambda _: fill_recent(self.preferences.recent_files))
        signals.animation_opened.connect(lambda _: self.press.show_animation())
        signals.measured.connect(self.volume.show_check)
        wall_entered = self.panel.measures.wall_fields.entered
        for change in (signals.measured, signals.status_changed, wall_entered):
            change.connect(self.reports.refresh_volumes)
        for change in (signals.changed, signals.measured):
            change.connect(self.measurements.refresh)
        signals.changed.connect(self.obstacles.refresh)
        signals.status_changed.connect(self.press.refresh)
        self.display_options.cutting_plane.measure_requested.connect(self.measurements.add_section)
        self.parts.changed.connect(self._show_parts)
        session_signals.connect_settings(self.panel, self.session, self.volume.wall_settings)
        session_signals.connect_parts(self.panel, self.session, self.parts)
        self.panel.area.unit.chosen.connect(self.choose_unit)
        self.panel.area.unit.chosen.connect(self.volume.update_wall_settings)
        self.panel.area.unit.chosen.connect(self.reports.refresh_volumes)
        self.docks["timeline"].visibilityChanged.connect(partial(spare_mesh, self.canvas.viewport))
        self.shell.history.chosen.connect(self.edits.go_to_step)
        self.status.cancel_requested.connect(self.session.jobs.cancel)
        self.status.run_stop_requested.connect(self.session.wall_run.stop)
        self.press.hidden_progress.connect(self.status.show_run)
        self.status.pause_requested.connect(self.session.store.pause_or_resume)
        self.status.restart_requested.connect(self.session.store.restart_solver)

    def _connect_canvas(self) -> None:
        canvas = self.canvas

        def set_frame_pause() -> None:
            self.session.store.frame_pause = canvas.viewport.antialiasing.frame_pause

        canvas.viewport.opengl_found.connect(set_frame_pause)
        set_frame_pause()  # the first draw may have come before
        session_signals.connect_canvas(
            canvas, self.session, self.parts, self.notice.show_message, self.status.showMessage
        )
        canvas.strokes.began.connect(lambda: self.invitation.show_text(""))
        canvas.strokes.ended.connect(self._show_next_step)
        canvas.drag_began.connect(self.next_step.record_drag)
        self.obstacles.drag_moved.connect(self.next_step.record_drag)
        self.obstacles.placer.prompt_changed.connect(self.status.showMessage)
        session_signals.connect_wheel(canvas, self.session, self.status)
        self.tools.tool_chosen.connect(self._show_tool)
        self.tools.mode_chosen.connect(lambda way: self.actions_.select.modes[way].setChecked(True))
        for change in (self.help.tour.began, self.help.tour.ended):
            change.connect(self._show_next_step)

    def _connect_shell(self) -> None:
        self.shell.closing.connect(self._ask_before_closing)
        self.shell.closing.connect(self.case_studies.ask_before_closing)
        self.shell.closed.connect(self._close)
        self.shell.escape_pressed.connect(self._escape)
        self.shell.activated.connect(self.session.saved_work.check_file)
        settings_dialog.connect_menu(self.preferences.values, self.actions_.view.schemes)
        settings_dialog.connect_language(self.preferences.values, self.notice.show_failure)
        self.shell.theme_changed.connect(self._set_theme)
        self._set_theme(self.shell.theme)

    # Commands of the window

    def _type_motion(self) -> None:
        self.docks["readings"].show()
        self.panel.focus_motion_field()

    def choose_unit(self, unit: Unit, is_saved: bool = False) -> None:
        """Set the unit of length of the mesh, and store it for its file.

        With ``is_saved``, as in an opened session, the document stays as it is.
        """
        if (state := self.session.store.state) is not None:
            self.units.set_unit(state.document.mesh, unit)
            self.session.store.unit = unit
            self.display_options.set_unit(unit)
            self.comparison.set_unit(unit)
            self.measurements.refresh()
            self.obstacles.refresh()
            self.press.refresh()
            self.panel.show_in_unit(unit, state, self.parts.handle, self.parts.region)
            if not is_saved:
                self.volume.update_contact_distance()
            self.status.show_session(self.session)

    def _escape(self) -> None:
        closings = self.help.close, self.findings.close, self.edits.text_entries.close
        if not any(close() for close in (*closings, self.notice.dismiss_failure)):
            self.tools.choose_tool(Tool.ORBIT)

    def view(self) -> View:
        """Current camera, overlay, wall and unit, as saved in a session."""
        seen = self.canvas.view.saved_view(self.session.store.unit.value)
        return self.volume.with_wall_and_overlay(replace(seen, image=self.region_picture.image))

    def _study_input(self) -> tuple[State, int, View] | None:
        store = self.session.store
        if store.state is None:
            return None
        return store.state, self.parts.handle, self.view()

    # Display of the session's state

    @Slot()
    def _receive(self) -> None:
        # A queued signal may arrive after the window has been closed.
        if not self.shell.is_closed:
            self.session.receive_results()

    def _show(self, old: State | None, new: State) -> None:
        document = new.document
        self.parts.follow_document(None if old is None else old.document, document)
        self.canvas.show_state(old, new, self.parts.handle, self.parts.region)
        self.region_picture.follow_document(document)
        self.display_options.follow_state(new)
        if old is None or old.document.mesh is not document.mesh:
            self.findings.show_mesh_findings(new.inspection.findings)
            if old is None or old.document.mesh.F is not document.mesh.F:
                self._show_opened(new)
            else:
                self.units.carry_over(old.document.mesh, document.mesh)
        self.panel.highlight_edited_part(self.canvas.tool, self.parts.obstacle)
        self.panel.show_state(old, new, self.parts.handle, self.parts.region)
        self.symmetry.refresh()
        if old is None or old.document is not document:
            self.poses.refresh()
            self.actions_.follow_document(document)
        self.volume.follow_settings(old, new)
        self.actions_.pose.show_symmetry(document.mirror_axis is not None)
        self.plots.refresh()
        self.findings.refresh()
        before = None if old is None else old.document
        if before is None or may_change_next_step(before, document):
            self._show_next_step()

    def _show_opened(self, state: State) -> None:
        mesh = state.document.mesh
        self.notice.hide()
        self.proposal.hide()
        self.actions_.view.refresh()
        self.tools.choose_tool(Tool.BASE if state.document.paint_problem else Tool.MOVE)
        self.session.store.unit = self.panel.unit = self.units.unit_of(mesh)
        self.panel.handles.motion.clear()
        self.volume.show_mesh_wall(mesh)
        self.display_options.set_unit(self.session.store.unit)
        self.display_options.overlay.choose_measure(None)  # a session's own comes with its view
        self.files.remember_mesh_files(state)
        self.actions_.file.fill_recent(self.preferences.recent_files)
        if (axis := self.canvas.likely_up_axis) is not None:
            sentence = tr("This mesh seems to lie on its side: it would stand with {axis} up.")
            stand = self.actions_.view.camera.up_axes[axis].trigger
            self.proposal.offer(sentence.format(axis=axis.value), tr("Stand upright"), stand)

    def _apply_view(self, view: View) -> None:
        self.canvas.view.restore(view)
        if view.up_axis is not None:  # sessions store their up axis
            self.proposal.hide()
        self.actions_.view.camera.refresh()
        self.volume.restore_view(view)
        self.region_picture.restore(view.image)
        self.choose_unit(Unit(view.unit), is_saved=True)
        if self.session.player.timeline.belongs_to(self.session.store.required_state().document):
            self.press.show_timeline()

    def _show_parts(self) -> None:
        self.canvas.set_active_parts(self.parts.handle, self.parts.region)
        self.panel.highlight_edited_part(self.canvas.tool, self.parts.obstacle)
        if self.session.store.state is not None:
            self.panel.show_parts(self.session.store.state, self.parts.handle, self.parts.region)
        self._show_next_step()

    def _show_status(self) -> None:
        session = self.session
        history, state = session.gestures.history, session.store.state
        self.actions_.show_history(history.next_undo_name, history.next_redo_name)
        if state is not None:
            first = (history.undo_states or [state])[0].document.mesh
            self.shell.history.show_steps(first.name, history.undo_names, history.redo_names)
        self.actions_.enable_actions(state is not None, state is None or state.is_at_rest)
        self.panel.show_status(session)
        self.empty_state.setVisible(state is None and session.jobs.current is None)
        self.status.show_session(session)
        self.next_step.follow_store(session.store)
        self.notice.show_persistent_failure(session.store.silence_text)
        self.recovery.follow_session(session)
        self.help.refresh()

    def _show_tool(self, tool: Tool) -> None:
        self.actions_.tools[tool].setChecked(True)
        self.measurements.tool.enabled = measures = tool is Tool.MEASURE
        self.mode_bar.show_bar(tool.traits.is_brush)
        self.kind_bar.show_bar(measures)
        self.obstacles.follow_tool(tool)
        self.panel.highlight_edited_part(tool, self.parts.obstacle)
        self._show_next_step()

    def _show_next_step(self) -> None:
        state, tool, obstacle = self.session.store.state, self.canvas.tool, self.parts.obstacle
        camera = self.canvas.viewport.navigation.preset.sentence
        hint = tool.hint(self.canvas.selection_mode, camera, obstacle is not None)
        self.status.show_hint(self.measurements.hint if tool is Tool.MEASURE else hint)
        if self.help.tour.is_active:
            self.next_step.hide_hint()  # the tour's card gives the instructions
        elif state is not None:
            self.next_step.show_hint(state.document, tool, self.parts.handle, obstacle)

    def _set_theme(self, theme: Theme) -> None:
        over = self.notice, self.proposal, self.recovery, self.findings.list, self.help, self.display_options
        bars = self.mode_bar, self.kind_bar, self.actions_.bar
        for part in (self.plots, self.press, self.comparison, self.case_studies, *over, *bars):
            part.set_theme(theme)

    # Closing the window

    def _ask_before_closing(self, event: QCloseEvent) -> None:
        agreed, self._agreed = self._agreed, False  # something else may keep the window open
        if not agreed and not self.files.may_discard_work(self._close_anyway, closes=True):
            event.ignore()

    def _close_anyway(self) -> None:
        self._agreed = True
        # Delayed, as the session is still reporting the write.
        QTimer.singleShot(0, self.shell, self.shell.close)

    def _close(self) -> None:
        self.help.tour.end()
        self.findings.close()
        self.recovery.postpone_all()
        self.plots.join_thread()
        self.press.close()
        self.display_options.close()
        self.target.close()
        self.runs.close_all()
        self.case_studies.close()
        self.settings_page.close()
        self.comparison.close()
        self.session.close()
