"""Named poses in the window: the list in the panel, and the keys."""

from __future__ import annotations

from collections.abc import Callable

from apd_viewer.session.posing.named_poses import is_in_pose
from apd_viewer.session.session import Session
from apd_viewer.ui.panel.pose_section import PoseSection


class PoseController:
    """Connects the list of named poses with the session, if a document is open.

    Parameters
    ----------
    section : PoseSection
    session : Session
    cancel_drag : callable
        Takes back the drag that is under way; True if there was one.
    """

    def __init__(self, section: PoseSection, session: Session, cancel_drag: Callable[[], bool]) -> None:
        self._section, self._session, self._give_up = section, session, cancel_drag
        poses = session.poses
        section.keep_requested.connect(self.keep_pose)
        section.list.chosen.connect(self._go)
        section.list.renamed.connect(poses.rename)
        section.list.update_requested.connect(poses.update)
        section.list.removed.connect(poses.remove)

    def keep_pose(self) -> None:
        """Keep the present places of all handles."""
        if self._may_begin():
            self._session.poses.add()

    def step_pose(self, by: int) -> None:
        """Go to the next pose, 1, or the previous one, -1."""
        if self._may_begin():
            self._session.poses.go_to_neighbour(by)

    def refresh(self) -> None:
        """Show the poses, and the one that the handles are in."""
        state = self._session.store.state
        if state is not None:
            document = state.document
            at = (k for k, pose in enumerate(document.poses) if is_in_pose(document, pose))
            self._section.show_poses([pose.name for pose in document.poses], next(at, None))

    def _go(self, k: int) -> None:
        if self._may_begin():
            self._session.poses.go_to(k)

    def _may_begin(self) -> bool:
        return self._session.store.state is not None and not self._give_up()
