"""What is looked at only once a shape is at rest, because it takes longer than a frame."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from apd_viewer.geometry.crossings import crossings
from apd_viewer.geometry.room import packed_volume


class Examination(NamedTuple):
    """What was found.

    Attributes
    ----------
    crossing : (k,) int array or None
        Triangles that pass through others; None where nobody could look.
    packed : float
        Volume of the smallest box around the shape.
    """

    crossing: np.ndarray | None
    packed: float


def examined(U: np.ndarray, F: np.ndarray) -> Examination:
    """Examine the shape with the positions ``U`` (n, 3), whose triangles ``F`` (m, 3) hang together."""
    return Examination(crossings(U, F), packed_volume(U[np.unique(F)]))
