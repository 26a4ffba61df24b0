"""GLB with one morph target per shape, played back by animated weights.

The first shape is the mesh itself, and the targets are the differences of the others from it. While one
weight decreases from 1 to 0 and the next increases from 0 to 1, the shape is interpolated linearly. See the
specification of glTF 2.0, 3.7.2.2 (morph targets) and 3.11 (animations). Vertex scalars of the last shape are
attributes with names such as ``_AREA_CHANGE``; morph targets cannot change those.
"""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.animations.animation_shapes import Animation
from apd_viewer.files.storage.atomic_file import replacing_file
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.normals import triangle_frames, vertex_normals
from apd_viewer.language import tr

_FLOAT, _UINT = 5126, 5125  # component types of four bytes each
_VERTICES, _INDICES = 34962, 34963  # glTF targets of buffer views
_WIDTH = {"SCALAR": 1, "VEC3": 3}
LARGEST_FILE = 2**32 - 1  # bytes, the largest value of the 32-bit length field
_SECONDS, _FASTEST = 3.0, 24.0  # minimum duration in seconds; maximum number of shapes per second
_LOOK = {
    "pbrMetallicRoughness": {
        "baseColorFactor": [0.8, 0.8, 0.8, 1.0],
        "metallicFactor": 0.0,
        "roughnessFactor": 0.6,
    },
    "doubleSided": True,
}


class _Bounds(NamedTuple):
    """Minimum and maximum coordinates, each (3,)."""

    low: np.ndarray
    high: np.ndarray

    @classmethod
    def from_points(cls, X: np.ndarray) -> _Bounds:
        return cls(X.min(axis=0), X.max(axis=0))


class _Layout:
    """Consecutive buffer views of one buffer, and their accessors."""

    def __init__(self) -> None:
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []
        self.length = 0

    def add(
        self,
        kind: str,
        count: int,
        use: int | None = None,
        bounds: _Bounds | None = None,
        component: int = _FLOAT,
    ) -> int:
        """Append a buffer view for an array; return the index of its accessor."""
        size = 4 * _WIDTH[kind] * count
        view: dict[str, Any] = {"buffer": 0, "byteOffset": self.length, "byteLength": size}
        if use is not None:
            view["target"] = use
        told: dict[str, Any] = {"componentType": component, "count": count, "type": kind}
        if bounds is not None:
            told |= {"min": bounds.low.astype(float).tolist(), "max": bounds.high.astype(float).tolist()}
        self.accessors.append({"bufferView": len(self.views), **told})
        self.views.append(view)
        self.length += size
        return len(self.accessors) - 1


def write_morph_targets(animation: Animation, path: Path) -> None:
    """Write the shapes as a GLB animation of 3 s or more, in single precision.

    Raises
    ------
    InputError
        If the file would be longer than the format allows, or cannot be written.
    """
    document, length = _document(animation)
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    whole = 12 + 8 + len(text) + 8 + length
    if whole > LARGEST_FILE:
        raise InputError(
            tr("{name} would be longer than 4 GiB; use fewer steps, or .pc2 or .pvd.").format(name=path.name)
        )
    with replacing_file(path) as scratch, scratch.open("wb") as stream:
        stream.write(struct.pack("<4sIII4s", b"glTF", 2, whole, len(text), b"JSON") + text)
        stream.write(struct.pack("<I4s", length, b"BIN\0"))
        _write_arrays(animation, stream)


