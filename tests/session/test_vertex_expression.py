"""Vertices by ids and coordinates, against the arrays themselves."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st
from meshes import box

from apd_viewer.errors import InputError
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.typed_values import parse_vertices

STATE = initial_state(Mesh(*box(2, 3, 5)))
V = STATE.document.mesh.V
X, Y, Z = V.T
N = len(V)


@pytest.mark.parametrize(
    ("text", "ids"),
    [
        ("3", [3]),
        ("0-4", range(5)),
        ("1, 3;5 7-8", [1, 3, 5, 7, 8]),
        ("2–3 2", [2, 3]),
        (f"{N - 1}", [N - 1]),
    ],
)
def test_parse_vertices_takes_ids_and_ranges(text, ids):
    assert parse_vertices(text, STATE, Unit.NONE).tolist() == list(ids)


@pytest.mark.parametrize(
    ("text", "holds"),
    [
        ("z > 2", Z > 2),
        ("z ≥ 2", Z >= 2),
        ("1<=y<=2", (Y >= 1) & (Y <= 2)),
        ("x < 1 and z > 0.5Z", (X < 1) & (Z > 2.5)),
        ("x<1 or z==".replace("==", "> L-1"), (X < 1) | (Z > 4)),
        ("x < 1 or x > 1 and y < 1", (X < 1) | ((X > 1) & (Y < 1))),
        ("x < y", X < Y),
        ("3 > z", Z < 3),
        ("z > 99", np.zeros(N, dtype=bool)),
        ("z > 80% Z - 1", Z > 3),
    ],
)
def test_parse_vertices_takes_the_vertices_for_which_conditions_hold(text, holds):
    np.testing.assert_array_equal(parse_vertices(text, STATE, Unit.NONE), np.flatnonzero(holds))


@pytest.mark.parametrize("shift", [0.0, -2.5, 1e3 / 7])
@pytest.mark.parametrize(
    ("text", "holds"),
    [
        ("z > 70%", Z > 3.5),
        ("30 % > z", Z < 1.5),
        ("33,3% < y < 66.7% and x < .5%", (Y >= 1) & (Y <= 2) & (X == 0)),
        ("z >= 100%", Z == 5),
        ("z > 100%", Z > 5),
        ("z <= 0%", Z == 0),
        ("z > −10% and z < -10%", Z > 9),
        ("x > −10% and z > -10%", Z > -1),
        ("x < 51% < z", (X < 1.02) & (Z > 2.55)),
    ],
)
def test_parse_vertices_takes_a_percentage_of_the_way_through_the_mesh_anywhere(text, holds, shift):
    state = initial_state(Mesh(V + shift, STATE.document.mesh.F))
    np.testing.assert_array_equal(parse_vertices(text, state, Unit.NONE), np.flatnonzero(holds))


def test_parse_vertices_takes_a_percentage_of_the_shape_on_screen():
    state = STATE.updated(frame=replace(STATE.frame, U=np.column_stack((X, Y, np.minimum(Z, 3.0)))))
    np.testing.assert_array_equal(parse_vertices("z > 50%", state, Unit.NONE), np.flatnonzero(Z > 1.5))


def test_parse_vertices_takes_lengths_with_units():
    np.testing.assert_array_equal(parse_vertices("z > 15mm", STATE, Unit.CENTIMETRE), np.flatnonzero(Z > 1.5))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "Nothing was entered"),
        (f"{N}", f"run from 0 to {N - 1}"),
        (30_000 * "9", "too long"),
        ("1-" + 30_000 * "0", "too long"),
        ("5-3", "backwards"),
        ("3-", "incomplete range"),
        ("z", "not a condition"),
        ("1 < 2", "does not use"),
        ("z > 15mm", "unit"),
        ("z > q", "q"),
        ("q > 1", "q"),
        ("z >", ""),
        ("50% < 80%", "does not use"),
        ("80% > 3 > z", "compare it with x, y or z"),
        ("x < 20% < 80%", "compare it with x, y or z"),
        ("z > 1,000%", "write 1 or 1000"),
        ("z > 8.0.0%", "operator is missing"),
    ],
)
def test_parse_vertices_says_what_cannot_be_read(text, words):
    with pytest.raises(InputError, match=r"\.$") as refused:
        parse_vertices(text, STATE, Unit.NONE)
    assert words in str(refused.value)
    assert "\n" not in str(refused.value)


@given(st.text(alphabet="xyz0123456789 <>=&|andor-,;.()LXYZmk≤–%", max_size=25))
def test_parse_vertices_reads_or_refuses_whatever_is_typed(text):
    try:
        ids = parse_vertices(text, STATE, Unit.NONE)
    except InputError as error:
        refused = str(error)
        ids = np.empty(0, dtype=int)
    else:
        refused = "."
        assert (np.diff(ids) > 0).all()
        assert ids.size == 0 or (ids[0] >= 0 and ids[-1] < N)
    assert refused.endswith(".")
