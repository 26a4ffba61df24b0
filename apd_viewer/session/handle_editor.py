"""Editors of handle poses and pivots, and of poses kept under names."""

from dataclasses import replace

import numpy as np

from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import HANDLE, MOST_HANDLES, transform
from apd_viewer.language import comma_separated, in_quotes, tr
from apd_viewer.session.gestures import DocumentEditor, Gestures
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.document_parts import PaintedPart, next_name, unique_name
from apd_viewer.session.model.handle_paths import with_rounded_poses
from apd_viewer.session.model.handles_and_regions import MOST_POSES, Handle, NamedPose
from apd_viewer.session.model.state import State
from apd_viewer.session.part_operations import PartOperation, members_after
from apd_viewer.session.posing import motion_path, named_poses
from apd_viewer.session.posing.initial_positions import has_moved
from apd_viewer.session.posing.mirror_partner import mirrored_handle, with_pair_moved, with_pair_reset
from apd_viewer.session.posing.motion import Motion, MotionReference
from apd_viewer.session.quantities.expressions import unambiguous_text
from apd_viewer.session.state_store import Listener, StateStore
from apd_viewer.session.timeline_player import TimelinePlayer

_MIRRORS = PartOperation.MIRROR_X, PartOperation.MIRROR_Y, PartOperation.MIRROR_Z


