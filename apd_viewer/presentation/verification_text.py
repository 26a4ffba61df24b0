"""Cells of the verification table."""

from apd_viewer.language import tr, trn
from apd_viewer.presentation.number_format import format_short, format_significant
from apd_viewer.verification.verification_run import VerificationRow

COLUMN_TITLES = (
    tr("quantity"),
    tr("exact"),
    tr("this program"),
    tr("error"),
    tr("bar"),
    tr("result"),
    tr("order"),
    tr("plain ARAP"),
    tr("seconds"),
)


def row_cells(row: VerificationRow) -> tuple[str, ...]:
    """Cells of a row in column order; missing numbers are a dash."""
    return (
        row.quantity,
        _number(row.exact, 5),
        _number(row.ours, 5),
        _error(row.error, row.exact),
        _error(row.bar, row.exact),
        verdict(row),
        _order(row),
        _error(row.plain, row.exact),
        _number(row.seconds, 2),
    )


def verdict(row: VerificationRow) -> str:
    """Verdict on a verification row: "pass", "misses", "worse" or "not yet"."""
    if row.error is None:
        return tr("not yet")
    if row.is_worse:
        return tr("worse")
    return tr("pass") if row.passes else tr("misses")


def verification_summary(rows: list[VerificationRow]) -> str:
    """Sentence about the number of rows that pass."""
    measured = [row for row in rows if row.error is not None]
    worse = sum(row.is_worse for row in measured)
    said = tr("{passing} of {count} quantities are within their bar.").format(
        passing=sum(row.passes for row in measured), count=len(measured)
    )
    if not worse:
        return said
    sentence = trn("{n} is worse than in this release.", "{n} are worse than in this release.", worse)
    return f"{said} {sentence.format(n=worse)}"


def _number(value: float | None, digits: int) -> str:
    return "–" if value is None else format_significant(value, digits)


def _error(error: float | None, exact: float | None) -> str:
    """Error in percent; the absolute error if the exact value is 0."""
    if error is None:
        return "–"
    return f"{_two_digits(100.0 * error)} %" if exact else _two_digits(error)


def _order(row: VerificationRow) -> str:
    """Order of convergence, with the least accepted one."""
    order = _number(row.order, 2)
    return order if row.least_order is None else f"{order} (≥ {format_short(row.least_order)})"


def _two_digits(value: float) -> str:
    """Number of two digits with a true minus sign."""
    return format_short(float(f"{value:.2g}")).replace("-", "−")
