"""Controller of a press in the view and of the timeline of its steps."""

import itertools
import time
from collections.abc import Callable, Sequence
from contextlib import suppress

import numpy as np
from PySide6.QtCore import QObject, QTimer, Signal
from PySide6.QtWidgets import QDockWidget

from apd_viewer.errors import InputError
from apd_viewer.geometry.mesh.arrays import diagonal
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import FREE
from apd_viewer.language import tr
from apd_viewer.presentation import plate_readings
from apd_viewer.presentation.number_format import format_short
from apd_viewer.presentation.plate_readings import direction_number, direction_titles, press_directions
from apd_viewer.presentation.time_left import progress_text
from apd_viewer.session.model.obstacle_pair import ObstaclePair, obstacle_pair
from apd_viewer.session.model.timeline import Timeline
from apd_viewer.session.model.up_axis import UpAxis
from apd_viewer.session.obstacle_editor import Fingers
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.wall import WallText
from apd_viewer.session.session import Session
from apd_viewer.session.state_store import Activity
from apd_viewer.session.storage.timeline_file import TIMELINE_FORMATS
from apd_viewer.ui.filing import file_dialogs
from apd_viewer.ui.overlays.notice import Notice
from apd_viewer.ui.plots.chart_drawing import Chart
from apd_viewer.ui.preferences.preferences import Preferences
from apd_viewer.ui.scene.viewport import Viewport
from apd_viewer.ui.simulate.known_wall import KnownWall, PressReadings, WallRunController
from apd_viewer.ui.simulate.timeline_charts import PressCharts, StepCharts
from apd_viewer.ui.simulate.timeline_panel import TimelinePanel
from apd_viewer.ui.tools.active_parts import ActiveParts
from apd_viewer.ui.tools.tool_modes import Tool
from apd_viewer.ui.widgets.box_layouts import LayoutBoundary
from apd_viewer.ui.widgets.theme import Theme

_REPLAY, _FASTEST, _SLOWEST = 3000, 50, 250  # ms: duration of all steps, and limits of that of one step

_FINGER, _FINGER_SHARE = 0.008, 0.03  # radius of a finger, m, and as a fraction of the mesh's diagonal
_HELD = 0.05  # height of what is held under fingers, as a fraction of that of the mesh
_TICK = 1000  # ms; updates the time of a run even without new steps
_CORNERS = tuple(itertools.product((0, 1), repeat=3))


