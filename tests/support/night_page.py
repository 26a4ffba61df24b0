"""The page on the last night: written after it, and read for how old it is."""

import contextlib
import os
import platform
import re
import subprocess
import sys
from dataclasses import dataclass, field
from datetime import datetime, timedelta, timezone
from pathlib import Path

from night_results import Results

_TIME = "%Y-%m-%d %H:%M UTC"
_CHANGED = "with uncommitted changes"
_NONE = "No night has been run; see CONTRIBUTING.md."
_HEAD = """\
# The last night

Written by `make night`; [Contributing](../CONTRIBUTING.md#the-night) says when it is run.
"""


@dataclass(frozen=True)
class Step:
    """Target of the Makefile, what became of it, and its seconds."""

    name: str
    outcome: str
    seconds: float


@dataclass
class Night:
    """A night: when it was begun, on what, and what it found so far."""

    time: str
    commit: str
    machine: str
    steps: list = field(default_factory=list)
    results: Results = field(default_factory=lambda: Results([]))
    outcome: str = "not ended"

    @classmethod
    def begun(cls, page):
        """A night that begins now; that the page has changed is no change of the sources."""
        changed = _git("status", "--porcelain", "--", ".", f":!{page.as_posix()}")
        commit = _git("rev-parse", "HEAD") or "unknown"
        return cls(f"{_now():{_TIME}}", f"{commit} {_CHANGED}" if changed else commit, machine())

    def end(self, results):
        """End with the results of its tests; it has passed if all steps and all tests have."""
        self.results = results
        bad = [step for step in self.steps if step.outcome != "passed"]
        if bad:
            self.outcome = f"{bad[-1].outcome} ({', '.join(step.name for step in bad)})"
        else:
            self.outcome = "failed" if results.failed() else "passed"

    def page(self):
        """Text of the page."""
        results = self.results
        counts = ", ".join(f"{n:,} {outcome}" for outcome, n in results.counts().items())
        duration = lasting(sum(step.seconds for step in self.steps))
        rows = ["begun", "commit", "machine", "outcome", "duration", "tests"]
        values = [self.time, self.commit, self.machine, self.outcome, duration, counts]
        slowest = [(f"{case.seconds:.1f}", case.name) for case in results.slowest()]
        return _HEAD + "".join(
            [
                _table("", ["", ""], zip(rows, values, strict=True)),
                _table("Steps", ["step", "outcome", "duration"], map(_step_row, self.steps)),
                _table("Failed", ["test"], ([name] for name in results.failed())),
                _table("Skipped", ["reason", "file", "tests"], _skip_rows(results)),
                _table("Figures", ["figure", "value", "test"], map(_figure_row, results.figures())),
                _table("Slowest tests", ["seconds", "test"], slowest),
            ]
        )


def last_night(page):
    """One line on the last night: how long ago it was, and how it went."""
    text = page.read_text(encoding="utf-8") if page.is_file() else ""
    head = text.partition("\n## ")[0]
    rows = dict(re.findall(r"(?m)^\| (begun|commit|outcome|duration) \| (.+) \|$", head))
    if len(rows) < 4:
        return _NONE
    commit, _, changed = rows["commit"].partition(" ")
    begun = datetime.strptime(rows["begun"], _TIME).replace(tzinfo=timezone.utc)
    since = int(_git("rev-list", "--count", f"{commit}..HEAD") or 0)
    ago = aged(_now() - begun) + (f" and {_count_text(since, 'commit')}" if since else "")
    how = f"passed in {rows['duration']}" if rows["outcome"] == "passed" else rows["outcome"]
    return f"Last night: {ago} ago, {how}{changed and ', '}{changed}."


def aged(age):
    """Length of a time, in words: of the largest unit of which there is one, or a minute."""
    for unit, length in ("day", timedelta(days=1)), ("hour", timedelta(hours=1)):
        if age >= length:
            return _count_text(age // length, unit)
    return _count_text(max(age // timedelta(minutes=1), 1), "minute")


def lasting(seconds):
    """Duration in words: two units at most."""
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    hours, minutes = divmod(round(whole / 60), 60)
    return f"{hours} h {minutes} min" if hours else f"{minutes} min"


def machine():
    """The machine in words: cores, processor, system and Python."""
    told = Path("/proc/cpuinfo")
    info = told.read_text(encoding="utf-8") if told.exists() else ""
    named = re.search(r"(?m)^model name\s*: (.*)$", info)
    processor = named[1] if named else platform.processor()
    version = ".".join(map(str, sys.version_info[:3]))
    return f"{os.cpu_count()} cores, {processor}, {platform.system()} {platform.machine()}, Python {version}"


def _count_text(n, what):
    return f"{n:,} {what}" if n == 1 else f"{n:,} {what}s"


def _now():
    return datetime.now(timezone.utc)


def _git(*words):
    """What git says about this folder; nothing without git, without a repository, or on an error."""
    # Named: an outer repository, into which a source package was unpacked, is another one.
    command = ["git", "--git-dir=.git", "--work-tree=.", *words]
    try:
        found = subprocess.run(command, capture_output=True, text=True, check=False)
    except OSError:
        return ""
    return found.stdout.strip() if found.returncode == 0 else ""


def _step_row(step):
    return step.name, step.outcome, lasting(step.seconds)


def _skip_rows(results):
    return ((reason, file, str(n)) for (reason, file), n in sorted(results.skips().items()))


def _figure_row(figure):
    """Row of a figure, its value with as many digits as tell something."""
    name, value, test = figure
    with contextlib.suppress(ValueError):
        value = f"{float(value):,.6g}"
    return name, value, test


def _table(title, columns, rows):
    """Section with a table; nothing without rows."""
    lines = [[cell.replace("|", "\\|") for cell in row] for row in rows]
    if not lines:
        return ""
    heading = f"\n## {title}\n" if title else ""
    body = "\n".join(f"| {' | '.join(line)} |" for line in [columns, ["---"] * len(columns), *lines])
    return f"{heading}\n{body}\n"
