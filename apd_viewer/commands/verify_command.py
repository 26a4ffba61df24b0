"""The ``verify`` command: cases with exact solutions."""

import argparse
import json
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path

from apd_viewer.commands.terminal.columns import column_count, padded_text
from apd_viewer.commands.terminal.command_output import STANDARD_OUTPUT, CommandOutput
from apd_viewer.commands.terminal.parser import Parser, add_option
from apd_viewer.commands.terminal.progress import Progress
from apd_viewer.errors import InputError
from apd_viewer.files.storage.atomic_file import staging_folder
from apd_viewer.files.tables import write_table
from apd_viewer.language import tr
from apd_viewer.presentation.verification_text import COLUMN_TITLES, row_cells, verification_summary
from apd_viewer.verification.verification_case import VerificationCase
from apd_viewer.verification.verification_run import CaseRun, VerificationRow, run_cases

_NARROWEST = 10  # terminal columns of a number, including leading blanks


def verify_parser() -> Parser:
    """Argument parser for the ``verify`` command."""
    parser = Parser(
        prog="apd-viewer verify",
        description=tr(
            "Run cases with exact or published answers: errors, orders of convergence, and bars to meet. "
            "The exit status is 1 if a row is worse than in this release."
        ),
    )
    words = tr("letters of the cases, such as A,H; default: all")
    add_option(parser, "--case LETTERS", words)
    add_option(parser, "-o, --output DIR", tr("folder for a figure of each case, and the table"), type=Path)
    add_option(parser, "--progress-lines", tr("report progress as lines of JSON"))
    parser.set_defaults(run=_verify)
    return parser


def cases_of(letters: str | None) -> list[VerificationCase]:
    """Cases by letters, separated by commas; raises InputError for an unknown one."""
    # Imported here: with the integrals of SciPy it takes 0.14 s, for which no other command should wait.
    from apd_viewer.verification.case_table import CASES

    if letters is None:
        return list(CASES.values())
    found = list(dict.fromkeys(word.strip().upper() for word in letters.split(",") if word.strip()))
    unknown = [letter for letter in found if letter not in CASES]
    if unknown or not found:
        raise InputError(
            tr("There is no case “{letter}”; choose from {letters}.").format(
                letter=(unknown or [letters])[0], letters=", ".join(CASES)
            )
        )
    return [CASES[letter] for letter in found]


def _verify(options: argparse.Namespace) -> CommandOutput:
    cases, rows = cases_of(options.case), list[VerificationRow]()
    table = _Table(cases)
    with ExitStack() as stack:
        folder = stack.enter_context(staging_folder(options.output)) if options.output else None
        for run in _finished_runs(cases, Progress(options.progress_lines), options.progress_lines):
            rows += run.rows
            if folder is not None and run.measured:
                _draw(run, folder)
            if options.json != STANDARD_OUTPUT and not options.progress_lines:
                print(table.lines(run), flush=True)
        if folder is not None:
            write_table(folder / "verification.csv", VerificationRow._fields, rows)
    # A program reading the progress lines has seen the rows, and expects the status 0.
    is_worse = any(row.is_worse for row in rows) and not options.progress_lines
    return CommandOutput([verification_summary(rows)], lambda: [row._asdict() for row in rows], int(is_worse))


def _finished_runs(cases: Sequence[VerificationCase], progress: Progress, is_told: bool) -> Iterator[CaseRun]:
    """Finished cases, with progress shown meanwhile, as lines if ``is_told``."""
    fraction = 0.0

    def tick(done: float, doing: str) -> None:
        nonlocal fraction
        fraction = done
        progress.show(done, doing)

    for run in run_cases(cases, tick):
        progress.end()
        if is_told:
            rows = [row._asdict() for row in run.rows]
            told = {"done": round(fraction, 4), "doing": run.case.title, "rows": rows}
            print(json.dumps(told), flush=True)
        yield run


def _draw(run: CaseRun, folder: Path) -> None:
    # Imported here: matplotlib is slow to import, and must not delay the parsing of a command line.
    from apd_viewer.figures.curves import draw_verification

    draw_verification(run, folder)


class _Table:
    """Table for the terminal, one case at a time."""

    def __init__(self, cases: Sequence[VerificationCase]) -> None:
        titles = [quantity.title for case in cases for quantity in case.quantities]
        self._width = max(map(column_count, [COLUMN_TITLES[0], *titles]))
        self._widths = [max(_NARROWEST, column_count(title) + 2) for title in COLUMN_TITLES[1:]]
        self._head = [self._line(COLUMN_TITLES)]

    def lines(self, run: CaseRun) -> str:
        """Title, rows and reasons of a case, with the table's head above the first case."""
        lines, self._head = [*self._head, f"{run.case.letter}  {run.case.title}"], []
        lines += [self._line(row_cells(row)) for row in run.rows if row.quantity]
        lines += [f"   {reason}" for reason in dict.fromkeys(row.reason for row in run.rows) if reason]
        return "\n".join(lines).replace("−", "-")

    def _line(self, cells: Sequence[str]) -> str:
        first, *others = cells
        numbers = [
            " " * max(1, width - column_count(cell)) + cell
            for width, cell in zip(self._widths, others, strict=True)
        ]
        return f"   {padded_text(first, self._width)}{''.join(numbers)}"
