"""Upright vessel: its volume up to any level, and up to its brim."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from apd_viewer.errors import InputError
from apd_viewer.geometry.analysis.double_wall import inner_surface
from apd_viewer.geometry.measuring.sections import projected_areas, volume_below_level
from apd_viewer.geometry.mesh.arrays import as_float, checked_direction, checked_floats, checked_integers
from apd_viewer.geometry.mesh.edges_and_components import (
    boundary_vertices,
    edge_defect_counts,
    missing_volume_reason,
    opposite_half_edges,
    vertex_components,
)
from apd_viewer.geometry.mesh.hole_caps import Caps
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.operators import face_areas, volume
from apd_viewer.geometry.mesh.weld import Weld
from apd_viewer.language import tr


class Filling(NamedTuple):
    """Level of a volume in an upright vessel.

    Attributes
    ----------
    level : float
        Height of the liquid above the lowest point, mesh units.
    freeboard : float
        Height of the brim above the liquid, mesh units.
    spilled : float
        Part of the volume that the vessel does not hold, cubic mesh units.
    """

    level: float
    freeboard: float
    spilled: float


class Vessel:
    """Upright shape with an unlimited supply of liquid.

    The liquid rises to the same level everywhere inside, up to the lowest point of the openings. A closed
    surface is filled to its top. In a double-walled vessel the inner surface holds the liquid.

    Parameters
    ----------
    U : (n, 3) float array
        Positions, mesh units.
    F : (m, 3) int array
        Triangles.
    up : (3,) float array
        Direction against gravity, of any length.
    closed : sequence of int
        A vertex at the border of each opening that counts as closed, such as one of :meth:`openings`.

    Attributes
    ----------
    bottom : float
        Height of the lowest point along ``up``, from the origin, mesh units.
    brim : float
        Height of the lowest point of the openings, or of the top without any.
    brimful : float
        Volume up to the brim, cubic mesh units.
    V, F : (n, 3) float array, (k, 3) int array
        Vertices without seams, and the triangles that the liquid can wet, with caps over what is closed.

    Raises
    ------
    InputError
        If the input cannot be used, or the shape holds nothing upright; the message says why.

    Examples
    --------
    >>> import apd_viewer
    >>> bottle = apd_viewer.open_mesh("bottle.obj")  # in centimetres
    >>> vessel = apd_viewer.Vessel(bottle.V, bottle.F, up=(0, 1, 0))
    >>> half_full = vessel.level(250.0)
    >>> f"{vessel.brimful:.1f}", f"{half_full - vessel.bottom:.2f}", f"{vessel.volume(half_full):.1f}"
    ('500.0', '8.82', '250.0')
    """

    def __init__(self, U: np.ndarray, F: np.ndarray, up: np.ndarray, closed: Sequence[int] = ()) -> None:
        V, welded, weld = _welded(U, F)
        vertices = checked_integers(closed, tr("Closed openings")).ravel()
        caps = vessel_openings(V, welded) if len(vertices) else None
        for each in vertices.tolist():
            if caps is None or not 0 <= each < len(weld.inverse) or not caps.at(weld.inverse[each]).any():
                raise InputError(tr("The vertex {id} is at no opening; choose another.").format(id=each))
        self._stand(V, welded, checked_direction(up), weld.inverse[vertices])

    @classmethod
    def from_welded_surface(
        cls, U: np.ndarray, F: np.ndarray, up: np.ndarray, closed: Sequence[int] = ()
    ) -> Vessel:
        """Vessel of validated arrays without seams, and a unit vector ``up``."""
        vessel = cls.__new__(cls)
        vessel._stand(U, F, up, np.array(closed, dtype=np.int64))
        return vessel

    @staticmethod
    def openings(U: np.ndarray, F: np.ndarray, up: np.ndarray) -> np.ndarray:
        """Lowest vertex of each opening, the lowest opening first, (k,) int array."""
        V, welded, weld = _welded(U, F)
        caps, height = vessel_openings(V, welded), V @ checked_direction(up)
        borders = [] if caps is None else np.split(caps.ends[:, 0], caps.start[1:])
        lowest = [border[np.argmin(height[border])] for border in borders]
        return weld.first[np.array(sorted(lowest, key=lambda i: height[i]), dtype=np.int64)]

    def _stand(self, V: np.ndarray, F: np.ndarray, up: np.ndarray, closed: np.ndarray) -> None:
        F, is_open = _wet_surface(V, F)
        if len(closed) and (caps := _caps(V, F)) is not None:
            is_closed = caps.at(closed)
            V, F = caps.closed_surface(V, F, is_closed)
            is_open = not is_closed.all()
        self.V, self.F, height = V, F, V @ up
        self._heights, self._projected = np.sort(height[self.F]), projected_areas(V, self.F, up)
        self.bottom = float(self._heights.min())
        self.brim = float(height[boundary_vertices(self.F, len(V))].min() if is_open else self._heights.max())
        self.brimful = self.volume(self.brim)
        if not self.brimful > 0.0:
            raise InputError(
                tr("An opening is at the lowest point, so it holds nothing; close it or turn the shape.")
            )

    def volume(self, level: float) -> float:
        """Volume below a level, cubic mesh units.

        Parameters
        ----------
        level : float
            Height along ``up``, from the origin, mesh units; above the brim nothing is added.

        Raises
        ------
        InputError
            If it is no number.
        """
        level = min(as_float(level), self.brim)
        if np.isnan(level):
            raise InputError(tr("A level must be a number."))
        return abs(volume_below_level(self._projected, self._heights, level))

    def level(self, volume: float) -> float:
        """Height along ``up`` to which a volume rises.

        Parameters
        ----------
        volume : float
            Cubic mesh units.

        Raises
        ------
        InputError
            Unless it is from 0 to the brimful volume.
        """
        if not 0.0 <= as_float(volume) <= self.brimful:
            raise InputError(
                tr("It holds {most:.5g} cubic mesh units; enter a volume from 0 to that.").format(
                    most=self.brimful
                )
            )
        size = self.brim - self.bottom
        return float(brentq(lambda x: self.volume(x) - volume, self.bottom, self.brim, xtol=1e-12 * size))

    def filling(self, volume: float) -> Filling:
        """Level of a volume, as far as the vessel holds it.

        Parameters
        ----------
        volume : float
            Cubic mesh units.

        Raises
        ------
        InputError
            Unless it is a finite number of at least 0.
        """
        volume = as_float(volume)
        held = min(volume, self.brimful) if np.isfinite(volume) else volume
        level = self.level(held)
        return Filling(level - self.bottom, self.brim - level, volume - held)


def vessel_openings(V: np.ndarray, F: np.ndarray) -> Caps | None:
    """Openings of the surface that liquid can wet, without seams; None without any."""
    try:
        return _caps(V, _wet_surface(V, F)[0])
    except InputError:
        return None


def _caps(V: np.ndarray, F: np.ndarray) -> Caps | None:
    return Caps.from_triangles(F, opposite_half_edges(F, len(V)))


def _welded(U: np.ndarray, F: np.ndarray) -> tuple[np.ndarray, np.ndarray, Weld]:
    """Positions and triangles without seams, of arguments; raises InputError."""
    mesh = Mesh(checked_floats(U, tr("Vertices")), checked_integers(F, tr("Faces")))
    return mesh.V[mesh.weld.first], mesh.weld.inverse[mesh.F], mesh.weld


def _wet_surface(V: np.ndarray, F: np.ndarray) -> tuple[np.ndarray, bool]:
    """Triangles (k, 3) that the liquid can wet, and whether they are open.

    Raises
    ------
    InputError
        If it leaks.
    """
    opposite = opposite_half_edges(F, len(V))
    border, crowded, one_way = edge_defect_counts(F, opposite)
    if crowded or one_way:
        why = missing_volume_reason(F, opposite)
        raise InputError(tr("It cannot be filled: {why}; repair it first.").format(why=why))
    if border:
        return F, True
    piece = vertex_components(F, len(V))[F[:, 0]]
    inner = inner_surface(V, F, piece, face_areas(V, F), volume(V, F))
    return (F, False) if inner is None else (inner, True)
