"""Runs of the cases, row by row, against the recorded state of the release."""

import json
import time
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from apd_viewer.verification.verification_case import CaseQuantity, CaseResults, VerificationCase

RECORD = Path(__file__).with_name("recorded.json")
# Another processor changes errors by less than a tenth, or 2 % of the error bound if small.
_MARGIN, _FLOOR = 1.1, 0.02
_ROUNDING = 1e-9  # smaller errors give no order of convergence


class VerificationRow(NamedTuple):
    """Row of the table: a quantity of a case at its finest resolution.

    Attributes
    ----------
    case, title, quantity : str
        Letter and title of the case; it has no quantity if it cannot be set up yet.
    exact, ours, error : float or None
        Exact answer, that of the program, and its error, see :attr:`ResultPair.error`.
    plain : float or None
        Error of plain ARAP, where it can be asked.
    order : float or None
        Order of convergence between the two finest resolutions.
    seconds : float or None
        Time at the finest resolution.
    bar, least_order : float or None
        Largest error, and least order, with which it passes.
    passes : bool
    is_worse : bool
        Worse than the recorded state of the release.
    reason : str
        Sentence on why it does not pass; empty if it does.
    """

    case: str
    title: str
    quantity: str = ""
    exact: float | None = None
    ours: float | None = None
    error: float | None = None
    plain: float | None = None
    order: float | None = None
    seconds: float | None = None
    bar: float | None = None
    least_order: float | None = None
    passes: bool = False
    is_worse: bool = False
    reason: str = ""


class CaseRun(NamedTuple):
    """Finished case: its rows, and its measurements, also by plain ARAP."""

    case: VerificationCase
    rows: tuple[VerificationRow, ...]
    measured: tuple[CaseResults, ...]
    plain: CaseResults | None


@cache
def recorded_rows() -> dict[str, list[dict[str, Any]]]:
    """Fields of the rows in the recorded state of the release, by case letters."""
    found: dict[str, list[dict[str, Any]]] = json.loads(RECORD.read_text(encoding="utf-8"))
    return found


def run_cases(
    cases: Sequence[VerificationCase], tick: Callable[[float, str], object] = lambda *_: None
) -> Iterator[CaseRun]:
    """Run the cases in turn, from coarse to fine.

    Parameters
    ----------
    cases : sequence of VerificationCase
    tick : callable
        Called before each resolution with the finished fraction of the work, and the title of the case.
    """
    weights = [_weights(case) for case in cases]
    whole, done = max(1.0, sum(map(sum, weights))), 0.0
    for case, own in zip(cases, weights, strict=True):
        measured, seconds = [], 0.0
        for resolution, weight in zip(case.resolutions, own, strict=True):
            tick(done / whole, f"{case.letter}  {case.title}")
            started = time.perf_counter()
            assert case.measure is not None
            measured.append(case.measure(resolution, False))
            seconds = time.perf_counter() - started
            done += weight
        plain = case.measure(case.resolutions[-1], True) if case.measure and case.has_plain else None
        yield CaseRun(case, case_rows(case, measured, plain, seconds), tuple(measured), plain)


def _weights(case: VerificationCase) -> list[float]:
    """Expected seconds at each resolution, from the recorded time of the finest."""
    rows = recorded_rows().get(case.letter) or [{"seconds": 1.0}]
    return [rows[0]["seconds"] * (n / case.resolutions[-1]) ** 3 for n in case.resolutions]


def case_rows(
    case: VerificationCase, measured: Sequence[CaseResults], plain: CaseResults | None, seconds: float
) -> tuple[VerificationRow, ...]:
    """Rows of a case; a single one without numbers if not measured."""
    if not measured:
        return (VerificationRow(case.letter, case.title, reason=case.reason),)
    found = []
    for k in range(len(case.quantities)):
        beside = {"plain": plain and plain.answers[k].error, "seconds": seconds}
        found.append(_row(case, k, _numbers(case, k, measured) | beside))
    return tuple(found)


def recorded_case_rows(case: VerificationCase) -> tuple[VerificationRow, ...]:
    """Rows of a case in the recorded state of the release."""
    return tuple(_row(case, k, numbers) for k, numbers in enumerate(recorded_rows()[case.letter]))


def _numbers(case: VerificationCase, k: int, measured: Sequence[CaseResults]) -> dict[str, float | None]:
    answers = [each.answers[k] for each in measured]
    order = _order([answer.error for answer in answers[-2:]], case.resolutions[-2:])
    return {**answers[-1]._asdict(), "error": answers[-1].error, "order": order}


def _row(case: VerificationCase, k: int, numbers: dict[str, Any]) -> VerificationRow:
    quantity, error = case.quantities[k], numbers["error"]
    passes = quantity.shortfall(error) <= quantity.bar
    if quantity.least_order is not None:
        passes = passes and (numbers["order"] or 0.0) >= quantity.least_order
    recorded = [] if quantity.is_chaotic and passes else recorded_rows().get(case.letter, [])
    return VerificationRow(
        *(case.letter, case.title, quantity.title),
        **numbers,
        bar=quantity.bar,
        least_order=quantity.least_order,
        passes=passes,
        is_worse=k < len(recorded) and _is_worse_than(quantity, error, recorded[k]["error"]),
        reason="" if passes else quantity.reason,
    )


def _is_worse_than(quantity: CaseQuantity, error: float, recorded: float) -> bool:
    if quantity.is_lower_bound:
        error, recorded = max(0.0, -error), max(0.0, -recorded)
    return is_worse(error, recorded, quantity.bar)


def is_worse(error: float, recorded: float, bar: float) -> bool:
    """True if an error exceeds the recorded one by more than machines may differ."""
    return not abs(error) <= _MARGIN * abs(recorded) + _FLOOR * bar


def _order(errors: Sequence[float], resolutions: Sequence[int]) -> float | None:
    """Order of convergence of two errors; None for one or for rounding errors."""
    sizes = np.abs(errors)
    if len(sizes) < 2 or not (sizes > _ROUNDING).all():
        return None
    return float(np.log(sizes[0] / sizes[1]) / np.log(resolutions[1] / resolutions[0]))
