"""The way of two plates that close on a mesh, from the first touch on."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.contact.mesh_contact import contact_thickness
from apd_viewer.geometry.mesh.arrays import as_float, checked_direction, diagonal
from apd_viewer.language import tr


class PlateTravel(NamedTuple):
    """Way of two parallel plates.

    Attributes
    ----------
    axis : (3,) float array
        Direction in which they press, of length 1.
    low, high : float
        Places of the plates along the axis at the first touch, mesh units.
    last_distance : float
        Their distance in the end, mesh units.
    """

    axis: np.ndarray
    low: float
    high: float
    last_distance: float

    @property
    def first_distance(self) -> float:
        """Distance at the first touch."""
        return self.high - self.low

    @property
    def length(self) -> float:
        """Distance by which they close."""
        return self.first_distance - self.last_distance


def plate_travel(points: np.ndarray, axis: np.ndarray, to: float, thickness: float | None) -> PlateTravel:
    """Way of plates that touch ``points`` at first, and are ``to`` apart in the end.

    Parameters
    ----------
    points : (k, 3) float array
        Vertices of a mesh, without loose ones.
    axis : (3,) float array
    to : float
        Mesh units; less than the extent of the points.
    thickness : float or None
        Distance that plates and walls keep, mesh units; None for a thousandth of the diagonal.

    Raises
    ------
    InputError
        If the input cannot be used; the message says why.
    """
    axis, apart = checked_direction(axis), contact_thickness(diagonal(points), thickness)
    height = points @ axis
    way = PlateTravel(axis, float(height.min()) - apart, float(height.max()) + apart, to)
    if not 0.0 < as_float(to) < way.first_distance:
        raise InputError(
            tr(
                "The plates are {first:.4g} apart at first; enter a smaller distance, and greater than 0."
            ).format(first=way.first_distance)
        )
    return way
