"""Compile the kernels before they are needed."""

from __future__ import annotations

import numpy as np

from apd_viewer.geometry import skin
from apd_viewer.geometry.deform import deform


def warm_up() -> None:
    """Use every kernel once: the first time compiles them (seconds), later ones load them (0.2 s)."""
    V = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    F = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    fixed = np.arange(2)
    deform(V, F, fixed, V[fixed] * 1.1, handle=fixed[1:], iterations=1)
    skin.warm_up()
