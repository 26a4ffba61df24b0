"""Editor of named poses: keep, restore, rename, update and remove."""

from dataclasses import replace

from apd_viewer.language import comma_separated, in_quotes, tr
from apd_viewer.session.gestures import DocumentEditor, Gestures
from apd_viewer.session.handle_editor import HandleEditor
from apd_viewer.session.model.document_parts import next_name, unique_name
from apd_viewer.session.model.handles_and_regions import MOST_POSES, NamedPose
from apd_viewer.session.posing import named_poses
from apd_viewer.session.state_store import Listener, StateStore

_NO_HANDLE = tr("There is no handle whose pose could be kept; paint one first.")


class PoseEditor(DocumentEditor):
    """Editor storing handle poses under names and restoring them."""

    def __init__(
        self, store: StateStore, gestures: Gestures, handles: HandleEditor, listener: Listener
    ) -> None:
        super().__init__(store, gestures, listener)
        self._handles = handles

    def add(self) -> None:
        """Store the current poses of all handles under a new name."""
        document = self._gestures.state_without_gesture().document
        if not named_poses.handle_placements(document):
            self._listener.failed(_NO_HANDLE)
        elif len(document.poses) >= MOST_POSES:
            self._listener.failed(tr("The limit is {most} poses; remove one first.").format(most=MOST_POSES))
        else:
            name = next_name(tr("Pose"), [pose.name for pose in document.poses])
            self._replace(
                tr("Keep pose"),
                poses=(*document.poses, NamedPose(name, named_poses.handle_placements(document))),
            )
            # A message is needed, since the list of poses may be hidden.
            self._listener.message_sent(tr("Kept as “{pose}”.").format(pose=name))

    def go_to(self, k: int) -> None:
        """Move the handles to pose ``k``; handles not in the pose are not moved."""
        document = self._gestures.state_without_gesture().document
        pose = document.poses[k]
        gone = named_poses.missing_handles(document, pose)
        if len(gone) == len(pose.placements):
            self._listener.failed(
                tr("The handles of “{pose}” are gone or empty; update or remove the pose.").format(
                    pose=pose.name
                )
            )
            return
        if not named_poses.is_in_pose(document, pose):
            self._handles.apply_poses(
                named_poses.with_named_pose(document, pose), tr("Go to “{pose}”").format(pose=pose.name)
            )
        if gone:
            self._listener.message_sent(
                tr("“{pose}” also places {handles}, which is gone or empty; the others are there.").format(
                    pose=pose.name, handles=comma_separated(map(in_quotes, gone))
                )
            )

    def go_to_neighbour(self, offset: int) -> None:
        """Go to the next (1) or previous (-1) pose, wrapping around the list."""
        document = self._gestures.state_without_gesture().document
        at = [named_poses.is_in_pose(document, pose) for pose in document.poses]
        if not at:
            self._listener.failed(tr("No poses are kept yet; keep one first."))
        elif not all(at):
            k = at.index(True) if any(at) else -1 if offset > 0 else len(at)
            while at[k := (k + offset) % len(at)]:
                pass
            self.go_to(k)

    def rename(self, k: int, name: str) -> None:
        """Rename pose ``k``; a name in use gets a number."""
        poses = self._store.required_state().document.poses
        name = unique_name(name, poses[k].name, [pose.name for pose in poses])
        if name != poses[k].name:
            self._set(tr("Rename"), k, replace(poses[k], name=name))

    def update(self, k: int) -> None:
        """Replace pose ``k`` by the current poses of all handles."""
        document = self._gestures.state_without_gesture().document
        if present := named_poses.handle_placements(document):
            self._set(tr("Update pose"), k, replace(document.poses[k], placements=present))
        else:
            self._listener.failed(_NO_HANDLE)

    def remove(self, k: int) -> None:
        """Remove pose ``k``; the handles do not move."""
        poses = self._store.required_state().document.poses
        self._replace(tr("Remove pose"), poses=poses[:k] + poses[k + 1 :])

    def _set(self, gesture: str, k: int, pose: NamedPose) -> None:
        poses = self._store.required_state().document.poses
        self._replace(gesture, poses=(*poses[:k], pose, *poses[k + 1 :]))
