"""Dialog to design and start a study of the current document."""

import math
from pathlib import Path

from PySide6.QtCore import QObject, QSize, Qt, Signal
from PySide6.QtWidgets import QDialog, QFileDialog, QFrame, QGridLayout, QLabel, QLayout, QPushButton, QWidget

from apd_viewer.cases.case import MOST_STEPS
from apd_viewer.cases.design import GRID, LATIN, MOST_SAMPLES, SOBOL
from apd_viewer.errors import InputError
from apd_viewer.files.storage.atomic_file import unused_folder
from apd_viewer.geometry.solver.methods import METHODS
from apd_viewer.language import tr
from apd_viewer.presentation.time_left import duration_text
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.state import State
from apd_viewer.session.model.view import View
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.session import Session
from apd_viewer.session.state_store import Activity
from apd_viewer.ui.posing.motion_ghost import MotionGhost
from apd_viewer.ui.preferences.preferences import Preferences
from apd_viewer.ui.studies import study_run
from apd_viewer.ui.studies.engine_fields import EngineFields
from apd_viewer.ui.studies.run_dialog import add_titled_rows, count_field
from apd_viewer.ui.studies.varied_fields import TITLE_COLUMN_WIDTH, VariedFields
from apd_viewer.ui.widgets.box_layouts import STRETCH, column_layout, resize_on_screen, row_layout
from apd_viewer.ui.widgets.display_names import window_title_text
from apd_viewer.ui.widgets.fields import CheckBox, ComboBox, TextField
from apd_viewer.ui.widgets.help_button import HelpButton

_WIDTH = 720  # px: width of the dialog
_CASES, _LEVELS = 100, 5


