"""Checks of a shape at rest, too slow for every frame."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from apd_viewer.geometry.analysis.hull_readings import HullReadings, hull_readings
from apd_viewer.geometry.analysis.self_intersections import crossings
from apd_viewer.geometry.turns.held_turn import HandleTurns, HeldTurn


class ShapeCheck(NamedTuple):
    """Results of a shape check.

    Attributes
    ----------
    crossing : (k,) int array or None
        Triangles that pass through others; None where nobody could look.
    size : tuple of 3 floats
        Of the box along the axes.
    hull : HullReadings
    turns : tuple of HeldTurn
        Of the handles; empty where none has turned.
    """

    crossing: np.ndarray | None
    size: tuple[float, float, float]
    hull: HullReadings
    turns: tuple[HeldTurn, ...] = ()

    @property
    def box(self) -> float:
        """Volume of the box along the axes."""
        dx, dy, dz = self.size
        return dx * dy * dz

    @property
    def packed(self) -> float:
        """Volume of the smallest box around the shape, turned in any way."""
        return self.hull.box


def check_shape(U: np.ndarray, F: np.ndarray, handle_turns: HandleTurns | None = None) -> ShapeCheck:
    """Check the shape ``U`` (n, 3) of the triangles ``F`` (m, 3), with its turns."""
    points = U[np.unique(F)]
    dx, dy, dz = np.ptp(points, axis=0).tolist()
    turns: tuple[HeldTurn, ...] = ()
    if handle_turns is not None:
        from apd_viewer.geometry.turns.held_turns import held_turns  # Here: SciPy comes with it.

        turns = held_turns(handle_turns.V, U, F, handle_turns.labels, handle_turns.paths)
    return ShapeCheck(crossings(U, F), (dx, dy, dz), hull_readings(points), turns)
