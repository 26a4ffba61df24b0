"""The method Wall beside CalculiX, which computes the decks of the same walls."""

import re
from pathlib import Path

import numpy as np
import pytest
from calculix_cases import CASES
from decks import needs_ccx

METHODS = Path(__file__).parents[2] / "docs" / "methods.md"


def in_the_manual(title):
    """Numbers of a case in the table of the manual: deflections, loads and ratios."""
    rows = re.findall(rf"^\| {title} \|(.*)\|$", METHODS.read_text(encoding="utf-8"), re.MULTILINE)
    return np.array([[float(word.strip(" m")) for word in row.split("|")] for row in rows])


@pytest.mark.night
@needs_ccx
@pytest.mark.parametrize("title", CASES)
def test_walls_carry_the_loads_that_calculix_finds(title, tmp_path, monkeypatch):
    monkeypatch.setenv("OMP_NUM_THREADS", "1")  # of CalculiX
    case = CASES[title]
    loads = case.loads(tmp_path)
    assert np.abs(loads[:, 3] / loads[:, 1] - 1.0).max() < 0.05
    assert np.abs(loads[:, 1::2] / loads[:, ::2] - 1.0).max() < case.finer, (
        "finer meshes of either have the same"
    )
    written = in_the_manual(title)
    np.testing.assert_allclose(written[:, 0], case.deflections)
    np.testing.assert_allclose(written[:, 1:5], loads, rtol=2e-3)
    np.testing.assert_allclose(written[:, 5], loads[:, 3] / loads[:, 1], atol=2e-3)


@pytest.mark.parametrize("title", CASES)
def test_manual_has_the_loads_of_pushed_walls(title):
    written = in_the_manual(title)
    np.testing.assert_allclose(written[:, 0], CASES[title].deflections)
    np.testing.assert_allclose(written[:, 5], written[:, 4] / written[:, 2], atol=2e-3)
