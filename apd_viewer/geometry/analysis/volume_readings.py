"""Named volumes of a shape."""

from __future__ import annotations

from collections.abc import Sequence
from numbers import Real
from typing import NamedTuple

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.analysis.double_wall import DoubleWall
from apd_viewer.geometry.analysis.hull_readings import HullReadings, hull_readings
from apd_viewer.geometry.analysis.inspection import inspect
from apd_viewer.geometry.measuring.vessel import Filling, Vessel
from apd_viewer.geometry.mesh.arrays import checked, checked_floats, checked_integers, used_vertices
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.language import tr


class VolumeReadings(NamedTuple):
    """Volumes of a shape, cubic mesh units, with its area.

    Attributes
    ----------
    area : float
    enclosed : float or None
        Inside the surface, with flat caps over its ``openings``; None if it encloses none.
    openings : int
    hull : HullReadings
        Convex hull, smallest box and least width; bulk volume of one among many.
    material : float or None
        Rest area times thickness: nothing can be crushed to less. None if the thickness is not known. Of a
        double-walled vessel the volume between its walls.
    capacity : float or None
        Capacity of a double-walled vessel; None for other shapes.
    brimful : float or None
        Volume up to the lowest point of the openings; None if the direction upwards is not known.
    filling : Filling or None
        Level of a given volume; None without one.

    Examples
    --------
    >>> import apd_viewer
    >>> bottle = apd_viewer.open_mesh("bottle.obj")  # in centimetres
    >>> found = apd_viewer.volume_readings(bottle.V, bottle.F, thickness=0.03)
    >>> f"{found.enclosed:.1f}", f"{found.material:.2f}", found.openings
    ('500.0', '12.21', 0)
    """

    area: float
    enclosed: float | None
    openings: int
    hull: HullReadings
    material: float | None
    capacity: float | None = None
    brimful: float | None = None
    filling: Filling | None = None

    @classmethod
    def from_hull(
        cls,
        area: float,
        enclosed: float | None,
        openings: int,
        hull: HullReadings,
        thickness: float | None,
        wall: DoubleWall | None = None,
    ) -> VolumeReadings:
        """Readings of a shape, with material volume from a double wall or ``thickness``."""
        if wall is not None:
            return cls(area, enclosed, openings, hull, wall.material, wall.capacity)
        return cls(area, enclosed, openings, hull, None if thickness is None else area * thickness)

    def of_rest(self, rest: VolumeReadings) -> VolumeReadings:
        """Copy with the material volume of the rest shape, as no material is lost."""
        return self._replace(material=rest.material)


@checked
def volume_readings(
    U: np.ndarray, F: np.ndarray, *, thickness: float | None = None, up: np.ndarray | None = None
) -> VolumeReadings:
    """Measure the volumes of a shape.

    Parameters
    ----------
    U : (n, 3) float array
    F : (m, 3) int array
    thickness : float, optional
        Of the wall, mesh units.
    up : (3,) float array, optional
        Direction against gravity, for the brimful volume.

    Raises
    ------
    InputError
        If the input cannot be used; the message says why.

    Examples
    --------
    >>> import apd_viewer
    >>> U = [[0, 0, 0], [2, 0, 0], [0, 2, 0], [0, 0, 2]]
    >>> found = apd_viewer.volume_readings(U, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> round(found.enclosed, 3), round(found.hull.volume, 3), round(found.hull.bulk(), 3)
    (1.333, 1.333, 2.083)
    """
    mesh = Mesh(checked_floats(U, tr("Vertices")), checked_integers(F, tr("Faces")))
    return mesh_volumes(mesh, thickness, up)


def mesh_volumes(
    mesh: Mesh,
    thickness: float | None,
    up: np.ndarray | None = None,
    fill: float | None = None,
    closed: Sequence[int] = (),
) -> VolumeReadings:
    """Volumes of an undeformed mesh.

    Parameters
    ----------
    thickness : float or None
        Of the wall, mesh units.
    up : (3,) float array or None
        Direction against gravity.
    fill : float or None
        Volume that is filled in, cubic mesh units.
    closed : sequence of int
        A vertex at the border of each opening that counts as closed.

    Raises
    ------
    InputError
        Unless ``thickness`` > 0 and the mesh can be filled, if they are given.
    """
    if thickness is not None and not (isinstance(thickness, Real) and 0.0 < thickness < np.inf):
        raise InputError(tr("Enter a wall thickness greater than 0."))
    found, hull = inspect(mesh), hull_readings(mesh.V[used_vertices(mesh.F)])
    enclosed = found.volume if found.volume_capped is None else found.volume_capped
    readings = VolumeReadings.from_hull(
        found.area, enclosed, found.openings, hull, thickness, found.double_wall
    )
    if up is None:
        return readings
    vessel = Vessel(mesh.V, mesh.F, up, closed)
    return readings._replace(brimful=vessel.brimful, filling=None if fill is None else vessel.filling(fill))
