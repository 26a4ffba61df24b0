"""State of a study that is shown, in words and as a share."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

from apd_viewer.cases.case_file import DONE, FAILED
from apd_viewer.cases.results import WAITING, WRONG, ResultTable
from apd_viewer.cases.study_progress import CaseCounts, ProgressMeter
from apd_viewer.language import comma_separated, tr, trn
from apd_viewer.presentation.time_left import duration_text
from apd_viewer.ui.studies.study_run import may_continue

_SILENT = 120.0  # s without a new result, after which a study elsewhere is taken to have stopped


class StudyStatus:
    """Counts of a study, from its results or from the command that runs it.

    Attributes
    ----------
    is_running, is_stopping : bool
        Whether this program runs it, and whether it only finishes the running cases.
    """

    def __init__(self) -> None:
        self._folder: Path | None = None
        self.is_running = self.is_stopping = False
        self._sentence = ""
        self._forget()

    def _forget(self) -> None:
        self._counts: CaseCounts | None = None
        self._wrong = 0
        self._pace: ProgressMeter | None = None
        self._grown = -_SILENT

    def reset_for(self, folder: Path) -> None:
        """Begin with another study."""
        self._folder, self._sentence = folder, ""
        self.is_running = self.is_stopping = False
        self._forget()

    def set_running(self, is_running: bool, stopping: bool, sentence: str) -> None:
        """Note whether this program runs it, and what is to be said of its end."""
        if is_running and not self.is_running:
            self._forget()
        self.is_running, self.is_stopping, self._sentence = is_running, stopping, sentence

    def set_progress(self, progress: dict[str, Any]) -> None:
        """Note the progress told by the command."""
        self._counts = CaseCounts(
            progress["cases"],
            progress["finished"],
            progress["running"],
            progress["failed"],
            progress["rate"],
            progress["seconds_left"],
        )

    def set_results(self, table: ResultTable) -> None:
        """Update the counts from the results, unless a run reports them itself."""
        states = [row.status for row in table.rows if row.status in (DONE, FAILED, WAITING)]
        self._wrong = sum(row.status == WRONG for row in table.rows)
        done, failed = len(states) - states.count(WAITING), states.count(FAILED)
        if self.is_running:
            return
        before = self._counts
        # Cases may have been run again, or another plan.
        grown = before is not None and 0 <= failed - before.failed <= done - before.done
        if before is None or self._pace is None or before.cases != len(states) or not grown:
            self._pace = ProgressMeter(len(states), done, failed)
        else:
            for k in range(done - before.done):
                self._pace.count_case(k < failed - before.failed)
            if done > before.done:
                self._grown = time.monotonic()
        self._counts = self._pace.counts(0)

    @property
    def _grows(self) -> bool:
        """True if results have come in lately from elsewhere."""
        return time.monotonic() - self._grown < _SILENT

    @property
    def is_unfinished(self) -> bool:
        """True if cases are missing."""
        return self.is_running or (self._counts is not None and self._counts.done < self._counts.cases)

    @property
    def share(self) -> float | None:
        """Part of the cases that is finished; None while nobody knows."""
        if self._counts is None:
            return None if self.is_running else 0.0
        return self._counts.done / max(1, self._counts.cases)

    @property
    def _may_run(self) -> bool:
        """True if it could be run here, and nobody seems to run it."""
        folder = self._folder
        return folder is not None and not self.is_running and not self._grows and may_continue(folder)

    @property
    def may_continue(self) -> bool:
        """True if the remaining cases can be computed on this machine."""
        counts = self._counts
        return counts is not None and counts.done < counts.cases and self._may_run

    @property
    def may_retry(self) -> bool:
        """True if failed cases could be run here again."""
        return self._counts is not None and self._counts.failed > 0 and self._may_run

    @property
    def text(self) -> str:
        """All of it in a few words."""
        if self._counts is None:
            waiting = tr("starting …") if self.is_running else ""
            return self._sentence or waiting or (tr("No study is open.") if self._folder is None else "")
        now = self._counts
        words = [tr("{done:,} of {cases:,} done").format(done=now.done, cases=now.cases)]
        if now.failed:
            words.append(tr("{failed:,} failed").format(failed=now.failed))
        if self._wrong:
            words.append(trn("{n:,} row wrong", "{n:,} rows wrong", self._wrong).format(n=self._wrong))
        if self.is_running and now.running:
            words.append(tr("{running:,} running").format(running=now.running))
        if (
            now.done < now.cases
            and (self.is_running or self._grows)
            and now.rate
            and now.seconds_left is not None
        ):
            words.append(tr("{rate:.3g} a minute").format(rate=60.0 * now.rate))
            words.append(tr("{time} left").format(time=duration_text(now.seconds_left)))
        if self.is_stopping:
            words.append(tr("finishing the running cases"))
        said = comma_separated(words)
        return f"{said}. {self._sentence}" if self._sentence else said
