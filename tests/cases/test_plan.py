"""Plans: rows as cases, mistakes with their lines, and what makes a case another one."""

import pytest

from apd_viewer.cases.plan import read_plan
from apd_viewer.cases.study_case import InputFiles
from apd_viewer.errors import InputError
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.pose.transforms import rotation_about
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.model.view import View
from apd_viewer.session.storage.session_file import save_session

MISTAKES = {
    "missing mesh": ({"mesh": "gone.off"}, "There is no file"),
    "no mesh": ({"mesh": "bar.sel"}, "not a supported file type"),
    "no mesh at all": ({"mesh": ""}, "either a mesh or a session"),
    "missing selection": ({"selection": "gone.sel"}, "There is no file"),
    "no selection": ({"selection": ""}, "needs a selection"),
    "wrong unit": ({"motion": "move 0 2kg 0"}, "“motion”.*kg"),
    "a length without a unit of the mesh": (
        {"motion": "push 2cm"},
        "fill in “unit” for cm",
    ),
    "an unknown unit": ({"unit": "mile"}, "“unit”: “mile” is not a unit"),
    "no motion": ({"motion": ""}, "Nothing moves"),
    "0 steps": ({"steps": "0"}, "“steps”: “0” is not a whole number"),
    "half a step": ({"steps": "2.5"}, "“steps”: “2.5” is not a whole number"),
    "a number for a word": ({"method": "5"}, "“method”: Unknown method '5'"),
    "a word for a number": ({"stiffness": "soft"}, "“stiffness”"),
    "negative": ({"stiffness": "-1"}, "“stiffness”: -1 is out of range"),
    "an impossible target": ({"volume": "-20"}, "“volume”: -20 is out of range"),
    "a pressure of no unit": ({"pressure": "30", "method": "wall", "young": "1GPa"}, "needs a unit"),
    "a pressure of no wall": ({"pressure": "30mbar", "young": "1GPa"}, "Only the method Wall"),
    "a pressure without a modulus": ({"pressure": "30mbar", "method": "wall"}, "fill in “young”"),
    "a modulus of no kind": ({"young": "hard"}, "“young”"),
    "a vacuum without contact": (
        {"pressure": "-1mbar", "method": "wall", "young": "1GPa", "contact": "no"},
        "needs contact",
    ),
    "a pressure and a volume": (
        {"pressure": "1mbar", "method": "wall", "young": "1GPa", "volume": "90"},
        "exclude each other",
    ),
    "contact without it": ({"method": "paper", "contact": "yes"}, "cannot use contact"),
    "a thickness of nothing": ({"thickness": "1"}, "set “contact” to yes"),
    "perhaps": ({"contact": "perhaps"}, "not yes, no or auto"),
    "maybe": ({"calm": "maybe"}, "neither yes nor no"),
}


def test_read_plan_says_each_mistake_with_its_line_and_stops_no_other_row(planned):
    rows = [row for row, _ in MISTAKES.values()]
    plan = planned({}, *rows, {}, {"motion": "twist 50"})
    assert [row.line for row in plan.rows] == list(range(2, len(rows) + 5))
    good, *wrong, again, other = plan.rows
    assert (good.mistake, other.mistake) == ("", "")
    assert (again.same_as, again.mistake) == (2, "It repeats line 2.")
    for row, (_, words) in zip(wrong, MISTAKES.values(), strict=True):
        assert row.case is None
        with pytest.raises(InputError, match=words):
            raise InputError(row.mistake)
    assert list(plan.cases.values()) == [good.case, other.case]


UNREADABLE = {
    "an unknown column": (b"mesh,colour\na,b\n", "unknown column “colour”"),
    "a column twice": (b"mesh,steps,steps\na,1,2\n", "“steps” twice"),
    "no mesh": (b"selection,motion\na,b\n", "neither a column “mesh”"),
    "no rows": (b"mesh,selection\n\n", "no rows"),
    "nothing": (b"", "neither a column “mesh”"),
    "no text": (b"mesh\n\xff\xfe\n", "not UTF-8 text"),
    "an open quote": (b'mesh,selection\n"a,b\n', "line 2 cannot be read"),
}


