"""Vertex colours of a file as eight-bit sRGB."""

from __future__ import annotations

import numpy as np


def colors_to_uint8(colors: np.ndarray, largest: float) -> np.ndarray:
    """Colours (n, 3) from 0 to ``largest`` as uint8; NaN is black."""
    scaled = np.nan_to_num(colors.astype(np.float64) * (255.0 / largest))
    return np.rint(np.clip(scaled, 0.0, 255.0)).astype(np.uint8)


def text_colors_to_uint8(colors: np.ndarray) -> np.ndarray:
    """Colours (n, 3) of a text file, from 0 to 1 or to 255, as uint8."""
    return colors_to_uint8(colors, 1.0 if colors.max(initial=0.0) <= 1.0 else 255.0)


def linear_to_srgb(colors: np.ndarray) -> np.ndarray:
    """Linear colours (n, 3) from 0 to 1 as sRGB, uint8."""
    linear = np.clip(np.nan_to_num(colors), 0.0, 1.0)
    low, high = 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055
    return colors_to_uint8(np.where(linear <= 0.0031308, low, high), 1.0)
