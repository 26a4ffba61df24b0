"""Some hundred damaged files of all formats; ``python tests/support/fuzz.py`` tries as many as wanted."""

import pytest
from fuzz import NAMES, damaged, fuzz


@pytest.mark.parametrize("times", [5, pytest.param(40, marks=pytest.mark.night)])
def test_open_mesh_opens_damaged_files_that_can_be_written_or_refuses_them_in_one_sentence(times):
    count = times * len(NAMES)
    outcomes, failures = fuzz(count, seed=0, report=lambda _: None)
    assert failures == []
    # Or the damage is too great, or too small, to tell anything.
    assert outcomes["opened"] > count / 10
    assert outcomes["refused"] > count / 10


def test_fuzz_can_do_the_same_damage_again():
    assert damaged(7, seed=3) == damaged(7, seed=3)
    assert damaged(7, seed=3) != damaged(7 + len(NAMES), seed=3)
