"""How long the event loop of a window is kept waiting while a large mesh is factored, iterated and painted.

    python tests/benchmarks/event_loop_gaps.py [length of the edges]

A timer of 5 ms runs in an application that draws nothing; the gaps between its ticks are what a user would
feel. Beside them stand those of a process that does nothing but sleep for 5 ms at a time: what the machine
itself did to everybody meanwhile. With edges of 0.141, the default, the sample bottle has 655,000 vertices.
Prints the largest memory of the processes too, where the system tells.
"""

import gc
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
from PySide6.QtCore import QCoreApplication, QObject, Qt, QTimer, Signal

sys.path.insert(0, str(Path(__file__).parents[1] / "support"))
from meshes import rotation, sample_bottle

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE
from apd_viewer.session.session import Session
from apd_viewer.session.state_store import Listener
from apd_viewer.ui.application import SWITCH_INTERVAL, GuiThreadGC

SLEEPER = """
import select, sys, time
gaps, last = [], time.perf_counter()
while True:
    time.sleep(0.005)
    now = time.perf_counter()
    gaps.append(now - last)
    last = now
    if select.select([sys.stdin], [], [], 0)[0]:
        if not sys.stdin.readline():
            break
        gaps.sort()
        print(gaps[int(0.99 * len(gaps))], gaps[-1], flush=True)
        gaps.clear()
"""
EVENTS = 120  # of the mouse, in each measurement
EVERY = 1 / 60  # s


class Loop(QObject):
    """An event loop with a session, and the times at which its timer ticked."""

    woken = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.session = Session(
            Listener(self.woken.emit, lambda *_: None, lambda: None, self.say, lambda said: self.say(said))
        )
        self.woken.connect(self.session.receive_results, Qt.ConnectionType.QueuedConnection)
        self.ticks: list[float] = []
        self.timer = QTimer(self)
        self.timer.setTimerType(Qt.TimerType.PreciseTimer)
        self.timer.timeout.connect(lambda: self.ticks.append(time.perf_counter()))
        self.timer.start(5)
        self.sleeper = subprocess.Popen(
            [sys.executable, "-c", SLEEPER], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )

    def compared(self) -> tuple[float, float]:
        """The 99th percentile and the largest of the sleeper's gaps since this was asked last."""
        self.sleeper.stdin.write("\n")
        self.sleeper.stdin.flush()
        return tuple(map(float, self.sleeper.stdout.readline().split()))

    def say(self, sentence: str) -> None:
        print(" ", sentence)

    def run(self, title, done=lambda: True, event=lambda _: None, seconds=120.0, events=EVENTS) -> None:
        """Send mouse events until ``events`` are sent and it is done; prints the gaps."""
        self.compared()
        self.ticks.clear()
        begun, sent = time.perf_counter(), 0
        while time.perf_counter() - begun < seconds:
            if sent < events and time.perf_counter() - begun >= sent * EVERY:
                event(sent)
                sent += 1
            if sent == events and done():
                break
            QCoreApplication.processEvents()
            time.sleep(0.0002)
        gaps = np.diff(self.ticks)
        p50, p99, most = 1e3 * np.quantile(gaps, [0.5, 0.99, 1.0])
        asleep = "p99 {:5.1f}  max {:6.1f}".format(*(1e3 * gap for gap in self.compared()))
        print(
            f"{title:32} {len(gaps):6} ticks  p50 {p50:4.1f}  p99 {p99:5.1f}  max {most:6.1f} ms"
            f"   (asleep {asleep})",
            flush=True,
        )


def peak(pid: int | str) -> str:
    try:
        status = Path(f"/proc/{pid}/status").read_text()
        return f"{int(status.split('VmHWM:')[1].split()[0]) / 2**20:.2f} GiB"
    except (OSError, IndexError):
        return "unknown"


def main() -> None:
    application = QCoreApplication([])
    collector = GuiThreadGC(application)
    sys.setswitchinterval(SWITCH_INTERVAL)
    gc.freeze()  # as the window does
    edge = float(sys.argv[1]) if len(sys.argv) > 1 else 0.141
    V, F, labels = sample_bottle(edge)
    print(f"{len(V):,} vertices")
    loop = Loop()
    session = loop.session
    mesh = Mesh(V, F)
    loop.run("nothing")
    session.files.open_mesh(mesh)
    loop.run("open", lambda: session.jobs.current is None, events=0)

    def stroke(ids, label):
        session.gestures.begin()
        session.painting.paint(ids, label)
        session.painting.end_stroke("Paint")

    def twisted(angle):
        pose = np.eye(4)
        pose[:3, :3] = rotation([0, 1, 0], angle)
        return pose

    stroke(np.flatnonzero(labels == BASE), BASE)
    stroke(np.flatnonzero(labels == HANDLE), HANDLE)
    session.gestures.begin()
    loop.run(
        "drag: start, factor, first frame",
        lambda: session.store.state.frame.iteration,
        lambda k: session.handles.drag(twisted(0.002 * k)),
    )
    loop.run("drag: iterate", event=lambda k: session.handles.drag(twisted(0.2 + 0.002 * k)))
    session.gestures.end("Move handle")
    loop.run("iterate", events=8 * EVENTS)
    pid = session._worker._child._process.pid
    children = Path(f"/proc/{pid}/task/{pid}/children")
    factor = " and ".join(peak(child) for child in children.read_text().split()) if children.exists() else "?"
    order = np.argsort(V[:, 1])
    free = order[labels[order] == FREE]
    brush = (
        [free[k : k + 2000] for k in range(0, 2000 * EVENTS, 2000)] if len(free) > 2000 * EVENTS else [free]
    )

    def paint(k):
        session.painting.paint(brush[k % len(brush)], BASE)

    session.gestures.begin()
    loop.run("paint while it is iterated", event=paint)
    session.painting.end_stroke("Paint")
    session.gestures.begin()
    loop.run("paint while it is factored", event=paint)
    session.gestures.cancel()
    session.settings.change(method="local")
    session.settings.change(method="exact")
    session.gestures.begin()
    session.handles.drag(twisted(0.5))
    session.gestures.end("Move handle")
    first = session.store.state.frame
    loop.run("factor again, iterate", lambda: session.store.state.frame is not first)
    print(f"peak memory: {peak('self')} here, {peak(pid)} where it is solved, {factor} where it is factored")
    session.close()
    loop.sleeper.communicate()
    collector.close()


if __name__ == "__main__":
    main()
