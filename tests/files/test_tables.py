import csv

import numpy as np
import pytest

from apd_viewer.errors import InputError
from apd_viewer.files.tables import write_table


def test_what_is_read_back_is_the_same_to_the_last_digit(tmp_path):
    rows = np.random.default_rng(0).normal(size=(50, 3)) * 10.0 ** np.random.default_rng(1).integers(
        -20, 20, (50, 3)
    )
    rows[3], rows[4, 1] = [1.0, -7.0, 2.0**60], np.nan
    path = tmp_path / "table.csv"
    write_table(path, ("a", "b", "c, d"), rows)
    with path.open(newline="", encoding="utf-8") as stream:
        head, *lines = csv.reader(stream)
    assert head == ["a", "b", "c, d"]
    found = np.array([[float(cell or "nan") for cell in line] for line in lines])
    np.testing.assert_array_equal(found, rows)
    assert lines[3][:2] == ["1", "-7"]
    assert lines[4][1] == ""


def test_a_table_may_have_words_counts_and_gaps(tmp_path):
    rows = [["arap", 0.1, 3, True], ["exact, or so", float("nan"), None, np.float64(2.5)]]
    write_table(tmp_path / "a.csv", ["method", "x", "n", "y"], rows)
    with (tmp_path / "a.csv").open(newline="", encoding="utf-8") as stream:
        head, *lines = csv.reader(stream)
    assert head == ["method", "x", "n", "y"]
    assert lines == [["arap", "0.1", "3", "1"], ["exact, or so", "", "", "2.5"]]


def test_a_table_that_cannot_be_written_leaves_what_was_there(tmp_path):
    (tmp_path / "taken.csv").mkdir()
    with pytest.raises(InputError, match="choose another location"):
        write_table(tmp_path / "taken.csv", ("a",), np.ones((1, 1)))
    with pytest.raises(InputError, match="cannot be written"):
        write_table(tmp_path / "nowhere" / "table.csv", ("a",), np.ones((1, 1)))
    assert [path.name for path in tmp_path.iterdir()] == ["taken.csv"]
