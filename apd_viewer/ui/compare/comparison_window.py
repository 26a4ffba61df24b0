"""Comparison window: a view of each method's shape, and a table of readings."""

from collections.abc import Callable
from functools import partial
from pathlib import Path

from PySide6.QtCore import QSize, Qt, Signal, Slot
from PySide6.QtGui import QCloseEvent, QKeyEvent, QKeySequence, QShortcut
from PySide6.QtWidgets import QPushButton, QSizePolicy, QWidget

from apd_viewer.cases.comparison import Comparison, MethodOutcome, OutcomeOrigin
from apd_viewer.errors import InputError
from apd_viewer.geometry.analysis.deviation import Deviation
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.frame import Frame
from apd_viewer.geometry.solver.methods import COMPARED_METHODS, METHODS
from apd_viewer.geometry.warmup import warm_up
from apd_viewer.language import comma_separated, tr
from apd_viewer.presentation.method_readings import (
    method_readings,
    missing_contact,
    reading_columns,
    write_outcomes,
)
from apd_viewer.presentation.scales import Scale
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.state import State
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.solution import Solution
from apd_viewer.ui.compare.linked_views import LinkedViews, SharedScale
from apd_viewer.ui.compare.method_table import PIXEL_RATIO, ComparisonShape, MethodTable, write_comparison
from apd_viewer.ui.filing import file_dialogs
from apd_viewer.ui.obstacles.obstacle_scene import DrawnObstacle
from apd_viewer.ui.preferences.preferences import Preferences
from apd_viewer.ui.scene.camera import Camera
from apd_viewer.ui.widgets.background_task import BackgroundTask
from apd_viewer.ui.widgets.box_layouts import column_layout, resize_on_screen, row_layout
from apd_viewer.ui.widgets.convergence_progress import ConvergenceProgress
from apd_viewer.ui.widgets.display_names import window_title_text
from apd_viewer.ui.widgets.fields import CheckBox
from apd_viewer.ui.widgets.help_button import HelpButton
from apd_viewer.ui.widgets.theme import LIGHT, Theme, application_icon, set_style_property
from apd_viewer.ui.widgets.thin_bar import ElidedLabel

_FEWEST = 2
_SIZE = QSize(1280, 800)
_NO_ROOM = tr("Not enough memory to compare methods on this mesh; close other programs.")


