"""Main function of the geodesic process.

The library for straightening paths holds the interpreter lock, and cannot be interrupted.
"""

from typing import BinaryIO

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.measuring.geodesics import geodesic_path
from apd_viewer.geometry.measuring.surface_point import CarriedPath, SurfacePoint
from apd_viewer.session.processes import array_pipe
from apd_viewer.session.processes.child_boot import run_service


def main(reply_descriptor: int) -> None:
    """Answer the parent process; ``reply_descriptor`` is the descriptor for replies."""
    run_service(reply_descriptor, serve)


def serve(source: BinaryIO, sink: BinaryIO) -> None:
    """Find the geodesics between points from ``source`` until it ends.

    A question are three messages: triangles (m, 3) int32, positions (n, 3) float64, and two points, each a
    triangle and three weights, (2, 4) float64. The answer are two: the vertices around each corner of the
    path, (k, 3) int64, and their weights (k, 3) float64; empty where there is no path.
    """
    while (
        (triangles := array_pipe.read_message(source)) is not None
        and (positions := array_pipe.read_message(source)) is not None
        and (ends := array_pipe.read_message(source)) is not None
    ):
        F = np.frombuffer(triangles, dtype=np.int32).reshape(-1, 3).astype(np.int64)
        points = [SurfacePoint(int(face), (a, b, c)) for face, a, b, c in np.frombuffer(ends).reshape(-1, 4)]
        U = np.frombuffer(positions).reshape(-1, 3).copy()  # writable, as the cached kernels expect
        found = _found(U, F, *points)
        array_pipe.write_message(sink, found.corners.astype(np.int64).tobytes())
        array_pipe.write_message(sink, found.weights.tobytes())


def _found(U: np.ndarray, F: np.ndarray, start: SurfacePoint, end: SurfacePoint) -> CarriedPath:
    try:
        return CarriedPath.from_polyline(geodesic_path(U, F, start, end), U, F)
    except InputError:
        return CarriedPath.empty()
