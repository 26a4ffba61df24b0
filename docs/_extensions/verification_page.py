"""The verification table, written from the cases and the recorded state of the release."""

from __future__ import annotations

from plain_markdown import escaped, table

from apd_viewer.presentation.verification_text import COLUMN_TITLES, row_cells
from apd_viewer.verification.case_table import CASES
from apd_viewer.verification.verification_case import VerificationCase
from apd_viewer.verification.verification_run import VerificationRow, recorded_case_rows

# Columns that have no room on a page: the program's answers, which the errors tell, too, and the seconds.
_LEFT_OUT = 2, 8


def verification_page() -> str:
    """Markdown with a table of all quantities, and a list of the sources of the cases."""
    measured = [case for case in CASES.values() if case.quantities]
    lines = [_line(row) for case in measured for row in recorded_case_rows(case)]
    return "\n".join([table(_narrow(COLUMN_TITLES), lines), *map(_source, CASES.values())]) + "\n"


def _line(row: VerificationRow) -> tuple[str, ...]:
    quantity, *cells = _narrow(row_cells(row))
    return f"**{row.case}** {quantity}", *cells


def _narrow(cells: tuple[str, ...]) -> tuple[str, ...]:
    """Cells that have room, unbroken before percent."""
    shown = (cell for column, cell in enumerate(cells) if column not in _LEFT_OUT)
    return tuple(escaped(cell).replace(" %", "\u00a0%") for cell in shown)


def _source(case: VerificationCase) -> str:
    """Item of a list: title, time, why it misses or is not set up, and the source of the answer."""
    rows = recorded_case_rows(case) if case.quantities else ()
    time = f" ({row_cells(rows[0])[8]} s)" if rows else ""
    reasons = dict.fromkeys([case.reason, *(quantity.reason for quantity in case.quantities)])
    said = " ".join(escaped(reason) for reason in reasons if reason)
    return f"* **{case.letter}** {escaped(case.title)}{time}. {said} *{escaped(case.source)}*"
