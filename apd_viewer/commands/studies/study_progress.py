"""Progress of a study: on a terminal, in a log, or as lines of JSON."""

from __future__ import annotations

import sys
import time

from apd_viewer.commands.terminal.progress import Progress
from apd_viewer.language import comma_separated, tr
from apd_viewer.presentation.time_left import duration_text
from apd_viewer.studies.progress_meter import CaseCounts

_LOG = 30.0  # s between two lines of a log


class StudyProgress:
    """Says how far a study is, to whoever reads.

    Parameters
    ----------
    is_json : bool
        As lines of JSON on the standard output. Beside ``done``, a share, and ``doing`` they have
        ``cases``, ``finished``, ``running``, ``failed``, ``rate`` (cases a second) and ``seconds_left``.
    """

    def __init__(self, is_json: bool = False) -> None:
        self._display = Progress(is_json)
        self._log = not is_json and not sys.stderr.isatty()
        self._logged = time.monotonic()

    def show(self, counts: CaseCounts) -> None:
        """Show the state of the study."""
        self._display.show(
            counts.done / max(counts.cases, 1),
            counts_text(counts),
            cases=counts.cases,
            finished=counts.done,
            running=counts.running,
            failed=counts.failed,
            rate=counts.rate,
            seconds_left=counts.seconds_left,
        )
        if self._log and time.monotonic() - self._logged > _LOG:
            self._logged = time.monotonic()
            print(counts_text(counts), file=sys.stderr, flush=True)

    def end(self) -> None:
        """Remove the line."""
        self._display.end()


def counts_text(counts: CaseCounts) -> str:
    """The state of a study in a few words."""
    words = [tr("{done:,} of {cases:,}").format(done=counts.done, cases=counts.cases)]
    words.append(tr("{running} running").format(running=counts.running))
    if counts.failed:
        words.append(tr("{failed} failed").format(failed=counts.failed))
    if counts.rate is not None and counts.seconds_left is not None:
        words.append(tr("{rate:.3g}/min").format(rate=60.0 * counts.rate))
        words.append(tr("{time} left").format(time=duration_text(counts.seconds_left)))
    return comma_separated(words)
