"""How long the first shape of a drag takes on a large mesh, and how much memory all processes share.

    python tests/benchmarks/first_shape.py FILE|EDGE [seconds] [shapes] [stroke] [--window]

A session without a window, or with one, reads and opens the FILE, or the sample bottle with edges of that
length, such as 0.141 for 655,000 vertices. The ends of its longest side are painted, and after some seconds,
10 by default, one of them is turned by a degree at each event of the mouse, until so many shapes have come,
by default 5. Each end takes ``stroke`` seconds to paint, by default none. In a window a shape has come once
it is drawn, and what drawing the same shape again takes is told, too.
"""

import os
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from event_loop_gaps import EVERY, Loop, rotation, sample_bottle
from PySide6.QtCore import QCoreApplication, QSettings

from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, HANDLE
from apd_viewer.geometry.pose.frame import Frame
from apd_viewer.ui.application import make_application
from apd_viewer.ui.shell import Shell
from apd_viewer.ui.workbench import Workbench

END = 0.04  # of the longest side, that is painted at each end


def used_memory() -> str:
    """Memory of this process and its descendants in GiB, shared pages counted once."""
    children: dict[int, list[int]] = {}
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            parent = int(stat.read_text().rsplit(")", 1)[1].split()[1])
        except OSError:
            continue
        children.setdefault(parent, []).append(int(stat.parent.name))
    own, whole = [os.getpid()], 0.0
    for pid in own:
        own += children.get(pid, [])
        try:
            said = Path(f"/proc/{pid}/smaps_rollup").read_text()
        except OSError:
            continue
        whole += int(said.split("\nPss:")[1].split()[0]) / 2**20
    return f"{whole:5.2f} GiB"


class Clock:
    """Prints what took how long, and the memory then."""

    def __init__(self) -> None:
        self.began = time.perf_counter()

    def tell(self, what: str) -> None:
        took = time.perf_counter() - self.began
        print(f"{what:24} {took:7.2f} s  {used_memory()}", flush=True)
        self.began = time.perf_counter()


def has_moved(frame: Frame, before: np.ndarray) -> bool:
    """Whether it is a frame of the solver, of another shape."""
    return frame.iteration > 0 and frame.U is not before


def open_window() -> Workbench:
    """A shown window with settings of its own."""
    settings = QSettings(tempfile.mkdtemp() + "/none.ini", QSettings.Format.IniFormat)
    window = Workbench(Shell(settings))
    window.shell.resize(1280, 800)
    window.shell.show()
    return window


def main(
    source: str, pause: float = 10.0, shapes: int = 5, stroke: float = 0.0, in_window: bool = False
) -> None:
    """Print what each step takes."""
    _application = make_application([]) if in_window else QCoreApplication([])
    clock = Clock()
    mesh = open_mesh(source) if Path(source).exists() else Mesh(*sample_bottle(float(source))[:2])
    clock.tell("read")
    print(f"{len(mesh.V):,} vertices, {len(mesh.F):,} triangles")
    loop = None if in_window else Loop()
    window = open_window() if in_window else None
    view = window.canvas.viewport if window else None
    session = window.session if window else loop.session

    def is_drawn() -> bool:
        return view is None or (view.draw_count > 0 and not view.is_stale)

    def until(done, event=lambda: None) -> None:
        last = 0.0
        while not done():
            if time.perf_counter() - last >= EVERY:
                last = time.perf_counter()
                event()
            QCoreApplication.processEvents()
            time.sleep(0.0005)

    def wait(seconds: float) -> None:
        ends = time.perf_counter() + seconds
        until(lambda: time.perf_counter() >= ends)

    until(is_drawn)
    session.files.open_mesh(mesh)
    until(lambda: session.jobs.current is None and session.store.state is not None and is_drawn())
    clock.tell("opened")
    axis = int(np.argmax(np.ptp(mesh.V, axis=0)))
    along = (mesh.V[:, axis] - mesh.V[:, axis].min()) / np.ptp(mesh.V[:, axis])
    for ids, label in ((along < END, BASE), (along > 1.0 - END, HANDLE)):
        wait(stroke)
        session.gestures.begin()
        session.painting.paint(np.flatnonzero(ids), label)
        session.painting.end_stroke("Paint")
    clock.tell("painted")
    wait(pause)
    clock.tell("waited")
    if view is not None:
        view.screenshot()
        clock.tell("drawn again")
    session.gestures.begin()
    turned = 0

    def drag() -> None:
        nonlocal turned
        turned += 1
        pose = np.eye(4)
        pose[:3, :3] = rotation(np.eye(3)[axis], np.radians(turned))
        session.handles.drag(pose)

    for k in range(shapes):
        before = session.store.state.frame.U
        until(lambda before=before: has_moved(session.store.state.frame, before) and is_drawn(), drag)
        clock.tell(f"shape {k + 1}")
    if window is not None:
        window.files.may_discard_work = lambda *_, **__: True
        window.shell.close()
    else:
        session.close()
        loop.sleeper.communicate()


if __name__ == "__main__":
    words = [word for word in sys.argv[1:] if word != "--window"]
    numbers = (kind(given) for kind, given in zip((float, int, float), words[1:], strict=False))
    main(words[0], *numbers, in_window="--window" in sys.argv)