class PlanDialog(QDialog):
    """Dialog to design a study of the document open at its creation.

    Parameters
    ----------
    session : Session
        Session with the mesh for previews of the ranges' ends.
    handle : int
        Index of the handle moved by typed motions.
    ghost : MotionGhost
        Ghost of the handles, shown before the mesh follows.

    Attributes
    ----------
    study_designed : Signal(object, object)
        The folder with its plan, and the options of the command that runs it.
    """

    study_designed = Signal(object, object)

    def __init__(
        self,
        window: QWidget,
        session: Session,
        handle: int,
        view: View,
        preferences: Preferences,
        ghost: MotionGhost,
    ) -> None:
        super().__init__(window, objectName="study")
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self._state, self._handle, self._view, self._memory = (
            session.store.required_state(),
            handle,
            view,
            preferences,
        )
        self._preview = RangeEndPreview(session, ghost)
        # Seconds of the displayed shape; 0 if it was opened instead of solved.
        solved = session.store.activity is Activity.SETTLED
        self._step_seconds = solved * self._state.frame.iteration * session.store.seconds_per_iteration
        mesh = self._state.document.mesh
        self.setWindowTitle(tr("Study – {name}").format(name=window_title_text(mesh.name)))
        self.varied = VariedFields(self._state, Unit(view.unit))
        self.varied.changed.connect(self._count)
        self.varied.end_focused.connect(self._preview_end)
        self.varied.focus_lost.connect(self._preview.hide)
        self.methods = MethodFields(self._state.document)
        self.methods.changed.connect(self._count)
        self.engine = EngineFields()
        self.engine.engine_ready.connect(self._begin)
        self.engine.check.failed.connect(self._say_unreached)
        self.engine.processes.valueChanged.connect(self._count)
        self.engine.where.currentIndexChanged.connect(self._count)
        self._lay_out(unused_folder(preferences.last_folder, f"{mesh.stem}-study"))
        self._count()
        self._move_aside(window)

    # Layout

    def _move_aside(self, window: QWidget) -> None:
        """Move to the right of the window, to keep the mesh preview visible."""
        there = window.frameGeometry().intersected(window.screen().availableGeometry())
        self.move(there.right() + 1 - self.width(), there.center().y() - self.height() // 2)

    def _lay_out(self, folder: Path) -> None:
        about = tr(
            "Computes many variants of this deformation, each in steps, and collects their measurements in "
            "a table. While you edit an end of a range, the view shows it."
        )
        column = column_layout(
            QLabel(about, objectName="quiet", wordWrap=True),
            QLabel(self._vary_heading, objectName="heading"),
            self.varied,
            QFrame(objectName="rule", frameShape=QFrame.Shape.HLine),
            self._make_rows(folder),
            STRETCH,
            self._make_foot(),
            spacing=12,
            margins=(20, 16, 20, 16),
            parent=self,
        )
        column.activate()
        resize_on_screen(self, QSize(_WIDTH, column.totalHeightForWidth(_WIDTH)))

    @property
    def _vary_heading(self) -> str:
        handles = self._state.document.handles
        if len(handles) == 1:
            return tr("Vary")
        return tr("Vary – typed motions move “{name}”").format(name=handles[self._handle].name)

    def _make_rows(self, folder: Path) -> QGridLayout:
        rows: list[tuple[str, QLayout]] = [
            (tr("Methods"), self.methods.layout_),
            (tr("Cases"), self._make_design()),
            (tr("Run"), self.engine.layout_),
            (tr("Limit"), self.engine.limit_layout),
            (tr("Folder"), self._make_folder(folder)),
        ]
        grid = QGridLayout(horizontalSpacing=16, verticalSpacing=8)
        grid.setColumnMinimumWidth(0, TITLE_COLUMN_WIDTH - 16)
        add_titled_rows(grid, rows)
        return grid

    def _make_design(self) -> QLayout:
        self.design = ComboBox(accessibleName=tr("Design"))
        for method, title, tip in (
            (LATIN, tr("Latin hypercube"), tr("Covers each range evenly with any number of cases")),
            (SOBOL, tr("Sobol sequence"), tr("Covers the ranges most evenly with 64, 128, 256 … cases")),
            (GRID, tr("grid"), tr("All combinations of this many values of each range")),
        ):
            self.design.addItem(title, method)
            self.design.setItemData(self.design.count() - 1, tip, Qt.ItemDataRole.ToolTipRole)
        self.samples = count_field(tr("Number of cases"), 1, MOST_SAMPLES, _CASES)
        self.steps = count_field(tr("Steps per case"), 1, MOST_STEPS, 10)
        self.design.currentIndexChanged.connect(self._choose_design)
        self.samples.valueChanged.connect(self._count)
        self.steps.valueChanged.connect(self._count)
        self.count = QLabel(objectName="quiet")
        self._of_samples = QLabel()
        each = QLabel(tr("steps each"))
        return row_layout(self.samples, self._of_samples, self.design, self.count, self.steps, each, STRETCH)

    def _make_folder(self, folder: Path) -> QLayout:
        self.folder = TextField(toolTip=tr("New folder for the plan and the results"))
        self.folder.setAccessibleName(tr("Folder"))
        self.folder.setText(str(folder))
        self.browse = QPushButton(tr("Choose…"), clicked=self._browse, autoDefault=False)
        return row_layout((self.folder, 1), self.browse)

    def _make_foot(self) -> QLayout:
        self.message = QLabel(objectName="quiet", wordWrap=True)
        self.cancel = QPushButton(tr("Cancel"), clicked=self.reject, autoDefault=False)
        self.start = QPushButton(tr("Run"), objectName="primary", clicked=self.begin, default=True)
        self.help = HelpButton()
        return row_layout(self.help, (self.message, 1), self.cancel, self.start)

    # Choice of design, methods and ranges

    def _choose_design(self) -> None:
        grid = self.design.currentData() == GRID
        levels = round(self.samples.value())
        if grid is (levels == _CASES):
            self.samples.setValue(_LEVELS if grid else _CASES)
        self._count()

    def _count(self) -> None:
        """Show the number of cases of the current design."""
        grid = self.design.currentData() == GRID
        self._of_samples.setText(tr("values of each,") if grid else tr("cases,"))
        varying = sum(row.is_checked and row.has_two_ends for row in self.varied.rows.values())
        total = self.methods.chosen_count * math.pow(self.samples.value(), varying) if grid else 0.0
        self.count.setText(tr("= {n:,.0f} cases,").format(n=total) if grid else "")
        self.count.setVisible(grid)
        self.message.setText(self._duration(total if grid else self.samples.value()))

    def _duration(self, cases: float) -> str:
        """Sentence about the time of so many cases; empty if unknown."""
        rate = self.engine.local_processes / self._step_seconds if self._step_seconds else 0.0
        if not cases or not rate:
            return ""
        seconds = cases * self.steps.value() / rate
        unit = next(unit for unit in (1.0, 60.0, 3600.0) if seconds < 100.0 * unit or unit == 3600.0)
        said = tr("Roughly {time}, if each step takes as long as the shape on screen did.")
        return said.format(time=duration_text(unit * float(f"{seconds / unit:.1g}")))

    def _preview_end(self, name: str, upper: bool) -> None:
        """Preview one end of a range on the mesh."""
        try:
            said = self.varied.values_at_end(name, upper)
            document = study_run.document_with_values(self._state, Unit(self._view.unit), self._handle, said)
        except InputError as error:
            self.message.setText(str(error))
            self._preview.hide()
        else:
            self.message.setText("")
            self._preview.show(document)

    def _browse(self) -> None:
        folder = QFileDialog.getExistingDirectory(
            self, tr("Choose a folder to save in"), str(Path(self.folder.text()).parent)
        )
        if folder:
            self.folder.setText(str(unused_folder(Path(folder), Path(self.folder.text()).name)))

    # Start of the study

    def begin(self) -> None:
        """Start the study as soon as its engine is available."""
        self._preview.hide()
        try:
            self._asked = self._designed_study()
            self.message.setText("")
            self.engine.check_engine()
        except InputError as error:
            self.message.setText(str(error))
        if self.engine.check.is_waiting:
            self.start.setEnabled(False)
            self.message.setText(tr("Connecting to the scheduler …"))

    def _say_unreached(self, sentence: str) -> None:
        self.start.setEnabled(True)
        self.message.setText(sentence)

    def _designed_study(self) -> tuple[Path, study_run.PlanRows, list[str]]:
        """Folder, plan rows and command options as entered; raises InputError."""
        folder = study_run.path_from_text(self.folder.text())
        options = self.engine.options()
        design = study_run.StudyDesign(
            self.varied.ranges(),
            self.methods.chosen_methods(),
            self.design.currentData(),
            round(self.samples.value()),
            round(self.steps.value()),
            self._handle,
        )
        rows = design.plan_rows(self._state.document.settings.method)
        self._check(folder, design)
        return folder, rows, options

    def _begin(self) -> None:
        """Write the plan and session, and emit ``study_designed``."""
        self.start.setEnabled(True)
        folder, rows, options = self._asked
        try:
            study_run.write_study(folder, rows, self._state, self._view)
        except InputError as error:
            self.message.setText(str(error))
            return
        self.study_designed.emit(folder, options)
        self.accept()

    def _check(self, folder: Path, design: study_run.StudyDesign) -> None:
        """Raise InputError for a missing or used folder, or without any motion."""
        if not self.folder.text().strip():
            raise InputError(tr("Enter a new folder for the plan and the results."))
        if folder.is_file() or (folder.is_dir() and any(folder.iterdir())):
            raise InputError(tr("This folder is in use; enter a new one."))
        if not design.has_motion and not self._state.document.relative_to_rest.is_posed:
            raise InputError(tr("No handle moves; tick a motion as well, with one end or both."))

    def done(self, result: int) -> None:
        """Close the dialog and end the preview."""
        self._preview.hide()
        self.engine.check.stop()
        super().done(result)


class RangeEndPreview:
    """Preview of documents as a gesture, cancelled at its end.

    Parameters
    ----------
    ghost : MotionGhost
        Ghost of the handles, shown before the mesh follows.
    """

    def __init__(self, session: Session, ghost: MotionGhost) -> None:
        self._session, self._ghost = session, ghost
        self._before: State | None = None

    @property
    def is_showing(self) -> bool:
        """True while a preview is shown."""
        return self._before is not None and self._session.gestures.state_before is self._before

    def show(self, document: Document) -> None:
        """Preview a document of the open mesh, unless another gesture is active."""
        gestures, state = self._session.gestures, self._session.store.state
        if state is None or state.document.mesh is not document.mesh:
            return
        if not self.is_showing:
            if gestures.state_before is not None:
                return
            gestures.begin()
            self._before = gestures.state_before
        self._ghost.show_handles(document)
        self._session.handles.solve_poses(document)

    def hide(self) -> None:
        """End the preview, and restore the state before it."""
        self._ghost.hide()
        gestures, before, self._before = self._session.gestures, self._before, None
        if before is None:
            return
        if gestures.state_before is before:
            gestures.cancel()
        elif (
            gestures.state_before is not None and gestures.state_before.document.mesh is before.document.mesh
        ):
            gestures.state_before = before  # undo of a drag begun during the preview also reverts the preview


class MethodFields(QObject):
    """Check box for each method, with the document's method checked.

    Attributes
    ----------
    checks : dict of str to CheckBox
        By the names of methods.
    layout_ : QLayout
        The row of the boxes.
    """

    changed = Signal()

    def __init__(self, document: Document) -> None:
        super().__init__()
        self.checks = {name: CheckBox(method.short_title) for name, method in METHODS.items()}
        for name, check in self.checks.items():
            method = METHODS[name]
            slow = tr("Takes several times as long as the others")
            check.setToolTip(f"{method.description}\n{slow}" if method.is_slow else method.description)
            # Obstacles push by contact only.
            check.setEnabled(method.may_use_contact or not document.has_active_obstacles)
            check.setChecked(name == document.settings.method)
            check.toggled.connect(self.changed)
        self.layout_: QLayout = row_layout(*self.checks.values(), STRETCH, spacing=16)

    @property
    def chosen_count(self) -> int:
        """Number of checked methods."""
        return sum(check.isChecked() for check in self.checks.values())

    def chosen_methods(self) -> tuple[str, ...]:
        """Names of the checked methods; raises InputError if none is checked."""
        found = tuple(name for name, check in self.checks.items() if check.isChecked())
        if not found:
            raise InputError(tr("No method is ticked; tick one, or several to compare them."))
        return found
