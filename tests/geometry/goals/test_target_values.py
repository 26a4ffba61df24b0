"""Percentages of targets: what could be a factor is asked, and never guessed."""

import numpy as np
import pytest

import apd_viewer
from apd_viewer.errors import InputError
from apd_viewer.geometry.goals.target_values import (
    LEAST_PERCENTAGE,
    MOST_PERCENTAGE,
    percentage,
    percentage_text,
)

# A tetrahedron of which one corner is moved.
V = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
F = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
HELD = [0, 1, 3]


def deformed(**targets):
    return apd_viewer.deform(V, F, HELD, V[HELD] + [[0.0], [0.0], [0.1]], handle=[3], iterations=2, **targets)


@pytest.mark.parametrize("factor", [1.0, 1.1, 1.5, 2, 9.99])
def test_percentage_asks_about_a_number_that_could_be_a_factor(factor):
    with pytest.raises(InputError, match=rf"write {100 * factor:g}% or {factor:g}%"):
        percentage(factor, "the area")
    assert percentage(f"{factor}%", "the area") == factor
    assert percentage(f" {100 * factor} % ", "the area") == pytest.approx(100 * factor)


def test_deform_asks_about_every_target_that_could_be_a_factor():
    region = apd_viewer.Region("lid", np.arange(4), area=1.1)
    for asked in ({"area": 1.1}, {"volume": 1.1}, {"regions": [region]}):
        with pytest.raises(InputError, match=r"write 110% or 1\.1%"):
            deformed(**asked)
    assert deformed(area="110%").area_target == pytest.approx(1.1 * deformed().area_rest)


def test_percentage_reads_again_what_said_with_sign_writes():
    for value in [*np.geomspace(LEAST_PERCENTAGE, MOST_PERCENTAGE, 50).tolist(), 5.0, 10.0]:
        assert percentage(percentage_text(value), "the area") == value
    assert percentage_text(None) is None


@pytest.mark.parametrize("wrong", ["abc", "", "%", "0.5%", 0.5, 1001, "nan", "inf%", True, None])
def test_percentage_refuses_what_is_no_target(wrong):
    with pytest.raises(InputError, match="must be a percentage from 1 to 1000"):
        percentage(wrong, "the area")
