"""What is lost when the whole program is killed, with its window, at random moments while it is used.

    python tests/benchmarks/killed_program.py [kills]

The program is the real one, in a home and on a display of its own. A hand in it paints, drags, types, sweeps,
bakes, undoes and redoes, and writes down each gesture that is finished. After SIGKILL nothing of the program
may live on, and the next one must offer what was left; its hand presses Restore, and says what has come. Then
it goes on from there, until it is killed too. Prints a line a kill: how many finished gestures were lost, how
long before the kill the oldest of them was finished, and how soon the last of the processes had gone.
"""

import argparse
import hashlib
import json
import os
import random
import runpy
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "support"))
from process_tree import tree_of

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT))

SEED = 7
LONGEST = 10.0  # s that a program is used
PATIENCE = 90.0  # s, for a program to start on a busy machine


# In the program: a hand, and what it writes down


class Journal:
    """Lines that are there even if the next moment is the last."""

    def __init__(self, path: Path) -> None:
        self._file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_APPEND)

    def write(self, *words: object) -> None:
        os.write(self._file, (" ".join(map(str, words)) + "\n").encode())


def digest(document) -> str:
    """A word for all that a document says, the mesh with it."""
    from apd_viewer.session.storage.session_json import document_to_json

    arrays = document.mesh.V, document.mesh.F, document.labels, document.member, document.initial_positions
    said = hashlib.sha1(json.dumps(document_to_json(document)).encode())
    for array in arrays:
        said.update(array.tobytes())
    return said.hexdigest()[:16]


class Hand:
    """Uses a window like somebody who is in a hurry; each deed gives the seconds to wait until it goes on."""

    def __init__(self, window, journal: Journal, chance: random.Random) -> None:
        from driving import Mouse

        self.window, self.journal, self.chance = window, journal, chance
        self.mouse = Mouse(window.canvas.viewport)
        self._note_what_is_kept()

    @property
    def document(self):
        return self.window.session.store.state.document

    def work(self) -> Iterator[float]:
        self.journal.write("opened", digest(self.document))
        yield from self._restore()
        deeds = (
            *(self._paint, self._paint, self._drag, self._drag, self._drag, self._type, self._type),
            *(self._sweep, self._sweep, self._bake, self._go_back, self._go_back, self._open),
        )
        self.window.help.close()
        self.journal.write("begun")
        while True:
            deed = self.chance.choice(deeds)
            yield from deed()
            self.journal.write("done", digest(self.document), time.monotonic(), deed.__name__[1:])
            yield self.chance.uniform(0.0, 0.3)

    def _note_what_is_kept(self) -> None:
        """What is being written may be found, though the hand has not come to write down that it is done."""
        from apd_viewer.session.autosave import AutosaveWriter

        put = AutosaveWriter.put

        def noted(backup, copy, patience) -> None:
            self.journal.write("kept", digest(copy.state.document))
            put(backup, copy, patience)

        AutosaveWriter.put = noted

    def _restore(self) -> Iterator[float]:
        offer, before = self.window.recovery, self.document
        if not offer.text:
            self.journal.write("nothing")
            return
        self._click(offer.restore)
        while self.document is before and not self.window.notice.text.startswith("The unsaved work"):
            yield 0.005
        trouble = self.window.notice.text if self.document is before else self._broken()
        self.journal.write(*(("trouble", trouble) if trouble else ("restored", digest(self.document))))

    def _broken(self) -> str:
        """What is wrong with the shape that has been restored; empty where nothing is."""
        import numpy as np

        frame, mesh = self.window.session.store.state.frame, self.document.mesh
        if frame.U.shape != mesh.V.shape or not np.isfinite(frame.U).all():
            return "no shape of the mesh"
        size = np.ptp(mesh.V, axis=0).max()
        return "torn" if np.ptp(frame.U, axis=0).max() > 3.0 * size else ""

    def _click(self, button) -> None:
        from driving import Mouse, centre

        Mouse(button).drag(centre(button))

    def _paint(self) -> Iterator[float]:
        import numpy as np

        from apd_viewer.ui.tools.tool_modes import Tool

        tools = Tool.BASE, Tool.HANDLE, Tool.REGION, Tool.ERASE
        self.window.actions_.tools[self.chance.choice(tools)].trigger()
        view, U = self.window.canvas.viewport, self.window.session.store.state.frame.U
        x, y = view.camera_controller.camera.project(U[[self.chance.randrange(len(U))]])[0]
        points = [(x + dx, y) for dx in np.linspace(0.0, self.chance.uniform(-60.0, 60.0), 6)]
        self.mouse.press(points[0])
        for point in points[1:]:
            yield 0.01
            self.mouse.move(point)
        self.mouse.release(points[-1])

    def _drag(self) -> Iterator[float]:
        from driving import ring_grip

        from apd_viewer.ui.tools.tool_modes import Tool

        self.window.actions_.tools[Tool.MOVE].trigger()
        if not self.window.canvas.gizmo.visible:
            return
        x, y = ring_grip(self.window, self.chance.randrange(3))
        dx, dy = self.chance.uniform(-3.0, 3.0), self.chance.uniform(-3.0, 3.0)
        self.mouse.move((x, y))
        self.mouse.press((x, y))
        for k in range(1, 10):
            yield 0.016
            self.mouse.move((x + k * dx, y + k * dy))
        self.mouse.release((x + 9 * dx, y + 9 * dy))

    def _type(self) -> Iterator[float]:
        from PySide6.QtCore import Qt
        from PySide6.QtTest import QTest

        self.window.actions_.pose.enter_motion.trigger()
        amount = self.window.panel.handles.motion.amount
        if amount.isEnabled():
            yield 0.02
            amount.clear()
            QTest.keyClicks(amount, f"{self.chance.uniform(-25.0, 25.0):.2f}deg")
            QTest.keyClick(amount, Qt.Key.Key_Return)

    def _sweep(self) -> Iterator[float]:
        from driving import Mouse

        slider = self.chance.choice([self.window.panel.handles.falloff, self.window.panel.area.target]).slider
        mouse, middle = Mouse(slider), slider.height() / 2
        start, end = (self.chance.uniform(0.35, 0.6) * slider.width() for _ in range(2))
        mouse.press((start, middle))
        for k in range(1, 8):
            yield 0.016
            mouse.move((start + k * (end - start) / 7, middle))
        mouse.release((end, middle))

    def _bake(self) -> Iterator[float]:
        if self.window.actions_.bake.isEnabled():
            yield from self._another_mesh(self.window.actions_.bake.trigger)

    def _open(self) -> Iterator[float]:
        """Begin anew: what is baked again and again is nobody's work any more."""
        name = self.chance.choice(["bottle", "duck"])
        yield from self._another_mesh(lambda: self.window.session.files.open_sample(name))

    def _another_mesh(self, ask) -> Iterator[float]:
        mesh, since = self.document.mesh, time.monotonic()
        ask()
        while self.document.mesh is mesh and time.monotonic() - since < 2.0:
            yield 0.005

    def _go_back(self) -> Iterator[float]:
        for _ in range(self.chance.randrange(1, 4)):
            actions = self.window.actions_.undo, self.window.actions_.redo, self.window.actions_.undo
            self.chance.choice(actions).trigger()
            yield 0.03


