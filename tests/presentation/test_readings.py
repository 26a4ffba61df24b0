"""Readings as words."""

from dataclasses import replace

import numpy as np
import pytest
from driven_session import bar

from apd_viewer.files.html_page import PageTable
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.pose.constraints import BASE, HANDLE
from apd_viewer.geometry.pose.transforms import rotation_about, scaling_about, translation, twist
from apd_viewer.presentation.readings import motion
from apd_viewer.presentation.report_blocks import mesh_blocks, settings_blocks
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.quantities.expressions import parse_length
from apd_viewer.session.quantities.units import UNIT_NAMES, Unit
from apd_viewer.session.quantities.wall import NO_WALL, WallText

X = np.array([1.0, 0.0, 0.0])


@pytest.fixture
def painted():
    """A bar with a handle."""
    document = initial_state(bar()).document
    return replace(document, labels=frozen(np.full(len(document.labels), HANDLE, dtype=np.uint8)))


def said_of(document) -> str:
    """The motion of its handle, on a mesh of the size 6."""
    return motion(initial_state(document.mesh).updated(document), 0, Unit.MILLIMETRE)


@pytest.mark.parametrize(
    ("moves", "turns", "grows", "said"),
    [
        (0.0, 0.0, 1.0, "at rest"),
        (0.5, 0.0, 1.0, "moved 0.5000\u00a0mm"),
        (0.0, 60.0, 1.0, "rotated +60.0°"),
        (0.0, -60.0, 1.0, "rotated −60.0°"),
        (0.0, 0.0, 1.2, "scaled by 1.20"),
        (0.5, 60.0, 0.5, "moved 0.5000\u00a0mm, rotated +60.0°, scaled by 0.50"),
    ],
)
def test_motion_says_what_it_has(painted, moves, turns, grows, said):
    centre, angle = painted.centre(0), np.deg2rad(turns)
    pose = translation(moves * X) @ rotation_about(centre, X, angle) @ scaling_about(centre, grows)
    moved = replace(painted, handles=(painted.handles[0].moved_to(pose),))
    assert said_of(moved) == said


@pytest.mark.parametrize("axis", [X, -X])
@pytest.mark.parametrize(("turns", "said"), [(90.0, "twisted +90.0°"), (-90.0, "twisted −90.0°")])
def test_motion_gives_a_twist_the_sign_that_it_was_typed_with(painted, axis, turns, said):
    away = painted.mesh.V @ axis
    labels = np.where(away > np.median(away), HANDLE, BASE)
    both = replace(painted, labels=frozen(labels.astype(np.uint8)))
    base, handle = (both.initial_positions[both.labels == code].mean(axis=0) for code in (BASE, HANDLE))
    moved = replace(both, handles=(both.handles[0].moved_to(twist(base, handle, np.deg2rad(turns))),))
    assert said_of(moved) == said
    across = rotation_about(handle, [0.0, -1.0, 0.0], np.deg2rad(turns))
    crossed = replace(both, handles=(both.handles[0].moved_to(across),))
    assert said_of(crossed).startswith("rotated")


def test_mesh_blocks_say_that_their_unit_is_a_guess():
    state = initial_state(bar())
    for unit, symbol, remark in (
        (Unit.CENTIMETRE, "cm", ""),
        (Unit.CENTIMETRE.as_guess, "cm?", "an unconfirmed guess"),
        (Unit.NONE.as_guess, "no unit", ""),
    ):
        (table, *_) = (block for block in mesh_blocks(state, unit, None) if isinstance(block, PageTable))
        assert ("Unit of length", symbol, remark) in table.rows


def test_settings_blocks_give_a_pressure_in_its_unit_where_the_wall_is_known():
    state = initial_state(bar())
    settings = {"method": "wall", "wall_thickness": 0.02, "pressure": -5000.0 * 4.0 / (2e9 * 0.02)}
    state = state.updated(state.document.with_settings(**settings))

    def said(wall):
        table, *_ = settings_blocks(state, Unit.CENTIMETRE, wall)
        return {title: value for title, value, _ in table.rows}["Pressure"]

    assert said(WallText(young="2GPa")) == "-50 mbar"
    assert said(WallText(young="40GPa")) == "-1 bar"
    assert float(said(NO_WALL)) == pytest.approx(settings["pressure"], rel=1e-5)


@pytest.mark.parametrize("unit", [unit for unit in UNIT_NAMES if unit is not Unit.NONE])
def test_unit_that_is_guessed_measures_as_the_known_one_and_is_marked(unit):
    guess = unit.as_guess
    assert (guess.is_guess, unit.is_guess, guess.as_confirmed) == (True, False, unit)
    for value in (1.0, 3e7):
        (larger, factor), (known, same) = guess.legible_unit(value, 2), unit.legible_unit(value, 2)
        assert (larger.as_confirmed, factor, larger.is_guess) == (known, same, True)
    assert guess.to_litres(2.0) == unit.to_litres(2.0)
    for written in (
        guess.format_length("1"),
        guess.format_volume("1"),
        guess.capacity_unit(1.0)[0],
        guess.mass_unit(5.0)[0],
    ):
        assert written.endswith("?")
    assert parse_length("1 in", guess, {}) == parse_length("1 in", unit, {})


def lagging(document, way, reached, share):
    """The first handle asked along poses, its vertices at another pose on the way."""
    handle, mine = document.handles[0], document.labels == HANDLE
    for pose in way:
        handle = handle.moved_to(pose)
    state = initial_state(document.mesh).updated(document.with_handle(0, handle))
    U = document.mesh.V.copy()
    U[mine] = U[mine] @ reached[:3, :3].T + reached[:3, 3]
    return state.updated(frame=replace(state.frame, U=frozen(U), share_reached=share))


@pytest.mark.parametrize(
    ("asked", "reached"), [(201.3, 173.1), (-400.0, -310.5), (725.0, 361.0), (20.0, 0.0)]
)
def test_motion_says_what_lags_behind_as_asked_and_reached(painted, asked, reached):
    turn = [rotation_about(painted.centre(0), X, np.deg2rad(angle)) for angle in (asked, reached)]
    way = [rotation_about(painted.centre(0), X, np.deg2rad(part * asked)) for part in np.linspace(0, 1, 33)]
    state = lagging(painted, [*way, turn[0]], turn[1], reached / asked)
    said = f"rotated {asked:+.1f}°, reached {reached:+.1f}°".replace("-", "−").replace("+0.0", "0.0")
    assert motion(state, 0, Unit.NONE) == said
    arrived = lagging(painted, [*way, turn[0]], turn[0], 1.0)
    assert motion(arrived, 0, Unit.NONE) == said.partition(",")[0]


def test_motion_says_a_lag_of_each_part_that_has_one(painted):
    asked, reached = translation(0.5 * X), translation(0.25 * X)
    assert motion(lagging(painted, [asked], reached, 0.5), 0, Unit.NONE) == "moved 0.5000, reached 0.2500"
    assert motion(lagging(painted, [np.eye(4)], reached, 0.5), 0, Unit.NONE) == "moved 0, reached 0.2500"
