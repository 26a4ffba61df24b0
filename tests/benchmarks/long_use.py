"""What a window keeps of a long use: many openings, gestures and presses, one after the other.

    python tests/benchmarks/long_use.py [openings] [gestures] [presses] [undo memory in MiB]

Needs a display, such as `xvfb-run`. After each tenth a line tells of the window's process its memory (all
that is in the physical memory, what the C library has handed out, and what it keeps though it is free), its
handles, blocks of shared memory and threads, and its living objects; and the memory of the solver's process.
What the history of undo holds by its own count stands beside it. At last the free memory is given back.
"""

import ctypes
import gc
import sys
import tempfile
import time
from pathlib import Path

from PySide6.QtCore import QSettings
from PySide6.QtWidgets import QApplication

sys.path.insert(0, str(Path(__file__).parents[1] / "support"))
import resting
from long_sessions import resident
from meshes import rabbit, sample_bottle, sphere, tube

from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.model.state import State
from apd_viewer.session.processes.freed_memory import release_freed_memory
from apd_viewer.ui.application import make_application
from apd_viewer.ui.filing import file_controller
from apd_viewer.ui.filing.file_controller import UnsavedAnswer
from apd_viewer.ui.shell import Shell
from apd_viewer.ui.workbench import Workbench

FILES = 20
PAUSE = 3.0  # s; after two the solver gives freed memory back
SUFFIXES = ".obj", ".off", ".ply", ".stl", ".glb"


class Mallinfo(ctypes.Structure):
    _fields_ = tuple(
        (name, ctypes.c_size_t)
        for name in ("arena", "ordblks", "smblks", "hblks", "hblkhd", "usmblks", "fsmblks", "uordblks")
        + ("fordblks", "keepcost")
    )


def handed_out():
    """MiB that the C library has handed out, and that it keeps though nobody has them."""
    mallinfo2 = ctypes.CDLL(None).mallinfo2
    mallinfo2.restype = Mallinfo
    info = mallinfo2()
    return (info.uordblks + info.hblkhd) / 2**20, info.fordblks / 2**20


def files(folder):
    """Files of four kinds of meshes in five formats."""
    bottle = sample_bottle(edge=1.6)[:2]
    meshes = bottle, sphere(4), rabbit(4), tube(96, 64)
    found = []
    for k in range(FILES):
        V, F = meshes[k % len(meshes)]
        path = folder / f"{k}{SUFFIXES[k % len(SUFFIXES)]}"
        save_mesh(Mesh(V, F), (1.0 + 0.01 * k) * V, path)
        found.append(path)
    return found


def count(what):
    """Number of the handles or threads of this process."""
    return len(list(Path("/proc/self", what).iterdir()))


class Table:
    """Prints a line of figures for each tenth of a number of acts."""

    def __init__(self, window):
        self.window = window
        print(
            f"{'':16}  memory  handed out  kept free  undo, MiB | handles  shared  threads | objects  states"
            "  meshes  widgets  props | solver, MiB"
        )

    def run(self, title, times, act):
        every = max(1, times // 10)
        self.line(f"{title} 0")
        for k in range(times):
            act(k)
            if (k + 1) % every == 0:
                resting.settle(self.window)
                self.line(f"{title} {k + 1:,}")

    def line(self, title):
        time.sleep(PAUSE)
        QApplication.processEvents()
        gc.collect()
        out, free = handed_out()
        undo = self.window.session.gestures.history.undo_bytes / 2**20
        shared = sum(" /dev/shm/" in line for line in Path("/proc/self/maps").read_text().splitlines())
        objects = gc.get_objects()
        states, meshes = (sum(type(each) is kind for each in objects) for kind in (State, Mesh))
        child = self.window.session._worker._child
        solver = 0.0 if child is None else resident(child._process.pid)
        print(
            f"{title:16} {resident('self'):7.1f} {out:11.1f} {free:10.1f} {undo:10.1f} | "
            f"{count('fd'):7} {shared:7} {count('task'):8} | "
            f"{len(objects):7} {states:7} {meshes:7} {len(QApplication.allWidgets()):8} "
            f"{self.window.canvas.viewport.renderer.GetViewProps().GetNumberOfItems():6} | {solver:7.1f}",
            flush=True,
        )


def press(window, k):
    """Press a small ball in the dialog, and throw the results away."""
    window.runs.open_press()
    dialog = window.runs.dialogs["press"]
    dialog.steps.setValue(2)
    dialog.to.setValue(80 + k % 10)
    dialog.run.start.click()
    end = time.monotonic() + 120.0
    while dialog.run.is_running:
        assert time.monotonic() < end
        QApplication.processEvents()
        time.sleep(0.005)
    dialog.close()


def main():
    openings, gestures, presses, undo = ([*map(int, sys.argv[1:]), *(500, 3000, 30, 0)[len(sys.argv) - 1 :]])[
        :4
    ]
    file_controller.ask_before_leaving = lambda *_: UnsavedAnswer.DISCARD
    folder = Path(tempfile.mkdtemp())
    application = make_application([""])
    settings = QSettings(str(folder / "none.ini"), QSettings.Format.IniFormat)
    window = Workbench(Shell(settings), folder / "kept")
    window.shell.resize(1280, 800)
    window.shell.show()
    if undo:
        window.session.gestures.history.limit_memory(undo * 2**20)
    paths = files(folder)
    window.session.files.open_sample("bottle")
    while window.session.store.compiled_fraction != 1.0:
        application.processEvents()
        time.sleep(0.01)
    resting.settle(window)
    table = Table(window)

    def open_one(k):
        window.files.open_path(paths[k % len(paths)])
        resting.drawn(window)

    table.run("opening", openings, open_one)
    window.session.files.open_sample("bottle")
    resting.settle(window)
    table.run("gesture", gestures, lambda k: resting.gesture(window, k))
    window.session.files.open_mesh(Mesh(*sphere(2)))
    resting.settle(window)
    table.run("press", presses, lambda k: press(window, k))
    release_freed_memory()
    table.line("free given back")
    window.session.gestures.history.limit_memory(0)
    table.line("no undo")
    release_freed_memory()
    table.line("free given back")
    window.shell.close()
    application.processEvents()


if __name__ == "__main__":
    main()
