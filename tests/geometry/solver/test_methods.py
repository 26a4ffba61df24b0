"""The table of methods: complete, and the only place that tells methods apart by their names."""

import re
from pathlib import Path

import numpy as np
import pytest

import apd_viewer
from apd_viewer.errors import InputError
from apd_viewer.figures.style import METHOD_STYLES
from apd_viewer.geometry.solver.methods import COMPARED_METHODS, DEFAULT_METHOD, METHODS, checked_method

PACKAGE = Path(apd_viewer.__file__).parent
NAMES = "|".join(map(re.escape, METHODS))
COMPARES = re.compile(rf"(?:==|!=|\bin|\bis|\bcase) *\(?[\"'](?:{NAMES})[\"']")


def test_methods_is_the_only_module_that_compares_names_of_methods():
    assert COMPARES.search('if method == "paper":'), "the test is blind"
    found = [
        f"{path.relative_to(PACKAGE)}: {line.strip()}"
        for path in sorted(PACKAGE.rglob("*.py"))
        for line in path.read_text(encoding="utf-8").splitlines()
        if COMPARES.search(line)
    ]
    assert found == []


def test_methods_can_all_be_offered_and_drawn():
    assert set(COMPARED_METHODS) <= set(METHODS)
    assert DEFAULT_METHOD in COMPARED_METHODS
    assert set(METHOD_STYLES) == set(METHODS)
    assert [name for name in METHODS if f'"{name}"' not in apd_viewer.Deformation.__doc__] == []


@pytest.mark.parametrize("method", METHODS.values(), ids=METHODS)
def test_method_traits_do_not_contradict_each_other(method):
    assert not (method.keeps_total_area and method.may_keep_total_area)
    assert method.keeps_total_area or not (method.keeps_only_total_area or method.has_tolerance)


@pytest.mark.parametrize("name", ["", "Exact", None, ["exact"]])
def test_checked_method_refuses_an_unknown_method(name):
    with pytest.raises(InputError, match="Unknown method"):
        checked_method(name, np.array([0, 1]))
