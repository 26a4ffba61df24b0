"""How a drag of a large mesh goes, and how soon it goes on when the solver's process is killed in the middle.

    python tests/benchmarks/killed.py [length of the edges] [kills]

Poses come 60 times a second, as from a hand. With edges of 0.141, the default, the sample bottle has 655,000
vertices. "Goes on" is the time from the kill to the first shape of the next process; "jump" how far the shape
has moved meanwhile, in lengths of the mesh. At last the hand rests, and the full resolution follows.
"""

import os
import signal
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "support"))
from driven_session import Driven
from meshes import rotation, sample_bottle

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, HANDLE

RATE = 60.0
SPEED = 0.24  # radians a second


class Hand:
    """Turns the handle of a session, a little with every call."""

    def __init__(self, session: Driven) -> None:
        self.session = session
        self.angle = 0.0

    def move(self) -> None:
        self.angle += SPEED / RATE
        pose = np.eye(4)
        pose[:3, :3] = rotation([0, 1, 0], self.angle)
        self.session.handles.drag(pose)
        self.session.receive_results()
        time.sleep(1.0 / RATE)

    def move_until(self, happened) -> float:
        """Seconds that it took."""
        since = time.monotonic()
        while not happened():
            self.move()
            assert time.monotonic() - since < 120.0, self.session.failed
        return time.monotonic() - since

    def drag(self, seconds: float) -> None:
        """Print how often another shape was there, and how far its area was off at worst."""
        shown, frames, worst, longest = self.session.U, 0, 0.0, 0.0
        since = last = time.monotonic()
        while time.monotonic() - since < seconds:
            self.move()
            if self.session.U is not shown:
                shown, frames, now = self.session.U, frames + 1, time.monotonic()
                worst = max(worst, abs(self.session.store.state.frame.area_error))
                longest, last = max(longest, now - last), now
        print(
            f"drag: {frames / seconds:4.1f} shapes a second, at most {longest:.2f} s apart, area {worst:.0e}"
        )


def pid_of(session: Driven) -> int | None:
    child = session._worker._child
    return child and child._process.pid


def main(edge: float = 0.141, kills: int = 10) -> None:
    V, F, labels = sample_bottle(edge)
    length = np.ptp(V, axis=0).max()
    session = Driven()
    session.show_now(Mesh(V, F))
    print(f"{len(V):,} vertices")
    session.stroke(np.flatnonzero(labels == BASE), BASE)
    session.listen(8.0)  # the second stroke comes later than the first
    session.stroke(np.flatnonzero(labels == HANDLE), HANDLE)
    session.gestures.begin()
    hand, before = Hand(session), session.U
    print(f"first shape after {hand.move_until(lambda: session.U is not before):.2f} s")
    for _ in range(2):
        hand.drag(4.0)
    took = []
    for k in range(kills):
        document, pid = session.store.state.document, pid_of(session)
        os.kill(pid, signal.SIGKILL)
        since = time.monotonic()
        assert session.store.state.document is document
        hand.move_until(lambda pid=pid: pid_of(session) not in (pid, None))
        session.listen(0.05)  # what the last one had said already
        before = session.U
        hand.move_until(lambda before=before: session.U is not before)
        took.append(time.monotonic() - since)
        jump = np.abs(session.U - before).max() / length
        print(f"kill {k + 1}: goes on after {took[-1]:.2f} s, jump {jump:.3f}", flush=True)
        if k % 3 == 2:
            hand.drag(2.0)
    if took:
        print(f"goes on after {np.median(took):.2f} s (median), {max(took):.2f} s at most")
    session.gestures.end("Move handle")
    rested, shown = time.monotonic(), session.U
    while time.monotonic() - rested < 30.0 and not session.store.state.frame.settled:
        session.listen(0.01)
        if session.U is not shown:
            step, shown = np.abs(session.U - shown).max() / length, session.U
            at_rest = time.monotonic() - rested
            print(
                f"  {at_rest:5.2f} s at rest: moved {step:.4f}, "
                f"area {session.store.state.frame.area_error:.0e}"
            )
    session.close()


if __name__ == "__main__":
    main(*(kind(given) for kind, given in zip((float, int), sys.argv[1:], strict=False)))
