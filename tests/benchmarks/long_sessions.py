"""What a long session with the solver's process comes to: random verbs on two meshes, and a very long drag.

    python tests/benchmarks/long_sessions.py [interleavings] [events]

Raises AssertionError where a frame of another mesh or of an undone pose is seen, or nothing comes any more.
Prints the memory of both processes as the drag goes on.
"""

import os
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "support"))
import interleavings
from driven_session import Driven
from meshes import rotation, sample_bottle

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, HANDLE


def resident(pid: int | str) -> float:
    """MiB of a process in memory."""
    return int(Path(f"/proc/{pid}/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 2**20


def drag(events: int) -> None:
    """Drag the sample bottle's handle to and fro."""
    V, F, labels = sample_bottle(1.13)
    session = Driven()
    session.show_now(Mesh(V, F))
    for label in (BASE, HANDLE):
        session.stroke(np.flatnonzero(labels == label), label)
    session.gestures.begin()
    pose = np.eye(4)
    for k in range(events + 1):
        pose[:3, :3] = rotation([0, 1, 0], np.sin(0.02 * k))
        session.handles.drag(pose)
        session.receive_results()
        del session.changes[:]
        time.sleep(0.003)
        if k % (events // 10) == 0:
            pid = session._worker._child._process.pid
            print(f"{k:7,} events: {resident('self'):7.1f} + {resident(pid):7.1f} MiB", flush=True)
    session.gestures.cancel()
    session.close()


def main() -> None:
    times = int(sys.argv[1]) if len(sys.argv) > 1 else 500
    events = int(sys.argv[2]) if len(sys.argv) > 2 else 10_000
    started = time.perf_counter()
    frames = interleavings.play(times)
    print(f"{times} interleavings, {frames:,} frames, {time.perf_counter() - started:.0f} s")
    drag(events)


if __name__ == "__main__":
    main()