@pytest.mark.parametrize("case", UNREADABLE)
def test_read_plan_says_what_is_no_plan(case, tmp_path):
    content, words = UNREADABLE[case]
    (tmp_path / "plan.csv").write_bytes(content)
    with pytest.raises(InputError, match=words):
        read_plan(tmp_path / "plan.csv", InputFiles(tmp_path))
    with pytest.raises(InputError, match="There is no file"):
        read_plan(tmp_path / "other.csv", InputFiles(tmp_path))


@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_read_plan_takes_what_spreadsheets_separate_in_their_own_way(separator, bar, written):
    text = written({"motion": "twist 40; push 10%", "# note": "a"}, {"motion": "push 5%"}).read_text()
    usual = read_plan(bar / "plan.csv", InputFiles(bar / "inputs"))
    cells = [line.split(",") for line in text.splitlines()]
    quoted = [separator.join(f'"{cell}"' if separator in cell else cell for cell in row) for row in cells]
    content = "\ufeff" + "\r\n".join([*quoted, separator * 3, ""]) + "\r\n"
    (bar / "other.csv").write_bytes(content.encode())
    assert read_plan(bar / "other.csv", InputFiles(bar / "inputs")) == usual


def test_read_plan_says_that_there_are_too_many_cells(bar, written):
    path = written({})
    path.write_text(path.read_text().rstrip() + ",more\n")
    (row,) = read_plan(path, InputFiles(bar / "inputs")).rows
    assert "5 cells in 4 columns" in row.mistake


def test_read_plan_finds_what_is_the_same_case(planned):
    alike = [
        {},
        {"method": "exact", "stiffness": "0", "calm": "yes", "area": "100 %", "# note": "mine"},
        {"motion": "twist 40deg;", "contact": "no"},
    ]
    other = [
        {"motion": "twist 41deg"},
        {"steps": "3"},
        {"stiffness": "1e-3"},
        {"method": "arap"},
        {"unit": "mm"},
    ]
    plan = planned(*alike, *other)
    assert [row.same_as for row in plan.rows] == [None, 2, 2, *[None] * len(other)]
    assert len(plan.cases) == 1 + len(other)


def test_study_case_of_another_content_is_another(bar, planned):
    (before,) = planned({}).cases
    (bar / "bar.sel").write_text((bar / "bar.sel").read_text().replace("1", "0", 1))
    (after,) = planned({}).cases
    assert before != after


def test_read_plan_lets_sessions_bring_their_own_motion_paint_and_unit(bar, planned):
    state = initial_state(open_mesh(bar / "bar.off"))
    labels = state.document.labels.copy()
    labels[:3], labels[-3:] = 0, 2
    state = initial_state(open_mesh(bar / "bar.off"), labels)
    posed = state.updated(state.document.with_pose(0, rotation_about([1, 1, 0], [1, 0, 0], 0.3)))
    save_session(bar / "bar.apd", posed, View(unit="cm"))
    nothing = {"mesh": "", "selection": "", "motion": ""}
    plan = planned(
        {**nothing, "session": "bar.apd"},
        {**nothing, "mesh": "bar.apd", "motion": "push 2cm"},
        {**nothing, "session": "bar.apd", "selection": "bar.sel"},
        {**nothing, "session": "bar.apd", "unit": "mm"},
        {**nothing, "session": "bar.off"},
    )
    first, second, *wrong = plan.rows
    assert (first.mistake, second.mistake) == ("", "")
    assert first.case.motion == ()
    assert ["own paint" in wrong[0].mistake, "own unit" in wrong[1].mistake] == [True, True]
    assert "not a session" in wrong[2].mistake
