"""The night: what it writes when it has passed, failed or been stopped, and what of it is said by day."""

import os
import re
import subprocess
import sys
from datetime import datetime, timedelta, timezone
from pathlib import Path

import pytest
from night_page import Night, Step, aged, last_night, lasting
from night_results import Results

ROOT = Path(__file__).resolve().parents[1]
SUPPORT = ROOT / "tests" / "support"
(KEPT,) = re.findall(r"(?m)^results = (.*)$", (ROOT / "Makefile").read_text(encoding="utf-8"))
PAGE = Path("tests", "night.md")
SUITE = """
import numpy
import pytest

def test_short(record_property):
    record_property("growth [MB]", numpy.float64(1.25))

@pytest.mark.night
def test_long(record_property):
    record_property("volume [ml]", 1234.56789)
    record_property("way", "by | pressing")

@pytest.mark.skip(reason="nothing | to compute with")
def test_skipped():
    pass

@pytest.mark.extra
def test_extra():
    raise AssertionError

@pytest.mark.alone
def test_paced():
    raise AssertionError
"""
FAILING = """
import pytest

@pytest.mark.night
@pytest.mark.parametrize("n", [1, 2])
def test_halves(n):
    assert n % 2

@pytest.fixture
def left():
    yield
    raise OSError

def test_left(left):
    pass
"""
# Instead of make: the target tells what to do.
STEPS = """
import os, signal, subprocess, sys
target = sys.argv[1]
if target in ("SIGINT", "SIGTERM"):
    os.kill(os.getppid(), getattr(signal, target))
if target == "suite":
    words = ["-q", "--night", "-n", "1", "-p", "night_tests", "-p", "xdist.plugin", *sys.argv[2:]]
    sys.exit(subprocess.run([sys.executable, "-m", "pytest", *words]).returncode)
sys.exit(target != "lint")
"""


def git(*words):
    subprocess.run(["git", "-c", "user.name=a", "-c", "user.email=a@example.org", *words], check=True)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The folder in which the tests run: a repository with a commit."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PYTHONPATH", str(SUPPORT))
    monkeypatch.setenv("PYTHONDONTWRITEBYTECODE", "1")
    monkeypatch.setenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")
    (tmp_path / "tests").mkdir()
    (tmp_path / ".gitignore").write_text("build\n.pytest_cache\n")
    (tmp_path / "steps.py").write_text(STEPS)
    git("init", "--quiet", "--initial-branch", "main")
    git("add", ".")
    git("commit", "--quiet", "--message", "First")
    return tmp_path


def run(*targets):
    """Run a night of such targets in the working folder; returns its status."""
    program = "import sys; from night import run_night; sys.exit(run_night(sys.argv[1:3], sys.argv[3:]))"
    return subprocess.run([sys.executable, "-c", program, sys.executable, "steps.py", *targets]).returncode


def rows(title):
    """Rows of the table below a title of the page, without its heading."""
    _, _, below = PAGE.read_text(encoding="utf-8").partition(f"## {title}\n")
    table = below.partition("\n## ")[0].strip().splitlines()
    return [line.strip("| ").split(" | ") for line in table[2:]]


def suite(text):
    """Have the suite be this, and its results kept as the Makefile says."""
    Path("tests", "test_tiny.py").write_text(text)
    options = f"{KEPT}suite.xml".split()
    steps = Path("steps.py")
    steps.write_text(STEPS.replace("*sys.argv[2:]", f"*{options}"))
    git("add", ".")
    git("commit", "--quiet", "--message", "A suite")


@pytest.mark.night
def test_night_that_has_passed_writes_its_results(folder):
    suite(SUITE)
    assert run("lint", "suite") == 0
    assert [row[:2] for row in rows("Steps")] == [["lint", "passed"], ["suite", "passed"]]
    assert "| tests | 2 passed, 0 failed, 1 skipped |" in PAGE.read_text(encoding="utf-8")
    assert rows("Skipped") == [["nothing \\| to compute with", "tests/test_tiny.py", "1"]]
    long, short = (f"tests/test_tiny.py::test_{name}" for name in ("long", "short"))
    assert rows("Figures") == [
        ["volume [ml]", "1,234.57", long],
        ["way", "by \\| pressing", long],
        ["growth [MB]", "1.25", short],
    ]
    assert {long, short} < {name for _, name in rows("Slowest tests")}
    assert rows("Failed") == []
    assert re.fullmatch(r"Last night: \d minutes? ago, passed in \d+ (s|min)\.", last_night(PAGE))


