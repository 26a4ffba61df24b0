"""A step of a press."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class PressStep:
    """Shape between two plates at rest, and its readings.

    Attributes
    ----------
    U : (n, 3) float array
        Positions in the order of the file, mesh units, read-only.
    distance : float
        Of the plates from each other, mesh units.
    deflection : float
        How much nearer they are than at the first touch.
    load_low, load_high : float
        Force on the plate below and on the one above, energy per length: that of a material of stiffness 1.
        At rest, unless something is held, they are the same, and the slope of the energy as the plates close.
    stretching : float
        Share of the wall's energy that is in its stretching, 0 to 1; the rest bends it.
    energy : float
        Of the method, with that of the gaps; squared lengths.
    volume, volume_capped : float or None
        Enclosed volume; None if the surface is open. With flat caps over its openings; None without any.
    area_error : float
        ``area / rest area - 1``.
    crossings : int or None
        Triangles that cross others; None where that cannot be found.
    settled : bool
        The shape is at rest.
    iterations : int

    Examples
    --------
    >>> import apd_viewer
    >>> import trimesh
    >>> ball = trimesh.creation.icosphere(2)
    >>> plates = {"axis": (0, 0, 1), "to": 1.8, "steps": 1}
    >>> first, last = apd_viewer.press(ball.vertices, ball.faces, **plates, stiffness=0.01).steps
    >>> bool(last.load_low > first.load_low), bool(last.volume < first.volume)
    (True, True)
    """

    U: np.ndarray
    distance: float
    deflection: float
    load_low: float
    load_high: float
    stretching: float
    energy: float
    volume: float | None
    volume_capped: float | None
    area_error: float
    crossings: int | None
    settled: bool
    iterations: int