def play(journal: Path, seed: int) -> None:
    """Run the program with a hand in it."""
    from apd_viewer.ui.application import make_application

    application = make_application(["apd-viewer"])
    from PySide6.QtCore import QTimer

    timer = QTimer(singleShot=True)
    deeds: list[Iterator[float]] = []

    def go_on() -> None:
        if not deeds:
            # By its name: to import it here would keep the program from its first picture.
            children = (child for widget in application.topLevelWidgets() for child in widget.children())
            window = next((child for child in children if type(child).__name__ == "Workbench"), None)
            session = window and window.session
            if not session or session.store.state is None or session.jobs.current is not None:
                timer.start(10)
                return
            deeds.append(Hand(window, Journal(journal), random.Random(seed)).work())
        timer.start(round(1e3 * next(deeds[0])))

    timer.timeout.connect(go_on)
    timer.start(10)
    sys.argv[:] = ["apd-viewer"]
    runpy.run_module("apd_viewer", run_name="__main__")


# Outside: what kills, and looks at what is left


def alive(pid: int) -> bool:
    """Whether it is there, and not one of the dead who nobody has looked after yet."""
    try:
        return bool(Path(f"/proc/{pid}/cmdline").read_bytes())
    except OSError:
        return False


def blocks(pids: set[int]) -> set[Path]:
    """The shared memory that processes have."""
    found = set()
    for pid in pids:
        try:
            lines = Path(f"/proc/{pid}/maps").read_text().splitlines()
        except OSError:
            continue
        found |= {Path(line.split()[5]) for line in lines if " /dev/shm/" in line and "deleted" not in line}
    return found


