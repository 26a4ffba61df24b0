"""Cases: where the handles are at each step, what is read there, and what cannot be run."""

import numpy as np
import pytest
import trimesh
from meshes import box, ends

from apd_viewer.cases.case import case_of, case_steps, cases_by_method
from apd_viewer.errors import InputError
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.transforms import rotation_about, scaling_about, translation
from apd_viewer.geometry.solver.deformation_result import deform
from apd_viewer.geometry.solver.methods import COMPARED_METHODS
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.session.posing.motion_path import MotionStep

BENT = rotation_about([1, 1, 0], [1, 0, 0], 0.8)


@pytest.fixture(scope="module")
def bar():
    """The document of a bar, held at the bottom, with its handle at the top."""
    V, F = box(2, 2, 6)
    labels = np.ones(len(V), dtype=np.uint8)
    base, handle = ends(V)
    labels[base], labels[handle] = 0, 2
    return initial_state(Mesh(V, F), labels).document


def swept(document, steps, last_fraction=1.0, methods=COMPARED_METHODS, **limits):
    """The steps by each of the methods."""
    cases = cases_by_method(case_of(document, steps, last_fraction, **limits), methods)
    return [step for case in cases for step in case_steps(case)]


def held_at(document, step):
    return step.frame.U[document.labels == 2]


def test_case_steps_holds_the_handle_at_each_step_at_its_part_of_the_motion(bar):
    found = swept(bar.with_pose(0, BENT), 4, methods=["arap", "exact"])
    assert [(step.method, step.fraction) for step in found] == [
        (method, part) for method in ("arap", "exact") for part in (0.0, 0.25, 0.5, 0.75, 1.0)
    ]
    X = bar.mesh.V[bar.labels == 2]
    for step in found:
        M = rotation_about([1, 1, 0], [1, 0, 0], 0.8 * step.fraction)
        np.testing.assert_allclose(held_at(bar, step), X @ M[:3, :3].T + M[:3, 3], atol=1e-12)
        assert step.degrees == pytest.approx(np.degrees(0.8 * step.fraction))
        # The chord of the pivot, which is 6 above the line that is turned about.
        assert step.displacement == pytest.approx(12 * np.sin(0.4 * step.fraction), abs=1e-12)
    np.testing.assert_allclose(found[0].frame.U, bar.mesh.V, atol=1e-12)


def test_case_steps_is_not_changed_by_contact_before_anything_touches(bar):
    bent = bar.with_pose(0, BENT)
    apart, passing = (swept(bent.with_settings(contact=on), 3, methods=["exact"]) for on in (True, False))
    assert [step.frame.contact.pairs for step in apart] == [0, 0, 0, 0]
    for one, other in zip(apart, passing, strict=True):
        np.testing.assert_allclose(one.frame.U, other.frame.U, atol=1e-6)


def test_case_steps_has_the_readings_of_its_shapes(bar):
    for step in swept(bar.with_pose(0, BENT), 3, methods=["arap", "paper"]):
        shape = trimesh.Trimesh(step.frame.U, bar.mesh.F, process=False)
        assert shape.area == pytest.approx(step.frame.area, rel=1e-12)
        assert shape.volume == pytest.approx(step.frame.volume, rel=1e-12)
        assert step.volume_error == pytest.approx(shape.volume / 24 - 1, abs=1e-12)


def test_case_steps_lets_each_method_do_what_it_is_for(bar):
    found = swept(bar.with_pose(0, BENT), 4)
    error = {
        m: max(abs(s.frame.area_error) for s in found if s.method == m) for m in ("arap", "paper", "exact")
    }
    assert error["exact"] < 1e-9
    assert error["paper"] <= 1e-3
    assert error["arap"] > 1e-4
    energies = {m: [s.energy for s in found if s.method == m] for m in ("arap", "exact")}
    assert all(np.diff(energies["arap"]) > 0), "the farther the handle, the more energy"
    assert all(np.array(energies["arap"]) <= np.array(energies["exact"]) * (1 + 1e-6) + 1e-12)


def test_case_steps_ends_a_step_where_it_would_end_from_rest(bar):
    """In so mild a motion there is one shape of least energy, whichever way leads to it."""
    held = bar.with_pose(0, BENT).constraints()
    direct = deform(bar.mesh.V, bar.mesh.F, held.fixed, held.targets, "arap", handle=held.handles)
    *_, last = swept(bar.with_pose(0, BENT), 5, methods=["arap"], iterations=5000)
    assert last.energy == pytest.approx(direct.energy, rel=1e-4)


