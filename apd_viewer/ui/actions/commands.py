"""Controllers of a window, as called by its actions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from PySide6.QtCore import Qt

from apd_viewer.ui.actions.edit_controller import EditController, PartController
from apd_viewer.ui.compare.compare_controller import CompareController
from apd_viewer.ui.filing.file_controller import FileController
from apd_viewer.ui.filing.file_requests import FileRequests
from apd_viewer.ui.measuring.measure_controller import MeasureController
from apd_viewer.ui.obstacles.obstacle_controller import ObstacleController
from apd_viewer.ui.overlays.display_options import DisplayOptions
from apd_viewer.ui.overlays.findings_controller import FindingsController
from apd_viewer.ui.posing.pose_controller import PoseController, SymmetryController
from apd_viewer.ui.sharing.report_controller import ReportController
from apd_viewer.ui.studies.case_study_controller import CaseStudyController
from apd_viewer.ui.studies.run_controller import RunController
from apd_viewer.ui.target.target_controller import TargetController
from apd_viewer.ui.tools.canvas import Canvas
from apd_viewer.ui.tools.toolbox import SelectionMode, Tool


class HelpCommands(Protocol):
    """Help over the window, and the manual."""

    def open_manual(self) -> None:
        """Open the first page of the manual."""

    def explain_next_click(self) -> None:
        """Explain the next click."""

    def open_search(self) -> None:
        """Search for a command."""

    def open_sheet(self) -> None:
        """List the shortcuts."""

    def begin_tour(self) -> None:
        """Begin the tour."""


@dataclass(frozen=True, eq=False)
class Commands:
    """The controllers, and the commands of the window itself."""

    canvas: Canvas
    requests: FileRequests
    files: FileController
    edits: EditController
    parts: PartController
    symmetry: SymmetryController
    poses: PoseController
    display_options: DisplayOptions
    measurements: MeasureController
    obstacles: ObstacleController
    findings: FindingsController
    runs: RunController
    case_studies: CaseStudyController
    comparison: CompareController
    reports: ReportController
    target: TargetController
    choose_tool: Callable[[Tool], object]
    choose_mode: Callable[[SelectionMode], object]
    type_motion: Callable[[], object]
    pause_or_resume: Callable[[], object]
    set_scheme: Callable[[Qt.ColorScheme], object]
    open_settings: Callable[[], object]
    help: Callable[[], HelpCommands]
    show_about_box: Callable[[], object]
    quit: Callable[[], object]