class HandleEditor(DocumentEditor):
    """Editor of the handle poses; the shape is solved after each change."""

    def __init__(self, store: StateStore, gestures: Gestures, listener: Listener) -> None:
        super().__init__(store, gestures, listener)
        self._warned: Mesh | None = None

    def drag(self, pose: np.ndarray, k: int = 0) -> None:
        """Move a handle to a pose (4, 4) from its initial position, within a gesture."""
        state = self._store.required_state()
        if self._gestures.state_before is not None:  # another mesh may have ended the drag
            self._store.solve(with_pair_moved(state.document, k, pose))

    def end_drag(self, k: int = 0) -> None:
        """End the drag of a handle; solve along its path after half a turn or more.

        Otherwise the shape would depend on the pace of the drag if it has many minima.
        """
        before, document = self._gestures.state_before, self._store.required_state().document
        if before is not None:  # another mesh may have ended the drag
            self._gestures.end(
                motion_path.motion_title_between(before.document, document, k, self._store.unit)
            )
            if document.has_half_turn:
                self._solve_along_paths(document)

    def set_pose(self, pose: np.ndarray, k: int, gesture: str, is_repeat: bool = False) -> None:
        """Move a handle to a pose (4, 4) as a new undo step, or as part of the last one."""
        self.apply_poses(
            with_pair_moved(self._gestures.state_without_gesture().document, k, pose), gesture, is_repeat
        )

    def plan_motion(
        self, motion: Motion, text: str, k: int, line: np.ndarray | None = None, is_total: bool = False
    ) -> motion_path.MotionStep:
        """Motion of a handle by or to a typed amount, without applying it.

        ``line`` (2, 3) is the axis of a bend about a line. Raises InputError if the text is none.
        """
        document, kind = self._store.required_state().document, motion.kind.amount
        now = MotionReference(document.relative_to_rest, k, line)
        amount = kind.parse(
            unambiguous_text(text), self._store.unit, document.mesh.named_lengths, now.at_rest
        )
        amount = kind.remaining_amount(amount, motion, now) if is_total else amount
        return motion_path.MotionStep(k, motion, (amount,), line)

    def move_by(
        self, motion: Motion, text: str, k: int, line: np.ndarray | None = None, is_total: bool = False
    ) -> None:
        """Apply a typed relative or absolute motion to a handle; raises InputError."""
        self._gestures.cancel()
        step, start = self.plan_motion(motion, text, k, line, is_total), self._store.required_state().document
        end = step.end_document(start)
        names = motion_path.moved_handle_names(start, end)
        self.apply_poses(end, motion_path.motion_title(motion, step.amounts[0], names, self._store.unit))

    def play_motion(self, step: motion_path.MotionStep, count: int, player: TimelinePlayer) -> None:
        """Apply a motion in ``count`` equal steps on the timeline, in one undo step.

        Raises
        ------
        InputError
            If the motion is impossible; the message says why.
        """
        document = self._gestures.state_without_gesture().document
        if document.paint_problem:
            self._listener.failed(document.paint_problem)
            return
        documents = [with_rounded_poses(each) for each in step.documents(document, count)]
        names = motion_path.moved_handle_names(document, documents[-1])
        title = motion_path.motion_title(step.motion, step.amounts[0], names, self._store.unit)
        player.play(title, documents)

    def reset_handle(self, k: int) -> None:
        """Reset one handle to its rest position, and solve."""
        state = self._gestures.state_without_gesture()
        if state.document.paint_problem or state.is_handle_moved(k):
            self.apply_poses(with_pair_reset(state.document, k), tr("Reset handle"))

    def apply_poses(self, document: Document, gesture: str, is_repeat: bool = False) -> None:
        """Replace the handle poses in one undo step, and solve."""
        state = self._store.required_state()
        pairs = zip(state.document.handles, document.handles, strict=True)
        if state.document.paint_problem:
            self._listener.failed(state.document.paint_problem)
        elif document.initial_positions is not state.document.initial_positions or any(
            has_moved(*pair) for pair in pairs
        ):
            self._gestures.record(gesture, state, is_repeat)
            self.solve_poses(document)

    def solve_poses(self, document: Document) -> None:
        """Solve a document, along the handle paths if they include half a turn or more.

        Also if they did so before: the shortest way back would leave the shape twisted by a full turn.
        """
        before = self._store.required_state().document
        is_restarted = document.initial_positions is not before.initial_positions
        if (
            document.has_half_turn
            or before.has_half_turn
            or (is_restarted and before.relative_to_rest.has_half_turn)
        ):
            self._solve_along_paths(document)
        else:
            self._store.solve(document)

    def _solve_along_paths(self, document: Document) -> None:
        """Solve a document along its handle paths, with a one-time warning."""
        kept_apart = document.settings.uses_contact
        if document.has_half_turn and not kept_apart and document.mesh is not self._warned:
            self._warned = document.mesh
            self._listener.message_sent(
                tr(
                    "Beyond half a turn a thin wall may pass through itself and unwind; "
                    "the handle keeps its turns."
                )
            )
        self._store.solve_from_initial_positions(with_rounded_poses(document))

    def set_pivot(self, point: np.ndarray | None, k: int) -> None:
        """Set the pivot of a handle to a ``point`` (3,) of the shape; None is its centre."""
        state = self._gestures.state_without_gesture()
        handle = state.document.handles[k]
        if point is not None:
            point = frozen(transform(np.linalg.inv(handle.pose), np.asarray(point, dtype=float)[None])[0])
        elif handle.pivot is None:
            return
        self._gestures.record(tr("Move pivot"), state)
        self._store.set_document(state.document.with_handle(k, replace(handle, pivot=point)))

    def set_mirror_axis(self, axis: int | None) -> None:
        """Set the symmetry axis of handle motions, 0, 1 or 2; None for no symmetry."""
        if axis != self._gestures.state_without_gesture().document.mirror_axis:
            self._replace(tr("Change symmetry"), mirror_axis=axis)

    def paint_partner(self, k: int) -> None:
        """Paint a handle on the mirror image of handle ``k``, in the mirrored pose."""
        state = self._gestures.state_without_gesture()
        document = state.document.relative_to_rest
        ids = _unpainted_image(state, k)
        if len(document.handles) >= MOST_HANDLES:
            sentence = tr("The limit is {most} handles; remove one first.").format(most=MOST_HANDLES)
            self._listener.failed(sentence)
        elif not len(ids):
            self._listener.failed(
                tr("The other side has no free vertices there; choose another axis or erase paint.")
            )
        else:
            handle = document.handles[k]
            name = next_name(tr("Handle"), [each.name for each in document.handles])
            partner = mirrored_handle(document, handle, Handle(name, falloff=handle.falloff))
            self._gestures.record(tr("Paint mirror handle"), state)
            document = document.with_handle(len(document.handles), partner)
            self.solve_poses(document.with_label(ids, HANDLE + len(document.handles) - 1))


def _unpainted_image(state: State, k: int) -> np.ndarray:
    """Free vertices at the mirror image of handle ``k``."""
    document, part = state.document, PaintedPart(HANDLE + k)
    if document.mirror_axis is None:
        return np.empty(0, dtype=int)
    both = members_after(state, part, _MIRRORS[document.mirror_axis])
    return np.flatnonzero(both & ~part.mask(document))


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

    def go_to_pose(self, k: int) -> None:
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
            self.go_to_pose(k)

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
