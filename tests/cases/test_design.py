"""Designs: laws of samples, and what cannot be designed."""

import csv
import itertools
import re
import time

import numpy as np
import pytest
from motions import IN_WORDS, in_words

from apd_viewer.__main__ import main
from apd_viewer.cases.design import GRID, LATIN, SOBOL, design_table, parse_variable
from apd_viewer.errors import InputError
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.session.posing.motion_text import parse_motion

GIVEN = {"mesh": "a.off", "selection": "a.sel"}


def column(rows, names, name, unit=""):
    return np.array([float(row[names.index(name)].removesuffix(unit)) for row in rows])


def test_design_table_latin_hypercube_has_one_sample_in_each_stratum():
    vary = [parse_variable("stiffness=1e-4..1:log"), parse_variable("area=90..110%")]
    names, rows = design_table(GIVEN, vary, LATIN, 50, seed=3)
    assert names == ["mesh", "selection", "stiffness", "area", "#area"]
    for shares in (
        np.log10(column(rows, names, "stiffness")) / 4 + 1,
        (column(rows, names, "area", "%") - 90) / 20,
    ):
        assert sorted(np.floor(50 * (shares + 1e-7)).astype(int)) == list(range(50))


def test_design_table_sobol_sequence_is_balanced():
    names, rows = design_table(
        GIVEN, [parse_variable("stiffness=0..1"), parse_variable("method=arap,exact")], SOBOL, 64, 0
    )
    assert np.bincount((8 * column(rows, names, "stiffness")).astype(int), minlength=8).tolist() == [8] * 8
    assert sum(row[names.index("method")] == "arap" for row in rows) == 32


def test_design_table_grid_has_every_combination_once():
    vary = [
        parse_variable("mesh=a.off,b.off"),
        parse_variable("twist=0..180deg"),
        parse_variable("steps=5,10"),
    ]
    names, rows = design_table({"selection": "a.sel"}, vary, GRID, 3, 0)
    assert names == ["selection", "mesh", "steps", "motion", "#twist"]
    turns = ["twist 0deg", "twist 90deg", "twist 180deg"]
    expected = itertools.product(["a.off", "b.off"], turns, ["5", "10"])
    assert [tuple(row[1:4]) for row in rows] == [(mesh, steps, turn) for mesh, turn, steps in expected]


def test_design_table_adds_no_motion_behind_it_for_a_name_in_the_motion():
    given = {**GIVEN, "motion": "twist {twist} about z; move 0 0 {up}"}
    vary = [parse_variable("twist=5deg,6deg"), parse_variable("up=2,3"), parse_variable("push=3%,4%")]
    names, (row, *_) = design_table(given, vary, GRID, 2, 0)
    assert row[names.index("motion")] == "twist 5deg about z; move 0 0 2; push 3%"


@pytest.mark.parametrize("design", [LATIN, SOBOL, GRID])
def test_design_table_counts_are_whole_numbers(design):
    names, rows = design_table(
        GIVEN, [parse_variable("steps=5..10"), parse_variable("area=90..110")], design, 16, 0
    )
    found = [row[names.index("steps")] for row in rows]
    assert set(found) == {"5", "6", "7", "8", "9", "10"}
    assert len({tuple(row) for row in rows}) == len(rows) == (96 if design == GRID else 16)


def test_design_table_rows_are_decided_by_the_seed():
    vary = [parse_variable("twist=0..180deg"), parse_variable("push=0..40%")]
    for design in (LATIN, SOBOL):
        one, same, other = (design_table(GIVEN, vary, design, 20, seed)[1] for seed in (1, 1, 2))
        assert one == same != other
        said = [re.fullmatch(r"twist ([\d.e-]+)deg; push ([\d.e-]+)%", row[2]) for row in one]
        assert [list(each.groups()) for each in said] == [row[3:] for row in one]


def test_design_table_fills_in_names_in_the_motion():
    given = {**GIVEN, "motion": "bend {by}deg; move 0 {way} 0"}
    names, rows = design_table(
        given,
        [parse_variable("by=10..20"), parse_variable("way=1..2mm"), parse_variable("push=5..6%")],
        GRID,
        2,
        0,
    )
    assert rows[0][names.index("motion")] == "bend 10deg; move 0 1mm 0; push 5%"
    assert rows[-1][names.index("motion")] == "bend 20deg; move 0 2mm 0; push 6%"


def test_design_table_notes_are_the_numbers_within_motions_and_before_units():
    given = {**GIVEN, "motion": "bend {by}; move 0 {way} 0; {end}"}
    texts = ("by=-5deg,1e1 deg", "way=1..2mm", "end=scale 2,push 3%", "push=5mm,1cm", "area=90..91%")
    names, rows = design_table(
        given, [*map(parse_variable, texts), parse_variable("stiffness=0..1")], GRID, 2, 0
    )
    assert names == [
        *("mesh", "selection", "motion", "area", "stiffness"),
        *("#by", "#way", "#end", "#push", "#area"),
    ]
    assert rows[0][5:] == ["-5", "1", "scale 2", "5mm", "90"]
    assert rows[-1][5:] == ["1e1", "2", "push 3%", "1cm", "91"]


