"""Pair of plates or fingers facing each other, and readings of a shape between."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import combinations
from typing import NamedTuple

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.mesh.arrays import diagonal, used_vertices
from apd_viewer.language import tr
from apd_viewer.session.model import memo
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.named_obstacle import NamedObstacle, ObstacleKind
from apd_viewer.session.model.state import State

# Stiffness proposed for walls without any, which would crumple.
PROPOSED_STIFFNESS = 0.001
# Tolerances for opposite directions, and for equal positions relative to the mesh size.
_OPPOSITE, _SAME = 1e-9, 1e-9


class ObstaclePair(NamedTuple):
    """Two facing plates, or spheres as fingers, among the obstacles of a document.

    Attributes
    ----------
    low, high : int
        Numbers of the obstacles.
    axis : (3,) float array
        Unit vector from the low one to the high one, normal to plates.
    """

    low: int
    high: int
    axis: np.ndarray

    def distance(self, state: State) -> float:
        """Current distance between them, mesh units."""
        return self._distance(state.document.obstacles, state.obstacle_shifts)

    def first_distance(self, document: Document) -> float:
        """Initial distance between them, mesh units."""
        return self._distance(document.obstacles, np.zeros((len(document.obstacles), 3)))

    def extent(self, document: Document) -> float:
        """Extent of the mesh at rest along the axis, mesh units.

        A bag that is filled may be flat at rest: of it, the initial distance of the plates.
        """
        if document.settings.is_filled:
            return self.first_distance(document)
        return _extent(document.mesh.V, document.mesh.F, *self.axis.tolist())

    def _distance(self, obstacles: Sequence[NamedObstacle], shifts: np.ndarray) -> float:
        low, high = (obstacles[k].place + shifts[k] for k in (self.low, self.high))
        return float((high - low) @ self.axis) - obstacles[self.low].radius - obstacles[self.high].radius

    def press_documents(self, state: State, distance: float, steps: int) -> tuple[Document, ...]:
        """Documents with both moved to a ``distance`` in equal steps.

        Raises
        ------
        InputError
            If they would meet, are at that distance already, or began nearer.
        """
        now, size = self.distance(state), diagonal(state.document.mesh.V)
        first = self.first_distance(state.document)
        if not 0.0 < distance <= first + _SAME * size:
            sentence = tr(
                "They are {first:.4g} apart at first; enter a smaller distance, and greater than 0."
            )
            raise InputError(sentence.format(first=first))
        if abs(now - distance) <= _SAME * size:
            raise InputError(tr("They are at this distance already; enter another one."))
        fractions = np.arange(1, steps + 1) / steps
        return tuple(
            self._document_with_both_moved(state, 0.5 * fraction * (now - distance)) for fraction in fractions
        )

    def _document_with_both_moved(self, state: State, by: float) -> Document:
        """Document with each obstacle moved by a length towards the other."""
        obstacles = list(state.document.obstacles)
        for k, sign in ((self.low, 1.0), (self.high, -1.0)):
            obstacles[k] = obstacles[k].with_shift(state.obstacle_shifts[k] + sign * by * self.axis)
        return replace(state.document, obstacles=tuple(obstacles))

    def reading(self, state: State) -> PairReading:
        """Distance between them in a state, and the loads on them."""
        loads = state.frame.loads
        known = len(loads) == len(state.document.obstacles)
        low, high = (loads[[self.low, self.high]] @ self.axis).tolist() if known else (0.0, 0.0)
        distance = self.distance(state)
        return PairReading(distance, self.first_distance(state.document) - distance, -low, high)


@memo.memoised
def _extent(V: np.ndarray, F: np.ndarray, *axis: float) -> float:
    return float(np.ptp(V[used_vertices(F)] @ np.array(axis)))


class PairReading(NamedTuple):
    """Distance between two obstacles and the loads on them.

    Attributes
    ----------
    distance : float
        Mesh units.
    deflection : float
        Reduction of the distance since they were placed.
    load_low, load_high : float
        Force on each, as energy per length of a material of stiffness 1.
    """

    distance: float
    deflection: float
    load_low: float
    load_high: float

    @property
    def load(self) -> float:
        """Mean of both loads."""
        return 0.5 * (self.load_low + self.load_high)


def obstacle_pair(document: Document) -> ObstaclePair | None:
    """Last pair of facing plates, or else of fingers; None if there is none."""
    kinds = ObstacleKind.PLATE, ObstacleKind.SPHERE
    found = (pair for kind in kinds for pair in _pairs(document, kind))
    return next((pair for pair in found if pair.first_distance(document) > 0.0), None)


def _pairs(document: Document, kind: ObstacleKind) -> Iterator[ObstaclePair]:
    """Facing plates, or spheres with the mesh between; the last ones first."""
    obstacles = document.obstacles
    numbers = [k for k, each in enumerate(obstacles) if each.kind is kind]
    for high, low in combinations(reversed(numbers), 2):
        first, second = obstacles[low], obstacles[high]
        if kind is ObstacleKind.PLATE:
            if float(first.axis @ second.axis) <= _OPPOSITE - 1.0:
                yield ObstaclePair(low, high, first.axis)
        elif (length := float(np.linalg.norm(second.place - first.place))) > 0.0:
            axis = (second.place - first.place) / length
            middle = float(mesh_middle(document.mesh.V, document.mesh.F) @ axis)
            if first.place @ axis < middle < second.place @ axis:
                yield ObstaclePair(low, high, axis)


@memo.memoised
def mesh_middle(V: np.ndarray, F: np.ndarray) -> np.ndarray:
    """Middle (3,) of the bounding box."""
    used = V[used_vertices(F)]
    return 0.5 * (used.min(axis=0) + used.max(axis=0))