class Work:
    """What was done in programs that were killed one after the other, each going on from what was left.

    Parameters
    ----------
    home : Path
    display : str
    """

    def __init__(self, home: Path, display: str) -> None:
        self._home = home
        self._programs = 0
        # What was there; of what was finished, how long before its program was killed.
        self._log: list[tuple[str, float | None]] = []
        self._owed = False
        runtime = home / "runtime"
        runtime.mkdir(mode=0o700)
        self._environment = {
            **{name: word for name, word in os.environ.items() if name != "WAYLAND_DISPLAY"},
            **{f"XDG_{name}_HOME": str(home / name.lower()) for name in ("CONFIG", "DATA", "CACHE", "STATE")},
            "HOME": str(home),
            "XDG_RUNTIME_DIR": str(runtime),
            "DISPLAY": display,
            "QT_QPA_PLATFORM": "xcb",
            "XDG_SESSION_TYPE": "x11",
            "PYTHONPATH": str(ROOT),
        }

    def kill_one(self, seed: int, word: str, after: float) -> tuple[str, int, float, float]:
        """Start a program, and kill it so many seconds after its hand has written down a word.

        What it found of the one before; how many gestures of that had been lost, and how long before its
        kill the oldest of them; and how soon after the kill of this one the last of its processes had gone.
        """
        self._programs += 1
        journal = self._home / f"journal-{self._programs}"
        command = [sys.executable, __file__, "--play", str(journal), str(seed)]
        with (self._home / f"errors-{self._programs}").open("wb") as errors:
            program = subprocess.Popen(command, env=self._environment, stderr=errors, cwd=self._home)
        try:
            self._wait_for(word, journal, program)
            time.sleep(after)
            pids = set(tree_of(program.pid))
            shared = blocks(pids)
            assert program.poll() is None, f"it ended by itself: see {self._home}"
        finally:
            killed = time.monotonic()
            program.kill()
            program.wait()
        gone = self._wait_until_gone(pids, shared, killed)
        return *self._read(journal, killed), gone

    def _wait_for(self, word: str, journal: Path, program: subprocess.Popen) -> None:
        end = time.monotonic() + PATIENCE
        while not (journal.exists() and word in journal.read_text()):
            assert program.poll() is None, f"it ended by itself: see {self._home}"
            assert time.monotonic() < end, f"it does not start: see {self._home}"
            time.sleep(0.01)

    def _wait_until_gone(self, pids: set[int], shared: set[Path], killed: float) -> float:
        while left := [*(pid for pid in pids if alive(pid)), *(block for block in shared if block.exists())]:
            assert time.monotonic() - killed < PATIENCE, f"they live on: {left}"
            time.sleep(0.005)
        return time.monotonic() - killed

    def _read(self, journal: Path, killed: float) -> tuple[str, int, float]:
        """Take in what a program has written down: first what it has found of those before."""
        found, looked = ("killed before it looked", 0, 0.0), False
        for line in journal.read_text().splitlines():
            word, *rest = line.split()
            if word == "trouble":
                raise AssertionError(f"{line}: see {self._home}")
            if word in ("restored", "nothing"):
                found, looked = self._compare(rest[0] if rest else None), True
            elif rest and (word == "kept" if looked else word == "opened" and not self._log):
                self._log.append((rest[0], None))  # what is kept before it has looked is what comes back
            elif len(rest) == 3:
                self._log.append((rest[0], killed - float(rest[1])))
        return found

    def _compare(self, restored: str | None) -> tuple[str, int, float]:
        """What has become of the work of the program before."""
        there = [word for word, _ in self._log]
        assert restored is None or restored in there, f"{restored} was never there: see {self._home}"
        # Where nothing was done to what was opened there is nothing to keep.
        last = len(there) - 1 - there[::-1].index(restored) if restored else 0
        same = restored or (there[0] if there else "")
        lost = [age for word, age in self._log[last + 1 :] if age is not None and word != same]
        done = sum(age is not None for _, age in self._log)
        assert restored or not self._owed, f"what had been restored is there no more: see {self._home}"
        self._owed = bool(restored)
        self._log = [(restored, None)] if restored else self._log[:1]
        said = f"{done} gestures done, " + ("restored" if restored else "nothing to restore")
        return said, len(lost), max(lost, default=0.0)


def main(kills: int) -> None:
    chance, losses, ages, ends = random.Random(SEED), [], [], []
    read, write = os.pipe()
    screen = ["-displayfd", str(write), "-screen", "0", "1400x900x24"]
    display = subprocess.Popen(["Xvfb", *screen], pass_fds=[write], stderr=subprocess.DEVNULL)
    home = Path(tempfile.mkdtemp(prefix="killed-"))
    try:
        work = Work(home, ":" + os.read(read, 20).decode().strip())
        for kill in range(kills + 1):  # the last one only looks at what the one before has left
            # Every fifth is killed while it opens what the one before has left.
            when = (
                ("opened", chance.uniform(0.0, 1.0))
                if kill % 5 == 4
                else ("begun", chance.uniform(0.0, LONGEST))
            )
            found, lost, age, end = work.kill_one(kill, *(when if kill < kills else ("begun", 0.0)))
            if kill:
                print(
                    f"kill {kill}: {found}, {lost} lost ({1e3 * age:.0f} ms), gone {ends[-1]:.2f} s after",
                    flush=True,
                )
                losses.append(lost)
                ages.append(age)
            ends.append(end)
    finally:
        display.terminate()
        display.wait()
    print(
        f"{kills} kills: {sum(lost > 0 for lost in losses)} lost a finished gesture, at most {max(losses)}; "
        f"the oldest of them was done {1e3 * max(ages):.0f} ms before. Processes and shared memory were gone "
        f"{max(ends):.2f} s after, at the latest."
    )
    shutil.rmtree(home)


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("kills", nargs="?", type=int, default=50)
    parser.add_argument("--play", nargs=2, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.play:
        play(Path(given.play[0]), int(given.play[1]))
    else:
        main(given.kills)
