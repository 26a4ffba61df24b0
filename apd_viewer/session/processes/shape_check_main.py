"""Main function of the shape-check process.

The library for finding intersections holds the interpreter lock, and cannot be interrupted.
"""

import math
from typing import BinaryIO

import numpy as np

from apd_viewer.geometry.analysis.shape_check import check_shape
from apd_viewer.geometry.pose.held_turn import HandleTurns
from apd_viewer.session.processes import array_pipe
from apd_viewer.session.processes.child_boot import run_service

_NICENESS = 10  # low priority: no one waits for the check
NOT_CHECKED = b"-"


def main(reply_descriptor: int) -> None:
    """Answer the parent process; ``reply_descriptor`` is the descriptor for replies."""
    run_service(reply_descriptor, serve, _NICENESS)


def serve(source: BinaryIO, sink: BinaryIO) -> None:
    """Check the shapes from ``source`` until it ends.

    A shape are six messages: its triangles (m, 3) int32, its positions (n, 3) float64, and, empty where no
    handle has turned, the positions before, the labels (n,) int64, the number of poses of each handle, int64,
    and the poses, float64. The answer are three: the triangles that pass through
    others, int64; the three sizes of its box along the axes with the volume, the width and the three sides of
    the smallest box of its hull, float64; and each turn as it was asked and as it is held, float64.
    """
    while len(said := [read for _ in range(6) if (read := array_pipe.read_message(source)) is not None]) == 6:
        triangles, positions, *turned = said
        F = np.frombuffer(triangles, dtype=np.int32).reshape(-1, 3).astype(np.int64)
        found = check_shape(np.frombuffer(positions).reshape(-1, 3), F, _handle_turns(*turned))
        crossing = NOT_CHECKED if found.crossing is None else found.crossing.astype(np.int64).tobytes()
        array_pipe.write_message(sink, crossing)
        array_pipe.write_message(sink, np.array([*found.size, *found.hull[:2], *found.hull.sides]).tobytes())
        turns = [(turn.requested, math.nan if turn.held is None else turn.held) for turn in found.turns]
        array_pipe.write_message(sink, np.array(turns, dtype=float).tobytes())


def _handle_turns(before: bytes, labels: bytes, counts: bytes, poses: bytes) -> HandleTurns | None:
    if not before:
        return None
    ends = np.cumsum(np.frombuffer(counts, dtype=np.int64))[:-1]
    ways = np.split(np.frombuffer(poses).reshape(-1, 4, 4), ends)
    V = np.frombuffer(before).reshape(-1, 3)
    return HandleTurns(V, np.frombuffer(labels, dtype=np.int64), tuple(tuple(way) for way in ways))
