"""Cases: a painted document moved along its motion in steps.

Which folds touch depends on the path to a shape, and so on whether, and how often, the shape comes to rest on
the way. From the first self-contact on, each step is thus solved from a shape of one continuous path, and
the last step equals a single deformation to the end of the motion. Before, the path has no influence: each
step continues from the previous one, which halves the work.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple, TypeAlias

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.mesh.arrays import diagonal
from apd_viewer.geometry.pose.constraints import next_paint_sentence, transform
from apd_viewer.geometry.pose.frame import Frame
from apd_viewer.geometry.pose.held_turn import HeldTurn, most_lost_turn, pass_through_warnings
from apd_viewer.geometry.pose.screw_motion import RotationPath
from apd_viewer.geometry.pose.surface_turns import held_turns
from apd_viewer.geometry.pose.waypoint_path import HandlePath, WaypointPath
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.methods import COMPARED_METHODS, method_named
from apd_viewer.language import tr
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.document_parts import obstacle_shifts
from apd_viewer.session.model.handle_paths import document_at, handle_paths, handle_pose_sequences
from apd_viewer.session.model.named_obstacle import NamedObstacle
from apd_viewer.session.model.state import load_excess_of
from apd_viewer.session.posing import motion_path
from apd_viewer.session.posing.motion_path import MotionPath, MotionStep
from apd_viewer.session.processes.document_deformation import deformation_of, document_iteration

MOST_STEPS = 1000
# Largest number of iterations per step; "local" creeps for thousands without visible effect on the curves.
DEFAULT_ITERATIONS = 500
# Largest number of iterations per step with obstacles; their loads are meaningless before convergence.
SETTLING_ITERATIONS = 10_000
# Fraction of the rest shape's diagonal: a shorter displacement counts as none.
_LEAST_DISPLACEMENT = 1e-9

CasePath: TypeAlias = HandlePath | MotionPath


class CaseStep(NamedTuple):
    """Shape of a case at one step, with its readings.

    Attributes
    ----------
    number : int
        Index of the step; 0 is the initial shape.
    fraction : float
        Of the motion: 0 to 1, and beyond 1 past it.
    degrees : float
        Turn of the first moving handle, degrees.
    displacement : float
        Distance of its pivot from the initial position, mesh units.
    volume_rest, volume_capped_rest : float or None
        With flat caps over its openings; None if there is none.
    energy : float
        ARAP energy (Eq. 1, each undirected edge counted twice) with optimal rotations, whatever the method.
    loads : tuple of float
        Length of the force on each obstacle, energy per length: that of a material of stiffness 1.
    turns : tuple of HeldTurn, of the handles so far
    """

    method: str
    number: int
    fraction: float
    degrees: float
    displacement: float
    frame: Frame
    volume_rest: float | None
    volume_capped_rest: float | None
    energy: float
    loads: tuple[float, ...] = ()
    turns: tuple[HeldTurn, ...] = ()

    @property
    def volume_error(self) -> float | None:
        """Relative change of the volume, openings capped; None without a volume."""
        now, rest = self.frame.volume, self.volume_rest
        if now is None:
            now, rest = self.frame.volume_capped, self.volume_capped_rest
        return None if now is None or not rest else now / rest - 1.0

    @property
    def readings(self) -> dict[str, float | None]:
        """Readings by column name; turns of the handle with the largest lost rotation."""
        frame = self.frame
        return {
            "part": self.fraction,
            "degrees": self.degrees,
            "way": self.displacement,
            "area": frame.area,
            "area_error": frame.area_error,
            "volume": frame.volume,
            "volume_capped": frame.volume_capped,
            "volume_error": self.volume_error,
            "energy": self.energy,
            "local_change": frame.local_change,
            "largest_edge_strain": frame.largest_edge_strain,
            "mean_edge_strain": frame.mean_edge_strain,
            "handle_drift": frame.handle_drift,
            "iterations": frame.iteration,
            "settled": frame.settled,
            "stable": frame.stable,
            "saddle_escapes": frame.saddle_escapes,
            "share_reached": frame.share_reached,
            **dict(zip(("turned", "turned_held"), most_lost_turn(self.turns).degrees, strict=True)),
        }


@dataclass(frozen=True, eq=False)
class Case:
    """Painted document with a motion divided into steps.

    Attributes
    ----------
    document : Document
        Painted document with its settings and the initial positions of the handles.
    paths : tuple of CasePath
        Path of each handle.
    fractions : tuple of float
        Fraction of the motion at each step.
    iterations : int
        Largest number per step, besides those on the way to it in contact.
    """

    document: Document
    paths: tuple[CasePath, ...]
    fractions: tuple[float, ...]
    iterations: int = DEFAULT_ITERATIONS

    @property
    def method(self) -> str:
        """Name of the deformation method."""
        return self.document.settings.method

    @property
    def leading_handle(self) -> int:
        """Index of the first moving handle; 0 if only obstacles move."""
        return next((k for k, path in enumerate(self.paths) if path.has_motion), 0)

    @property
    def obstacles(self) -> tuple[NamedObstacle, ...]:
        """Obstacles with measured loads; none without contact."""
        return self.document.obstacles if self.document.settings.contact else ()

    @property
    def load_excess_percent(self) -> float | None:
        """Expected excess of the loads, percent; None without stiffness or loads."""
        excess = load_excess_of(self.document) if self.document.has_active_obstacles else None
        return None if excess is None else 100.0 * excess

    @property
    def abscissa(self) -> str:
        """Abscissa of curves: "degrees", "way" (displacement) or "part" (fraction)."""
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
        shortest = _LEAST_DISPLACEMENT * diagonal(self.document.mesh.V)
        return "part" if np.linalg.norm(path.along) > shortest else "degrees"

    @property
    def has_small_turns(self) -> bool:
        """True if each step turns the handles by less than half a turn."""
        step = max(np.diff(self.fractions, prepend=0.0))
        return bool(step * max(motion_path.total_turn(path) for path in self.paths) < np.pi)

    def step_warnings(self, step: CaseStep) -> tuple[str, ...]:
        """Warnings about unreached targets and self-penetration at a step."""
        may_touch, frame = method_named(step.method).may_use_contact, step.frame
        touch = self.document.settings.contact and may_touch, may_touch
        names = [each.name for each in self.document.handles]
        passing = pass_through_warnings(step.turns, frame, step.volume_rest, *touch, names)
        if frame.unreached:
            return frame.unreached, *passing
        if frame.share_reached < 1.0:
            said = tr("Contact stopped the handle after {share:.3g} % of its path.")
            return said.format(share=100.0 * frame.share_reached), *passing
        return passing

    def document_at(self, fraction: float) -> Document:
        """Document with its handles at a fraction of their motion."""
        return document_at(self.document, self.paths, fraction)

    def document_along_paths(self, fraction: float) -> Document:
        """Document at a fraction of the motion, with rotations of any size."""
        return motion_path.document_along_paths(self.document_at(fraction), self.paths, fraction)

    @property
    def end_document(self) -> Document:
        """Document at the last step, including rotations of more than half a turn."""
        return self.document_along_paths(self.fractions[-1])


def case_of(
    document: Document,
    steps: int,
    last_fraction: float = 1.0,
    iterations: int | None = None,
    motion: Sequence[MotionStep] = (),
) -> Case:
    """Case for the paths of a document's handles and obstacles, or a given motion.

    Parameters
    ----------
    steps : int
        Beside the one at the start.
    last_fraction : float
        Part of the motion that is the last step.
    iterations : int
        At most so many for each step; without, as many as are usual, and more where there are obstacles.
    motion : sequence of MotionStep
        Instead: typed motions of the handles from rest.

    Raises
    ------
    InputError
        If nothing moves; the message says why.
    """
    if not 1 <= steps <= MOST_STEPS:
        raise InputError(tr("A sweep has 1 to {most} steps; enter another number.").format(most=MOST_STEPS))
    if not 0.0 < last_fraction <= 100.0:
        raise InputError(
            tr("The end of a sweep must be a fraction of the motion greater than 0, such as 1 or 1.5.")
        )
    if iterations is None:
        iterations = SETTLING_ITERATIONS if document.has_active_obstacles else DEFAULT_ITERATIONS
    if iterations < 1:
        raise InputError(tr("Each step needs at least one iteration; enter a larger number."))
    if document.paint_problem:
        raise InputError(document.paint_problem)
    document = document.relative_to_rest
    paths: tuple[CasePath, ...] = (
        motion_path.motion_paths(document, motion) if motion else handle_paths(document)
    )
    if not any(path.has_motion for path in paths) and not obstacle_shifts(document).any():
        raise InputError(
            tr("No handle has moved, so there is no motion to sweep; move a handle or give a twist.")
        )
    return Case(document, paths, tuple(last_fraction * k / steps for k in range(steps + 1)), iterations)


def cases_by_method(case: Case, methods: Sequence[str] = COMPARED_METHODS) -> list[Case]:
    """The case for each of several methods; raises InputError for an unsuitable one."""
    document = case.document
    for method in methods:
        if (
            not method_named(method).may_use_contact
            and document.has_active_obstacles
            and next_paint_sentence(document.labels)
        ):
            raise InputError(
                tr("Obstacles move nothing without contact, which {method!r} lacks; omit it.").format(
                    method=method
                )
            )
    if not methods or len(set(methods)) < len(methods):
        raise InputError(tr("Give at least one method, and each method only once."))
    return [replace(case, document=document.with_settings(method=method)) for method in methods]


def case_steps(case: Case, tick: Callable[[float], object] = lambda _: None) -> Iterator[CaseStep]:
    """Yield the shapes of a case, step by step.

    Parameters
    ----------
    tick : callable
        Called after every iteration with the estimated fraction of finished work; its exceptions end the
        case.
    """

    def tell(number: int, k: int) -> None:
        # Most progress comes in the first iterations, and few steps use the full limit.
        tick((number + k / (k + 0.1 * case.iterations)) / len(case.fractions))

    tick(0.0)
    solver = deformation_of(case.document, case.document.constraints())
    for number, frame in enumerate(_frames(case, solver, tell)):
        yield _step(case, solver, number, frame)


def _step(case: Case, solver: Deformation, number: int, frame: Frame) -> CaseStep:
    k, fraction = case.leading_handle, case.fractions[number]
    path, pivot = case.paths[k], case.document.pivot(k)
    way = 0.0 if pivot is None else np.linalg.norm(transform(path.pose_at(fraction), pivot[None])[0] - pivot)
    return CaseStep(
        solver.method,
        number,
        fraction,
        float(np.degrees(fraction * path.angle)),
        float(way),
        frame,
        solver.rest.volume,
        solver.rest.volume_capped,
        solver.rest.energy(frame.U),
        tuple(np.linalg.norm(frame.loads, axis=1).tolist()),
        document_turns(motion_path.document_along_paths(case.document, case.paths, fraction), frame.U),
    )


def document_turns(document: Document, U: np.ndarray) -> tuple[HeldTurn, ...]:
    """Requested and actual turns of the handles from rest, at the shape ``U`` (n, 3)."""
    document = document.relative_to_rest
    return held_turns(
        document.initial_positions,
        U,
        document.mesh.joined_F,
        document.labels,
        handle_pose_sequences(document),
    )


def _frames(case: Case, solver: Deformation, tick: Callable[[int, int], object]) -> Iterator[Frame]:
    """Frame of each step, started from the previous one or from the contact path."""
    documents = [case.document_at(fraction) for fraction in case.fractions]
    # With obstacles, each step starts from the previous one and is solved until its loads have converged.
    may_touch = solver.contact is not None and not case.document.has_active_obstacles
    if may_touch:
        documents[-1] = case.end_document
    begun = 0
    for number, document in enumerate(documents if case.has_small_turns or not may_touch else ()):
        start = None if number else document.initial_positions
        step = document_iteration(solver, document, start, along_paths=False)
        frame = step.settle(case.iterations, partial(tick, number))
        if may_touch and frame.contact is not None and frame.contact.pairs:
            break
        yield frame
        begun = number + 1
    if begun < len(documents):
        yield from _frames_from_path(case, solver, documents, tick, begun)


def _frames_from_path(
    case: Case,
    solver: Deformation,
    documents: Sequence[Document],
    tick: Callable[[int, int], object],
    begun: int,
) -> Iterator[Frame]:
    """Frames from step ``begun`` on, each started from a shape of the contact path."""
    *others, last = documents
    U = last.initial_positions
    walk = document_iteration(deformation_of(last, last.constraints(), solver.rest), last, U)
    for number, document in enumerate(others[begun:], begun):
        while walk.is_on_its_way:
            frame = walk.frame()
            if frame.share_reached > case.fractions[number] / case.fractions[-1]:
                break
            U = frame.U
            walk.iterate()
            tick(number, 0)  # only the iterations of a step, not those on the path to it, count as progress
        beside = document_iteration(solver, document, U, along_paths=False)
        yield beside.settle(case.iterations, partial(tick, number))
    yield walk.settle(case.iterations, partial(tick, len(others)))