def _document(animation: Animation) -> tuple[dict[str, Any], int]:
    """JSON document of the file, and the byte length of its binary buffer."""
    mesh, count, layout = animation.mesh, len(animation), _Layout()
    n = len(mesh.V)
    indices = layout.add("SCALAR", mesh.F.size, _INDICES, component=_UINT)
    bounds = _bounds(animation)
    base = _points(layout, n, bounds[0])
    targets = [_points(layout, n, each) for each in bounds[1:]]
    end = _times(count)[-1:]
    times = layout.add("SCALAR", count, bounds=_Bounds(np.zeros(1), end))
    weights = layout.add("SCALAR", count * (count - 1))
    for name in _scalars(animation):  # scalars alone: Blender 5.0 mixes up vectors with them
        base[f"_{name.upper()}"] = layout.add("SCALAR", n, _VERTICES)
    surface = {"attributes": base, "indices": indices, "material": 0, "mode": 4, "targets": targets}
    names = {"targetNames": [f"{time:g}" for time in animation.times[1:]]}
    channel = {"sampler": 0, "target": {"node": 0, "path": "weights"}}
    sampler = {"input": times, "output": weights, "interpolation": "LINEAR"}
    document = {
        "asset": {"version": "2.0", "generator": "APD Viewer"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": mesh.stem, **_metre_scale(animation.metres)}],
        "meshes": [
            {"name": mesh.stem, "primitives": [surface], "weights": [0] * (count - 1), "extras": names}
        ],
        "materials": [_LOOK],
        "animations": [{"name": mesh.stem, "channels": [channel], "samplers": [sampler]}],
        "buffers": [{"byteLength": layout.length}],
        "bufferViews": layout.views,
        "accessors": layout.accessors,
    }
    return document, layout.length


def _metre_scale(metres: float) -> dict[str, Any]:
    """Node scale to metres for a mesh in another unit; otherwise empty."""
    return {"scale": [metres] * 3} if metres != 1.0 else {}


def _scalars(animation: Animation) -> dict[str, np.ndarray]:
    """Vertex scalars of the last shape, 0 where there is none: glTF has no NaN."""
    found = animation.scalars(np.load(animation.files[-1])).vertices
    return {name: np.nan_to_num(values.astype("<f4")) for name, values in found.items()}


def _points(layout: _Layout, n: int, bounds: _Bounds) -> dict[str, int]:
    return {"POSITION": layout.add("VEC3", n, _VERTICES, bounds), "NORMAL": layout.add("VEC3", n, _VERTICES)}


def _bounds(animation: Animation) -> list[_Bounds]:
    """Bounds of the first shape, and of the displacements from it to the other shapes."""
    found: list[_Bounds] = []
    start: np.ndarray | None = None
    for U in animation:
        moved = _single_precision(U) if start is None else _difference(U, start)
        start = moved if start is None else start
        found.append(_Bounds.from_points(moved))
    return found


def _write_arrays(animation: Animation, stream: BinaryIO) -> None:
    mesh, count = animation.mesh, len(animation)
    stream.write(mesh.F.astype("<u4").tobytes())
    start: tuple[np.ndarray, np.ndarray] | None = None
    for U in animation:
        N = shading_normals(mesh, U)
        if start is None:
            start = both = _single_precision(U), _single_precision(N)
        else:
            both = _difference(U, start[0]), _difference(N, start[1])
        for array in both:
            stream.write(array.tobytes())
    stream.write(_times(count).tobytes())
    # All weights are 0 at the first shape; at any other shape its own weight is 1.
    stream.write(np.eye(count, count - 1, -1, dtype="<f4").tobytes())
    for values in _scalars(animation).values():
        stream.write(values.tobytes())


def _single_precision(X: np.ndarray) -> np.ndarray:
    return X.astype("<f4")


def _difference(X: np.ndarray, start: np.ndarray) -> np.ndarray:
    """Difference from ``start`` as stored, so that rounding does not accumulate."""
    return _single_precision(X - start.astype(np.float64))


def shapes_per_second(count: int) -> float:
    """Pace at which ``count`` shapes are played."""
    return min(max(count - 1, 1) / _SECONDS, _FASTEST)


def _times(count: int) -> np.ndarray:
    """Times of the shapes in seconds, (count,)."""
    return (np.arange(count) / shapes_per_second(count)).astype("<f4")


_ANY = 0.0, 0.0, 1.0  # normal at vertices without any area, since glTF requires unit normals


def shading_normals(mesh: Mesh, U: np.ndarray) -> np.ndarray:
    """Unit vertex normals (n, 3) of the shape ``U`` (n, 3).

    The normals of the file are rotated with their triangles, and averaged if a vertex has several; without
    any, they are those of a smooth surface, equal on both sides of a seam.
    """
    if mesh.corner_normals is None:
        N = vertex_normals(U, mesh.joined_F)[mesh.weld.representative]
    else:
        N = _vertex_normals(mesh, mesh.corner_normals.local, U)
    N[~N.any(axis=1)] = _ANY
    return N


def _vertex_normals(mesh: Mesh, local: np.ndarray, U: np.ndarray) -> np.ndarray:
    """Vertex normals (n, 3) from corner normals in triangle frames (m, 3, 3)."""
    corners = U[mesh.F]
    edges = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    weight = np.linalg.norm(np.cross(*edges), axis=1)[:, None, None]
    own = (weight * (local @ triangle_frames(corners))).reshape(-1, 3)
    N = np.column_stack([np.bincount(mesh.F.ravel(), x, len(U)) for x in own.T])
    length = np.linalg.norm(N, axis=1, keepdims=True)
    unit: np.ndarray = np.divide(N, length, out=np.zeros_like(N), where=length > 0.0)
    return unit
