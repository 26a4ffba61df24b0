"""Sweeps: a motion in steps by several methods."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import TypeAlias

import numpy as np

from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.mesh.arrays import diagonal
from apd_viewer.geometry.pose.constraints import transform
from apd_viewer.geometry.pose.frame import Frame
from apd_viewer.geometry.pose.screw_motion import RotationPath
from apd_viewer.geometry.pose.waypoint_path import HandlePath, WaypointPath
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.methods import method_named
from apd_viewer.geometry.turns.held_turn import pass_through_warnings
from apd_viewer.language import tr
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.handle_paths import document_at
from apd_viewer.session.model.named_obstacle import NamedObstacle
from apd_viewer.session.model.state import load_excess_of
from apd_viewer.session.posing.motion_path import MotionPath, document_along, total_turn
from apd_viewer.session.processes.document_deformation import deformation_of, document_iteration
from apd_viewer.session.studies.contact_frames import contact_frames
from apd_viewer.session.studies.document_turns import document_turns
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
        # Obstacles press against shapes at rest, as it is their loads that matter.
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