def test_night_that_has_failed_runs_all_steps_and_says_so(folder):
    suite(FAILING)
    assert run("mistaken", "suite", "lint") == 1
    steps = {"mistaken": "failed", "suite": "failed", "lint": "passed"}
    assert {name: outcome for name, outcome, _ in rows("Steps")} == steps
    assert rows("Failed") == [[f"tests/test_tiny.py::test_{name}"] for name in ("halves[2]", "left")]
    assert last_night(PAGE).endswith(" ago, failed (mistaken, suite).")
    assert run("lint") == 0
    assert rows("Failed") == [], "those were results of another night"


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no signals of this kind")
@pytest.mark.parametrize(("how", "said"), [("SIGINT", "interrupted (SIGINT)"), ("SIGTERM", "not ended")])
def test_night_that_was_stopped_has_not_passed(how, said, folder):
    assert run("lint") == 0
    assert run("lint", how, "lint") != 0
    assert last_night(PAGE).endswith(f" ago, {said}.")


@pytest.fixture
def before():
    """A night of 48 minutes that was begun so long ago."""

    def night(ago, commit):
        time = datetime.now(timezone.utc) - ago
        found = Night(f"{time:%Y-%m-%d %H:%M} UTC", commit, "2 cores", [Step("suite", "passed", 2880)])
        found.end(Results([]))
        PAGE.write_text(found.page(), encoding="utf-8")

    return night


def test_night_tells_how_many_commits_ago_the_last_one_was(folder, before):
    begun = Night.begun(PAGE)
    assert re.fullmatch("[0-9a-f]{40}", begun.commit)
    before(timedelta(days=3, hours=5), begun.commit)
    assert last_night(PAGE) == "Last night: 3 days ago, passed in 48 min."
    assert Night.begun(PAGE).commit == begun.commit, "its own page changes nothing"
    for count in ("1 commit", "2 commits"):
        git("commit", "--quiet", "--allow-empty", "--message", "Another")
        assert last_night(PAGE) == f"Last night: 3 days and {count} ago, passed in 48 min."
    (folder / "steps.py").write_text("")
    before(timedelta(hours=1, minutes=59), Night.begun(PAGE).commit)
    assert last_night(PAGE) == "Last night: 1 hour ago, passed in 48 min, with uncommitted changes."


def test_night_tells_only_the_time_without_its_history(folder, before):
    """As in a clone of the newest commit alone, or in a source package within another repository."""
    before(timedelta(minutes=7), "0" * 40)
    assert last_night(PAGE) == "Last night: 7 minutes ago, passed in 48 min."
    inner = folder / "package"
    (inner / "tests").mkdir(parents=True)
    os.chdir(inner)
    assert last_night(PAGE) == "No night has been run; see CONTRIBUTING.md."
    assert Night.begun(PAGE).commit == "unknown"
    before(timedelta(minutes=7), "unknown")
    assert last_night(PAGE) == "Last night: 7 minutes ago, passed in 48 min."


def test_night_says_ages_and_durations_in_words():
    ages = {59: "59 minutes", 60: "1 hour", 1439: "23 hours", 1440: "1 day", 90_000: "62 days"}
    assert {minutes: aged(timedelta(minutes=minutes)) for minutes in ages} == ages
    assert aged(timedelta(seconds=-9)) == "1 minute", "the clock of another machine"
    durations = {0.4: "0 s", 59.4: "59 s", 59.6: "1 min", 3599: "1 h 0 min", 4350: "1 h 12 min"}
    assert {seconds: lasting(seconds) for seconds in durations} == durations


@pytest.mark.parametrize(
    ("options", "chosen"),
    [
        ([], ["short", "skipped"]),
        (["--night"], ["short", "long", "skipped"]),
        (["--extras"], ["extra"]),
        (["--alone"], ["paced"]),
    ],
)
def test_night_chooses_tests_by_their_marks(options, chosen, folder):
    suite(SUITE)
    words = ["-m", "pytest", "--collect-only", "-q", "-p", "night_tests", *options]
    told = subprocess.run([sys.executable, *words], capture_output=True, text=True, check=True).stdout
    assert re.findall(r"::test_(\w+)$", told, re.M) == chosen


def test_night_alone_has_extras_and_none_is_installed_by_day():
    """What a user has who installed none is what is tested."""
    project = (ROOT / "pyproject.toml").read_text(encoding="utf-8")

    def libraries(text):
        return set(re.findall(r'"([\w.-]+)[^"]*[<>=]', text))

    (extras,) = re.findall(r"(?ms)^\[project\.optional-dependencies\]$(.*?)^\[", project)
    docs, dev = (re.search(rf"(?ms)^{group} = \[$(.*?)^\]", project)[1] for group in ("docs", "dev"))
    assert {"imageio-ffmpeg", "distributed"} <= libraries(extras)
    assert {"sphinx", "pytest"} < libraries(docs + dev)
    assert not libraries(extras) & libraries(docs + dev)
