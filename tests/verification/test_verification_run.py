"""Runs of the cases: their rows, plain ARAP, and the recorded state of the release."""

import json
from dataclasses import replace

import igl
import numpy as np
import pytest

from apd_viewer.verification import verification_run
from apd_viewer.verification.case_meshes import grid
from apd_viewer.verification.case_table import CASES
from apd_viewer.verification.shape_cases import CATENOID, SPINDLE, bonnet
from apd_viewer.verification.verification_case import CaseQuantity, CaseResults, ResultPair, VerificationCase
from apd_viewer.verification.verification_run import case_rows, is_worse, recorded_rows, run_cases


def case_with(*answers, **traits):
    """A case that was measured already, and its rows."""
    quantity = CaseQuantity("a quantity", 0.01, **traits)
    resolutions = tuple(10 * 2**k for k in range(len(answers)))
    case = VerificationCase("X", "a case", "", (quantity,), resolutions)
    return case_rows(case, [CaseResults((answer,), np.empty((0, 2))) for answer in answers], None, 1.0)[0]


def test_run_cases_yields_the_rows_of_a_case_when_it_is_finished():
    coarse = replace(SPINDLE, resolutions=(4, 8))
    told = []
    (run,) = run_cases([coarse], lambda *words: told.append(words))
    volume, distance = run.rows
    assert volume.exact == pytest.approx(2.5636540)
    assert volume.error == pytest.approx(volume.ours / volume.exact - 1.0)
    assert abs(volume.error) < 0.03
    assert distance.error == distance.ours < 0.02
    assert 0.7 < distance.order < 2.5
    assert abs(volume.plain) < 0.1
    assert [done for done, _ in told] == sorted(done for done, _ in told)
    assert [len(measured.points) for measured in run.measured] == [5, 9]


def test_run_cases_gives_a_case_that_cannot_be_set_up_one_row_with_the_reason():
    (run,) = run_cases([CASES["K"]])
    (row,) = run.rows
    assert row.reason.startswith("Not yet")
    assert row.error is None
    assert not row.is_worse


def test_case_rows_have_the_order_between_the_two_finest_resolutions():
    row = case_with(ResultPair(0.0, 0.5), ResultPair(0.0, 0.04), ResultPair(0.0, 0.01))
    assert row.order == pytest.approx(2.0)
    assert row.passes
    assert not case_with(
        ResultPair(0.0, 0.5), ResultPair(0.0, 0.008), ResultPair(0.0, 0.006), least_order=1.8
    ).passes
    assert case_with(ResultPair(1.0, 1.0), ResultPair(1.0, 1.0)).order is None


def test_case_rows_are_numbers_that_json_knows():
    row = case_with(ResultPair(np.float64(1.0), np.float64(1.001)))
    assert json.loads(json.dumps(row._asdict()))["passes"] is True


def test_case_rows_give_the_reason_only_of_what_does_not_pass():
    assert case_with(ResultPair(2.0, 2.1), reason="for a reason").reason == "for a reason"
    assert case_with(ResultPair(2.0, 2.01), reason="for a reason").reason == ""


@pytest.mark.parametrize(
    ("error", "recorded", "worse"),
    [
        (0.0101, 0.01, False),
        (-0.0101, 0.01, False),
        (0.02, 0.01, True),
        (0.0001, 0.0, False),
        (0.0, 0.01, False),
        (np.nan, 0.01, True),
    ],
)
def test_is_worse_allows_for_other_machines(error, recorded, worse):
    assert is_worse(error, recorded, 0.01) is worse


def test_case_rows_pass_beyond_a_lower_bound_however_far():
    assert case_with(ResultPair(2.0, 2.1), is_lower_bound=True).passes
    assert case_with(ResultPair(2.0, 1.99), is_lower_bound=True).passes
    assert not case_with(ResultPair(2.0, 1.9), is_lower_bound=True).passes


def test_case_rows_are_worse_than_a_recorded_state_that_was_better(monkeypatch):
    monkeypatch.setattr(verification_run, "recorded_rows", lambda: {"X": [{"error": 0.001}]})
    assert case_with(ResultPair(1.0, 1.005)).is_worse
    assert not case_with(ResultPair(1.0, 1.001)).is_worse
    assert not case_with(ResultPair(1.0, 1.2), is_lower_bound=True).is_worse
    assert case_with(ResultPair(1.0, 0.995), is_lower_bound=True).is_worse


def test_case_rows_hold_what_rounding_decides_to_its_bar_alone(monkeypatch):
    monkeypatch.setattr(verification_run, "recorded_rows", lambda: {"X": [{"error": 0.001}]})
    assert not case_with(ResultPair(1.0, 1.005), is_chaotic=True).is_worse
    assert case_with(ResultPair(1.0, 1.02), is_chaotic=True).is_worse


def test_run_cases_asks_plain_arap_what_libigl_answers():
    """But for cotangents of obtuse triangles, which here are clamped to 0; 2.3 % were measured."""
    n = 8
    uv, F = grid(3 * n, n)
    u, v = 2.0 * np.pi * uv[:, 0], 2.0 * uv[:, 1] - 1.0
    V, goal = bonnet(u, v, 0.0), bonnet(u, v, np.pi / 2.0)
    ids = np.arange(len(uv)).reshape(3 * n + 1, n + 1)
    free = ids[2:-2, 2:-2].ravel()
    held = np.setdiff1d(ids, free)
    data = igl.ARAPData()
    data.energy, data.max_iter = igl.ARAP_ENERGY_TYPE_SPOKES, 1000
    igl.arap_precomputation(V, F, 3, held.astype(np.int32), data)
    U = igl.arap_solve(goal[held], data, V)
    expected = np.sqrt(((U - goal)[free] ** 2).sum(axis=1).mean()) / 2.0
    assert CATENOID.measure(n, True).answers[0].ours == pytest.approx(expected, rel=0.05)


def test_recorded_rows_are_there_for_each_quantity_with_a_reason_where_it_misses():
    measured = {letter: case for letter, case in CASES.items() if case.quantities}
    assert recorded_rows().keys() == measured.keys()
    for letter, case in measured.items():
        for quantity, row in zip(case.quantities, recorded_rows()[letter], strict=True):
            passes = quantity.shortfall(row["error"]) <= quantity.bar
            assert passes == (quantity.reason == ""), (letter, quantity.title)


def test_case_table_has_a_source_for_each_and_a_reason_for_those_that_are_not_set_up():
    assert [case.letter for case in CASES.values()] == list(CASES) == sorted(CASES)
    for case in CASES.values():
        assert case.source
        assert bool(case.reason) == (not case.quantities)


@pytest.mark.night
@pytest.mark.parametrize("letter", CASES)
def test_run_cases_finds_no_row_worse_than_recorded(letter, record_property):
    (run,) = run_cases([CASES[letter]])
    for row in run.rows:
        if row.error is not None:
            record_property(f"{row.case} {row.quantity}, error", row.error)
    assert [row.quantity for row in run.rows if row.is_worse] == []
    assert json.loads(json.dumps([row._asdict() for row in run.rows]))[0]["case"] == letter
