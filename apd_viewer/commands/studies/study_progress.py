"""Progress of a study: on a terminal, in a log, or as lines of JSON."""

from __future__ import annotations

import sys
import time
from typing import TYPE_CHECKING

from apd_viewer.commands.terminal.progress import Progress
from apd_viewer.language import listed, tr
from apd_viewer.presentation.time_left import duration

if TYPE_CHECKING:
    from apd_viewer.studies.pace import CaseCounts

_LOG = 30.0  # s between two lines of a log


class StudyProgress:
    """Says how far a study is, to whoever reads.

    Parameters
    ----------
    lines : bool
        As lines of JSON on the standard output. Beside ``done``, a share, and ``doing`` they have
        ``cases``, ``finished``, ``running``, ``failed``, ``rate`` (cases a second) and ``seconds_left``.
    """

    def __init__(self, lines: bool = False) -> None:
        self._display = Progress(lines)
        self._log = not lines and not sys.stderr.isatty()
        self._logged = time.monotonic()

    def show(self, now: CaseCounts) -> None:
        """Show the state of the study."""
        self._display.show(
            now.done / max(now.cases, 1),
            said(now),
            cases=now.cases,
            finished=now.done,
            running=now.running,
            failed=now.failed,
            rate=now.rate,
            seconds_left=now.seconds_left,
        )
        if self._log and time.monotonic() - self._logged > _LOG:
            self._logged = time.monotonic()
            print(said(now), file=sys.stderr, flush=True)

    def end(self) -> None:
        """Remove the line."""
        self._display.end()


def said(now: CaseCounts) -> str:
    """The state of a study in a few words."""
    words = [tr("{done:,} of {cases:,}").format(done=now.done, cases=now.cases)]
    words.append(tr("{running} running").format(running=now.running))
    if now.failed:
        words.append(tr("{failed} failed").format(failed=now.failed))
    if now.rate is not None and now.seconds_left is not None:
        words.append(tr("{rate:.3g}/min").format(rate=60.0 * now.rate))
        words.append(tr("{time} left").format(time=duration(now.seconds_left)))
    return listed(words)
