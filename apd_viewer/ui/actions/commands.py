"""Controllers and commands called by the actions of a window."""

from collections.abc import Callable
from dataclasses import dataclass

from PySide6.QtCore import Qt

from apd_viewer.ui.actions.edit_controller import EditController, PartController
from apd_viewer.ui.compare.compare_controller import CompareController
from apd_viewer.ui.filing.file_controller import FileController
from apd_viewer.ui.filing.file_requests import FileRequests
from apd_viewer.ui.measuring.measure_controller import MeasureController
from apd_viewer.ui.obstacles.obstacle_controller import ObstacleController
from apd_viewer.ui.overlays.display_options import DisplayOptions
from apd_viewer.ui.overlays.findings_controller import FindingsController
from apd_viewer.ui.overlays.region_picture import RegionPicture
from apd_viewer.ui.posing.pose_controller import PoseController, SymmetryController
from apd_viewer.ui.sharing.report_controller import ReportController
from apd_viewer.ui.simulate.press_controller import PressController
from apd_viewer.ui.studies.case_study_controller import CaseStudyController
from apd_viewer.ui.studies.run_controller import RunController
from apd_viewer.ui.target.target_controller import TargetController
from apd_viewer.ui.tools.canvas import Canvas
from apd_viewer.ui.tools.tool_modes import SelectionMode


@dataclass(frozen=True, eq=False)
class Commands:
    """Controllers and window commands called by the actions."""

    canvas: Canvas
    requests: FileRequests
    files: FileController
    edits: EditController
    parts: PartController
    symmetry: SymmetryController
    poses: PoseController
    display_options: DisplayOptions
    region_picture: RegionPicture
    measurements: MeasureController
    obstacles: ObstacleController
    findings: FindingsController
    press: PressController
    runs: RunController
    case_studies: CaseStudyController
    comparison: CompareController
    reports: ReportController
    target: TargetController
    choose_mode: Callable[[SelectionMode], object]
    type_motion: Callable[[], object]
    pause_or_resume: Callable[[], object]
    set_scheme: Callable[[Qt.ColorScheme], object]
    open_settings: Callable[[], object]
    show_about_box: Callable[[], object]
