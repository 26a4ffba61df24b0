"""Main function of the factor process.

Factoring holds the interpreter lock for seconds and cannot be interrupted, except by killing its process.
"""

from typing import BinaryIO

import numpy as np

from apd_viewer.geometry.linalg.linear_solver import LinearSolver
from apd_viewer.session.processes import array_pipe
from apd_viewer.session.processes.child_boot import run_service

_NICENESS = 10  # displayed frames have priority


def main(reply_descriptor: int) -> None:
    """Answer the parent process; ``reply_descriptor`` is the descriptor for replies."""
    run_service(reply_descriptor, serve, _NICENESS)


def serve(source: BinaryIO, sink: BinaryIO) -> None:
    """Factor one matrix from ``source``, then solve until ``source`` ends.

    A matrix are four messages: where its rows start, columns, entries, and the positions of its unknowns. The
    word on it is empty, or says what is wrong with it. After that every two messages are a byte, 1 for a
    refined solution, and a right-hand side (n, 3); the answer is the solution.
    """
    parts = [array_pipe.read_message(source) for _ in range(4)]
    if None in parts:
        return
    start, column, entry, V = (
        np.frombuffer(bytearray(part or b""), dtype)  # cholespy accepts no read-only arrays
        for part, dtype in zip(parts, (np.int32, np.int32, np.float64, np.float64), strict=True)
    )
    try:
        factor = LinearSolver.from_rows(start, column, entry, V.reshape(-1, 3))
    except Exception as error:
        array_pipe.write_message(sink, (str(error) or type(error).__name__).encode())
        return
    del parts, start, column, entry, V
    array_pipe.write_message(sink, b"")
    while (refined := array_pipe.read_message(source)) and (
        message := array_pipe.read_message(source)
    ) is not None:
        solve = factor.solve_refined if refined[0] else factor.solve
        array_pipe.write_message(sink, solve(np.frombuffer(bytearray(message)).reshape(-1, 3)))
