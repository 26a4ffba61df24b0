"""What a window does while it rests: events, wakings and processor time, in each state it can be in.

    python tests/benchmarks/idle.py [seconds] [words of a state]

Needs a display, such as `xvfb-run`. The window is taken from state to state; in each it is left alone. The
processor's time is that of the window's process and of all that have come from it, in percent of one core;
wakings are those of the threads of all of them. Prints a line a state, and the largest at the end.
"""

import os
import sys
import tempfile
import time
from pathlib import Path

from PySide6.QtCore import QSettings

sys.path.insert(0, str(Path(__file__).parents[1] / "support"))
import resting
from process_tree import tree_of

from apd_viewer.ui.application import make_application
from apd_viewer.ui.filing import file_controller
from apd_viewer.ui.filing.file_controller import UnsavedAnswer
from apd_viewer.ui.shell import Shell
from apd_viewer.ui.workbench import Workbench

ALLOWED = 2.0  # percent of a core
GESTURES = 300
_TICKS = os.sysconf("SC_CLK_TCK")


def spent(pid):
    """Processor time of a process in seconds, and how often its threads were woken."""
    try:
        words = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
        wakings = sum(
            int(status.read_text().split("\nvoluntary_ctxt_switches:")[1].split()[0])
            for status in Path(f"/proc/{pid}/task").glob("*/status")
        )
    except OSError:
        return 0.0, 0
    return (int(words[11]) + int(words[12])) / _TICKS, wakings


def main():
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 10.0
    wanted = sys.argv[2] if len(sys.argv) > 2 else ""
    file_controller.ask_before_leaving = lambda *_: UnsavedAnswer.DISCARD
    folder = Path(tempfile.mkdtemp())
    application = make_application([""])
    window = Workbench(
        Shell(QSettings(str(folder / "none.ini"), QSettings.Format.IniFormat)), folder / "kept"
    )
    window.shell.resize(1280, 800)
    window.shell.show()
    window.session.files.open_sample("bottle")
    while window.session.store.compiled_fraction != 1.0:
        application.processEvents()
        time.sleep(0.01)
    resting.settle(window)
    watch, most = resting.Watch(), []
    print(f"{'':34}   window    others   wakings      paints  timers  other events")
    for name in resting.states(window, folder, GESTURES):
        if wanted not in name:
            continue
        watch.wait(4.0)  # a shape that rests is checked once, in a process
        others = set(tree_of(os.getpid())) - {os.getpid()}
        before = [spent(os.getpid()), *map(spent, others)]
        began = time.monotonic()
        counts = watch.count(seconds)
        took = time.monotonic() - began
        after = [spent(os.getpid()), *map(spent, others)]
        own, rest = (
            after[0][0] - before[0][0],
            sum(b[0] - a[0] for a, b in zip(before[1:], after[1:], strict=True)),
        )
        woken = sum(b[1] - a[1] for a, b in zip(before, after, strict=True))
        paints = sum(n for (_, kind), n in counts.items() if kind == "Paint")
        timers = sum(n for (_, kind), n in counts.items() if kind == "Timer")
        others_ = sum(counts.values()) - paints - timers
        most.append((100 * (own + rest) / took, name))
        said = ", ".join(f"{n} {who}.{kind}" for (who, kind), n in counts.most_common(3))
        print(
            f"{name:34} {100 * own / took:6.2f} % {100 * rest / took:6.2f} % {woken / took:7.1f}/s "
            f"{paints / took:8.1f}/s {timers / took:5.1f}/s {others_ / took:5.1f}/s  {said}",
            flush=True,
        )
    print(f"largest: {max(most)[0]:.2f} % ({max(most)[1]}); allowed are {ALLOWED} %")
    window.shell.close()
    application.processEvents()


if __name__ == "__main__":
    main()
