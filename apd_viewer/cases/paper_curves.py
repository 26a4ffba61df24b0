"""Curves beside the paper's tables: ARAP's loss by angle, Eq. 8's handle drift."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from apd_viewer.cases.case import case_of, run
from apd_viewer.geometry.pose.constraints import BASE, HANDLE
from apd_viewer.geometry.pose.transforms import translation
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.session.model.document import Document
from apd_viewer.session.posing.motion import TWIST, Motion
from apd_viewer.session.posing.motion_path import MotionStep

# Iteration counts from rest at which ARAP is measured.
LOSS_ITERATIONS = (1, 2, 3, 5, 20)
_WIDEST = 180.0  # degrees
_TWIST = MotionStep(0, Motion(TWIST), (np.radians(_WIDEST),))
_PUSH, _PULL = 0.2, 0.4  # of the height
_STEPS_OF_A_PULL = 4

ProgressCallback = Callable[[float], object]


class LossCurvePoint(NamedTuple):
    """The area after a twist.

    Attributes
    ----------
    degrees : float
    iterations : int
        Plain ones from rest; 0 is a shape that was left to settle, twisted from the one before.
    area_error : float
    """

    degrees: float
    iterations: int
    area_error: float


class HandleCurvePoint(NamedTuple):
    """Requested and actual position of a handle under the paper's method.

    Attributes
    ----------
    motion : str
        "twist" or "pull".
    asked : float
        Degrees of a twist; of a pull the way along the axis by the height of the mesh.
    got : float
        Of a pull likewise; of a twist the drift by the height.
    """

    motion: str
    asked: float
    got: float


def loss_curve(
    document: Document, steps: int = 18, tick: ProgressCallback = lambda _: None
) -> list[LossCurvePoint]:
    """ARAP's area change for twists of 0 to 180 degrees, in ``steps`` steps."""
    found = []
    document = document.with_settings(method="arap", contact=False)  # of which the paper knows nothing
    held = document.constraints()
    mesh = document.mesh
    solver = Deformation(mesh.V, mesh.F, held.fixed, method="arap", handle=held.handles, plain=True)
    case = case_of(document, steps, motion=[_TWIST])
    for number, part in enumerate(case.shares):
        tick(0.1 * number / steps)
        solver.aim(case.document_at(part).constraints().targets, mesh.V)
        for iteration in range(1, max(LOSS_ITERATIONS) + 1):
            solver.iterate()
            if iteration in LOSS_ITERATIONS:
                found.append(LossCurvePoint(_WIDEST * part, iteration, solver.frame().area_error))
    for step in run(case, lambda done: tick(0.1 + 0.9 * done)):
        found.append(LossCurvePoint(step.degrees, 0, step.frame.area_error))
    return found


def handle_curve(
    document: Document, steps: int = 12, tick: ProgressCallback = lambda _: None
) -> list[HandleCurvePoint]:
    """Handle drift of the paper's method in twists up to 180 degrees, pulls, pushes."""
    found = []
    height = float(np.linalg.norm(_line(document)))
    document = document.with_settings(method="paper")
    for step in run(case_of(document, steps, motion=[_TWIST]), lambda done: tick(0.6 * done)):
        found.append(HandleCurvePoint("twist", step.degrees, step.frame.handle_drift / height))
    ways = [
        *_pulls(document, -_PUSH, lambda done: tick(0.6 + 0.2 * done)),
        *_pulls(document, _PULL, lambda done: tick(0.8 + 0.2 * done)),
    ]
    return found + sorted(set(ways), key=lambda held: held.asked)


def _pulls(document: Document, share: float, tick: ProgressCallback) -> Iterator[HandleCurvePoint]:
    line = _line(document)
    case = case_of(document.with_pose(0, translation(share * line)), _STEPS_OF_A_PULL)
    handle = document.labels == HANDLE
    for step in run(case, tick):
        away = (step.frame.U[handle] - document.grip[handle]).mean(axis=0)
        got = float(away @ line / (line @ line))
        yield HandleCurvePoint("pull", share * step.share + 0.0, round(got, 12) + 0.0)


def _line(document: Document) -> np.ndarray:
    """Vector from base to handle centre, as long as the mesh in this direction."""
    base, handle = (document.grip[document.labels == label].mean(axis=0) for label in (BASE, HANDLE))
    axis = (handle - base) / np.linalg.norm(handle - base)
    whole: np.ndarray = axis * np.ptp(document.mesh.V @ axis)
    return whole
