"""A bar to study: its files, and plans that name them."""

import csv

import pytest
from painted_meshes import write_bar

from apd_viewer.cases.plan import read_plan
from apd_viewer.cases.study_case import InputFiles


@pytest.fixture
def bar(tmp_path):
    """The folder of a bar, ``bar.off``, painted by ``bar.sel``."""
    write_bar(tmp_path)
    return tmp_path


@pytest.fixture
def written(bar):
    """Write a plan of rows that differ from a usual one; return its path."""

    def write(*rows, name="plan.csv"):
        usual = {"mesh": "bar.off", "selection": "bar.sel", "motion": "twist 40deg", "steps": "2"}
        whole = [{**usual, **row} for row in rows]
        columns = list(dict.fromkeys(column for row in whole for column in row))
        with (bar / name).open("w", newline="", encoding="utf-8") as stream:
            writer = csv.DictWriter(stream, columns)
            writer.writeheader()
            writer.writerows(whole)
        return bar / name

    return write


@pytest.fixture
def planned(written, bar):
    """Write such a plan and read it."""
    return lambda *rows: read_plan(written(*rows), InputFiles(bar / "inputs"))
