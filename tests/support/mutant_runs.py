"""Copies of the working tree in which tests run: once with notes of what they reach, then with mutants."""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from mutations import Place
from process_tree import tree_of
from reach import is_compiled_in, read_map

SUPPORT = Path(__file__).parent
LEFT_OUT = shutil.ignore_patterns(
    *(".git", ".venv", "build", "dist", "out", ".hypothesis", ".pytest_cache", ".mypy_cache", ".ruff_cache")
)
SECONDS = 40.0  # of tests for a mutant, by the map
EACH = 0.01  # what pytest takes for a test besides, in seconds
PATIENCE, SLOWER, COMPILATION = 60.0, 8.0, 90.0  # with one test: seconds, times the map's, and seconds
SITE = """\
from pathlib import Path
import reach
reach.install(Path({package!r}), {folders!r}, Path({notes!r}))
"""


@contextmanager
def copied(root: Path) -> Iterator[Path]:
    """Copy of a working tree with its compiled kernels, for as long as it is needed."""
    with tempfile.TemporaryDirectory(prefix="mutant-", ignore_cleanup_errors=True) as folder:
        tree = Path(folder) / "tree"
        shutil.copytree(root, tree, ignore=LEFT_OUT, symlinks=True)  # with its times, so that bytecode holds
        yield tree


def make_map(package: Path, folders: list[str], words: list[str], build: Path) -> float:
    """Note what tests reach in the package's folders, by words for pytest; seconds that it took.

    Notes of other tests, of an earlier map, are kept.
    """
    began = time.monotonic()
    notes = build / "notes"
    notes.mkdir(parents=True, exist_ok=True)
    with copied(package.parent) as tree:
        site = tree.parent / "site"
        site.mkdir()
        names = {"package": str(tree / package.name), "folders": folders, "notes": str(notes.resolve())}
        (site / "sitecustomize.py").write_text(SITE.format(**names), encoding="utf-8")
        subprocess.run(_pytest(*words), cwd=tree, env=_environment(tree, site), check=False)
    found = json.dumps(read_map(notes))
    (build / "map.json").write_text(found, encoding="utf-8")
    return time.monotonic() - began


def _pytest(*words: str) -> list[str]:
    fixed = ("-q", "-p", "reach_plugin", "-p", "no:cacheprovider", "--rootdir=.")
    return [sys.executable, "-m", "pytest", *fixed, *words]


def _environment(tree: Path, *more: Path) -> dict[str, str]:
    """Variables for tests in a tree, and their own folder for what they leave behind."""
    left_out = ("WAYLAND_DISPLAY", "NUMBA_CACHE_DIR", "PYTEST_")  # the last are of a test above
    kept = {name: value for name, value in os.environ.items() if not name.startswith(left_out)}
    scratch = tree.parent / "tmp"
    scratch.mkdir(exist_ok=True)
    path = os.pathsep.join(map(str, (tree, *more, SUPPORT)))
    return {**kept, "XDG_SESSION_TYPE": "x11", "PYTHONPATH": path, "TMPDIR": str(scratch)}


@dataclass(frozen=True)
class Choice:
    """Tests for a mutant, cheapest first, seconds of the longest, and how many reach it."""

    tests: list[str]
    longest: float
    reaching: int

    @property
    def is_cut(self) -> bool:
        """True if there are more tests that reach it."""
        return len(self.tests) < self.reaching


def choice_of(place: Place, found: dict, limit: float = SECONDS) -> Choice:
    """Tests that reach a place and pass without the change, for some seconds of tests.

    Where there are too many, those of its module come first, then those of its folder, then others; there
    all files take turns, each with its cheapest first.
    """
    seconds = {name: each[0] + EACH for name, each in found["tests"].items() if each[1] == "passed"}
    reaching = [name for name in found["reached"].get(place.key, ()) if name in seconds]
    chosen, total, turns, turn = [], 0.0, Counter(), {}
    for name in sorted(reaching, key=lambda name: seconds[name]):
        turn[name] = turns[name.partition("::")[0]]
        turns[name.partition("::")[0]] += 1
    for name in sorted(turn, key=lambda name: (_distance(place, name), turn[name], seconds[name])):
        if not chosen or total + seconds[name] <= limit:
            chosen.append(name)
            total += seconds[name]
    longest = max((seconds[name] for name in chosen), default=0.0)
    return Choice(sorted(chosen, key=lambda name: seconds[name]), longest, len(reaching))


