"""Editor of the rest shape (reset, bake, weld) and the target shape."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from apd_viewer.errors import InputError
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.analysis.inspection import inspect
from apd_viewer.geometry.analysis.target_shape import TargetShape
from apd_viewer.language import tr
from apd_viewer.session.background_job import Jobs
from apd_viewer.session.gestures import DocumentEditor, Gestures
from apd_viewer.session.model.state import State, rest_frame, welded_state
from apd_viewer.session.model.status_text import LOAD_AGAIN, baking_sentence, target_sentence
from apd_viewer.session.posing.named_poses import rebased_poses
from apd_viewer.session.posing.obstacle_placement import reset_obstacles
from apd_viewer.session.state_store import Listener, StateStore


class ShapeEditor(DocumentEditor):
    """Editor of the rest shape and the target shape."""

    def __init__(self, store: StateStore, gestures: Gestures, jobs: Jobs, listener: Listener) -> None:
        super().__init__(store, gestures, listener)
        self._jobs = jobs

    def restore(self) -> None:
        """Reset handles, obstacles, shape and targets; the paint is kept."""
        state = self._gestures.state_without_gesture()
        if not state.is_at_rest:
            self._gestures.record(tr("Reset all handles"), state)
            rest = rest_frame(state.document.mesh, state.inspection)
            state = state.updated(state.document.at_rest(), rest)
            self._store.jump_to(state.updated(replace(state.document, obstacles=reset_obstacles(state))))

    def bake(self) -> None:
        """Make the displayed shape the rest shape, in the background."""

        def tell(shown: State) -> None:
            self._listener.message_sent(
                baking_sentence(shown.frame.area, shown.inspection.area, self._store.unit)
            )

        again = tr("The shape changed in the meantime; bake it again.")
        self._change(
            tr("Measuring the new rest shape"), _baked_with_poses, tr("Bake as rest shape"), again, tell
        )

    def weld(self) -> None:
        """Weld nearly coincident seams; the vertices of the file are kept."""
        again = tr("The shape changed in the meantime; weld it again.")
        self._change(tr("Welding the seams"), welded_state, tr("Weld seams"), again)

    def _change(
        self,
        doing: str,
        change: Callable[[State], State],
        gesture: str,
        again: str,
        tell: Callable[[State], object] = lambda _: None,
    ) -> None:
        """Change the state in the background; fail with ``again`` if it was replaced."""
        shown = self._gestures.state_without_gesture()

        def done(state: State) -> None:
            if self._gestures.state_without_gesture().document is not shown.document:
                self._listener.failed(again)
                return
            self._record_state(gesture)
            self._store.jump_to(state)
            tell(shown)

        self._jobs.run(doing, lambda: change(shown), done)

    def load_target(self, path: str | Path, on_success: Callable[[], object] = lambda: None) -> None:
        """Load a target shape from a mesh file in the background.

        ``on_success()`` follows if all went well.
        """
        path, mesh = Path(path), self._store.required_state().document.mesh

        def loaded(target: TargetShape) -> None:
            if self._store.required_state().document.mesh.F is not mesh.F:
                self._listener.failed(LOAD_AGAIN)
                return
            self._replace(tr("Load target shape"), target_shape=target, missing_target_shape=None)
            self._listener.message_sent(target_sentence(target, mesh))
            on_success()

        title = tr("Opening {name}").format(name=path.name)
        self._jobs.run(title, lambda: TargetShape(open_mesh(path)), loaded)

    def clear_target(self) -> None:
        """Remove the target shape."""
        document = self._store.required_state().document
        if document.target_shape is not None or document.missing_target_shape is not None:
            self._replace(tr("Clear target shape"), target_shape=None, missing_target_shape=None)


def _baked_with_poses(state: State) -> State:
    """State with its shape as the rest shape, and with rebased named poses."""
    at_rest = baked_state(state)
    return replace(at_rest, document=replace(at_rest.document, poses=rebased_poses(state.document)))


def baked_state(state: State) -> State:
    """State with its shape as the rest shape; raises InputError if it has no area."""
    mesh = state.document.mesh.baked(state.frame.U)
    inspection = inspect(mesh)
    if inspection.area <= 0.0:
        raise InputError(tr("The shape has no area and cannot be a rest shape; undo a step first."))
    # Motions restart from the new rest shape; pivots keep their current positions.
    handles = tuple(
        replace(handle.with_restarted_motion(), earlier_poses=(), former_twist_axis=None)
        for handle in state.document.handles
    )
    document = replace(state.document, mesh=mesh, handles=handles).at_rest()
    there = zip(document.obstacles, state.obstacle_shifts, strict=True)
    document = replace(document, obstacles=tuple(each.with_shift_applied(shift) for each, shift in there))
    at_rest = State(document, inspection, state.surface_index, rest_frame(mesh, inspection))
    return at_rest.updated(document, replace(at_rest.frame, regions=document.region_areas(mesh.V)))
