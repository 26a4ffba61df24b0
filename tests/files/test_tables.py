import csv
import re

import numpy as np
import pytest
from hypothesis import example, given, strategies as st

from apd_viewer.errors import InputError
from apd_viewer.files.tables import escaped_cell, unescaped_cell, write_table

SIGNS = "=+-@\N{FULLWIDTH EQUALS SIGN}\N{FULLWIDTH COMMERCIAL AT}"
FORMULAS = ["=1+1", "+1+1", "-2+3+cmd|' /C calc'!A0", "@SUM(A1)", "\t=1+1", "\r=1+1", " =1+1"]
FORMULAS += ["a;=1+1", "b\t@x"]


def computed(cell):
    """Whether a spreadsheet, by whichever separator it reads the cell, computes a part of it."""
    parts = [part.lstrip(" ") for part in re.split(r"[;\t\r\n]", cell)]
    return any(part[:1] in SIGNS for part in parts if part) or cell[:1] in ("\t", "\r")


def test_write_table_writes_what_is_read_back_the_same_to_the_last_digit(tmp_path):
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


def test_write_table_takes_words_counts_and_gaps(tmp_path):
    rows = [["arap", 0.1, 3, True], ["exact, or so", float("nan"), None, np.float64(2.5)]]
    write_table(tmp_path / "a.csv", ["method", "x", "n", "y"], rows)
    with (tmp_path / "a.csv").open(newline="", encoding="utf-8") as stream:
        head, *lines = csv.reader(stream)
    assert head == ["method", "x", "n", "y"]
    assert lines == [["arap", "0.1", "3", "1"], ["exact, or so", "", "", "2.5"]]


def test_write_table_leaves_what_was_there_when_it_cannot_write(tmp_path):
    (tmp_path / "taken.csv").mkdir()
    with pytest.raises(InputError, match="choose another location"):
        write_table(tmp_path / "taken.csv", ("a",), np.ones((1, 1)))
    with pytest.raises(InputError, match="cannot be written"):
        write_table(tmp_path / "nowhere" / "table.csv", ("a",), np.ones((1, 1)))
    assert [path.name for path in tmp_path.iterdir()] == ["taken.csv"]


def is_number(text):
    try:
        float(text.removesuffix("%"))
    except ValueError:
        return False
    return True


@given(st.text(st.sampled_from("=+-@'; \t\r\n,1a.%\N{FULLWIDTH EQUALS SIGN}")) | st.text())
@example("-1.5")
@example("'=1+1")
def test_escaped_cell_is_never_a_formula_and_comes_back(text):
    cell = escaped_cell(text)
    assert unescaped_cell(cell) == text
    if is_number(text):
        assert cell == text
    elif re.search("[^-+=@.,;%' \t\r\n0-9]", text):
        assert not computed(cell)


@pytest.mark.parametrize("text", FORMULAS)
def test_write_table_lets_a_formula_stay_text_in_the_file(tmp_path, text):
    assert computed(text)
    write_table(tmp_path / "a.csv", [text, "n"], [[text, -1.5], ["-1.5", None]])
    with (tmp_path / "a.csv").open(newline="", encoding="utf-8") as stream:
        lines = list(csv.reader(stream))
    assert not any(map(computed, (lines[0][0], lines[1][0])))
    assert [unescaped_cell(lines[0][0]), unescaped_cell(lines[1][0])] == [text, text]
    assert [lines[1][1], lines[2][0]] == ["-1.5", "-1.5"]


@pytest.mark.parametrize("text", ["no = formula", "twist 30deg; push 10%", "it's", "-20%", "+2.34 %", ""])
def test_escaped_cell_writes_other_texts_as_they_are(text):
    assert escaped_cell(text) == text
