"""Texture of a mesh: coordinates by corner, and the image."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Texture(NamedTuple):
    """An image on a mesh, with seams.

    Attributes
    ----------
    uv : (k, 2) float32 array
        Texture coordinates: 0 to 1 from left to right and from bottom to top, repeated beyond.
    uv_of : (m, 3) int32 array
        Which of them each corner has.
    image : (h, w, 3) uint8 array
        Rows from top to bottom, sRGB.
    """

    uv: np.ndarray
    uv_of: np.ndarray
    image: np.ndarray
