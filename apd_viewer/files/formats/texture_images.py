"""Texture images, and their combination into one atlas."""

import io
import math
from pathlib import Path

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.storage.regular_files import sibling_content, without_library_warnings
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.texture import Texture
from apd_viewer.language import tr

# Largest side in pixels, supported by graphics cards of the last ten years.
_LARGEST = 8192
_LARGEST_PICTURE = 4096
_BARE = np.full((1, 1, 3), 255, dtype=np.uint8)


def sibling_image(named: str, mesh: Path | None) -> np.ndarray:
    """Image (h, w, 3) uint8 of a file named by a mesh, scaled down if too large.

    Raises
    ------
    InputError
        If it is outside the folder of the mesh, or cannot be read.
    """
    try:
        content = sibling_content(named, mesh)
    except OSError as error:
        raise _missing_texture_error(named) from error
    if content is None:
        raise _missing_texture_error(named)
    return read_image(content, named)


def read_image(content: bytes, name: str) -> np.ndarray:
    """Image (h, w, 3) uint8 from file content, scaled down if too large.

    Raises
    ------
    InputError
        If it cannot be read; ``name`` is that of the image.
    """
    from PIL import Image  # imported on demand: loading takes a tenth of a second

    try:
        with without_library_warnings(), Image.open(io.BytesIO(content)) as image:
            image.draft("RGB", (_LARGEST, _LARGEST))
            image.thumbnail((_LARGEST, _LARGEST))
            return np.array(image.convert("RGB"))
    except (OSError, ValueError, SyntaxError, Image.DecompressionBombError) as error:
        raise _missing_texture_error(name) from error


def read_picture(content: bytes, name: str) -> np.ndarray:
    """Picture (h, w, 4) uint8 of an image file, upright, scaled down if too large.

    ``name`` is that of the file.

    Raises
    ------
    InputError
        If it cannot be read.
    """
    from PIL import Image, ImageOps  # imported on demand: loading takes a tenth of a second

    most = _LARGEST_PICTURE, _LARGEST_PICTURE
    try:
        with without_library_warnings(), Image.open(io.BytesIO(content)) as image:
            image.draft(image.mode, most)
            picture = ImageOps.exif_transpose(image).convert("RGBA")
            picture.thumbnail(most)
            return np.array(picture)
    except (OSError, ValueError, SyntaxError, MemoryError, Image.DecompressionBombError) as error:
        raise InputError(
            tr("{name} is no image that can be read; choose a PNG, JPEG or WebP file.").format(name=name)
        ) from error


def _missing_texture_error(name: str) -> InputError:
    return InputError(
        tr(
            "The texture {name} is missing or cannot be read; put it beside the mesh and open that again."
        ).format(name=name)
    )


def joined_texture(
    uv: np.ndarray, uv_of: np.ndarray, image_of: np.ndarray, images: list[np.ndarray]
) -> Texture | None:
    """Texture of triangles with one image each; None if no triangle has one.

    Several images are combined into one atlas, which cannot be tiled.

    Parameters
    ----------
    uv : (k, 2) float array
    uv_of : (m, 3) int array
        Index into them for each corner; -1 is none.
    image_of : (m,) int array
        Index into ``images`` for each triangle; -1 is none.
    images : list of (h, w, 3) uint8 arrays
    """
    good = np.isfinite(uv).all(axis=1)
    valid = ((uv_of >= 0) & (uv_of < len(uv))).all(axis=1) & (image_of >= 0)
    valid[valid] = good[uv_of[valid]].all(axis=1)
    if not valid.any():
        return None
    if valid.all() and len(images) == 1:
        return Texture(frozen(uv.astype(np.float32)), frozen(uv_of.astype(np.int32)), frozen(images[0]))
    cell = np.where(valid, image_of, len(images))
    pairs, corner = np.unique(
        np.where(valid[:, None], uv_of, 0) + len(uv) * cell[:, None], return_inverse=True
    )
    image, places = _atlas([*images, _BARE])
    inside = np.nan_to_num(uv[pairs % len(uv)])
    inside = np.where((inside < 0.0) | (inside > 1.0), inside - np.floor(inside), inside)
    low, size = places[pairs // len(uv)].reshape(-1, 2, 2).transpose(1, 0, 2)
    corner = corner.reshape(uv_of.shape).astype(np.int32)
    return Texture(frozen((low + inside * size).astype(np.float32)), frozen(corner), frozen(image))


def _atlas(images: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Atlas of several images, with the lower corner and size of each, (k, 4)."""
    columns = math.ceil(math.sqrt(len(images)))
    rows = math.ceil(len(images) / columns)
    side = min(max(max(image.shape[:2]) for image in images), _LARGEST // columns)
    whole = np.full((rows * side, columns * side, 3), 255, dtype=np.uint8)
    places = []
    for k, image in enumerate(images):
        top, left = side * (k // columns), side * (k % columns)
        whole[top : top + side, left : left + side] = _resized_image(image, side)
        # An inset of half a pixel keeps interpolation from blending in the neighbouring image.
        x, y = (left + 0.5) / whole.shape[1], 1.0 - (top + side - 0.5) / whole.shape[0]
        places.append((x, y, (side - 1) / whole.shape[1], (side - 1) / whole.shape[0]))
    return whole, np.array(places)


def _resized_image(image: np.ndarray, side: int) -> np.ndarray:
    """Image resampled to (side, side, 3) by nearest pixels."""
    down, along = (np.arange(side) * n // side for n in image.shape[:2])
    return image[down[:, None], along]
