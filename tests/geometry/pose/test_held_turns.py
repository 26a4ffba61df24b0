"""Turns that surfaces hold, against shapes whose turns are known."""

import itertools
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from meshes import rotation

from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE
from apd_viewer.geometry.pose.held_turn import pass_through_warnings
from apd_viewer.geometry.pose.surface_turns import held_turns, relative_paths
from apd_viewer.geometry.pose.transforms import rotation_about
from apd_viewer.geometry.pose.waypoint_path import rotation_pose, rotation_vector
from apd_viewer.notation import Notation, notation, use_notation

AROUND, ALONG, HEIGHT = 16, 81, 8.0
Z = np.array([0.0, 0.0, 1.0])


def tube():
    """A long tube along z, with its triangles and the share of the height of each vertex."""
    i, j = np.meshgrid(np.arange(AROUND), np.arange(ALONG), indexing="ij")
    angle, share = (2.0 * np.pi * i / AROUND).ravel(), (j / (ALONG - 1)).ravel()
    V = np.column_stack([np.cos(angle), np.sin(angle), HEIGHT * share])
    a, b = (i[:, :-1] * ALONG + j[:, :-1]).ravel(), (((i + 1) % AROUND)[:, :-1] * ALONG + j[:, :-1]).ravel()
    F = np.concatenate([np.column_stack([a, b, b + 1]), np.column_stack([a, b + 1, a + 1])])
    return V, F, share


V, F, SHARE = tube()
LABELS = np.where(SHARE < 0.1, BASE, np.where(SHARE > 0.9, HANDLE, FREE))
GROWING = np.clip((SHARE - 0.1) / 0.8, 0.0, 1.0)


def turned_by(radians, X=V):
    """The points, each turned about z by its own angle."""
    c, s = np.cos(radians), np.sin(radians)
    return np.column_stack([c * X[:, 0] - s * X[:, 1], s * X[:, 0] + c * X[:, 1], X[:, 2]])


def way(degrees, axis=Z, steps=15):
    """Poses on the way of a turn about an axis through the origin."""
    return [rotation_about([0, 0, 0], axis, np.deg2rad(degrees) * k / steps) for k in range(1, steps + 1)]


def turns_of(U, *degrees, labels=LABELS, X=V, G=F, axis=Z):
    """Turns of handles that were turned about an axis."""
    return held_turns(X, U, G, labels, [way(each, axis) for each in degrees])


def held(U, *degrees, **how):
    """Degrees held of those asked about an axis, for each handle."""
    turns = turns_of(U, *degrees, **how)
    assert [turn.degrees[0] for turn in turns] == pytest.approx(degrees)
    return [turn.degrees[1] for turn in turns]


@settings(max_examples=40, deadline=None)
@given(st.floats(-1000, 1000).filter(lambda angle: abs(angle) >= 5.0), st.integers(0, 10**6))
def test_held_turns_read_a_twist_of_any_angle_wherever_the_tube_lies(degrees, seed):
    chance = np.random.default_rng(seed)
    R, shift = rotation(chance.normal(size=3), chance.uniform(-3, 3)), chance.normal(size=3)
    U = turned_by(np.deg2rad(degrees) * GROWING) + 0.005 * chance.normal(size=V.shape)
    found = held(U @ R.T + shift, degrees, X=V @ R.T + shift, axis=R @ Z)
    # Either way round half a turn is as much.
    assert found == pytest.approx([degrees], abs=1.0)


@pytest.mark.parametrize("lost", [-2, -1, 1, 2, 3])
@pytest.mark.parametrize("degrees", [240.0, -400.0, 720.0, 170.0])
def test_held_turns_miss_what_was_unwound(degrees, lost):
    left = degrees - 360.0 * lost
    U = turned_by(np.deg2rad(left) * GROWING)
    assert held(U, degrees) == pytest.approx([left], abs=1e-6)
    assert turns_of(U, degrees)[0].has_lost_whole_turns


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10**6))
def test_held_turns_find_no_turn_in_a_surface_that_moves_as_one(seed):
    chance = np.random.default_rng(seed)
    X = V + 0.03 * chance.normal(size=V.shape)
    U = X @ rotation(chance.normal(size=3), chance.uniform(-3, 3)).T + chance.normal(size=3)
    assert held(U, 360.0, X=X) == pytest.approx([0.0], abs=1e-3)


