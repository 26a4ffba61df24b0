"""The colours of the mesh: Okabe and Ito's, which colour-blind people can tell apart."""

from __future__ import annotations

import numpy as np

from apd_viewer.geometry.constraints import BASE, FREE, HANDLE

BASE_COLOR = (0, 114, 178)  # blue
HANDLE_COLOR = (213, 94, 0)  # vermilion
FREE_COLOR = (205, 203, 198)

_BY_LABEL = np.empty((3, 4), dtype=np.uint8)
_BY_LABEL[BASE] = (*BASE_COLOR, 255)
_BY_LABEL[FREE] = (*FREE_COLOR, 255)
_BY_LABEL[HANDLE] = (*HANDLE_COLOR, 255)


def label_colors(labels: np.ndarray) -> np.ndarray:
    """RGBA of every vertex, (n, 4) uint8 array, for its label (n,)."""
    return _BY_LABEL[labels]
