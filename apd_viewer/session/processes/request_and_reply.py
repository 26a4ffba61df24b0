"""Requests to the solver and its replies, each self-contained."""

from dataclasses import dataclass, field
from enum import Enum
from logging import LogRecord
from typing import NamedTuple

import numpy as np

from apd_viewer.geometry.mesh.decimation import Decimation
from apd_viewer.geometry.pose.frame import NO_SHIFTS, Frame
from apd_viewer.geometry.solver.settings import SETTINGS
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.handles_and_regions import Handle, factored_fields


@dataclass(frozen=True, eq=False)
class Request:
    """Document to be solved, and the shape to start from.

    Attributes
    ----------
    generation : int
        Counts jumps of the state. A new one starts from ``U``; the same one goes on from where
        the solver is.
    U : (n, 3) float array
        The shape to start from.
    iterate : bool
        Whether to iterate, instead of only factoring for a first drag without a wait.
    is_timed : bool
        Whether the seconds of its cost are to be comparable: kernels are compiled beforehand.
    shifts : (o, 3) float array
        Displacements of the obstacles at ``U``; empty if unknown.
    number : int
        Given when it is sent; a later request has a higher one.
    shape_buffer : str or None
        Name of the shared memory for the shapes; without one they travel in the replies.
    decimations : tuple of Decimation
        Of the mesh, where they are known and the process has not found them itself.
    frame_pause : float
        Least seconds between two frames, for pictures that take the processor from the solver. The first
        frame and the last one do not wait.
    """

    document: Document
    generation: int
    U: np.ndarray
    iterate: bool
    is_timed: bool = False
    shifts: np.ndarray = field(default_factory=lambda: NO_SHIFTS)
    number: int = 0
    shape_buffer: str | None = None
    decimations: tuple[Decimation, ...] = ()
    frame_pause: float = 0.0


@dataclass(frozen=True)
class Cost:
    """Energy and time of an answer; see also ``is_timed`` of the request.

    Attributes
    ----------
    energy : float
        Eq. 1 of the shape, each undirected edge counted twice, squared lengths.
    seconds : float
        Time from the mesh at rest to the last iteration: factoring and iterating.
    """

    energy: float
    seconds: float


@dataclass(frozen=True, eq=False)
class Reply:
    """Result of a request: a frame, or a message about its failure.

    Attributes
    ----------
    request : Request
        Request answered; sent as its number.
    finished : bool
        True if no further reply follows.
    seconds : float
        Time that an iteration takes.
    warning : str or None
        Sentence to the user about the held vertices.
    news : str or None
        Sentence on an event of the solver.
    cost : Cost or None
        Cost, in the last reply.
    shape_number : int or None
        Number of the shape in shared memory, where it lies there instead of in the frame.
    decimations : tuple of Decimation or None
        Of the mesh, in a reply of their own once they are found.
    """

    request: Request
    frame: Frame | None = None
    finished: bool = False
    seconds: float = 0.0
    failure: str | None = None
    warning: str | None = None
    news: str | None = None
    cost: Cost | None = None
    shape_number: int | None = None
    decimations: tuple[Decimation, ...] | None = None


class RequestStage(Enum):
    """Progress of a request."""

    RECEIVED = "received"
    TURNED_TO = "turned to"  # all earlier requests are answered or dropped
    UNDER_WAY = "under way"  # sent every second while the request is being processed
    ANSWERED = "answered"  # answered or dropped; no more messages follow


class RequestProgress(NamedTuple):
    """Stage reached by a request; None stands for the current request."""

    stage: RequestStage
    request: Request | None = None


@dataclass(frozen=True)
class CompilationProgress:
    """Progress of kernel compilation on this computer; ``fraction`` is 1 at the end."""

    fraction: float


SolverMessage = Reply | RequestProgress | CompilationProgress | LogRecord

# Settings changeable in a running solver; a change of any other needs a new solver.
TOLD_SETTINGS = ("area", "volume", "hold_area", "calm", "tolerance", "convergence")
_OF_DOCUMENT, _OF_HANDLE = factored_fields(Document), factored_fields(Handle)
_OF_SETTINGS = tuple(name for name in SETTINGS if name not in TOLD_SETTINGS)


def factor_key(document: Document) -> tuple[object, ...]:
    """Key of a document's solver and its factorization; a changed key needs new ones."""
    return (
        *(getattr(document, name) for name in _OF_DOCUMENT),
        *(getattr(document.settings, name) for name in _OF_SETTINGS),
        document.immobile_components if document.settings.contact else None,
        *(getattr(handle, name) for handle in document.handles for name in _OF_HANDLE),
    )


def are_same_keys(a: tuple[object, ...], b: tuple[object, ...]) -> bool:
    """True if two keys are equal, with arrays compared by identity."""
    return len(a) == len(b) and all(
        x is y or (not isinstance(x, np.ndarray) and x == y) for x, y in zip(a, b, strict=True)
    )


def goal_key(document: Document) -> tuple[object, ...]:
    """Key of the targets of areas and volume."""
    names = tuple(region.name for region in document.regions)
    settings = document.settings
    return document.target_percentages, settings.hold_area, document.member, names, settings.calm


def pose_key(document: Document) -> tuple[object, ...]:
    """Key of the places of handles and obstacles."""
    moved = *(handle.pose for handle in document.handles), *(each.shift for each in document.obstacles)
    return document.initial_positions, *moved


def solution_key(document: Document) -> tuple[object, ...]:
    """Key of all that a converged shape depends on."""
    told = document.settings.tolerance, document.settings.convergence
    around = obstacle_key(document)
    return *factor_key(document), *goal_key(document), *pose_key(document), *told, *around


def obstacle_key(document: Document) -> tuple[object, ...]:
    """Key of the initial obstacles; a changed key needs new contact data."""
    if not document.has_active_obstacles:
        return ()
    each = ((one.kind, one.place, one.axis, one.radius, one.length) for one in document.obstacles)
    return tuple(value for values in each for value in values)