WRONG = {
    "nothing": ([], {}, "Nothing varies"),
    "no range": (["twist"], {}, "varies nothing"),
    "backwards": (["twist=9..2"], {}, "swap its ends"),
    "factors from 0": (["stiffness=0..1:log"], {}, "ends above 0"),
    "an unknown name": (["colour=1..2"], {}, "“colour” is not a column"),
    "twice": (["push=1..2", "push=3..4"], {}, "given twice"),
    "given already": (["steps=1,2"], {"steps": "4"}, "given twice"),
    "no number of steps": (["push=1..2"], {"steps": "x"}, "Column “steps”: "),
    "an unknown method": (["method=arap,exakt"], {}, "Column “method”: .*exakt"),
    "a range out of range": (["stiffness=-1..1"], {}, "Column “stiffness”: -1 is out of range"),
    "a note twice": (["push=1..2"], {"#push": "4"}, "given twice"),
    "too many": (["push=1..2", "twist=1..2"], {}, "the limit is"),
}


@pytest.mark.parametrize("case", WRONG)
def test_design_table_says_what_cannot_be_designed(case):
    vary, given, words = WRONG[case]
    with pytest.raises(InputError, match=words):
        design_table({**GIVEN, **given}, list(map(parse_variable, vary)), GRID, 1001, 0)


def test_parse_variable_takes_no_time_for_many_digits():
    """A pattern that divides them in every way takes as many steps squared."""
    began = time.process_time()
    assert parse_variable(f"a=1..{'1' * 20_000}!").choices == (f"1..{'1' * 20_000}!",)
    assert time.process_time() - began < 2.0


def test_study_design_writes_a_plan_that_finds_its_files(bar, planned, capsys, monkeypatch):
    monkeypatch.chdir(bar)
    (bar / "plans").mkdir()
    words = "--mesh bar.off --selection bar.sel --vary twist=0..180deg --samples 7 --method sobol --seed 5"
    words += " --set steps=3 --set method=arap -o plans/plan.csv"
    assert main(["study", "design", *words.split()]) == 0
    assert capsys.readouterr().out == "plans/plan.csv: 7 cases\n"
    with (bar / "plans" / "plan.csv").open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    assert {(row["mesh"], row["selection"], row["steps"]) for row in rows} == {
        ("../bar.off", "../bar.sel", "3")
    }
    assert len({row["motion"] for row in rows}) == 7
    assert [row["motion"] for row in rows] == [f"twist {row['#twist']}deg" for row in rows]
    assert main(["study", "design", "--vary", "twist=1..2", "-o", "plans/other.csv"]) == 2
    assert "There is no mesh" in capsys.readouterr().err
    words = "--mesh bar.off --vary twist=1..2 --set steps=x -o plans/other.csv"
    assert main(["study", "design", *words.split()]) == 2
    assert capsys.readouterr().err.startswith("error: Column “steps”: ")
    assert not (bar / "plans" / "other.csv").exists()


@pytest.mark.parametrize("said", ["area=1.0..1.1", "volume=0.5,1.5", "area=2..110", "area=1.1"])
@pytest.mark.parametrize("design", [LATIN, SOBOL, GRID])
def test_design_table_refuses_a_percentage_that_could_be_a_factor(said, design):
    with pytest.raises(InputError, match=r"write \d+% or|out of range"):
        design_table(GIVEN, [parse_variable(said)], design, 4, 0)
    if ".." in said:
        design_table(GIVEN, [parse_variable(said + "%")], design, 4, 0)


def test_design_table_varies_a_pressure_in_its_unit():
    given = GIVEN | {"method": "wall", "young": "2GPa"}
    names, rows = design_table(given, [parse_variable("pressure=-50..30mbar")], GRID, 3, 0)
    assert [row[names.index("pressure")] for row in rows] == ["-50mbar", "-10mbar", "30mbar"]


@pytest.mark.parametrize("name", IN_WORDS)
def test_design_table_varies_every_motion(name):
    kind = MOTIONS[name].kind
    given = GIVEN | {"motion": in_words(name, "{by}")}
    designs = [design_table(given, [parse_variable(f"by=1,{kind.example}")], GRID, 2, 0)]
    if kind.takes_single_amount:
        designs.append(design_table(GIVEN, [parse_variable(f"{kind.word}=1,{kind.example}")], GRID, 2, 0))
    for names, rows in designs:
        motions = [row[names.index("motion")] for row in rows]
        assert [parse_motion(motion)[0].motion.kind for motion in motions] == [kind, kind]
        assert parse_motion(motions[1])[0].amounts == parse_motion(in_words(name))[0].amounts
