"""What a reader makes of a file."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from apd_viewer.geometry.mesh import Origin


class Parsed(NamedTuple):
    """Positions (n, 3), triangles (m, 3), and the file that they came from."""

    V: np.ndarray
    F: np.ndarray
    origin: Origin | None
