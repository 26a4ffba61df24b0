"""Controllers of a window, as called by its actions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Callable

    from PySide6.QtCore import Qt

    from apd_viewer.ui.actions.edit_commands import Editing
    from apd_viewer.ui.actions.part_commands import PartCommands
    from apd_viewer.ui.case_studies.case_studies import CaseStudies
    from apd_viewer.ui.compare.compare_controller import Comparing
    from apd_viewer.ui.filing.file_commands import Filing
    from apd_viewer.ui.filing.file_requests import FileRequests
    from apd_viewer.ui.measuring.measure_controller import MeasureController
    from apd_viewer.ui.obstacles.obstacle_controller import ObstacleController
    from apd_viewer.ui.overlays.display_options import Looks
    from apd_viewer.ui.overlays.findings_controller import Health
    from apd_viewer.ui.panel.target_controller import Targeting
    from apd_viewer.ui.posing.pose_controller import PoseController
    from apd_viewer.ui.posing.symmetry_controller import SymmetryController
    from apd_viewer.ui.sharing.report_controller import Reporting
    from apd_viewer.ui.studies.studies import Studies
    from apd_viewer.ui.tools.canvas import Canvas
    from apd_viewer.ui.tools.toolbox import Tool, Way


class HelpCommands(Protocol):
    """Help over the window, and the manual."""

    def open_manual(self) -> None:
        """Open the first page of the manual."""

    def ask(self) -> None:
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
    filing: Filing
    editing: Editing
    parts: PartCommands
    symmetry: SymmetryController
    poses: PoseController
    looks: Looks
    measure: MeasureController
    obstacles: ObstacleController
    findings: Health
    studies: Studies
    case_studies: CaseStudies
    comparing: Comparing
    reporting: Reporting
    targeting: Targeting
    take: Callable[[Tool], object]
    choose_way: Callable[[Way], object]
    type_motion: Callable[[], object]
    pause: Callable[[], object]
    set_scheme: Callable[[Qt.ColorScheme], object]
    open_settings: Callable[[], object]
    help: Callable[[], HelpCommands]
    tell_about: Callable[[], object]
    quit: Callable[[], object]
