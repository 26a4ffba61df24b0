"""A case: the shapes and readings of the sweep, a session of it, and sentences where it fails."""

import numpy as np
import pytest
import trimesh
from meshes import ends, tube

from apd_viewer.cases import run_case as module
from apd_viewer.cases.case import case_of, case_steps as steps_of
from apd_viewer.cases.case_file import case_path, case_to_bytes, write_case
from apd_viewer.cases.run_case import CaseDocuments, case_session, case_state, run_case
from apd_viewer.errors import InputError
from apd_viewer.files.meshes import open_mesh
from apd_viewer.files.selections.selection_files import read_selection_file
from apd_viewer.geometry.analysis.self_intersections import crossings
from apd_viewer.geometry.pose.transforms import rotation_about
from apd_viewer.session.model.document_parts import with_selection
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.model.view import View
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.session.posing.motion_path import MotionStep
from apd_viewer.session.quantities.wall import WallText
from apd_viewer.session.storage.session_file import open_session, save_session


@pytest.fixture
def run(planned):
    """Run a case of the bar."""

    def result(limit=None, **cells):
        (row,) = planned(cells).rows
        assert row.mistake == ""
        return run_case(row.case, CaseDocuments(lambda source: source.path.read_bytes()), limit)

    return result


@pytest.fixture
def document(bar):
    mesh = open_mesh(bar / "bar.off")
    return with_selection(initial_state(mesh).document, read_selection_file(bar / "bar.sel", mesh))


@pytest.mark.parametrize("contact", ["", "no", "auto", "yes"])
def test_run_case_is_a_sweep_bit_for_bit(run, document, contact):
    result = run(motion="twist 200deg", steps="3", iterations="40", method="exact", contact=contact)
    # New documents are in contact, and plans that do not say it are not.
    document = document.with_settings(contact=document.settings.contact and contact in ("auto", "yes"))
    twist = MotionStep(0, MOTIONS["TWIST"], (np.radians(200.0),))
    steps = list(steps_of(case_of(document, 3, 1.0, 40, [twist])))
    assert np.array_equal(result.U, steps[-1].frame.U)
    for name, values in {
        "area": [step.frame.area for step in steps],
        "volume": [step.frame.volume for step in steps],
        "energy": [step.energy for step in steps],
        "degrees": [step.degrees for step in steps],
    }.items():
        assert result.curves[name] == values
        assert result.readings[name] == values[-1]


def test_run_case_gives_the_readings_of_the_shape(run, document):
    result = run(motion="twist 170deg; push 30%", method="arap", iterations="200")
    shape = trimesh.Trimesh(result.U, document.mesh.F, process=False)
    found = result.readings
    assert found["area"] == pytest.approx(shape.area, rel=1e-12)
    assert found["volume"] == pytest.approx(shape.volume, rel=1e-12)
    assert found["area_error"] == pytest.approx(shape.area / found["area_rest"] - 1, abs=1e-12)
    assert found["box_volume"] == pytest.approx(np.prod(shape.extents), rel=1e-12)
    assert found["hull_volume"] == pytest.approx(shape.convex_hull.volume, rel=1e-9)
    assert found["crossings"] == len(crossings(result.U, document.mesh.joined_F))
    assert found["crossings"] > 0
    assert found["handle_drift"] == pytest.approx(0.0, abs=1e-12)
    assert found["volume_capped"] is None


@pytest.mark.parametrize(
    "cells", [{"motion": "twist 400deg; push 10%"}, {"motion": "bend 30", "contact": "yes"}]
)
def test_case_session_lets_a_case_open_as_a_session(cells, run, bar):
    result = run(**cells, iterations="30", unit="cm")
    write_case(case_path(bar, result.key), case_to_bytes(result))
    save_session(bar / "case.apd", *case_session(bar, result.key), embed=True)
    state, view = open_session(bar / "case.apd")
    assert np.array_equal(state.frame.U, result.U)
    assert state.frame.area_error == pytest.approx(result.readings["area_error"], abs=1e-12)
    posed = state.document
    assert (view.unit, posed.settings.contact, posed.mesh.name) == ("cm", "contact" in cells, "bar.off")
    if not posed.settings.contact:  # which stops the handle on its way
        held = posed.constraints()
        np.testing.assert_allclose(result.U[held.fixed], held.targets, atol=1e-9)
    turned = np.degrees(np.linalg.norm(posed.handles[0].rotation))
    assert turned == pytest.approx(400 if "400" in cells["motion"] else 30)


def test_run_case_walks_the_own_motion_of_a_session_or_a_given_one(bar, document, planned):
    pose = rotation_about([1, 1, 0], [1, 0, 0], 0.5)
    save_session(
        bar / "bar.apd", initial_state(document.mesh).updated(document.with_pose(0, pose)), View(unit="mm")
    )
    nothing = {"mesh": "bar.apd", "selection": "", "motion": "", "method": "arap"}
    plan = planned(nothing, {**nothing, "motion": "push 1mm"})
    meshes = CaseDocuments(lambda source: source.path.read_bytes())
    own, pushed = (run_case(case, meshes) for case in plan.cases.values())
    handle, X = document.labels == 2, document.mesh.V
    np.testing.assert_allclose(own.U[handle], X[handle] @ pose[:3, :3].T + pose[:3, 3], atol=1e-12)
    np.testing.assert_allclose(pushed.U[handle], X[handle] - [0, 0, 1], atol=1e-12)


