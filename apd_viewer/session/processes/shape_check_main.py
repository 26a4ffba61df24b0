"""Main function of the shape-check process.

The library that looks for crossings holds the interpreter, and cannot be stopped.
"""

from __future__ import annotations

from typing import BinaryIO

import numpy as np

from apd_viewer.geometry.analysis.shape_check import check_shape
from apd_viewer.session.processes import array_pipe
from apd_viewer.session.processes.child_boot import run

_NICENESS = 10  # nobody waits for it
NOBODY_LOOKED = b"-"


def main(replies: int) -> None:
    """Serve the owner; ``replies`` is the file descriptor for answers."""
    run(replies, serve, _NICENESS)


def serve(source: BinaryIO, sink: BinaryIO) -> None:
    """Check the shapes from ``source`` until it ends.

    A shape are two messages: its triangles (m, 3) int32, and its positions (n, 3) float64. The answer are two
    as well: the triangles that pass through others, int64, and the three sizes of its box along the axes with
    the volume, the width and the three sides of the smallest box of its hull, float64.
    """
    while (triangles := array_pipe.read(source)) is not None and (
        positions := array_pipe.read(source)
    ) is not None:
        F = np.frombuffer(triangles, dtype=np.int32).reshape(-1, 3).astype(np.int64)
        found = check_shape(np.frombuffer(positions).reshape(-1, 3), F)
        crossing = NOBODY_LOOKED if found.crossing is None else found.crossing.astype(np.int64).tobytes()
        array_pipe.write(sink, crossing)
        array_pipe.write(sink, np.array([*found.size, *found.hull[:2], *found.hull.sides]).tobytes())
