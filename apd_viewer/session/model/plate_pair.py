"""Pair of plates facing each other, and readings of a shape between them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations
from typing import NamedTuple

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.mesh.arrays import diagonal
from apd_viewer.language import tr
from apd_viewer.session.model import memo
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.named_obstacle import NamedObstacle, ObstacleKind
from apd_viewer.session.model.state import State

# Stiffness proposed for walls without any, which would crumple.
PROPOSED_STIFFNESS = 0.001
# Tolerances for opposite directions, and for equal positions relative to the mesh size.
_OPPOSITE, _SAME = 1e-9, 1e-9


class PlatePair(NamedTuple):
    """Two facing plates among the obstacles of a document.

    Attributes
    ----------
    low, high : int
        Numbers of the obstacles; the normal of the low one leads to the high one.
    axis : (3,) float array
        Normal of the low plate.
    """

    low: int
    high: int
    axis: np.ndarray

    def distance(self, state: State) -> float:
        """Current distance of the plates, mesh units."""
        return self._distance(state.document.obstacles, state.obstacle_shifts)

    def first_distance(self, document: Document) -> float:
        """Initial distance of the plates, mesh units."""
        return self._distance(document.obstacles, np.zeros((len(document.obstacles), 3)))

    def extent(self, document: Document) -> float:
        """Extent of the mesh at rest along the axis, mesh units.

        A bag that is filled may be flat at rest: of it, the initial distance of the plates.
        """
        if document.settings.filled_volume is not None:
            return self.first_distance(document)
        return _extent(document.mesh.V, document.mesh.F, *self.axis.tolist())

    def _distance(self, obstacles: Sequence[NamedObstacle], shifts: np.ndarray) -> float:
        low, high = (obstacles[k].place + shifts[k] for k in (self.low, self.high))
        return float((high - low) @ self.axis)

    def press_documents(self, state: State, distance: float, steps: int) -> tuple[Document, ...]:
        """Documents with both plates moved to a ``distance`` in equal steps.

        Raises
        ------
        InputError
            If the plates would meet, are at that distance already, or began nearer.
        """
        now, size = self.distance(state), diagonal(state.document.mesh.V)
        first = self.first_distance(state.document)
        if not 0.0 < distance <= first + _SAME * size:
            sentence = tr(
                "The plates are {first:.4g} apart at first; enter a smaller distance, and greater than 0."
            )
            raise InputError(sentence.format(first=first))
        if abs(now - distance) <= _SAME * size:
            raise InputError(tr("The plates are at this distance already; enter another one."))
        fractions = np.arange(1, steps + 1) / steps
        return tuple(
            self._document_with_plates_moved(state, 0.5 * fraction * (now - distance))
            for fraction in fractions
        )

    def _document_with_plates_moved(self, state: State, by: float) -> Document:
        """Document with each plate moved by a length towards the other."""
        obstacles = list(state.document.obstacles)
        for k, sign in ((self.low, 1.0), (self.high, -1.0)):
            obstacles[k] = obstacles[k].with_shift(state.obstacle_shifts[k] + sign * by * self.axis)
        return replace(state.document, obstacles=tuple(obstacles))

    def reading(self, state: State) -> PlateReading:
        """Distance of the plates in a state, and the loads on them."""
        loads = state.frame.loads
        known = len(loads) == len(state.document.obstacles)
        low, high = (loads[[self.low, self.high]] @ self.axis).tolist() if known else (0.0, 0.0)
        distance = self.distance(state)
        return PlateReading(distance, self.first_distance(state.document) - distance, -low, high)


@memo.memoised
def _extent(V: np.ndarray, F: np.ndarray, *axis: float) -> float:
    return float(np.ptp(V[np.unique(F)] @ np.array(axis)))


class PlateReading(NamedTuple):
    """Distance of two plates and the loads on them.

    Attributes
    ----------
    distance : float
        Mesh units.
    deflection : float
        Reduction of the distance since the plates were placed.
    load_low, load_high : float
        Force on each plate, as energy per length of a material of stiffness 1.
    """

    distance: float
    deflection: float
    load_low: float
    load_high: float

    @property
    def load(self) -> float:
        """Mean of both loads."""
        return 0.5 * (self.load_low + self.load_high)


def plate_pair(document: Document) -> PlatePair | None:
    """Last pair of plates that face each other; None if there is none."""
    plates = [k for k, each in enumerate(document.obstacles) if each.kind is ObstacleKind.PLATE]
    for high, low in combinations(reversed(plates), 2):
        axes = document.obstacles[low].axis, document.obstacles[high].axis
        pair = PlatePair(low, high, axes[0])
        if float(axes[0] @ axes[1]) <= _OPPOSITE - 1.0 and pair.first_distance(document) > 0.0:
            return pair
    return None
