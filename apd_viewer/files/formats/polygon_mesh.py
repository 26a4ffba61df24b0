"""Parsed mesh file: polygons, triangles, encoding, normals and colours."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain, count
from typing import NamedTuple

import numpy as np

from apd_viewer.files.formats.text import Encoding
from apd_viewer.geometry.mesh.mesh import DerivedOrigin, Mesh, Origin
from apd_viewer.geometry.mesh.normals import rotated_normals
from apd_viewer.language import tr, trn

_LONGEST_NAME = 60  # characters of the name of a part
_LONGEST = 1e30  # longest accepted normal; the square of a longer one overflows


class ParsedMesh(NamedTuple):
    """Positions and triangles of a mesh file, its origin for rewriting, and remarks.

    The ``remarks`` list peculiarities of the file, and contents that were not read. The ``unit`` is the
    symbol of the unit of length stated in the file; empty without one.
    """

    V: np.ndarray
    F: np.ndarray
    origin: Origin | None
    remarks: tuple[str, ...] = ()
    unit: str = ""


@dataclass(frozen=True, eq=False)
class EncodedMeshOrigin(DerivedOrigin):
    """Source file in a text encoding, decoded to UTF-8 for its reader.

    Attributes
    ----------
    encoding : Encoding
        Of the file.
    """

    encoding: Encoding

    def rewritten_content(self, mesh: Mesh, U: np.ndarray) -> bytes:
        """File content with positions ``U`` (n, 3), in the encoding of the file."""
        return self.encoding.encode(self.origin.rewritten_content(mesh, U))


@dataclass(frozen=True, eq=False)
class PartsOrigin(DerivedOrigin):
    """Source file of an assembly.

    Attributes
    ----------
    names : tuple of str
        Of its parts.
    member : (n,) uint8 array
        k + 1 for the vertices of ``names[k]``, 0 for those of other parts.
    """

    names: tuple[str, ...]
    member: np.ndarray


def distinct_names(names: list[str]) -> list[str]:
    """Names without unprintable characters, and numbered where they recur."""
    found: list[str] = []
    for name in names:
        own = "".join(filter(str.isprintable, name)).strip()[:_LONGEST_NAME] or tr("Part")
        numbered = (own if k == 1 else f"{own} {k}" for k in count(1))
        found.append(next(each for each in numbered if each not in found))
    return found


def trailing_bytes_remark(size: int) -> tuple[str, ...]:
    """Remark on the bytes after the last face of a file, if any."""
    said = trn(
        "{n:,} byte after the last face that the file declares was not read.",
        "{n:,} bytes after the last face that the file declares were not read.",
        size,
    )
    return (said.format(n=size),) if size else ()


def updated_normals(
    V: np.ndarray, U: np.ndarray, F: np.ndarray, N: np.ndarray, normal_of: np.ndarray
) -> np.ndarray:
    """Normals ``N`` rotated with the surface; zero and huge normals unchanged."""
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
    """Colours (n, 3) of a text file, in 0 to 1 or 0 to 255, as uint8."""
    return colors_to_uint8(colors, 1.0 if colors.max(initial=0.0) <= 1.0 else 255.0)


def linear_to_srgb(colors: np.ndarray) -> np.ndarray:
    """Linear colours (n, 3) from 0 to 1 as sRGB, uint8."""
    linear = np.clip(np.nan_to_num(colors), 0.0, 1.0)
    low, high = 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055
    return colors_to_uint8(np.where(linear <= 0.0031308, low, high), 1.0)


# Faces with more corners keep their fan triangulation.
_MOST_TO_CLIP = 1000
# Limit on tested ears in total; further faces keep their fan triangulation.
_MOST_TRIES = 100_000


class Polygons(NamedTuple):
    """Polygons as vertex indices (c,) of all corners and face offsets (p + 1,)."""

    corner: np.ndarray
    start: np.ndarray

    @classmethod
    def from_faces(cls, faces: Sequence[Sequence[int]]) -> Polygons:
        """Polygons from faces of any size; raises ValueError on indices out of range."""
        sizes = np.fromiter((len(face) for face in faces), np.int64, len(faces))
        start = np.concatenate([[0], np.cumsum(sizes)])
        try:
            corner = np.fromiter(chain.from_iterable(faces), np.int64, int(start[-1]))
        except OverflowError:
            raise ValueError(tr("a face has a vertex index out of range")) from None
        return cls(corner, start)

    @classmethod
    def from_array(cls, faces: np.ndarray) -> Polygons:
        """Polygons from faces (p, k) with equal numbers of corners."""
        corner = np.ascontiguousarray(faces, dtype=np.int64).ravel()
        return cls(corner, np.arange(0, faces.size + 1, max(faces.shape[1], 1)))

    def triangles(self, V: np.ndarray) -> np.ndarray:
        """Triangles (m, 3) of the faces as vertex indices, in face order."""
        sizes = np.diff(self.start)
        if (sizes == 3).all():
            return self.corner.reshape(-1, 3)
        return self.corner[self.triangle_corners(V)]

    def triangle_corners(self, V: np.ndarray) -> np.ndarray:
        """Triangles (m, 3) of the faces as indices into ``corner``, in face order.

        A fan around the first corner, unless it would fold over in a non-convex face.
        """
        sizes = np.diff(self.start)
        first = np.concatenate([[0], np.cumsum(np.maximum(sizes - 2, 0))])
        face = np.repeat(np.arange(len(sizes)), np.diff(first))
        k = np.arange(first[-1]) - first[face]
        begin = self.start[face]
        T = np.column_stack([begin, begin + k + 1, begin + k + 2])
        if len(self.corner) and self.corner.min() >= 0 and self.corner.max() < len(V):
            tries = 0
            for folded in np.unique(face[_folds(V[self.corner], T, face)]):
                a, b = self.start[folded], self.start[folded + 1]
                if b - a <= _MOST_TO_CLIP and tries < _MOST_TRIES:  # too many folds mean a broken file
                    ears, tried = _ear_clipped_triangles(V[self.corner[a:b]])
                    T[first[folded] : first[folded + 1]] = a + ears
                    tries += tried
        return T


def concatenated_polygons(polygons: Sequence[Polygons]) -> Polygons:
    """Concatenation of several sets of polygons."""
    corner = np.concatenate([np.empty(0, dtype=np.int64), *(part.corner for part in polygons)])
    sizes = np.concatenate([np.empty(0, dtype=np.int64), *(np.diff(part.start) for part in polygons)])
    return Polygons(corner, np.concatenate([[0], np.cumsum(sizes)]))


def strip_triangles(strips: np.ndarray) -> np.ndarray:
    """Triangles (t, 3) of strips (k,) separated by -1, every other one reversed."""
    place = np.arange(len(strips))
    begin = np.maximum.accumulate(np.where(strips == -1, place + 1, 0))
    k = np.flatnonzero(begin[2:] <= place[:-2])
    odd = (k - begin[k]) % 2
    return np.column_stack([strips[k], strips[k + 1 + odd], strips[k + 2 - odd]])


def _folds(X: np.ndarray, T: np.ndarray, face: np.ndarray) -> np.ndarray:
    """Indices (t,) of triangles opposed to the area vector of their face."""
    with np.errstate(all="ignore"):  # huge coordinates are rejected later
        cross = np.cross(X[T[:, 1]] - X[T[:, 0]], X[T[:, 2]] - X[T[:, 0]])
        count = int(face[-1]) + 1 if len(face) else 0
        whole = np.column_stack(
            [np.bincount(face, weights=cross[:, axis], minlength=count) for axis in range(3)]
        )
        return np.flatnonzero((cross * whole[face]).sum(axis=1) < 0.0)


def _ear_clipped_triangles(X: np.ndarray) -> tuple[np.ndarray, int]:
    """Ear-clipped triangles (k - 2, 3) of a polygon (k, 3); number of corners tested."""
    left, found, tries = np.arange(len(X)), [], 0
    with np.errstate(all="ignore"):  # huge coordinates are rejected later
        x = _projected_corners(X)
        while len(left) > 3:
            ear = next((k for k in range(len(left)) if _is_ear(x, left, k)), None)
            tries += len(left) if ear is None else ear + 1
            ear = ear or 0
            found.append([left[ear - 1], left[ear], left[(ear + 1) % len(left)]])
            left = np.delete(left, ear)
    return np.array([*found, left]), tries


def _projected_corners(X: np.ndarray) -> np.ndarray:
    """Corners (k, 2) projected along the area vector, counter-clockwise."""
    normal = np.cross(X - X[0], np.roll(X, -1, axis=0) - X[0]).sum(axis=0)
    size = np.linalg.norm(normal)
    normal = normal / size if size > 0.0 else np.array([0.0, 0.0, 1.0])
    along = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
    return (X - X[0]) @ np.column_stack([along, np.cross(normal, along)])


def _is_ear(x: np.ndarray, left: np.ndarray, k: int) -> bool:
    own = left[[k - 1, k, (k + 1) % len(left)]]
    a, b, c = x[own]
    if _side(a, b, c) <= 0.0:
        return False
    others = x[np.setdiff1d(left, own)]
    others = others[(others[:, None] != (a, b, c)).any(axis=2).all(axis=1)]  # bridges to holes repeat corners
    inside = (_side(a, b, others) >= 0.0) & (_side(b, c, others) >= 0.0) & (_side(c, a, others) >= 0.0)
    return not inside.any()


def _side(a: np.ndarray, b: np.ndarray, p: np.ndarray) -> np.ndarray:
    """Twice the signed area of plane triangles a, b, p; positive for p on the left."""
    return (b[0] - a[0]) * (p[..., 1] - a[1]) - (b[1] - a[1]) * (p[..., 0] - a[0])
