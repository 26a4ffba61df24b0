"""Twists of the sample bottle by every way there is: volume, crossings, and the turn that is held.

    python tests/benchmarks/twist_routes.py [--angles DEG ...] [--steps N] [--no-contact]

The ways are the command line, Python (legs of 45 degrees, as those of the command line), the last step of a
sweep, a case of a designed plan of as many steps, and a session with the solver's process, as the window has
it, in which it is typed.
Everything is at its default; without contact what each of them says is printed, too.
"""

import argparse
import contextlib
import csv
import io
import json
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "support"))
from driven_session import Driven

import apd_viewer
from apd_viewer.__main__ import main as command
from apd_viewer.geometry.analysis.self_intersections import crossings
from apd_viewer.geometry.pose.constraints import BASE, HANDLE
from apd_viewer.geometry.pose.held_turn import most_lost_turn
from apd_viewer.geometry.pose.transforms import twist
from apd_viewer.session.model.status_text import self_intersection_warnings
from apd_viewer.session.posing.motion import MOTIONS

RESOURCES = Path(__file__).parents[2] / "resources"
MESH, SELECTION = RESOURCES / "bottle.obj", RESOURCES / "bottle.sel"
LEG = 45.0  # degrees, of Python; as long as those of the command line
LONG = 1800.0  # seconds
# What a sentence on a turn that was lost says in any case.
SAID = "passed through itself"


class Found(NamedTuple):
    """What a way gives."""

    volume: float
    crossings: int
    turned: float
    held: float | None
    said: str


class Twist:
    """A twist of the sample bottle, in contact or not, with its files in a folder."""

    def __init__(self, degrees: float, contact: bool, steps: int, folder: Path) -> None:
        self.degrees, self.contact, self.steps, self.folder = degrees, contact, steps, folder
        self.mesh = apd_viewer.open_mesh(MESH)
        self.words = [str(MESH), "--selection", str(SELECTION), f"--twist={degrees:g}deg"]
        self.words += [] if contact else ["--no-contact"]

    def _crossings(self, U: np.ndarray) -> int:
        return len(crossings(U, self.mesh.joined_F))

    def _rows(self, name: str) -> list[dict[str, str]]:
        with (self.folder / name).open(newline="", encoding="utf-8") as stream:
            return list(csv.DictReader(stream))

    def deformed(self) -> Found:
        out, report = self.folder / "out.obj", self.folder / "report.json"
        run("deform", *self.words, "-o", out, "--report", report)
        read = json.loads(report.read_text(encoding="utf-8"))
        crossed = self._crossings(apd_viewer.open_mesh(out).V)
        turn, said = (*read["turned"], *read["turned_held"]), " ".join(read["warnings"])
        return Found(read["volume"], crossed, *turn, said)

    def in_python(self) -> Found:
        V, labels = self.mesh.V, np.loadtxt(SELECTION, dtype=int)
        held, cap = np.flatnonzero((labels == BASE) | (labels == HANDLE)), np.flatnonzero(labels == HANDLE)
        legs, path = int(np.ceil(abs(self.degrees) / LEG)), []
        for leg in range(1, legs + 1):
            centres = V[labels == BASE].mean(axis=0), V[cap].mean(axis=0)
            P, U = twist(*centres, np.deg2rad(self.degrees * leg / legs)), V.copy()
            U[cap] = V[cap] @ P[:3, :3].T + P[:3, 3]
            path.append(U[held])
        off = {} if self.contact else {"contact": False}
        result = apd_viewer.deform(V, self.mesh.F, held, np.array(path), handle=cap, **off)
        turn, said = (*result.turned, *result.turned_held), " ".join(result.warnings)
        return Found(result.volume, self._crossings(result.U), *turn, said)

    def swept(self) -> Found:
        words = ("--methods", "exact", "--steps", self.steps, "--meshes")
        said = run("sweep", *self.words, *words, "-o", self.folder / "swept")
        row = self._rows("swept/sweep.csv")[-1]
        last = self.folder / "swept" / "meshes" / f"exact-{self.steps:03d}.obj"
        return found(row, self._crossings(apd_viewer.open_mesh(last).V), said)

    def studied(self) -> Found:
        words = ["--mesh", MESH, "--selection", SELECTION, "--set", f"steps={self.steps}", "--method", "grid"]
        words += [] if self.contact else ["--set", "contact=no"]
        plan = self.folder / "plan.csv"
        run("study", "design", *words, "--vary", f"motion=twist {self.degrees:g}deg", "-o", plan)
        run("study", plan, "-o", self.folder / "study", "--processes", "1")
        (row,) = self._rows("study/results.csv")
        return found(row, int(row["crossings"]), row["sentence"])

    def in_the_window(self) -> Found:
        session = Driven()
        session.files.open_sample("bottle")
        session.until(lambda: session.jobs.current is None and session.store.state is not None)
        session.settle()
        if not self.contact:
            session.settings.set_contact(False)
            session.settle()
        session.handles.move_by(MOTIONS["TWIST"], f"{self.degrees:g}deg", 0)
        assert session.wait_idle(LONG)
        session.until(lambda: session.shape_checks.shape_check is not None)
        state, check = session.store.state, session.shape_checks.shape_check
        session.close()
        degrees, said = (
            most_lost_turn(check.turns).degrees,
            " ".join(self_intersection_warnings(state, check)),
        )
        return Found(state.frame.volume, self._crossings(state.frame.U), *degrees, said)


def run(*words: object) -> str:
    """Run a command; what it said."""
    with contextlib.redirect_stdout(io.StringIO()) as out:
        assert command([str(word) for word in words]) == 0
    return out.getvalue()


def found(row: dict[str, str], crossed: int, said: str) -> Found:
    """Readings of a row of a table."""
    volume, turned, held = (float(row[name]) for name in ("volume", "turned", "turned_held"))
    return Found(volume, crossed, turned, held, said)


WAYS = {
    "deform": Twist.deformed,
    "Python": Twist.in_python,
    "sweep": Twist.swept,
    "study": Twist.studied,
    "window": Twist.in_the_window,
}


def show(degrees: float, contact: bool, steps: int) -> None:
    """Print the rows of a twist."""
    volumes = []
    for name, way in WAYS.items():
        started = time.perf_counter()
        with tempfile.TemporaryDirectory(prefix="twist-routes-") as folder:
            it = way(Twist(degrees, contact, steps, Path(folder)))
        volumes.append(it.volume)
        cells = f"{degrees:g}° | {name} | {it.volume:.4f} | {it.crossings:,} | {it.turned:g} | {it.held:g}"
        said = "" if contact else f" {'yes' if SAID in it.said else 'NO'} |"
        print(f"| {cells} | {time.perf_counter() - started:.0f} |{said}", flush=True)
        if not contact:
            print(f"<!-- {it.said.strip()} -->", flush=True)
    print(f"| {degrees:g}° | apart by at most | {max(volumes) / min(volumes) - 1:.2%} | | | | |", flush=True)


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--angles", type=float, nargs="+", default=[180, 240, 300, 400, -400])
    parser.add_argument("--steps", type=int, default=10, help="of sweep and study")
    parser.add_argument("--no-contact", action="store_true")
    told = parser.parse_args()
    print("| twist | way | volume | crossings | turned | held | seconds |", "says it |" * told.no_contact)
    print("|---|---|---|---|---|---|---|" + "---|" * told.no_contact)
    for degrees in told.angles:
        show(degrees, not told.no_contact, told.steps)


if __name__ == "__main__":
    main()
