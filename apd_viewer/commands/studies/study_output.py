"""Output of a study: mistakes of its plan, work left, summary."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

from apd_viewer.language import comma_separated, tr, trn
from apd_viewer.presentation.number_format import format_grouped
from apd_viewer.presentation.time_left import duration_text
from apd_viewer.studies.case_file import FAILED
from apd_viewer.studies.plans.plan import Plan
from apd_viewer.studies.results import ResultTable, status_text
from apd_viewer.studies.study_forecast import StudyForecast

_MOST_SAID = 20  # sentences; the table has all of them


def mistake_lines(plan: Plan) -> str:
    """A line for each wrong or repeated row."""
    lines = [_on_line(row.line, row.mistake) for row in plan.rows if row.mistake]
    return "".join(f"{line}\n" for line in _first(lines))


def work_left_lines(work_left: StudyForecast, processes: int) -> str:
    """Lines on the work left."""
    lines = [
        trn(
            "{cases:,} case, {done:,} done, {left:,} to do",
            "{cases:,} cases, {done:,} of them done, {left:,} to do",
            work_left.cases,
        ).format(cases=work_left.cases, done=work_left.done, left=work_left.cases - work_left.done)
    ]
    if work_left.failed:
        lines.append(
            tr("failed so far: {failed:,}; --retry-failed tries again").format(failed=work_left.failed)
        )
    if work_left.wrong:
        said = trn(
            "{wrong:,} row is wrong and is left out",
            "{wrong:,} rows are wrong and are left out",
            work_left.wrong,
        )
        lines.append(said.format(wrong=work_left.wrong))
    if work_left.seconds is None:
        lines.append(tr("No case was timed yet, so nobody knows how long they take."))
    elif work_left.cases > work_left.done:
        lines.append(
            tr("about {time} by {processes} processes, as measured so far").format(
                time=duration_text(work_left.seconds / processes), processes=processes
            )
        )
    return "\n".join(lines)


def study_summary(table: ResultTable, folder: Path) -> str:
    """Lines on the results."""
    count = Counter(row.status for row in table.rows)
    words = comma_separated(
        f"{format_grouped(number, 0)} {status_text(status)}" for status, number in count.items()
    )
    lines = [tr("{folder}: {words}").format(folder=folder / "results.csv", words=words)]
    failed = [_on_line(row.line, row.sentence) for row in table.rows if row.status == FAILED]
    return "\n".join([*lines, *_first(failed)])


def damaged_results_line(count: int) -> str:
    """A line on damaged results; empty without any."""
    said = trn(
        "{count:,} damaged result is computed again", "{count:,} damaged results are computed again", count
    )
    return said.format(count=count) + "\n" if count else ""


def _on_line(line: int, sentence: str) -> str:
    return tr("line {line}: {sentence}").format(line=line, sentence=sentence)


def _first(lines: list[str]) -> list[str]:
    """The first lines, and how many more there are."""
    more = len(lines) - _MOST_SAID
    return lines if more <= 0 else [*lines[:_MOST_SAID], tr("... and {more:,} more").format(more=more)]
