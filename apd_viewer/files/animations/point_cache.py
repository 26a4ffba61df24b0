"""Point caches, PC2 and MDD: the positions of all vertices, shape by shape.

Neither has triangles: a cache is played on the mesh of the file that was opened here.
"""

from __future__ import annotations

import struct
from pathlib import Path
from typing import BinaryIO

import numpy as np

from apd_viewer.files.animations.animation_shapes import Animation
from apd_viewer.files.storage.atomic_file import replacing_file

# Signature, version, points, first frame, frames from sample to sample, samples.
_PC2 = struct.Struct("<12siiffi")
_RATE = 24.0  # shapes a second, as many as Blender plays unless told otherwise


def write_pc2(animation: Animation, path: Path) -> None:
    """Write the shapes as PC2, one a frame from frame 0; raises InputError."""
    points = len(animation.imported_vertices)
    with replacing_file(path) as scratch, scratch.open("wb") as stream:
        stream.write(_PC2.pack(b"POINTCACHE2\0", 1, points, 0.0, 1.0, len(animation)))
        _write_points(animation, stream, "<f4")


def write_mdd(animation: Animation, path: Path) -> None:
    """Write the shapes as MDD, 24 a second from time 0; raises InputError."""
    count = len(animation)
    with replacing_file(path) as scratch, scratch.open("wb") as stream:
        stream.write(struct.pack(">ii", count, len(animation.imported_vertices)))
        stream.write((np.arange(count) / _RATE).astype(">f4").tobytes())
        _write_points(animation, stream, ">f4")


def _write_points(animation: Animation, stream: BinaryIO, kind: str) -> None:
    for U in animation:
        stream.write(U[animation.imported_vertices].astype(kind).tobytes())
