"""Obstacles in words, in the list and in the report."""

import re
from dataclasses import replace

import numpy as np
import pytest
from driven_session import bar

from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.presentation import obstacle_readings as readings
from apd_viewer.presentation.report_blocks import obstacle_blocks
from apd_viewer.session.model.named_obstacle import NamedObstacle, ObstacleKind
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.quantities.newton_conversion import NewtonConversion
from apd_viewer.session.quantities.units import Unit


def vector(*x):
    return frozen(np.array(x, dtype=float))


PLATE = NamedObstacle("Table", ObstacleKind.PLATE, vector(0, 0, -1), vector(0, 0, 1), shift=vector(0, 0, 0.5))
FINGER = NamedObstacle("Finger", ObstacleKind.CYLINDER, vector(5, 1, 3), vector(-1, 0, 0), 0.25, 2.0)


def state(contact=True, **of_frame):
    rest = initial_state(bar())
    document = replace(rest.document.with_settings(contact=contact), obstacles=(PLATE, FINGER))
    return replace(rest, document=document, frame=replace(rest.frame, **of_frame))


def test_load_text_is_said_where_something_presses_and_only_at_rest():
    loads = np.array([[0.0, 0.0, -1.2345], [0.0, 0.0, 0.0]])
    assert [readings.load_text(state(loads=loads), k, None) for k in (0, 1)] == [
        "load 1.23 at stiffness 1",
        "",
    ]
    unsettled = state(loads=loads, settled=False)
    assert [readings.load_text(unsettled, k, None) for k in (0, 1)] == ["touched", ""]
    assert readings.load_text(state(loads=loads, contact=False), 0, None) == ""
    assert readings.load_text(state(), 0, None) == ""
    barely = np.array([[0.0, 0.0, -4e-23], [0.0, 0.0, 0.0]])
    for settled in (True, False):
        assert readings.load_text(state(loads=barely, settled=settled), 0, None) == ""


def test_load_text_is_in_newtons_where_they_are_known():
    pressed = state(loads=np.array([[0.0, 0.0, -1.2345], [0.0, 0.0, 0.0]]))
    same = NewtonConversion(20.0, 1e-3, stiffness=0.01, pressed_stiffness=0.01, curvature=3.0)
    assert readings.load_text(pressed, 0, same) == "load 24.7 N"
    thinner = replace(same, stiffness=0.0025)
    (table,) = obstacle_blocks(pressed, Unit.NONE, thinner)
    for said in (readings.load_excess_text(pressed, thinner), table.rows[0][2]):
        assert said.endswith("; up to 2.0 times too low")
    assert "too low" not in readings.load_excess_text(pressed, same)


def test_load_excess_text_is_said_with_loads_at_rest():
    """Of the cells of squares, 0.75 h^2 over D; less by a quarter at the sharp edges of a narrow bar."""
    loads = np.array([[0.0, 0.0, -1.2345], [0.0, 0.0, 0.0]])
    pressed = state(loads=loads)
    stiff = replace(pressed, document=pressed.document.with_settings(stiffness=0.01, method="exact"))
    known = 100.0 * 0.75 / (2.0 * 0.01 * stiff.inspection.area)
    said = float(
        re.fullmatch(r"Expected excess of loads ([\d.]+) %", readings.load_excess_text(stiff, None))[1]
    )
    assert said == pytest.approx(known, rel=0.3)
    (table,) = obstacle_blocks(stiff, Unit.NONE)
    assert table.rows[0][2].endswith(
        f"; load 1.23 at stiffness 1, {readings.load_excess_text(stiff, None).lower()}"
    )
    assert "excess" not in table.rows[1][2]
    assert readings.load_excess_text(pressed, None).endswith("loads mean little"), "without stiffness"
    for nothing in (state(), state(loads=loads, settled=False), state(loads=loads, contact=False)):
        assert readings.load_excess_text(nothing, None) == ""


def test_motion_text_is_said_with_what_contact_has_not_let():
    short = np.array([[0.0, 0.0, 0.2], [0.0, 0.0, 0.0]])
    asked = "asked for 0.5000\u00a0mm, stopped 0.3000\u00a0mm short"
    assert readings.motion_text(state(shifts=short), 0, Unit.MILLIMETRE) == asked
    assert (
        readings.motion_text(state(shifts=short, settled=False), 0, Unit.NONE)
        == "moved 0.5000, reached 0.2000"
    )
    assert readings.motion_text(state(shifts=short, contact=False), 0, Unit.NONE) == "moved 0.5000"
    assert readings.motion_text(state(), 1, Unit.NONE) == "not moved"


def test_obstacle_blocks_say_enough_to_put_obstacles_again():
    (table,) = obstacle_blocks(state(), Unit.NONE)
    plate, finger = table.rows
    assert plate == (
        "Table",
        "moved 0.5000",
        "Plate; place (0, 0, -1); displacement (0, 0, 0.5); normal (0, 0, 1)",
    )
    assert finger[2] == "Cylinder; place (5, 1, 3); radius 0.25; length 2; axis (-1, 0, 0)"
    _, why = obstacle_blocks(state(contact=False), Unit.NONE)
    assert "Contact is off" in why.text


def test_obstacle_blocks_say_that_there_are_no_obstacles():
    (note,) = obstacle_blocks(initial_state(bar()), Unit.NONE)
    assert "no obstacles" in note.text
