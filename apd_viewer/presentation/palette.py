"""Colours of the mesh: Okabe and Ito's and their shades, colour-blind safe.

Moving parts are warm and fixed parts blue; regions have the colours in between. Neighbouring colours also
differ in lightness, and the panel names all parts.
"""

import numpy as np

from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE

BASE_COLOR = (0, 114, 178)  # blue
FREE_COLOR = (205, 203, 198)
HANDLE_COLORS = (
    (213, 94, 0),  # vermilion
    (236, 170, 30),  # orange
    (128, 44, 0),
    (246, 166, 124),
    (122, 84, 10),
    (255, 214, 120),
    (176, 58, 58),
    (84, 48, 28),
)
REGION_COLORS = (
    (0, 158, 115),  # bluish green
    (204, 121, 167),  # reddish purple
    (86, 180, 233),  # sky blue
    (240, 228, 66),  # yellow
    (88, 60, 130),
    (150, 214, 180),
    (60, 66, 74),
    (150, 150, 40),
)
# Colour of marked findings, distinct from all other colours.
MARK_COLOR = (226, 0, 142)
# Obstacle colours on light and dark backgrounds; grey, since obstacles are not part of the mesh.
OBSTACLE_COLOR, OBSTACLE_COLOR_ON_DARK = (92, 102, 120), (172, 182, 200)
# Opacity of a region: high over free vertices, low so as not to hide base and handles.
_OVER_FREE, _OVER_PAINT = 0.82, 0.42
# Weak tint of vertices in a falloff, since they are still free.
_SOFT = 0.5
# Blend factor of a paint preview, close to the final colour.
_PREVIEWED = 0.6


def handle_color(k: int) -> tuple[int, int, int]:
    """RGB colour of handle ``k``; colours repeat for many handles."""
    return HANDLE_COLORS[k % len(HANDLE_COLORS)]


def _mixed_colors() -> np.ndarray:
    """RGBA for each label and region number, (labels, 1 + regions, 4) uint8 array."""
    paint = np.array([handle_color(label - HANDLE) for label in range(256)], dtype=float)
    paint[BASE], paint[FREE] = BASE_COLOR, FREE_COLOR
    opacity = np.full((len(paint), 1, 1), _OVER_PAINT)
    opacity[FREE] = _OVER_FREE
    mixed = np.full((len(paint), 1 + len(REGION_COLORS), 4), 255.0)
    mixed[:, 0, :3] = paint
    mixed[:, 1:, :3] = paint[:, None] + opacity * (np.array(REGION_COLORS) - paint[:, None])
    return np.rint(mixed).astype(np.uint8)


_MIXED = _mixed_colors()


def _color_classes() -> tuple[np.ndarray, np.ndarray]:
    """Sorted keys of the colours of painted parts, and the class of each, from 1 to 4.

    Parts that are likely to touch differ in it: base and handles have 1 or 2, regions 3 or 4, and a region
    over base or handle the one that neither has.
    """
    labels, members = np.indices(_MIXED.shape[:2])
    held = np.where(labels == BASE, 1, 2 - (labels - HANDLE) % 2)
    free = np.where(members > 0, 3 + (members - 1) % 2, 0)
    classes = np.where(labels == FREE, free, np.where(members > 0, 3 - held, held))
    keys, first = np.unique(_color_keys(_MIXED.reshape(-1, 4)), return_index=True)
    return keys, classes.ravel()[first].astype(np.uint8)


def _color_keys(rgba: np.ndarray) -> np.ndarray:
    key: np.ndarray = rgba[:, :3] @ np.array([1 << 16, 1 << 8, 1], dtype=np.int32)
    return key


_KEYS, _CLASSES = _color_classes()


def paint_classes(rgba: np.ndarray) -> np.ndarray:
    """Classes (k,) uint8 of colours (k, 4): 1 to 4 of painted parts, 0 of all others."""
    keys = _color_keys(rgba)
    places = np.searchsorted(_KEYS, keys).clip(max=len(_KEYS) - 1)
    return np.where(_KEYS[places] == keys, _CLASSES[places], np.uint8(0))


def label_colors(labels: np.ndarray, member: np.ndarray | None = None) -> np.ndarray:
    """RGBA of every vertex, (n, 4) uint8 array, by label and region number, both (n,)."""
    return _MIXED[labels, 0 if member is None else member]


def falloff_colors(colors: np.ndarray, handle: np.ndarray, strength: np.ndarray) -> np.ndarray:
    """RGBA ``colors`` (k, 4) uint8 tinted by handle colours, by falloff strength."""
    mixed = colors.astype(float)
    paint = np.array([handle_color(k) for k in range(int(handle.max(initial=0)) + 1)], dtype=float)
    mixed[:, :3] += _SOFT * strength[:, None] * (paint[handle] - mixed[:, :3])
    return np.rint(mixed).astype(np.uint8)


def tinted_colors(colors: np.ndarray, color: tuple[int, ...]) -> np.ndarray:
    """RGBA ``colors`` (k, 4) uint8 blended towards an RGB ``color``."""
    mixed = colors.astype(float)
    mixed[:, :3] += _PREVIEWED * (np.array(color[:3]) - mixed[:, :3])
    return np.rint(mixed).astype(np.uint8)
