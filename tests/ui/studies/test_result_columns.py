"""Columns of results: numbers of plans, motions apart, readings in their units."""

import numpy as np
import pytest
from motions import IN_WORDS, in_words
from PySide6.QtCore import Qt

from apd_viewer.cases.plan_columns import COLUMNS
from apd_viewer.cases.results import ResultRow, ResultTable
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.ui.studies.case_plots import CaseColors, axis_of, dot_colors
from apd_viewer.ui.studies.result_columns import MOTION_COLUMN, PLAN_TITLES, result_columns, shown_columns
from apd_viewer.ui.studies.result_table import ResultModel


def table(columns, *rows):
    """Results of such cells; each with readings."""
    return ResultTable(
        tuple(columns),
        tuple(
            ResultRow(k + 2, f"key{k}", tuple(cells), "done", "", readings)
            for k, (cells, readings) in enumerate(rows)
        ),
    )


def named(found):
    return {column.title: column for column in found}


def test_result_columns_make_columns_of_the_amounts_of_motions_of_a_plan():
    found = named(
        result_columns(
            table(
                ["motion", "stiffness"],
                (["twist 90deg; push 20%", "0.1"], {}),
                (["push -5%", "1e-3"], {}),
                (["", "0.01"], {}),
            )
        )
    )
    assert found["Twist"].values == pytest.approx([90.0, np.nan, np.nan], nan_ok=True)
    assert found["Push"].values == pytest.approx([20.0, -5.0, np.nan], nan_ok=True)
    assert found["Push"].texts == ("20 %", "−5 %", "")
    assert found["Stiffness"].values == pytest.approx([0.1, 0.001, 0.01])


def test_result_columns_tell_handles_apart_only_where_there_are_several():
    motion = "handle 1: twist 9deg; handle 2: move 1 0 {}"
    found = named(result_columns(table(["motion"], *[([motion.format(z)], {}) for z in "34"])))
    assert "Move z (handle 2)" in found
    assert found["Move z (handle 2)"].values == pytest.approx([3.0, 4.0])


def test_result_columns_leave_out_what_is_the_same_in_all_rows():
    rows = [(["a.apd", "9", area], {}) for area in ("98%", "99%")]
    found = result_columns(table(["session", "steps", "area"], *rows))
    assert [column.title for column in found] == ["Line", "Area target"]


def test_result_columns_leave_out_a_note_that_repeats_a_quantity():
    columns = ["motion", "area", "#twist", "#by", "#area", "#load"]
    rows = [
        (["twist 30deg; push -1e1%", "98%", "30", "-10", "98", "7"], {}),
        (["twist 45deg; push -20%", "99%", "45", "-20", "99", "30"], {}),
        (["fly 3", "99%", "60", "-30", "99", "45"], {}),
    ]
    assert [column.title for column in result_columns(table(columns, *rows))[1:]] == [
        *("Twist", "Push", "Area target", "Load"),
    ]


def test_result_columns_keep_a_note_that_tells_what_a_motion_does_not_show():
    rows = [([f"twist {a}deg; push 1%; twist {a}deg", str(a)], {}) for a in (30, 60)]
    found = named(result_columns(table(["motion", "#twist"], *rows)))
    assert set(found) == {"Line", "Motion", "Twist"}
    assert found["Twist"].values == pytest.approx([30.0, 60.0])


def test_result_columns_make_two_columns_of_a_target_and_a_reading_of_one_name():
    found = result_columns(
        table(["volume"], (["60%"], {"volume": 300.0, "volume_error": -0.4}), (["70%"], {"volume": 350.0}))
    )
    names = [column.name for column in found]
    assert len(set(names)) == len(names)
    columns = named(found)
    assert columns["Volume change"].values == pytest.approx([-40.0, np.nan], nan_ok=True)
    assert columns["Volume change"].texts == ("−40.00 %", "")
    assert columns["Volume"].texts == ("300.0", "350.0")
    assert columns["Volume target"].is_from_plan


def test_result_columns_begin_the_readings_with_the_volume():
    readings = {"area": 9.0, "area_error": 0.0, "energy": 1.0, "volume": 60.0, "volume_error": -0.4}
    first, *others = (each.title for each in result_columns(table([], ([], readings)))[1:])
    assert first == "Volume change"
    assert set(others) == {"Area", "Area change", "Energy", "Volume"}


