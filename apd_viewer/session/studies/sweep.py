"""Sweeps: a motion in steps by several methods, each shape starting from the last."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.pose.constraints import BASE, transform
from apd_viewer.geometry.pose.screw_motion import ScrewPath, Turn, path_of
from apd_viewer.geometry.solver.methods import METHODS, OFFERED
from apd_viewer.language import tr
from apd_viewer.session.model import memo
from apd_viewer.session.model.named_parts import IDENTITY
from apd_viewer.session.processes.deforming import deformation_of
from apd_viewer.session.quantities.expressions import angle

if TYPE_CHECKING:
    from apd_viewer.geometry.energy.rest_mesh import RestMesh
    from apd_viewer.geometry.pose.frame import Frame
    from apd_viewer.geometry.solver.deformation import Deformation
    from apd_viewer.session.model.document import Document

MOST_STEPS = 1000
# For each step: "local" creeps on for thousands of iterations that nobody sees in a curve.
DEFAULT_ITERATIONS = 500
# Of the rest shape's diagonal: less is no way.
_NO_WAY = 1e-9


class SweepStep(NamedTuple):
    """A shape on the way, and its readings.

    Attributes
    ----------
    method : str
    number : int
        From 0, where nothing has moved yet.
    part : float
        Of the motion: 0 to 1, and beyond 1 past it.
    degrees : float
        By how much the first handle that moves has turned.
    way : float
        How far its pivot is from where it was, mesh units.
    frame : Frame
    volume_rest : float or None
    energy : float
        ARAP energy (Eq. 1, each undirected edge counted twice) with optimal rotations, whatever the method.
    """

    method: str
    number: int
    part: float
    degrees: float
    way: float
    frame: Frame
    volume_rest: float | None
    energy: float

    @property
    def volume_error(self) -> float | None:
        """Relative change of the volume; None without a volume."""
        if self.frame.volume is None or not self.volume_rest:
            return None
        return self.frame.volume / self.volume_rest - 1.0


@dataclass(frozen=True, eq=False)
class Sweep:
    """Parameters of a sweep.

    Attributes
    ----------
    document : Document
        Its paint, its settings, and its grip, from which the handles start.
    paths : tuple of ScrewPath or Turn
        The way of each handle.
    parts : tuple of float
        Of the motion, one for each step.
    methods : tuple of str
    iterations : int
        At most so many for each step.
    """

    document: Document
    paths: tuple[ScrewPath | Turn, ...]
    parts: tuple[float, ...]
    methods: tuple[str, ...]
    iterations: int = DEFAULT_ITERATIONS

    @property
    def leading(self) -> int:
        """The first moving handle."""
        return next(k for k, path in enumerate(self.paths) if _moves(path))

    @property
    def abscissa(self) -> str:
        """Kind of abscissa: "degrees" of a turn, the "way" of a shift, or the "part"."""
        path = self.paths[self.leading]
        if sum(map(_moves, self.paths)) > 1 or path.stretched:
            return "part"
        if isinstance(path, Turn):
            return "degrees"
        if path.angle == 0.0:
            return "way"
        return "part" if np.linalg.norm(path.along) > _NO_WAY * self._diagonal else "degrees"

    @property
    def _diagonal(self) -> float:
        return float(np.linalg.norm(np.ptp(self.document.mesh.V, axis=0)))

    def document_at(self, part: float) -> Document:
        """The document with its handles at a part of their motion."""
        document = self.document
        for k, path in enumerate(self.paths):
            document = document.with_pose(k, path.at(part))
        return document

    def steps(self, tick: Callable[[float, str], object] = lambda *_: None) -> Iterator[SweepStep]:
        """The shapes, one method after another.

        Parameters
        ----------
        tick : callable
            Called after every iteration with the share of all work that is done, at a guess, and with the
            method; what it raises ends the sweep.
        """
        rest: RestMesh | None = None
        each = 1.0 / (len(self.methods) * len(self.parts))
        for m, method in enumerate(self.methods):
            document = replace(self.document, method=method)
            tick(m / len(self.methods), method)
            solver = deformation_of(document, document.constraints(), rest)
            rest = solver.rest
            U: np.ndarray | None = document.grip
            for number, part in enumerate(self.parts):
                held = self.document_at(part).constraints()
                solver.aim(held.targets, U, held.soft_targets)
                U = None  # from here on each goes on from the one before
                before = m / len(self.methods) + number * each
                for k in range(self.iterations):
                    solver.iterate()
                    # The first iterations bring most, and few steps need all.
                    tick(before + each * (k + 1) / (k + 1 + 0.1 * self.iterations), method)
                    if solver.settled:
                        break
                yield self._step(solver, method, number, part)

    def _step(self, solver: Deformation, method: str, number: int, part: float) -> SweepStep:
        k, frame = self.leading, solver.frame()
        path, pivot = self.paths[k], self.document.pivot(k)
        assert pivot is not None
        away = transform(path.at(part), pivot[None])[0] - pivot
        return SweepStep(
            method,
            number,
            part,
            float(np.degrees(part * path.angle)),
            float(np.linalg.norm(away)),
            frame,
            solver.rest.volume,
            solver.rest.energy(frame.U),
        )


def sweep_of(
    document: Document,
    steps: int,
    to: float = 1.0,
    methods: Sequence[str] = OFFERED,
    twists: Sequence[float] = (),
    iterations: int = DEFAULT_ITERATIONS,
) -> Sweep:
    """Sweep of the poses of a document's handles, or of ``twists`` instead.

    Parameters
    ----------
    document : Document
    steps : int
        Beside the one at the start.
    to : float
        Part of the motion that is the last step.
    methods : sequence of str
    twists : sequence of float
        An angle for each handle, radians: it turns about the line from the centre of the base to its own.
    iterations : int
        At most so many for each step.

    Raises
    ------
    InputError
        If there is nothing to sweep; the message says why.
    """
    if not 1 <= steps <= MOST_STEPS:
        raise InputError(tr("A sweep has 1 to {most} steps; enter another number.").format(most=MOST_STEPS))
    if not 0.0 < to <= 100.0:
        raise InputError(
            tr("The end of a sweep must be a fraction of the motion greater than 0, such as 1 or 1.5.")
        )
    if iterations < 1:
        raise InputError(tr("Each step needs at least one iteration; enter a larger number."))
    for method in methods:
        if method not in METHODS:
            raise InputError(
                tr("Unknown method {method}; choose from {methods}.").format(
                    method=method, methods=", ".join(METHODS)
                )
            )
    if not methods or len(set(methods)) < len(methods):
        raise InputError(tr("Give at least one method, and each method only once."))
    if document.problem:
        raise InputError(document.problem)
    paths = _twisting(document, twists) if twists else _posed(document)
    if not any(map(_moves, paths)):
        raise InputError(
            tr("No handle has moved, so there is no motion to sweep; move a handle or give a twist.")
        )
    parts = tuple(to * k / steps for k in range(steps + 1))
    return Sweep(document, paths, parts, tuple(methods), iterations)


def twist_of(text: str) -> float:
    """Angle of a twist in radians from a text; raises InputError with a sentence."""
    return angle(text, {})


def _posed(document: Document) -> tuple[ScrewPath | Turn, ...]:
    pivots = [document.pivot(k) for k in range(len(document.handles))]
    return tuple(
        path_of(IDENTITY, np.zeros(3)) if pivot is None else path_of(handle.pose, pivot)
        for handle, pivot in zip(document.handles, pivots, strict=True)
    )


def _twisting(document: Document, twists: Sequence[float]) -> tuple[ScrewPath | Turn, ...]:
    if len(twists) != len(document.handles):
        raise InputError(
            tr("There are {handles} handles but {twists} twists; give one for each handle.").format(
                handles=len(document.handles), twists=len(twists)
            )
        )
    base = memo.centre(document.labels, document.grip, BASE)
    return tuple(Turn(base, _line(document, k, base), amount) for k, amount in enumerate(twists))


def _line(document: Document, k: int, base: np.ndarray) -> np.ndarray:
    """Vector from the centre of the base to that of handle ``k``."""
    centre = document.centre(k)
    if centre is None:
        raise InputError(tr("“{name}” is empty; paint it first.").format(name=document.handles[k].name))
    line: np.ndarray = centre - base
    if not line.any():
        raise InputError(
            tr("The centres of the base and the handle coincide, so there is no line to twist about.")
        )
    return line


def _moves(path: ScrewPath | Turn) -> bool:
    if isinstance(path, Turn):
        return path.angle != 0.0
    return path.angle != 0.0 or path.stretched or bool(path.along.any() or path.across.any())
