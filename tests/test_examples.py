"""The examples in the docstrings of the public Python names run, and say what comes of it."""

import doctest
import shutil
from pathlib import Path

import pytest

import apd_viewer

ROOT = Path(__file__).parents[1]
WITH_A_WINDOW = {"view"}  # it returns when somebody closes the window


def examples(name):
    """Examples of a public name, those of its methods left out."""
    return doctest.DocTestParser().get_doctest(getattr(apd_viewer, name).__doc__ or "", {}, name, None, 0)


@pytest.mark.parametrize("name", apd_viewer.__all__)
def test_every_public_name_has_an_example_that_runs(name, compiled, tmp_path, monkeypatch):
    shutil.copy(ROOT / "resources" / "bottle.obj", tmp_path)
    monkeypatch.chdir(tmp_path)
    found = examples(name)
    run = doctest.DocTestRunner().run(found)
    assert run.failed == 0
    skipped = [example for example in found.examples if doctest.SKIP in example.options]
    assert len(skipped) == (name in WITH_A_WINDOW)
    assert len(found.examples) > 1