@pytest.mark.parametrize("degrees", [20.0, 200.0, 300.0, -250.0])
def test_held_turns_read_a_bend_about_its_axis(degrees):
    """The tube on an arc: beyond half a turn its way decides, too."""
    angle = np.deg2rad(degrees) * GROWING
    radius = 0.8 * HEIGHT / np.deg2rad(degrees)
    over = V[:, 2] - HEIGHT * (0.1 + 0.8 * GROWING)  # beyond the arc it goes on straight
    out = radius - V[:, 0]
    U = np.column_stack(
        [
            radius - out * np.cos(angle) + over * np.sin(angle),
            V[:, 1],
            0.1 * HEIGHT + out * np.sin(angle) + over * np.cos(angle),
        ]
    )
    assert held(U, degrees, axis=[0.0, 1.0, 0.0]) == pytest.approx([degrees], abs=1e-6)


def test_held_turns_count_of_two_arms_the_one_which_lost_most():
    away = abs(np.rint(SHARE * (ALONG - 1)) - ALONG // 2)
    labels = np.where(away < 4, HANDLE, np.where(away > 36, BASE, FREE))
    there = np.clip((36 - away) / 32, 0.0, 1.0)
    whole, lost = np.deg2rad(400.0) * there, np.deg2rad(40.0) * there
    assert held(turned_by(whole), 400.0, labels=labels) == pytest.approx([400.0], abs=1e-6)
    for below in (True, False):
        U = turned_by(np.where((SHARE < 0.5) == below, lost, whole))
        assert held(U, 400.0, labels=labels) == pytest.approx([40.0], abs=1e-6)


def test_held_turns_measure_a_handle_behind_another_over_it():
    labels = np.where(abs(SHARE - 0.5) < 0.05, HANDLE, np.where(SHARE > 0.9, HANDLE + 1, FREE))
    labels[SHARE < 0.1] = BASE
    first = np.clip((SHARE - 0.1) / 0.35, 0.0, 1.0)
    second = np.clip((SHARE - 0.55) / 0.35, 0.0, 1.0)
    for one, more in itertools.product((400.0, 40.0, -100.0), (250.0, -110.0)):
        U = turned_by(np.deg2rad(one * first + more * second))
        assert held(U, one, one + more, labels=labels) == pytest.approx([one, one + more], abs=1e-6)


def test_held_turns_do_not_say_what_cannot_be_told():
    U = turned_by(np.deg2rad(40.0) * GROWING)
    assert held(U, 4.0) == [None], "little was asked"
    assert held(U, 400.0, labels=np.where(LABELS == BASE, FREE, LABELS)) == [None], "no base"
    point = np.where(LABELS == HANDLE, FREE, LABELS)
    point[-1] = HANDLE
    assert held(U, 400.0, labels=point) == [None], "a point"
    apart = F[~((SHARE[F] < 0.5).any(axis=1) & (SHARE[F] >= 0.5).any(axis=1))]
    assert held(U, 400.0, G=apart) == [None], "no surface leads there"
    assert held(np.full_like(V, np.nan), 400.0) == [None], "it diverged"
    assert warnings(turns_of(U, 400.0, G=apart)) == ()


def test_held_turns_take_half_a_turn_either_way_round():
    for degrees, asked in itertools.product((180.0, -180.0), repeat=2):
        assert held(turned_by(np.deg2rad(degrees) * GROWING), asked) == pytest.approx([asked])


@settings(max_examples=20, deadline=None)
@given(st.floats(-1000, 1000), st.integers(0, 10**6))
def test_relative_paths_reads_what_was_asked_from_places_on_the_way(degrees, seed):
    chance = np.random.default_rng(seed)
    X, labels = chance.normal(size=(12, 3)), np.repeat([BASE, HANDLE], 6)
    axis, all_of_it = chance.normal(size=3), rotation(chance.normal(size=3), 2.0)
    axis /= np.linalg.norm(axis)
    count = int(abs(degrees) // 100) + 1
    ways = []
    for step in range(1, count + 1):
        Y = X.copy()
        Y[6:] = X[6:] @ rotation(axis, np.deg2rad(degrees * step / count)).T + step
        ways.append(Y @ all_of_it.T)  # all together: the base turns as well
    (poses,) = relative_paths(X, np.array(ways), labels)
    found = rotation_vector(poses[:-1], poses[-1])
    assert np.rad2deg(found @ axis) == pytest.approx(degrees, abs=1e-6)


def warnings(turns, contact=False, may_touch=True, names=(), volumes=(None, None)):
    frame = SimpleNamespace(volume=volumes[0], share_reached=1.0)
    return pass_through_warnings(turns, frame, volumes[1], contact, may_touch, names)


def test_pass_through_warnings_say_that_a_closed_surface_turned_inside_out():
    (said,) = warnings((), volumes=(-3.0, 4.0))
    assert said.startswith("The surface has turned inside out: without contact it passed through itself")
    assert warnings((), volumes=(3.0, -4.0)) == (said,), "the triangles looked inwards at first"
    for volumes in ((3.0, 4.0), (-3.0, -4.0), (None, 4.0), (-1e-9, 4.0)):
        assert warnings((), volumes=volumes) == ()


def test_pass_through_warnings_say_what_is_held_and_what_to_do():
    turns = turns_of(turned_by(np.deg2rad(40.0) * GROWING), 400.0)
    begin = "The surface holds 40 of the 400 degrees asked: "
    without = "without contact it passed through itself; turn contact on."
    assert warnings(turns, contact=False) == (begin + without,)
    (never,) = warnings(turns, contact=False, may_touch=False)
    assert never == begin + "it passed through itself, as this method cannot use contact."
    assert warnings(turns, contact=True) == (begin + "it passed through itself.",)
    kept = turns_of(turned_by(np.deg2rad(400.0) * GROWING), 400.0)
    assert warnings(kept, contact=False) == ()
    less = turns_of(turned_by(np.deg2rad(380.0) * GROWING), 400.0)
    assert warnings(less, contact=False) == ("The surface holds 380 of the 400 degrees asked.",)
    two = warnings((*kept, *turns), contact=True, names=("Cap", "Neck"))
    assert two == ("Neck: " + begin + "it passed through itself.",)


def test_pass_through_warnings_write_angles_in_the_notation_in_use():
    less = turns_of(turned_by(np.deg2rad(340.5) * GROWING), 400.0)
    assert warnings(less) == ("The surface holds 340.5 of the 400 degrees asked.",)
    used = notation()
    use_notation(Notation(",", "."))
    try:
        assert warnings(less) == ("The surface holds 340,5 of the 400 degrees asked.",)
    finally:
        use_notation(used)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10**6), st.booleans())
