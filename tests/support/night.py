"""Run the checks of a night, and write what they found into tests/night.md.

    python tests/support/night.py MAKE TARGET ...
    python tests/support/night.py --last

Each target of the Makefile is a step; what its tests found it has left as build/night/*.xml. ``--last`` says
how old the last night is.
"""

import signal
import subprocess
import sys
import time
from pathlib import Path

from night_page import Night, Step, last_night
from night_results import results_in

PAGE, RESULTS = Path("tests", "night.md"), Path("build", "night")


class Steps:
    """Steps of a night, all of them, one after the other; an interruption ends the one that runs."""

    def __init__(self, make):
        self.make, self.interrupted = make, False
        signal.signal(signal.SIGINT, self._interrupt)

    def _interrupt(self, *_):
        # The step gets the signal too, and is waited for.
        self.interrupted = True

    def run(self, target):
        began = time.monotonic()
        with subprocess.Popen([*self.make, target]) as process:
            status = process.wait()
        outcome = "interrupted" if self.interrupted else "failed" if status else "passed"
        return Step(target, outcome, time.monotonic() - began)


def run_night(make, targets):
    """Run the targets; returns the exit status.

    The page says from the beginning that this night has not ended: one that is killed leaves no other behind.
    """
    night = Night.begun(PAGE)
    PAGE.write_text(night.page(), encoding="utf-8")
    RESULTS.mkdir(parents=True, exist_ok=True)
    for file in RESULTS.glob("*.xml"):
        file.unlink()
    steps = Steps(make)
    for target in targets:
        night.steps.append(steps.run(target))
        if steps.interrupted:
            break
    night.end(results_in(RESULTS))
    PAGE.write_text(night.page(), encoding="utf-8")
    return 0 if night.outcome == "passed" else 1


if __name__ == "__main__":
    if sys.argv[1:] == ["--last"]:
        print(last_night(PAGE))
    else:
        sys.exit(run_night([sys.argv[1], "--no-print-directory"], sys.argv[2:]))