def test_axis_of_is_logarithmic_for_ranges_by_factors():
    rows = [([text], {}) for text in ("1e-4", "0.001", "0.1")]
    column = named(result_columns(table(["stiffness"], *rows)))["Stiffness"]
    axis, places = axis_of(column)
    assert places == pytest.approx([-4.0, -3.0, -1.0])
    assert (axis.low, axis.high) == (-4.0, -1.0)
    even = [([f"twist {angle}deg"], {}) for angle in range(1, 1000, 90)]
    assert axis_of(named(result_columns(table(["motion"], *even)))["Twist"])[0].low == 0.0
    assert [place for place, _ in axis.ticks(9)] == [-4.0, -3.0, -2.0, -1.0]
    colors = dot_colors(axis, np.append(places, np.nan))
    assert len(set(colors)) == 4


def test_case_colors_stay_with_their_cases():
    colors = CaseColors()
    first = dict(colors.colors_of([4, 9]))
    second = colors.colors_of([9, 1])
    assert second[9] == first[9]
    assert second[1] != second[9]
    assert len(set(colors.colors_of(range(30)).values())) == len(colors.colors_of(range(30))) == 8


def test_shown_columns_sort_states_by_their_meaning_and_texts_by_the_alphabet():
    states = ("waiting", "failed", "done", "duplicate", "wrong")
    rows = tuple(
        ResultRow(k + 2, f"key{k}", (f"#{9 - k}",), status, f"sentence {k % 2}", {"energy": 1.0})
        for k, status in enumerate(states)
    )
    found = {column.name: column for column in shown_columns(ResultTable(("#note",), rows))}
    assert not found["status"].is_numeric
    order = [states[k] for k in np.argsort(found["status"].sort_keys)]
    assert order == ["done", "failed", "wrong", "duplicate", "waiting"]
    assert np.argsort(found["plan #note"].sort_keys).tolist() == [4, 3, 2, 1, 0]
    assert found["line"].sort_keys.tolist() == [2.0, 3.0, 4.0, 5.0, 6.0]
    assert list(found)[:3] == ["line", "plan #note", "status"]
    assert list(found)[-1] == "sentence"


def test_result_columns_have_a_translatable_title_for_each_column_of_a_plan():
    assert set(PLAN_TITLES) | {MOTION_COLUMN} == set(COLUMNS)


def test_axis_of_is_no_finer_than_what_is_shown():
    rows = [(["9"], {"area_error": error}) for error in (1e-12, -4e-13)]
    column = named(result_columns(table(["steps"], *rows)))["Area change"]
    assert set(column.texts) == {"0.00 %"}
    axis, _ = axis_of(column)
    assert axis.high - axis.low >= 0.01
    assert max(len(text) for _, text in axis.ticks(5)) <= len("−0.010 %")


@pytest.mark.parametrize("name", IN_WORDS)
def test_result_columns_name_the_amounts_of_every_motion(name):
    found = named(result_columns(table(["motion"], *[([in_words(name, f"{n}")], {}) for n in (1, 2)])))
    titles = [title for title in found if title.split()[0] == MOTIONS[name].kind.title]
    assert titles
    assert titles[-1].removeprefix(MOTIONS[name].kind.title).strip() in MOTIONS[name].axis.lower()
    assert found[titles[-1]].values == pytest.approx([1.0, 2.0])


def test_shown_columns_mark_the_row_of_the_smallest_volume_that_is_one():
    """Where walls cross the volume is wrong, and what is alone or alike is not the smallest."""

    def states(*readings):
        found = table(["method"], *(([f"m{k}"], each) for k, each in enumerate(readings)))
        return [text.partition(", ")[2] for text in named(shown_columns(found))["State"].texts]

    one, two, capped = {"volume": 3.0}, {"volume": 2.0}, {"volume": None, "volume_capped": 2.5}
    assert states(one, two, {"volume": 1.0, "crossings": 4}) == ["", "smallest volume", ""]
    assert states(one, capped, {}) == ["", "smallest volume", ""]
    assert states(one) == [""]
    assert states(one, one) == ["", ""]


def test_result_model_names_a_row_by_what_the_plan_varies():
    found = table(["method", "angle"], (["arap", "30deg"], {}), (["exact", "60deg"], {}))
    model = ResultModel()
    model.show_results(found, shown_columns(found))
    name = model.data(model.index(1, 0), Qt.ItemDataRole.ToolTipRole)
    assert "exact" in name
    assert "60" in name
    assert "arap" not in name
