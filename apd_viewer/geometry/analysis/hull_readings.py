"""Readings of a shape that depend on its convex hull alone."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.analysis.bounding_boxes import smallest_box
from apd_viewer.geometry.analysis.convex_hull import convex_hull, minimum_width
from apd_viewer.geometry.mesh.arrays import local_origin
from apd_viewer.geometry.mesh.checked_arguments import as_float, checked
from apd_viewer.language import tr

# Share of a container that convex bodies fill when they lie in it at random: equal spheres at their densest,
# and the range from the loosest spheres [Onoda & Liniger 1990] to the densest spheroids [Donev et al. 2004].
PACKING, LOOSEST, DENSEST = 0.64, 0.55, 0.71
_LITTLE = 1e-9  # of an object: rounding


class HullReadings(NamedTuple):
    """Readings of a convex hull, mesh units; a flat shape has no volume and no width.

    Attributes
    ----------
    volume : float
    width : float
        Least distance of two parallel planes with the shape between them.
    sides : tuple of 3 floats
        Of the smallest box in any orientation, shortest first.

    Examples
    --------
    >>> import apd_viewer
    >>> bottle = apd_viewer.open_mesh("bottle.obj")  # in centimetres
    >>> hull = apd_viewer.volume_readings(bottle.V, bottle.F).hull
    >>> f"{hull.volume:.0f}", f"{hull.bulk():.0f}", hull.count_in(45_000)
    ('573', '896', 50)
    """

    volume: float
    width: float
    sides: tuple[float, float, float]

    @property
    def box(self) -> float:
        """Volume of the smallest box."""
        a, b, c = self.sides
        return a * b * c

    def bulk(self, packing: float = PACKING) -> float:
        """Volume that one of many takes in a container, lying at random.

        ``packing`` is the share of the container that they fill.
        """
        if not 0.0 < as_float(packing) <= 1.0:
            raise InputError(tr("The packing must be a share above 0 and at most 1, such as 0.64."))
        return self.volume / packing

    @checked
    def count_in(self, container: float, packing: float = PACKING) -> int:
        """Number of objects in a ``container``, cubic mesh units; 0 of a flat shape."""
        return int(container / self.bulk(packing) + _LITTLE) if self.volume > 0.0 else 0


def hull_readings(points: np.ndarray) -> HullReadings:
    """Readings of the convex hull of ``points`` (k, 3)."""
    points = points - local_origin(points)
    hull = convex_hull(points)
    if hull is None:  # its box has no volume either, in whatever way it is turned in its plane
        centred = points - points.mean(axis=0)
        along = centred @ np.linalg.svd(centred, full_matrices=False)[2].T
        _, b, c = np.sort(np.ptp(along, axis=0)).tolist()
        return HullReadings(0.0, 0.0, (0.0, b, c))
    return HullReadings(hull.volume, minimum_width(hull), smallest_box(hull.corners))