def test_held_turns_about_several_axes_raise_no_alarm_and_a_lost_one_does(seed, loses):
    """The tube follows its handle on its whole way: as far from the base as the handle had come by then."""
    chance = np.random.default_rng(seed)
    axes, degrees = chance.normal(size=(3, 3)), chance.uniform(-250, 250, size=3)

    def rotation_at(part):
        R = np.eye(3)
        for k, axis in enumerate(axes):
            R = rotation(axis, np.deg2rad(degrees[k]) * np.clip(3.0 * part - k, 0.0, 1.0)) @ R
        return R

    passed = [rotation_pose(rotation_at(part)) for part in np.linspace(0.0, 1.0, 25)[1:]]
    # A slender one on the curve that its rings stand across of; and a turn more that nobody asked for.
    slender, rows = V * [0.01, 0.01, 1.0], np.arange(len(V)) % ALONG
    R = np.array([rotation_at(part) for part in GROWING[:ALONG]])
    curve = np.vstack(
        [np.zeros(3), np.cumsum((R[1:] + R[:-1])[:, :, 2] * HEIGHT / (ALONG - 1) / 2.0, axis=0)]
    )
    about = turned_by(2.0 * np.pi * GROWING if loses else np.zeros(len(V)), slender) * [1.0, 1.0, 0.0]
    U = curve[rows] + np.einsum("ijk,ik->ij", R[rows], about)
    (turn,) = held_turns(slender, U, F, LABELS, [passed])
    assert turn.held is not None
    assert turn.has_lost_whole_turns == loses