def _distance(place: Place, test: str) -> int:
    """0 for a test file of the module, 1 for one in the folder that mirrors its own, 2 for others."""
    module, file = Path(place.where), Path(test.partition("::")[0])
    if file.stem == f"test_{module.stem}":
        return 0
    return 1 if file.parent.as_posix().endswith(module.parent.as_posix()) else 2


@dataclass(frozen=True)
class Verdict:
    """What became of a mutant: killed, survived, timed out, not reached, or broken off; and by which test."""

    outcome: str
    test: str = ""
    seconds: float = 0.0


def run_mutant(place: Place, package: Path, tests: Choice, log: Path, is_over: Callable[[], bool]) -> Verdict:
    """Run chosen tests in a copy of the tree with the change, to the first that fails; the log is kept.

    One that passes when it is run again has failed by chance: the others go on.
    """
    if not tests.tests:
        return Verdict("not reached")
    began = time.monotonic()
    with copied(package.parent) as tree:
        module = tree / package.name / place.where
        source = module.read_bytes()
        module.write_bytes(place.applied(source))
        patience = PATIENCE + SLOWER * tests.longest + COMPILATION * is_compiled_in(source)
        run = partial(_run_chosen, tree, log=log, patience=patience, is_over=is_over)
        code, test = run(tests.tests)
        while code == 1 and test and run([test])[0] == 0:
            rest = tests.tests[tests.tests.index(test) + 1 :]
            code, test = run(rest) if rest else (0, "")
    seconds = time.monotonic() - began
    if code is None:
        return Verdict("broken off" if is_over() else "timed out", test, seconds)
    outcome = {0: "survived", 5: "not reached"}.get(code, "killed")
    return Verdict(outcome, "" if outcome != "killed" else test or "collection", seconds)


def _run_chosen(
    tree: Path, tests: list[str], log: Path, patience: float, is_over: Callable[[], bool]
) -> tuple[int | None, str]:
    """Exit code of pytest, None if it took too long, and the last test that began."""
    chosen, started = tree.parent / "chosen", tree.parent / "started"
    chosen.write_text("\n".join(tests), encoding="utf-8")
    started.write_text("", encoding="utf-8")
    variables = {"CHOSEN_TESTS": str(chosen), "STARTED_TEST": str(started)}
    files = filter(
        lambda file: (tree / file).exists(), dict.fromkeys(name.partition("::")[0] for name in tests)
    )
    with (
        log.open("w", encoding="utf-8") as output,
        subprocess.Popen(
            _pytest("-x", "-m", "", *files),  # whatever marks the suite leaves out
            cwd=tree,
            env=_environment(tree) | variables,
            stdout=output,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        ) as process,
    ):
        try:
            code = _code_of(process, started, patience, is_over)
        finally:
            _kill_with_children(process)
    return code, started.read_text(encoding="utf-8")


def _code_of(
    process: subprocess.Popen, started: Path, patience: float, is_over: Callable[[], bool]
) -> int | None:
    """Exit code; None where a test, or what is before the first, takes too long, or time is up."""
    test, since = "", time.monotonic()
    while process.poll() is None:
        now = time.monotonic()
        if started.read_text(encoding="utf-8") != test:
            test, since = started.read_text(encoding="utf-8"), now
        if now - since > patience or is_over():
            return None
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(0.2)
    return process.returncode


def _kill_with_children(process: subprocess.Popen) -> None:
    """End a process, what it started, and what of its group outlived it."""
    below = tree_of(process.pid) if process.poll() is None else []
    for kill in (partial(os.killpg, process.pid), *(partial(os.kill, each) for each in below)):
        with contextlib.suppress(ProcessLookupError):
            kill(signal.SIGKILL)
