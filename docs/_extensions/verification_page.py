"""The verification table, written from the cases and the recorded state of the release."""

from __future__ import annotations

from plain_markdown import escaped, table

from apd_viewer.presentation.verification_text import COLUMN_TITLES, row_cells
from apd_viewer.verification.case_table import CASES
from apd_viewer.verification.verification_case import VerificationCase
from apd_viewer.verification.verification_run import recorded_case_rows


def verification_page() -> str:
    """Markdown with a table of all quantities, and a section on the source of each case."""
    measured = [case for case in CASES.values() if case.quantities]
    lines = [line for case in measured for line in _lines(case)]
    titles = "case", *map(escaped, COLUMN_TITLES)
    return "\n".join([table(titles, lines), *map(_source, CASES.values())]) + "\n"


def _lines(case: VerificationCase) -> list[tuple[str, ...]]:
    cells = [tuple(map(escaped, row_cells(row))) for row in recorded_case_rows(case)]
    return [(f"**{case.letter}**" if k == 0 else "", *own) for k, own in enumerate(cells)]


def _source(case: VerificationCase) -> str:
    """Item of a list: title, why it misses or is not set up, and where the answer is from."""
    reasons = dict.fromkeys([case.reason, *(quantity.reason for quantity in case.quantities)])
    said = " ".join(escaped(reason) for reason in reasons if reason)
    return f"* **{case.letter}** {escaped(case.title)}. {said} *{escaped(case.source)}*"