class TimelineReplay(QTimer):
    """Replay of the steps of a timeline, one after another.

    Parameters
    ----------
    is_repeated : callable
        True to start again after the last step.
    """

    step_shown = Signal()

    def __init__(self, parent: QObject, session: Session, is_repeated: Callable[[], bool]) -> None:
        super().__init__(parent, timeout=self._show_next)
        self._session, self._is_repeated = session, is_repeated

    def begin_or_end(self) -> None:
        """Start at the displayed step, or at the first after the last; stop if running."""
        if self.isActive():
            self.end()
            return
        player = self._session.player
        count, shown = len(player.timeline.steps), player.shown_step
        player.show_step(0 if shown in (None, count - 1) else shown)
        self.start(min(max(_REPLAY // max(1, count), _FASTEST), _SLOWEST))

    def end(self) -> None:
        """Stop the replay at the displayed step."""
        if self.isActive():
            self.stop()
            self._session.player.accept_shown_step()

    def _show_next(self) -> None:
        player = self._session.player
        count = len(player.timeline.steps)
        after = (player.shown_step if player.shown_step is not None else count) + 1
        if not self._session.gestures.is_showing or player.is_playing:
            self.stop()  # another gesture or motion has begun
        elif after < count or (count and self._is_repeated()):
            player.show_step(after % count)
        else:
            self.end()
        self.step_shown.emit()


class PressController(QObject):
    """Presses the mesh between two plates, and shows the solved steps.

    Parameters
    ----------
    dock : QDockWidget
        Dock of the panel.
    parts : ActiveParts
        Make a plate the active obstacle.
    choose_tool : callable
        Activates a tool.
    cancel_drag : callable
        Function to cancel the current drag.
    wall : callable
        The wall as typed.
    wall_settings : callable
        Settings by name that follow from it.

    Attributes
    ----------
    hidden_progress : Signal(str)
        Progress of the Wall method while the panel is closed; empty while it is open or none runs.
    """

    hidden_progress = Signal(str)

    def __init__(
        self,
        dock: QDockWidget,
        viewport: Viewport,
        session: Session,
        parts: ActiveParts,
        choose_tool: Callable[[Tool], object],
        cancel_drag: Callable[[], bool],
        wall: Callable[[], WallText],
        wall_settings: Callable[..., dict[str, float | None]],
        preferences: Preferences,
        notice: Notice,
    ) -> None:
        super().__init__(dock)
        self._dock, self._session, self._parts = dock, session, parts
        self._choose_tool, self._give_up, self._wall = choose_tool, cancel_drag, wall
        self._wall_settings = wall_settings
        self._memory, self._notice, self._viewport = preferences, notice, viewport
        self._direction = 0
        self.known_wall = KnownWall(session, wall)
        self._wall_run_controller = WallRunController(session, self.known_wall, lambda: self._timeline)
        self._readings = PressReadings(session, self.known_wall)
        self.charts = PressCharts(session, self.known_wall)
        self.panel = panel = TimelinePanel()
        dock.setWidget(LayoutBoundary(panel))
        panel.load_view.chart = self.charts.load_chart
        panel.volume_view.chart = self.charts.volume_chart
        self.step_charts = StepCharts()
        panel.size_view.chart = self.step_charts.size_chart
        panel.effort_view.chart = self.step_charts.effort_chart
        self._replay = TimelineReplay(self, session, panel.loop.isChecked)
        self._replay.step_shown.connect(self.refresh)
        self._ticks = QTimer(self, interval=_TICK, timeout=self._show_progress)
        self._connect()

    def _connect(self) -> None:
        panel, player = self.panel, self._session.player
        panel.press_requested.connect(self._press_or_pause)
        panel.stop_requested.connect(player.stop)
        panel.open_requested.connect(self._open)
        panel.direction_chosen.connect(self._put_plates)
        panel.step_shown.connect(self._show_step)
        panel.show_ended.connect(player.accept_shown_step)
        panel.show_cancelled.connect(self._session.gestures.cancel)
        for go in (self._replay.begin_or_end, self.refresh):
            panel.play_requested.connect(go)
        panel.wall_requested.connect(self._wall_run_controller.begin_or_stop)
        panel.wall_chosen.connect(self._choose_wall)
        panel.clear_requested.connect(player.clear)
        panel.export_requested.connect(self._export)
        self._dock.visibilityChanged.connect(self.refresh)

    # Pressing

    def begin(self) -> None:
        """Put plates on both sides unless present, and prepare to press."""
        state = self._session.store.state
        if state is None or self._give_up():
            return
        is_new = obstacle_pair(state.document) is None
        if is_new and not self._put_plates(self._direction):
            return
        if not self._timeline.steps:
            self._session.player.begin_run()
        self._show_and_frame(is_new)
        self.panel.end.setFocus()
        self.panel.end.selectAll()

    def _frame(self) -> None:
        """Frame mesh and plates."""
        state = self._session.store.state
        boxes = [box for find in self._viewport.more_boxes if (box := find())]
        if state is not None:
            corners = [np.array(box).reshape(3, 2).T[list(k), range(3)] for box in boxes for k in _CORNERS]
            self._viewport.camera_controller.frame(np.vstack([state.frame.U, *corners]))

    def _put_plates(self, direction: int) -> bool:
        """Put plates or fingers on both sides, replacing existing ones."""
        before, unit = self._session.store.required_state().document, self._session.store.unit
        thickness = self._wall().contact_distance(unit)
        creases = self._wall_settings("yield_radius")
        axis, is_squeeze = press_directions(self._up)[direction]
        fingers = _fingers(before.mesh, unit, self._up.direction) if is_squeeze else None
        k = self._session.obstacles.add_press_plates(np.eye(3)[axis], thickness, fingers, **creases)
        if k is None:
            return False
        if is_squeeze:
            self._notice.show_message(
                tr("The lowest part is held as base, or the fingers would push it away; paint another one.")
            )
        elif before.label_counts[FREE] < len(before.labels):
            self._notice.show_message(
                tr("Base and handles are let go, so that all is pressed; undo holds them again.")
            )
        self._direction = direction
        self._session.player.begin_run()
        self._choose_tool(Tool.MOVE)
        self._parts.choose_obstacle(k)
        return True

    @property
    def _up(self) -> UpAxis:
        return self._viewport.camera_controller.camera.up_axis

    def _press_or_pause(self) -> None:
        if self._session.player.is_playing:
            self._session.store.pause_or_resume()
            return
        self._replay.end()
        state = self._session.store.state
        if state is None or self._give_up():
            return
        if obstacle_pair(state.document) is None and not self._put_plates(self._direction):
            return
        try:
            pair, text = self._required_pair(), self.panel.end.text()
            extent = pair.extent(self._session.store.required_state().document)  # with plates that were put
            distance = self._session.typed_values.parse_fraction_or_length(text, extent)
            said = f"{format_short(100.0 * distance / extent)}\u00a0%"
            self._move_plates(tr("Press to {distance}").format(distance=said), distance)
        except InputError as error:
            self.panel.show_problem(str(error))

    def _open(self) -> None:
        self._replay.end()
        state = self._session.store.required_state()
        with suppress(InputError):  # the plates are already open
            self._move_plates(tr("Open plates"), self._required_pair().first_distance(state.document))

    def _move_plates(self, title: str, distance: float) -> None:
        self._session.player.choose_wall_results(False)  # the press is solved first, the Wall method after it
        state, steps = self._session.store.required_state(), round(self.panel.steps.value())
        documents = self._required_pair().press_documents(state, distance, steps)
        self._session.player.play(title, documents)
        self._wall_run_controller.is_due = True
        self.charts.reach = self._required_pair().first_distance(state.document) - distance
        self._dock.window().setFocus()

    def _required_pair(self) -> ObstaclePair:
        pair = obstacle_pair(self._session.store.required_state().document)
        if pair is None:
            raise InputError(
                tr("There are no plates or fingers that face each other; put them on both sides first.")
            )
        return pair

    # Timeline

    def _show_step(self, k: int) -> None:
        if self._timeline.steps:
            self._session.player.show_step(min(k, len(self._timeline.steps) - 1))

    @property
    def _timeline(self) -> Timeline:
        """Steps of the open mesh; empty if the timeline belongs to another mesh."""
        state, timeline = self._session.store.state, self._session.player.timeline
        return timeline if state is not None and timeline.belongs_to(state.document) else Timeline()

    def show_timeline(self) -> None:
        """Show the panel of the timeline."""
        self._dock.show()
        self._dock.raise_()
        self.refresh()

    def show_animation(self) -> None:
        """Show the panel with the opened animation."""
        self._replay.end()
        self._show_and_frame(is_new=False)

    def _show_and_frame(self, is_new: bool) -> None:
        """Show the panel; frame the mesh if plates are new or its view has shrunk."""
        if is_new or not self._dock.isVisible():
            QTimer.singleShot(0, self, self._frame)  # after the layout has resized the view
        self.show_timeline()

    def _choose_wall(self, shows_wall: bool) -> None:
        self._replay.end()
        self._session.player.choose_wall_results(shows_wall)

    def _export(self) -> None:
        mesh = self._session.store.required_state().document.mesh
        proposed = self._memory.last_folder / f"{mesh.stem}-timeline.csv"
        path = file_dialogs.ask_for_format(self.panel, tr("Export timeline"), proposed, TIMELINE_FORMATS)
        if path is not None and self._session.files.is_still_open(mesh):
            newtons, of_wall = self._wall_run_controller.newtons_per_load(), self._session.player.shows_wall
            self._session.files.export_timeline(path, self._timeline, newtons, of_wall, self._up)

    # Display

    def report_charts(self) -> tuple[tuple[Chart, str], ...]:
        """Charts of the timeline with their captions, for a report."""
        state = self._session.store.state
        self.charts.timeline = self.step_charts.timeline = self._timeline
        self.step_charts.shown_number = self._shown_number
        if state is not None and obstacle_pair(state.document) is not None:
            return (
                (self.charts.load_chart(), tr("Load over the way of the plates")),
                (self.charts.volume_chart(), tr("Volume over the way of the plates")),
            )
        return ((self.step_charts.size_chart(), tr("Area and volume by step")),)

    def refresh(self, *_: object) -> None:
        """Show the state of the session, if the dock is visible."""
        self._wall_run_controller.update()
        self._show_progress()
        state = self._session.store.state
        if state is None or not self._dock.isVisible():
            return
        player, steps = self._session.player, self._timeline.steps
        pair = obstacle_pair(state.document)
        if pair is not None:
            self._direction = direction_number(pair, state.document, self._up)
        titles = direction_titles(state, self._session.store.unit, self._up)
        self.panel.show_directions(titles, self._direction)
        shown = self._shown_number
        may_open = pair is not None and pair.reading(state).deflection > 1e-9 * pair.extent(state.document)
        self.panel.show_run(player.is_playing, player.is_paused, may_open)
        last = len(steps) - 1 if player.is_playing else None
        self.panel.show_steps(len(steps), shown if shown is not None else last, self._replay.isActive())
        is_press = pair is not None or not steps
        self.panel.show_kind(is_press, player.is_playing, self._session.wall_run.is_running)
        if is_press:
            self._show_texts(*self._readings.of(state, self._timeline))
        else:
            texts = plate_readings.step_reading_texts(state, self._session.store.unit)
            self._show_texts(texts, *plate_readings.step_verdict(state))
        self.charts.timeline = self.step_charts.timeline = self._timeline
        self.step_charts.shown_number = shown
        self.step_charts.ahead = player.count - player.done if player.is_playing else 0
        is_running, may_begin = self._session.wall_run.is_running, self._wall_run_controller.may_begin
        names = self.charts.names if any(step.wall_result is not None for step in steps) else ()
        self.panel.show_wall(is_running, may_begin, names, player.shows_wall)
        if not player.is_playing:
            self.charts.reach = 0.0
        self.panel.update_charts()

    def _show_progress(self) -> None:
        """Show the progress of the motion or Wall method, with its current time."""
        is_shown, is_running = self._dock.isVisible(), self._session.wall_run.is_running
        self.panel.progress.setText(self._progress)
        self.hidden_progress.emit("" if is_shown else self._wall_run_controller.progress)
        if is_running is not self._ticks.isActive():
            (self._ticks.start if is_running else self._ticks.stop)()

    def _show_texts(
        self,
        texts: Sequence[plate_readings.ReadingText],
        said: str,
        is_calm: bool,
        names: Sequence[str] = (),
    ) -> None:
        if self._session.store.activity is Activity.REFINING:
            said, is_calm = tr("Coming to rest…"), True
        self.panel.show_readings(texts, said, is_calm, names)

    @property
    def _shown_number(self) -> int | None:
        return self._session.player.shown_step if self._timeline.steps else None

    @property
    def _progress(self) -> str:
        player = self._session.player
        if not player.is_playing:
            if wall := self._wall_run_controller.progress:
                return wall
            dropped = self._timeline.dropped
            said = tr("The first {n} steps were dropped to save memory.")
            return said.format(n=dropped) if dropped else ""
        said = tr("Step {k} of {count}").format(k=player.done + 1, count=player.count)
        if player.is_paused:
            return tr("{progress}, paused").format(progress=said)
        return progress_text(said, time.monotonic() - player.began, player.done, player.count)

    def set_theme(self, theme: Theme) -> None:
        """Redraw icons and charts."""
        self.charts.theme = self.step_charts.theme = theme
        self.panel.set_theme(theme)

    def close(self) -> None:
        """End a running replay."""
        self._replay.stop()
        self._ticks.stop()


def _fingers(mesh: Mesh, unit: Unit, up: np.ndarray) -> Fingers:
    """Fingers for a mesh, a share of it if its unit is unknown, and its lowest part."""
    radius = _FINGER_SHARE * diagonal(mesh.V) if unit.metres is None else _FINGER / unit.metres
    height = mesh.V @ up
    low, high = np.percentile(height[mesh.F.ravel()], (0.0, 100.0))
    return Fingers(radius, np.flatnonzero(height <= low + _HELD * (high - low)))