def test_case_steps_of_a_twist_goes_past_half_a_turn(bar):
    twist = [MotionStep(0, MOTIONS["TWIST"], (np.pi,))]
    case = case_of(bar.with_settings(method="arap"), 4, 1.5, motion=twist)
    found = list(case_steps(case))
    assert case.abscissa == "degrees"
    assert [step.degrees for step in found] == pytest.approx([0, 67.5, 135, 202.5, 270])
    X = bar.mesh.V[bar.labels == 2] - [1, 1, 0]
    np.testing.assert_allclose(held_at(bar, found[-1]) - [1, 1, 0], X[:, [1, 0, 2]] * [1, -1, 1], atol=1e-9)


def test_abscissa_is_what_tells_the_steps_apart(bar):
    for pose, kind in (
        (BENT, "degrees"),
        (translation([0, 0, 1]), "way"),
        (translation([1, 0, 0]) @ BENT, "part"),
        (scaling_about([1, 1, 6], 1.2), "part"),
    ):
        assert case_of(bar.with_pose(0, pose), 2).abscissa == kind


def test_case_steps_takes_at_no_step_more_iterations_than_it_may(bar):
    document = bar.with_pose(0, BENT).with_settings(contact=False)
    found = swept(document, 3, methods=["exact"], iterations=2)
    assert all(step.frame.iteration <= 2 for step in found)
    assert not found[-1].frame.settled


def test_case_steps_ends_in_contact_with_the_shape_of_a_deformation_by_any_number_of_steps(bar):
    document = bar.with_pose(0, BENT)
    held = document.constraints()
    alone = deform(bar.mesh.V, bar.mesh.F, held.fixed, held.targets, handle=held.handles, area=100.0)
    for steps in (1, 3):
        last = swept(document, steps, methods=["exact"])[-1].frame
        assert last.settled
        np.testing.assert_allclose(last.U, alone.U, atol=1e-7)  # as far as shapes at rest agree


def test_case_steps_ticks_never_go_back_and_can_end_it(bar):
    case, ticks = case_of(bar.with_pose(0, BENT).with_settings(method="arap"), 3), []
    list(case_steps(case, ticks.append))
    assert ticks == sorted(ticks)
    assert 0.5 < ticks[-1] <= 1

    def stop(done):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        next(case_steps(case, stop))


WRONG = {
    "no motion": (lambda bar: case_of(bar, 3), "No handle has moved"),
    "no steps": (lambda bar: case_of(bar.with_pose(0, BENT), 0), "1 to 1000 steps"),
    "no end": (lambda bar: case_of(bar.with_pose(0, BENT), 3, 0.0), "greater than 0"),
    "an end without a number": (
        lambda bar: case_of(bar.with_pose(0, BENT), 3, float("nan")),
        "greater than 0",
    ),
    "no method": (lambda bar: swept(bar.with_pose(0, BENT), 3, methods=[]), "at least one"),
    "a method twice": (lambda bar: swept(bar.with_pose(0, BENT), 3, methods=["arap"] * 2), "once"),
    "an unknown method": (
        lambda bar: swept(bar.with_pose(0, BENT), 3, methods=["fast"]),
        "Unknown method 'fast'",
    ),
    "half turn": (
        lambda bar: case_of(bar.with_pose(0, rotation_about([1, 1, 0], [0, 0, 1], np.pi)), 3),
        "twist of 180deg",
    ),
    "no iterations": (lambda bar: case_of(bar, 3, iterations=0), "at least one iteration"),
}


@pytest.mark.parametrize("case", WRONG)
def test_case_of_says_what_cannot_be_swept(case, bar):
    act, words = WRONG[case]
    with pytest.raises(InputError, match=words):
        act(bar)


def test_case_steps_says_at_each_step_what_turn_is_held(bar):
    turn = (MotionStep(0, MOTIONS["TWIST"], (np.radians(-400.0),)),)
    case = case_of(bar.with_settings(contact=False, method="arap"), 5, motion=turn)
    steps = list(case_steps(case))
    assert [step.readings["turned"] for step in steps] == pytest.approx(
        [0.0, -80.0, -160.0, -240.0, -320.0, -400.0]
    )
    held = [step.readings["turned_held"] for step in steps]
    assert held[0] is None
    assert held[1:] == pytest.approx([-80.0, -160.0, 120.0, 40.0, -40.0], abs=1e-6)
    (said,) = case.step_warnings(steps[-1])
    assert said.startswith("The surface holds -40 of the -400 degrees asked: without contact")
    assert case.step_warnings(steps[1]) == ()
