"""From the first start after an installation to the first picture, and to the first solved shape of a drag.

    python tests/benchmarks/first_drag.py [--none] [PYTHON ...]

Needs a display. PYTHON is that of an environment with apd-viewer, by default this one. It is started twice,
in a home of its own: the second start finds what the first has left. With ``--none`` no kernel is there at
first, as after the installation of a wheel without any. A handle is turned by 5 degrees three seconds after
the window is ready.
"""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

# Watches the program from outside: it knows nothing of being measured.
WATCHED = """
import os, sys, time
from apd_viewer.__main__ import main
from apd_viewer.ui import application

sessions, pictures = [], []

def swapped():
    if not pictures:
        pictures.append(time.time())
        print("picture", pictures[0], flush=True)

def made(argv, make=application.make_application):
    made = make(argv)
    from PySide6.QtCore import QTimer
    from apd_viewer.ui.scene.viewport import Viewport
    from apd_viewer.ui.tools.canvas import Canvas
    timer = QTimer(made, interval=5)

    def open_viewport(self, *args, begin=Viewport.__init__, **named):
        begin(self, *args, **named)
        self.frameSwapped.connect(swapped)

    Viewport.__init__ = open_viewport

    def look():
        if sessions[0].store.state.frame.iteration:
            print("solved", time.time(), flush=True)
            os._exit(0)

    def drag():
        from apd_viewer.geometry.pose.transforms import rotation_about
        session = sessions[0]
        print("dragged", time.time(), flush=True)
        session.gestures.begin()
        session.handles.drag(rotation_about([0.0, 0.0, 0.0], [0.0, 1.0, 0.0], 0.087), 0)
        timer.timeout.connect(look)
        timer.start()

    def show_state(self, *args, show=Canvas.show_state):
        show(self, *args)
        if not sessions:
            from apd_viewer.ui.workbench import Workbench
            sessions.extend(w.session for w in workbenches)
            print("ready", time.time(), flush=True)
            QTimer.singleShot(3000, drag)

    workbenches = []

    def loaded():
        import apd_viewer.ui.workbench as module
        def begin(self, *args, begin=module.Workbench.__init__, **named):
            workbenches.append(self)
            begin(self, *args, **named)
        module.Workbench.__init__ = begin

    Canvas.show_state = show_state
    from apd_viewer.ui.background_imports import BackgroundImports
    def run(self, run=BackgroundImports._run):
        import apd_viewer.ui.workbench
        loaded()
        run(self)
    BackgroundImports._run = run
    return made

application.make_application = made
sys.argv = ["apd-viewer"]
main()
"""


def moments(python: str, home: Path, **environment: str) -> dict[str, float]:
    """Seconds from the start to the moments that the program prints."""
    began = time.time()
    own = {"HOME": str(home), "XDG_CONFIG_HOME": str(home), "QT_API": "pyside6"} | environment
    command = [python, "-c", WATCHED]
    done = subprocess.run(
        command, env=os.environ | own, stdout=subprocess.PIPE, text=True, check=False, timeout=300
    )
    said = done.stdout
    return {name: float(at) - began for name, at in (line.split() for line in said.splitlines())}


def main() -> None:
    """Print a row for each start."""
    words = sys.argv[1:]
    none = "--none" in words
    for python in [word for word in words if word != "--none"] or [sys.executable]:
        with tempfile.TemporaryDirectory() as home, tempfile.TemporaryDirectory() as kernels:
            for start in ("first", "second"):
                found = moments(python, Path(home), **({"NUMBA_CACHE_DIR": kernels} if none else {}))
                row = "  ".join(
                    f"{name} {found[name]:5.1f} s" for name in ("picture", "ready", "dragged", "solved")
                )
                print(f"{start:7} {row}  drag {found['solved'] - found['dragged']:5.2f} s", flush=True)


if __name__ == "__main__":
    main()
