"""Named poses and symmetric posing in the window."""

from collections.abc import Callable

from apd_viewer.language import tr
from apd_viewer.session.model.document import Document
from apd_viewer.session.posing.mirror_partner import mirror_partner
from apd_viewer.session.posing.named_poses import is_in_pose
from apd_viewer.session.session import Session
from apd_viewer.ui.posing.motion_field import SymmetryRow
from apd_viewer.ui.posing.pose_section import PoseSection
from apd_viewer.ui.tools.active_parts import ActiveParts


class PoseController:
    """Connects the list of named poses to the session.

    Parameters
    ----------
    cancel_drag : callable
        Function to cancel the current drag; True if there was one.
    """

    def __init__(self, section: PoseSection, session: Session, cancel_drag: Callable[[], bool]) -> None:
        self._section, self._session, self._give_up = section, session, cancel_drag
        poses = session.poses
        section.keep_requested.connect(self.keep_pose)
        section.list.chosen.connect(self._go_to)
        section.list.renamed.connect(poses.rename)
        section.list.update_requested.connect(poses.update)
        section.list.removed.connect(poses.remove)

    def keep_pose(self) -> None:
        """Add a named pose with the current positions of all handles."""
        if self._may_begin():
            self._session.poses.add()

    def step_pose(self, by: int) -> None:
        """Switch to the next (1) or previous (-1) named pose."""
        if self._may_begin():
            self._session.poses.go_to_neighbour(by)

    def refresh(self) -> None:
        """Show the named poses, and mark the current one."""
        state = self._session.store.state
        if state is not None:
            document = state.document
            at = (k for k, pose in enumerate(document.poses) if is_in_pose(document, pose))
            self._section.show_poses([pose.name for pose in document.poses], next(at, None))

    def _go_to(self, k: int) -> None:
        if self._may_begin():
            self._session.poses.go_to_pose(k)

    def _may_begin(self) -> bool:
        return self._session.store.state is not None and not self._give_up()


# Mirror partners with a smaller fraction of matching vertices are reported with the percentage.
_ALIKE = 0.98


class SymmetryController:
    """Connects the controls of symmetric posing to the session.

    Parameters
    ----------
    cancel_drag : callable
        Function to cancel the current drag.
    """

    def __init__(
        self, row: SymmetryRow, session: Session, parts: ActiveParts, cancel_drag: Callable[[], object]
    ) -> None:
        self._row, self._session, self._parts = row, session, parts
        self._give_up = cancel_drag
        row.axis_chosen.connect(self._choose)
        row.paint_requested.connect(self._paint)
        parts.changed.connect(self.refresh)

    def set_symmetric(self, on: bool) -> None:
        """Turn symmetric posing on or off."""
        self._row.box.setChecked(on)

    def refresh(self) -> None:
        """Show the mirror axis, and the mirror partner of the active handle."""
        state = self._session.store.state
        # Not during a brush stroke: the handles are still changing, and the search for a partner is slow.
        if state is not None and self._session.gestures.state_before is None:
            document, k = state.document, self._parts.handle
            searched = document.mirror_axis is not None and document.centre(k) is not None
            partner = mirror_partner(document, k) if searched else None
            self._row.show_settings(
                document.mirror_axis,
                _partner_sentence(document, k) if searched else "",
                searched and partner is None,
            )

    def _choose(self, axis: int | None) -> None:
        if self._session.store.state is not None:
            self._give_up()
            self._session.handles.set_mirror_axis(axis)

    def _paint(self) -> None:
        self._give_up()
        self._session.handles.paint_partner(self._parts.handle)


def _partner_sentence(document: Document, k: int) -> str:
    """Sentence about the mirror partner of handle ``k``."""
    partner = mirror_partner(document, k)
    if partner is None:
        return tr("No handle is painted at its mirror image, so it moves alone.")
    name = document.handles[partner.number].name
    if partner.number == k:
        return tr("This handle is its own mirror image: it moves within the mirror plane.")
    if partner.fraction < _ALIKE:
        said = tr("“{name}” moves along; {share:.0f} % of the two are mirror images.")
        return said.format(name=name, share=100.0 * partner.fraction)
    return tr("“{name}” moves along, mirrored.").format(name=name)
