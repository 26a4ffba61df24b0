"""Result of a format reader, in any encoding, and normals turned with the surface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from apd_viewer.files.formats.text import Encoding
from apd_viewer.geometry.mesh.mesh import DerivedOrigin, Mesh, Origin
from apd_viewer.geometry.mesh.normals import rotated_normals
from apd_viewer.language import trn

_LONGEST = 1e30  # of a normal; the square of a longer one overflows


class ParsedMesh(NamedTuple):
    """Positions (n, 3), triangles (m, 3) and their file, with sentences on it.

    The ``remarks`` say what is strange about the file, and what it has that was not read. The ``unit`` of
    length is the symbol of the one that the file states; without one it is empty.
    """

    V: np.ndarray
    F: np.ndarray
    origin: Origin | None
    remarks: tuple[str, ...] = ()
    unit: str = ""


@dataclass(frozen=True, eq=False)
class EncodedMeshOrigin(DerivedOrigin):
    """Origin in another encoding than the UTF-8 of its reader.

    Attributes
    ----------
    encoding : Encoding
        Of the file.
    """

    encoding: Encoding

    def rewritten(self, mesh: Mesh, U: np.ndarray) -> bytes:
        """File content with positions ``U`` (n, 3), in its own encoding."""
        return self.encoding.encode(self.origin.rewritten(mesh, U))


def trailing_bytes_remark(size: int) -> tuple[str, ...]:
    """Remark on the bytes after the last face of a file, if there are any."""
    said = trn(
        "{n:,} byte after the last face that the file declares was not read.",
        "{n:,} bytes after the last face that the file declares were not read.",
        size,
    )
    return (said.format(n=size),) if size else ()


def updated_normals(
    V: np.ndarray, U: np.ndarray, F: np.ndarray, N: np.ndarray, normal_of: np.ndarray
) -> np.ndarray:
    """Normals ``N`` turned with the surface; zero normals unchanged."""
    good = (np.abs(N) < _LONGEST).all(axis=1)
    if good.all():
        return rotated_normals(V, U, F, N, normal_of)
    sane = np.where(good[:, None], N, 0.0)
    return np.where(good[:, None], rotated_normals(V, U, F, sane, normal_of), N)


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