def test_run_case_says_in_a_sentence_what_does_not_fit_the_mesh(run, bar, monkeypatch):
    assert "no handle 2" in run(motion="handle 2: push 1").sentence
    assert "longer than 1e-06 s" in run(limit=1e-6).sentence
    V, F = tube()
    base, handle = ends(V)
    labels = np.ones(len(V), dtype=int)
    labels[base], labels[handle] = 0, 2
    (bar / "bar.sel").write_text("0\n1\n2\n")
    assert "for a mesh of 3 vertices" in run().sentence
    trimesh.Trimesh(V, F, process=False).export(bar / "bar.off")
    np.savetxt(bar / "bar.sel", labels, fmt="%d")
    assert "no volume to keep" in run(volume="50").sentence
    monkeypatch.setattr(module, "check_shape", lambda *_: 1 / 0)
    result = run(iterations="2")
    assert (result.status, result.U) == ("failed", None)
    assert "ZeroDivisionError" in result.sentence


def test_run_case_says_that_targets_are_out_of_reach(run):
    result = run(volume="900", iterations="300", steps="1")
    assert result.status == "done"
    assert "volume" in result.sentence


def test_run_case_holds_the_pressure_of_a_plan_as_the_command_does(run, document):
    """By thickness and Young's modulus of the row; and it widens the bar."""
    words = {
        "motion": "twist 1deg",
        "steps": "1",
        "method": "wall",
        "wall_thickness": "0.02",
        "poisson": "0.3",
    }
    plain, filled = (run(**words, **more) for more in ({}, {"pressure": "20mbar", "young": "10MPa"}))
    settings = {
        "method": "wall",
        "wall_thickness": 0.02,
        "poisson": 0.3,
        "pressure": 2000.0 * 4.0 / (1e7 * 0.02),
    }
    held = document.with_settings(**settings, contact=False)
    twist = MotionStep(0, MOTIONS["TWIST"], (np.radians(1.0),))
    *_, last = steps_of(case_of(held, 1, 1.0, None, [twist]))
    np.testing.assert_allclose(filled.U, last.frame.U, atol=1e-9)
    assert filled.readings["volume"] > 1.001 * plain.readings["volume"]


def test_run_case_holds_the_pressure_of_a_plan_in_place_of_what_a_session_keeps(planned, document, bar):
    """The modulus is that of the session's wall, unless the plan has another one."""
    wall = WallText(thickness="0.02mm", young="10MPa")
    document = document.with_settings(method="wall", wall_thickness=0.02, poisson=0.3, volume=90.0)
    state = initial_state(document.mesh).updated(document)
    for name, view in (("known", View(unit="mm", wall=wall)), ("bare", View(unit="mm"))):
        save_session(bar / f"{name}.apd", state, view, embed=True)
    cells = {"selection": "", "motion": "", "pressure": "20mbar"}
    plan = planned(
        {**cells, "mesh": "known.apd"},
        {**cells, "mesh": "known.apd", "young": "20MPa"},
        {**cells, "mesh": "bare.apd"},
        {**cells, "mesh": "known.apd", "pressure": "", "volume": "95"},
    )
    assert [row.mistake for row in plan.rows] == 4 * [""]
    documents = CaseDocuments(lambda source: source.path.read_bytes())
    own, stiffer, _, volume = (row.case for row in plan.rows)
    held = [case_state(case, documents)[0].document.settings for case in (own, stiffer, volume)]
    pressure = 2000.0 * 4.0 / (1e7 * 0.02)
    assert [each.volume for each in held] == [None, None, 95.0]
    assert held[0].pressure == pytest.approx(pressure)
    assert held[1].pressure == pytest.approx(pressure / 2.0)
    assert held[2].pressure is None
    with pytest.raises(InputError, match="fill in “young”"):
        case_state(plan.rows[2].case, documents)


def test_run_case_says_that_steps_do_not_settle(run):
    result = run(iterations="1", motion="twist 90deg")
    assert "of 3 shapes did not converge within 1 iterations" in result.sentence
    assert result.readings["unsettled_steps"] > 0


def test_part_of_motion_is_a_smaller_motion(run, bar):
    """Of typed motions, and of that of a session, whose handle then stands where the shape is."""
    part, whole = run(motion="twist 40deg", to="50%"), run(motion="twist 20deg")
    np.testing.assert_array_equal(part.U, whole.U)
    assert part.key != whole.key
    write_case(case_path(bar, part.key), case_to_bytes(part))
    save_session(bar / "part.apd", *case_session(bar, part.key), embed=True)
    state, _ = open_session(bar / "part.apd")
    turned = np.degrees(np.arccos((np.trace(state.document.handles[0].pose[:3, :3]) - 1.0) / 2.0))
    assert turned == pytest.approx(20.0)
    plan = {"mesh": "", "selection": "", "motion": "", "session": "part.apd", "steps": "2"}
    half = run(**plan, to="50")
    np.testing.assert_allclose(half.U, run(motion="twist 10deg").U, atol=1e-6)


def test_run_case_says_that_a_turn_is_lost(run):
    result = run(motion="twist 400deg", steps="5", iterations="100", method="arap", contact="off")
    assert result.curves["turned"] == pytest.approx([0.0, 80.0, 160.0, 240.0, 320.0, 400.0])
    assert (result.readings["turned"], result.readings["turned_held"]) == pytest.approx((400.0, 40.0))
    assert "The surface holds 40 of the 400 degrees asked: without contact it passed" in result.sentence
    kept = run(motion="twist 80deg", steps="1", iterations="100", method="arap", contact="off")
    assert kept.readings["turned_held"] == pytest.approx(80.0)
    assert "holds" not in kept.sentence