class ComparisonWindow(QWidget):
    """Views side by side, with a legend and a table of readings below.

    Parameters
    ----------
    scale : Scale or None
        Of the local area change, chosen by the user; without, it is fitted when a comparison ends.
    camera : Camera
        Initial camera.
    """

    repeat_requested = Signal()
    closed = Signal()
    _woken = Signal()

    def __init__(self, preferences: Preferences, scale: Scale | None, camera: Camera) -> None:
        super().__init__(None, Qt.WindowType.Window, objectName="comparison")
        self.setAttribute(Qt.WidgetAttribute.WA_StyledBackground)
        self.setWindowIcon(application_icon())
        self.setMinimumSize(960, 600)
        resize_on_screen(self, _SIZE)
        self._memory, self._eye, self._theme = preferences, camera, LIGHT
        self.comparison: Comparison | None = None
        self._state: State | None = None
        self._task = BackgroundTask(self)
        self._task.done.connect(self._take)
        self._woken.connect(self._receive, Qt.ConnectionType.QueuedConnection)
        self.linked = LinkedViews({method: METHODS[method].title for method in COMPARED_METHODS})
        self.views = self.linked.views
        chosen = [method for method in COMPARED_METHODS if method in preferences.compared_methods]
        self.checks = self._make_checks(chosen if len(chosen) >= _FEWEST else list(COMPARED_METHODS))
        self.legend = SharedScale(scale)
        self.legend.changed.connect(self._rescale)
        self.linked.span_measured.connect(self._show_span)
        self.table = MethodTable()
        self._lay_out()

    # Construction and layout

    def _make_checks(self, chosen: list[str]) -> dict[str, CheckBox]:
        checks = {}
        for method in COMPARED_METHODS:
            check = CheckBox(METHODS[method].title, toolTip=METHODS[method].description)
            check.setChecked(method in chosen)
            check.toggled.connect(self._choose)
            checks[method] = check
        return checks

    def _lay_out(self) -> None:
        self.status = ElidedLabel(objectName="quiet")
        self.status.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self.progress = ConvergenceProgress()
        self.stop = QPushButton(tr("Stop"), toolTip=tr("Stop the solver and keep the results so far (Esc)"))
        self.stop.clicked.connect(self._stop)
        tip = tr(
            "Compare again, with the current pose of the main window; a pose compared already is solved "
            "by every method from rest"
        )
        self.again = QPushButton(tr("Compare again"), toolTip=tip)
        self.again.clicked.connect(self.repeat_requested)
        self.save_table = QPushButton(tr("Save table…"), toolTip=tr("Save the measurements as CSV"))
        self.save_table.clicked.connect(partial(self._ask, ".csv"))
        self.save_picture = QPushButton(
            tr("Save picture…"), toolTip=tr("Save the shapes with their names and the legend as PNG")
        )
        self.save_picture.clicked.connect(partial(self._ask, ".png"))
        self.help = HelpButton()
        buttons = row_layout(self.stop, self.again, self.save_table, self.save_picture, self.help)
        head = row_layout(
            *self.checks.values(),
            (self.status, 1),
            self.progress,
            buttons,
            spacing=16,
            margins=(12, 8, 12, 8),
        )
        top = Qt.AlignmentFlag.AlignTop
        foot = row_layout((self.legend, 0, top), (self.table, 1, top), spacing=16, margins=(12, 10, 12, 8))
        column_layout(head, (self.linked, 1), foot, spacing=0, parent=self)

    def add_shortcuts(self, keys: list[QKeySequence], command: Callable[[], object]) -> None:
        """Add shortcuts of the main window to a command."""
        for sequence in keys:
            QShortcut(sequence, self, command)

    # Methods and solver runs

    @property
    def chosen_methods(self) -> list[str]:
        """Names of the checked methods."""
        return [method for method, check in self.checks.items() if check.isChecked()]

    def compare(self, state: State, unit: Unit, solution: Solution | None = None) -> None:
        """Start comparing the methods on a document, from its rest shape.

        Its own method takes the displayed shape, where that is a ``solution`` and has not been compared yet.
        """
        known = None
        if self.comparison is not None:
            self.comparison.stop()
            solution = None if self.comparison.document is state.document else solution
        if solution is not None:
            origin = OutcomeOrigin.DISPLAYED if solution.is_from_rest else OutcomeOrigin.OTHER_PATH
            known = MethodOutcome(state.frame, True, solution.cost, origin=origin)
        name = state.document.mesh.name
        self.setWindowTitle(tr("Compare methods – {name}").format(name=window_title_text(name)))
        first = self._state is None or self._state.document.mesh is not state.document.mesh
        self._state = state
        self.comparison = Comparison(state.document, self._woken.emit, known)
        self.table.set_columns(reading_columns(state, unit))
        try:
            self.linked.show_rest_shape(state, unit)
        except MemoryError:
            self._say(_NO_ROOM, warn=True)
            return
        if first:
            self.linked.set_camera(state, self._eye)
        self._prepare(state)
        self._choose()
        self.views[self.chosen_methods[0]].viewport.setFocus()

    def is_comparing(self, mesh: Mesh) -> bool:
        """True if this mesh is being compared."""
        return self._state is not None and self._state.document.mesh is mesh

    def set_unit(self, unit: Unit) -> None:
        """Change the unit of lengths in the table."""
        if self._state is not None:
            self.table.set_columns(reading_columns(self._state, unit))
            self._show()

    def _prepare(self, state: State) -> None:
        """Compile the kernels of the measurements in the background."""
        mesh, skin = state.document.mesh, state.surface_index

        def work(_: Callable[[], bool]) -> object:
            warm_up("overlays")
            return Deviation(mesh.V, skin.joined, skin.source)

        self._task.begin(work)

    def _take(self, result: object) -> None:
        if not isinstance(result, Deviation):
            self._say(_NO_ROOM, warn=True)
            return
        self.linked.set_deviation(result, self.legend.scale)

    def _choose(self) -> None:
        """Compare the checked methods; the last two cannot be unchecked."""
        chosen = self.chosen_methods
        self._memory.compared_methods = chosen
        for method, check in self.checks.items():
            needed = len(chosen) <= _FEWEST and method in chosen
            check.setEnabled(not needed)
            about = tr("At least two methods must be selected.") if needed else METHODS[method].description
            check.setToolTip(about)
        self.linked.show_views(chosen)
        self.table.show_methods([METHODS[method].title for method in chosen])
        if self.comparison is not None:
            self.comparison.set_methods(chosen)
        self._show()

    def _stop(self) -> None:
        if self.comparison is not None:
            self.comparison.stop()
        self._show()

    @Slot()
    def _receive(self) -> None:
        # A queued signal may arrive after the window has been closed.
        if self.comparison is not None and self.comparison.receive_reply():
            self._show()

    # Display of shapes, readings and messages

    def _show(self) -> None:
        comparison, state = self.comparison, self._state
        if comparison is None or state is None:
            return
        for row, method in enumerate(self.chosen_methods):
            outcome = comparison.outcomes.get(method, MethodOutcome())
            if outcome.frame is not None:
                self.views[method].show_shape(outcome.frame.U)
                self.views[method].show_obstacles(_drawn_obstacles(state.document, method, outcome.frame))
            said, tip, note = _status_texts(method, comparison)
            self.views[method].show_status(said, tip, note)
            missing = missing_contact(state, method)
            self.table.show_title(row, _row_title(method, outcome, bool(missing)), missing)
            self.table.show_readings(row, method_readings(state, method, outcome), "" if note else said)
        under_way = comparison.current_method
        self.progress.set_frame(comparison.outcomes[under_way].frame if under_way else None, bool(under_way))
        self.stop.setEnabled(under_way is not None)
        there = any(
            comparison.outcomes[m].frame is not None for m in self.chosen_methods if m in comparison.outcomes
        )
        self.save_table.setEnabled(there)
        self._say(comparison.news if under_way is None else _progress(comparison, self.chosen_methods))
        # A method may end after its changes were read, or without a new shape.
        self._show_span(self.legend.span)

    def _say(self, sentence: str, warn: bool = False) -> None:
        self.status.setText(sentence)
        self.status.setToolTip(sentence)
        set_style_property(self.status, "warn", warn)

    def show_refusal(self, sentence: str) -> None:
        """Show a sentence saying why the document cannot be compared."""
        self._say(sentence, warn=True)

    def _show_span(self, span: tuple[float, float] | None) -> None:
        """Show the changes of all shapes; fit the scale to them at the end."""
        self.legend.show_span(span)
        is_ended = self.comparison is not None and self.comparison.current_method is None
        if is_ended and not self.legend.is_chosen:
            self.legend.fit_to_span()

    def _rescale(self) -> None:
        self.linked.show_scale(self.legend.scale)

    def set_theme(self, theme: Theme) -> None:
        """Apply the theme to the backgrounds of the views."""
        self._theme = theme
        self.linked.set_theme(theme)

    # Export of the table and the picture

    def _ask(self, suffix: str) -> None:
        assert self._state is not None
        proposed = self._memory.last_folder / f"{self._state.document.mesh.stem}-methods{suffix}"
        path = file_dialogs.ask_where_to_save(self, tr("Save comparison"), proposed)
        if path is None:
            return
        try:
            (self.write_table if suffix == ".csv" else self.write_picture)(path)
        except InputError as error:
            self._say(str(error), warn=True)
        else:
            self._say(tr("Saved {name}.").format(name=path.name))

    def _outcomes(self) -> list[tuple[str, MethodOutcome]]:
        assert self.comparison is not None
        return [
            (method, self.comparison.outcomes.get(method, MethodOutcome())) for method in self.chosen_methods
        ]

    def write_table(self, path: Path) -> None:
        """Write the readings as CSV; raises InputError."""
        assert self._state is not None
        write_outcomes(path, self._state, self._outcomes())

    def write_picture(self, path: Path) -> None:
        """Write the views as displayed, on white, as PNG; raises InputError."""
        assert self._state is not None
        shown = []
        for method, outcome in self._outcomes():
            view = self.views[method]
            found = method_readings(self._state, method, outcome)
            is_usual = outcome.is_finished and found and outcome.origin.has_same_path
            brief = [] if is_usual else [view.status_texts[0]]
            for column in (each for each in self.table.columns if each.name in ("area", "volume")):
                brief += [f"{column.title} {column.cell_text(found)}"] if found else []
            shown.append(ComparisonShape(view.title, comma_separated(brief), view.picture(PIXEL_RATIO)))
        self.set_theme(self._theme)
        write_comparison(path, shown, self.linked.column_count, self.legend.scale, self.font())

    # Qt events

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Stop on Esc; close if nothing is running."""
        if event.key() == Qt.Key.Key_Escape:
            if self.stop.isEnabled():
                self._stop()
            else:
                self.close()
        else:
            super().keyPressEvent(event)

    def closeEvent(self, event: QCloseEvent) -> None:
        """Stop the solver process, and close the views before the window."""
        if self.comparison is not None:
            self.comparison.stop()
            self.comparison = None
        self._task.close()
        self.linked.close_all()
        self.closed.emit()
        super().closeEvent(event)


_ORIGINS = {  # tooltips
    OutcomeOrigin.COMPARISON: "",
    OutcomeOrigin.DISPLAYED: tr("Solved in the main window from the rest shape, as the others are here"),
    OutcomeOrigin.OTHER_PATH: tr(
        "Solved in the main window by way of other shapes, such as those of a drag; "
        "Compare again solves it from rest"
    ),
}


def _row_title(method: str, outcome: MethodOutcome, lacks_contact: bool) -> str:
    """Title of a row in the table, with a lack of contact and another origin."""
    title = METHODS[method].title
    if lacks_contact:
        title = tr("{method}, no contact").format(method=METHODS[method].short_title)
    if outcome.origin.has_same_path:
        return title
    return tr("{method}, as it stands in the window").format(method=title)


def _drawn_obstacles(document: Document, method: str, frame: Frame) -> list[DrawnObstacle]:
    """Obstacles where a method has moved them; faint where it knows none."""
    acts = document.settings.contact and METHODS[method].may_use_contact
    reached = frame.shifts if acts and len(frame.shifts) == len(document.obstacles) else None
    return [
        DrawnObstacle(each, each.shift if reached is None else reached[k], is_idle=not acts)
        for k, each in enumerate(document.obstacles)
    ]


def _status_texts(method: str, comparison: Comparison) -> tuple[str, str, str]:
    """Progress of a method, its details, and a failure message."""
    outcome = comparison.outcomes.get(method)
    if outcome is None:
        before = comparison.method_before(method)
        said = tr("waits for {method}").format(method=METHODS[before].title) if before else tr("not started")
        return said, "", ""
    frame = outcome.frame
    if outcome.failure:
        return tr("failed"), outcome.failure, outcome.failure
    if outcome.is_finished and frame is not None:
        if not outcome.origin.has_same_path:
            return tr("as it stands in the window"), _ORIGINS[outcome.origin], ""
        said = tr("converged") if frame.converged else tr("did not converge")
        return said, frame.unreached or _ORIGINS[outcome.origin], ""
    if method == comparison.current_method:
        return (tr("iteration {n:,}").format(n=frame.iteration) if frame else tr("preparing")), "", ""
    return (tr("stopped at iteration {n:,}").format(n=frame.iteration) if frame else tr("stopped")), "", ""


def _progress(comparison: Comparison, chosen: list[str]) -> str:
    """Overall progress as one line of text."""
    method = comparison.current_method or ""
    name, count = METHODS[method].title, len(chosen)
    number = chosen.index(method) + 1
    frame = comparison.outcomes[method].frame
    if frame is None:
        return tr("{method} ({number} of {count}): preparing…").format(
            method=name, number=number, count=count
        )
    return tr("{method} ({number} of {count}): iteration {n:,}").format(
        method=name, number=number, count=count, n=frame.iteration
    )
