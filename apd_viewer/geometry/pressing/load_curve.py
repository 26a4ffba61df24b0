"""Readings of a load against a deflection.

The words are those of the column crush test [ASTM D2659, Standard test method for column crush properties
of blown thermoplastic containers]: crushing yield load, deflection at it, apparent stiffness.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

# A load that falls by this part after its maximum has yielded: less is the noise of shapes nearly at rest.
_FALLS = 0.01
# The apparent stiffness is the slope of the line through the first points up to this part of the yield load.
_STRAIGHT = 0.5


class LoadCurve(NamedTuple):
    """Readings of a curve of loads.

    Attributes
    ----------
    yield_load : float or None
        The first maximum, from which the load falls; None if it only rises.
    yield_deflection : float or None
        Deflection at it, mesh units.
    apparent_stiffness : float or None
        Load per deflection at the beginning: of the line through 0 nearest to the points up to half of the
        yield load, or of the last load. None if the plates have not moved.
    work : float
        Work of the load along the whole way.
    """

    yield_load: float | None
    yield_deflection: float | None
    apparent_stiffness: float | None
    work: float


def load_curve(deflection: np.ndarray, load: np.ndarray) -> LoadCurve:
    """Readings of the loads (s,) at deflections (s,), both from 0 on.

    Parameters
    ----------
    deflection : (s,) float array
        Ascending, from 0 at the first touch on; at least two.
    load : (s,) float array
    """
    x, y = np.asarray(deflection, dtype=float), np.asarray(load, dtype=float)
    top = _first_maximum(y)
    most = y[top] if top is not None else y[-1]
    straight = (y <= _STRAIGHT * most) & (np.arange(len(y)) <= (len(y) if top is None else top))
    straight[1] = True
    slope = float(x[straight] @ y[straight] / (x[straight] @ x[straight])) if x[-1] > 0.0 else None
    work = float(np.trapezoid(y, x))
    if top is None:
        return LoadCurve(None, None, slope, work)
    return LoadCurve(float(y[top]), float(x[top]), slope, work)


def _first_maximum(y: np.ndarray) -> int | None:
    """Place of the first maximum that is followed by a fall; None without one."""
    top = 0
    for k in range(1, len(y)):
        if y[k] > y[top]:
            top = k
        elif y[k] < (1.0 - _FALLS) * y[top]:
            return top
    return None
