"""Change the program at places chosen by seed, and see which test notices: ``python tests/mutants.py``.

Each mutant is a copy of the working tree with one small change in solver, contact, files or session. Only
tests that reach the changed function run there, cheapest first and 40 seconds of them at most, to the first
that fails; a survivor gets all of them, if time is left. Which test reaches which function is noted once, by
a run of the suite, and kept in ``build/mutants``; ``--map`` does it anew. The table is printed as it grows
and kept there too, with a log of each mutant. Linux and macOS.

What a function does at import is reached by no test; a value that is cached is noted for the first test that
asks; processes that a test starts are noted unless they get an environment without PYTHONPATH. A test that
fails kills a mutant only if it fails again.
"""

from __future__ import annotations

import argparse
import math
import shutil
import sys
import threading
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor, wait
from json import loads
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests" / "support"))

from mutant_runs import SECONDS, Choice, Verdict, choice_of, make_map, run_mutant  # noqa: E402
from mutations import Place, chosen_places  # noqa: E402

AREAS = {
    "solver": ["geometry/solver", "geometry/energy", "geometry/linalg"],
    "contact": ["geometry/contact"],
    "files": ["files"],
    "session": ["session"],
}
PACKAGE = ROOT / "apd_viewer"
BUILD = ROOT / "build" / "mutants"
CORES = 2
HEADINGS = ("area", "place", "function", "change", "verdict", "tests run / reaching", "s")

Row = tuple[str, Place, Choice, Verdict]


def options(words: list[str]) -> argparse.Namespace:
    """Options of the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seed", type=int, default=0, help="which places are chosen")
    parser.add_argument("--count", type=int, default=60, help="number of mutants (default: 60)")
    parser.add_argument("--minutes", type=float, default=60.0, help="time for all of them (default: 60)")
    parser.add_argument(
        "--map", action="store_true", help="note anew what all tests reach, or the named ones"
    )
    parser.add_argument("words", nargs="*", help="for pytest, with --map: tests, and after -- its options")
    return parser.parse_args(words)


def update_map(words: list[str]) -> None:
    """Run tests with notes of what they reach; without a word all of them, for a new map."""
    if not words:
        shutil.rmtree(BUILD / "notes", ignore_errors=True)
    folders = [folder for area in AREAS.values() for folder in area]
    spread = ["-n", str(CORES), "--dist", "worksteal"]
    seconds = make_map(PACKAGE, folders, [*spread, *words], BUILD)
    print(f"The map of tests took {seconds / 60:.1f} minutes.", flush=True)


class Table:
    """Rows as they come, on the screen and in a file."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._path.write_text("", encoding="utf-8")
        self._say(_line(HEADINGS))
        self._say(_line(["---"] * len(HEADINGS)))

    def add(self, row: Row) -> None:
        area, place, choice, verdict = row
        outcome = f"{verdict.outcome} {verdict.test}".replace("killed ", "killed by ").strip()
        run = f"{len(choice.tests)} / {choice.reaching}"
        where = f"{place.where}:{place.line}"
        self._say(_line([area, where, place.function, str(place), outcome, run, f"{verdict.seconds:.0f}"]))

    def close(self, rows: list[Row], count: int) -> None:
        """Add the figures of each area."""
        outcomes = ("killed", "timed out", "survived", "not reached", "broken off")
        self._say("\n" + _line(("area", "tried", *outcomes)))
        self._say(_line(["---"] * (len(outcomes) + 2)))
        for area in (*AREAS, "all"):
            found = Counter(row[3].outcome for row in rows if area in (row[0], "all"))
            self._say(_line([area, found.total(), *(found[each] for each in outcomes)]))
        cut = sum(choice.is_cut for _, _, choice, _ in rows)
        self._say(f"\n{len(rows)} of {count} places tried; {cut} with some of the tests that reach them.")

    def _say(self, line: str) -> None:
        print(line, flush=True)
        with self._path.open("a", encoding="utf-8") as file:
            file.write(line + "\n")


def _line(cells) -> str:
    return "| " + " | ".join(str(cell).replace("|", "\\|") for cell in cells) + " |"


class Trials:
    """Places that are tried until time is up or Ctrl+C is pressed, as many at once as there are cores."""

    def __init__(self, places: list[tuple[str, Place]], found: dict, table: Table, minutes: float) -> None:
        self._places, self._found, self._table = places, found, table
        self._until, self._stopped = time.monotonic() + 60 * minutes, threading.Event()

    def rows(self) -> list[Row]:
        """Rows of all places; survivors are tried again, with all tests that reach them."""
        rows = self._tried(list(range(len(self._places))), SECONDS)
        left = [k for k, row in rows.items() if row[3].outcome == "survived" and row[2].is_cut]
        again = self._tried(left, math.inf)
        return list((rows | {k: row for k, row in again.items() if row[3].outcome != "broken off"}).values())

    def _tried(self, numbers: list[int], limit: float) -> dict[int, Row]:
        with ThreadPoolExecutor(CORES) as pool:
            rows = {k: pool.submit(self._row, k, limit) for k in numbers}
            try:
                wait(rows.values())
            except KeyboardInterrupt:
                self._stopped.set()
        return {k: row.result() for k, row in rows.items() if row.result()}

    def _row(self, k: int, limit: float) -> Row | None:
        if self._is_over():
            return None
        (area, place), log = self._places[k], BUILD / f"{k + 1}.log"
        choice = choice_of(place, self._found, limit)
        row = area, place, choice, run_mutant(place, PACKAGE, choice, log, self._is_over)
        self._table.add(row)
        return row

    def _is_over(self) -> bool:
        return self._stopped.is_set() or time.monotonic() >= self._until


def main(words: list[str]) -> None:
    """Make the map where it is missing or asked for, then the table."""
    asked = options(words)
    if asked.map or not (BUILD / "map.json").exists():
        update_map(asked.words)
    found = loads((BUILD / "map.json").read_text(encoding="utf-8"))
    places = chosen_places(PACKAGE, AREAS, asked.count, asked.seed)
    table = Table(BUILD / f"table-{asked.seed}.md")
    table.close(Trials(places, found, table, asked.minutes).rows(), asked.count)


if __name__ == "__main__":
    main(sys.argv[1:])
