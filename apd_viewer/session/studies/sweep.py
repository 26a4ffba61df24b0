"""Sweeps: a motion in steps by several methods.

Which folds press against each other depends on the way there. Through shapes at rest it leads to others than
the walk of a single deformation does, and to others again by the number of the steps. So from the first shape
that touches itself each one comes to rest beside the walk, and the last one is that of a deformation to the
end of the motion. Before, the way does not matter, and each goes on from the one before: half the work.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TypeAlias

import numpy as np

from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.mesh.arrays import diagonal
from apd_viewer.geometry.pose.constraints import transform
from apd_viewer.geometry.pose.frame import Frame
from apd_viewer.geometry.pose.held_turn import HeldTurn, pass_through_warnings
from apd_viewer.geometry.pose.screw_motion import RotationPath
from apd_viewer.geometry.pose.surface_turns import held_turns
from apd_viewer.geometry.pose.waypoint_path import HandlePath, WaypointPath
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.methods import method_named
from apd_viewer.geometry.solver.path_iteration import PathIteration
from apd_viewer.language import tr
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.handle_paths import document_at, handle_pose_sequences
from apd_viewer.session.model.named_obstacle import NamedObstacle
from apd_viewer.session.model.state import load_excess_of
from apd_viewer.session.posing.motion_path import MotionPath, document_along, total_turn
from apd_viewer.session.processes.document_deformation import deformation_of, document_iteration
from apd_viewer.session.studies.sweep_step import SweepStep

# For each step: "local" creeps on for thousands of iterations without visible effect on the curve.
DEFAULT_ITERATIONS = 500
# With obstacles, whose loads mean nothing before the shape has settled.
SETTLING_ITERATIONS = 10_000
# Of the rest shape's diagonal: a shorter path is none.
_NO_WAY = 1e-9

SweepPath: TypeAlias = HandlePath | MotionPath


@dataclass(frozen=True, eq=False)
class Sweep:
    """Parameters of a sweep.

    Attributes
    ----------
    document : Document
        Its paint, its settings, and its grip, from which the handles start.
    paths : tuple of SweepPath
        The way of each handle.
    shares : tuple of float
        Of the motion, one for each step.
    methods : tuple of str
    iterations : int
        At most so many for each step, without those on the way to it in contact.
    """

    document: Document
    paths: tuple[SweepPath, ...]
    shares: tuple[float, ...]
    methods: tuple[str, ...]
    iterations: int = DEFAULT_ITERATIONS

    @property
    def leading_handle(self) -> int:
        """The first moving handle; the first of all where obstacles alone move."""
        return next((k for k, path in enumerate(self.paths) if path.has_motion), 0)

    @property
    def obstacles(self) -> tuple[NamedObstacle, ...]:
        """Obstacles whose loads are measured."""
        return self.document.obstacles if self.document.settings.contact else ()

    def load_excess_percent(self, method: str) -> float | None:
        """Expected excess of the loads by a method; None without stiffness or loads."""
        document = self.document.with_settings(method=method)
        excess = load_excess_of(document) if document.has_active_obstacles else None
        return None if excess is None else 100.0 * excess

    @property
    def abscissa(self) -> str:
        """Kind of abscissa: "degrees" of a turn, the "way" of a shift, or the "part"."""
        path = self.paths[self.leading_handle]
        if not path.has_motion or any(each.shift.any() for each in self.obstacles):
            return "part"
        several = sum(path.has_motion for path in self.paths) > 1
        if several or path.has_stretch or isinstance(path, WaypointPath | MotionPath):
            return "part"
        if isinstance(path, RotationPath):
            return "degrees"
        if path.angle == 0.0:
            return "way"
        return "part" if np.linalg.norm(path.along) > _NO_WAY * self._diagonal else "degrees"

    @property
    def _diagonal(self) -> float:
        return diagonal(self.document.mesh.V)

    def warnings_of(self, step: SweepStep) -> tuple[str, ...]:
        """Sentences on what a step does not reach, and on passing through itself."""
        frame = step.frame
        if frame.unreached:
            return frame.unreached, *self._passing(step)
        if frame.share_reached < 1.0:
            said = tr("Contact stopped the handle after {share:.3g} % of its way.")
            return said.format(share=100.0 * frame.share_reached), *self._passing(step)
        return self._passing(step)

    def _passing(self, step: SweepStep) -> tuple[str, ...]:
        may_touch, names = (
            method_named(step.method).may_use_contact,
            [each.name for each in self.document.handles],
        )
        touch = self.document.settings.contact and may_touch, may_touch
        return pass_through_warnings(step.turns, step.frame, step.volume_rest, *touch, names)

    def document_at(self, share: float) -> Document:
        """The document with its handles at a part of their motion."""
        return document_at(self.document, self.paths, share)

    def steps(self, tick: Callable[[float, str], object] = lambda *_: None) -> Iterator[SweepStep]:
        """The shapes, one method after another.

        Parameters
        ----------
        tick : callable
            Called after every iteration with the share of all work that is done, at a guess, and with the
            method; what it raises ends the sweep.
        """
        rest: RestMesh | None = None
        for m, method in enumerate(self.methods):
            document = self.document.with_settings(method=method)
            tick(m / len(self.methods), method)
            solver = deformation_of(document, document.constraints(), rest)
            rest = solver.rest
            told = partial(self._tell, tick, m)
            for number, frame in enumerate(self._frames(solver, told)):
                yield self._step(solver, number, frame)

    def _tell(self, tick: Callable[[float, str], object], m: int, number: int, k: int) -> None:
        """Tell how much is done after an iteration of a step by a method."""
        # Most progress is in the first iterations, and few steps need all of them.
        step = number + k / (k + 0.1 * self.iterations)
        tick((m + step / len(self.shares)) / len(self.methods), self.methods[m])

    def _frames(self, solver: Deformation, tick: Callable[[int, int], object]) -> Iterator[Frame]:
        """Frame of each step, continued from the one before or beside a walk."""
        documents = [self.document_at(part).with_settings(method=solver.method) for part in self.shares]
        # With obstacles each step is solved until it settles, since the loads matter.
        if solver.contact is not None and not documents[0].has_active_obstacles:
            end = self.shares[-1]
            documents[-1] = document_along(documents[-1], self.paths, end)
            shares = [part / end for part in self.shares]
            largest = max(np.diff(self.shares, prepend=0.0)) * max(total_turn(path) for path in self.paths)
            yield from contact_frames(solver, documents, shares, self.iterations, tick, largest < np.pi)
            return
        U: np.ndarray | None = self.document.grip
        for number, there in enumerate(documents):
            step = document_iteration(solver, there, U, along_paths=False)
            U = None
            yield step.settle(self.iterations, partial(tick, number))

    def _step(self, solver: Deformation, number: int, frame: Frame) -> SweepStep:
        k, part = self.leading_handle, self.shares[number]
        path, pivot = self.paths[k], self.document.pivot(k)
        way = 0.0 if pivot is None else np.linalg.norm(transform(path.pose_at(part), pivot[None])[0] - pivot)
        return SweepStep(
            solver.method,
            number,
            part,
            float(np.degrees(part * path.angle)),
            float(way),
            frame,
            solver.rest.volume,
            solver.rest.volume_capped,
            solver.rest.energy(frame.U),
            tuple(np.linalg.norm(frame.loads, axis=1).tolist()),
            document_turns(document_along(self.document, self.paths, part), frame.U),
        )


def document_turns(document: Document, U: np.ndarray) -> tuple[HeldTurn, ...]:
    """Turns of the handles from rest, asked and held by the shape ``U`` (n, 3)."""
    document = document.relative_to_rest
    return held_turns(
        document.grip, U, document.mesh.joined_F, document.labels, handle_pose_sequences(document)
    )


def contact_frames(
    solver: Deformation,
    documents: Sequence[Document],
    shares: Sequence[float],
    iterations: int,
    tick: Callable[[int, int], object],
    is_direct: bool,
) -> Iterator[Frame]:
    """Frame of each step.

    Parameters
    ----------
    solver : Deformation
        In contact.
    documents : sequence of Document
        With the handles at each step; the last one with all turns on its way.
    shares : sequence of float
        Of the way to the last one, for each.
    iterations : int
        At most so many for each step, without those on the way to it.
    tick : callable
        Called after every iteration with the numbers of the step and of the iteration, from 0.
    is_direct : bool
        Whether each step turns the handles by less than half a turn, so that it can be gone at once.
    """
    begun, U = 0, documents[0].grip if is_direct else None
    for number, document in enumerate(documents if is_direct else ()):
        step = document_iteration(solver, document, U, along_paths=False)
        frame = step.settle(iterations, partial(tick, number))
        if frame.contact is not None and frame.contact.pairs:
            break
        yield frame
        begun, U = number + 1, None
    if begun < len(documents):
        yield from _frames_beside_path(solver, documents, shares, iterations, tick, begun)


def _frames_beside_path(
    solver: Deformation,
    documents: Sequence[Document],
    shares: Sequence[float],
    iterations: int,
    tick: Callable[[int, int], object],
    begun: int,
) -> Iterator[Frame]:
    """Frames from step ``begun`` on, each beside a walk from rest to the last."""
    *others, last = documents
    U = last.grip
    walk = document_iteration(deformation_of(last, last.constraints(), solver.rest), last, U)
    for number, document in enumerate(others[begun:], begun):
        U = _shape_before(walk, shares[number], U, partial(tick, number))
        beside = document_iteration(solver, document, U, along_paths=False)
        yield beside.settle(iterations, partial(tick, number))
    yield walk.settle(iterations, partial(tick, len(others)))


def _shape_before(
    iteration: PathIteration, share: float, U: np.ndarray, tick: Callable[[int], object]
) -> np.ndarray:
    """Last shape (n, 3) of a walk up to a share of its way; ``U`` is the last so far."""
    while iteration.is_on_its_way:
        frame = iteration.frame()
        if frame.share_reached > share:
            break
        U = frame.U
        iteration.iterate()
        tick(0)  # the iterations at the step itself are counted
    return U
