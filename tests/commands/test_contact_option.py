"""One default of contact: command line, Python, sweep, study and session give the same volume."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest
import trimesh
from crossing_check import CrossingCheck
from meshes import ends, rotation, tube

import apd_viewer
from apd_viewer.__main__ import main
from apd_viewer.commands.replay_command import replay_session
from apd_viewer.geometry.solver import methods
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.model.view import View
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.session.posing.motion_path import MotionStep, document_along_paths, motion_paths
from apd_viewer.session.storage.session_file import save_session

pytestmark = pytest.mark.usefixtures("undrawn_sweeps", "cases_run_here")

V, F = tube(10, 9)
BASE, HANDLE = ends(V)
TURN = 240  # degrees: without contact the tube unwinds by passing through itself
TUBE = ("tube.off", "--selection", "tube.sel")


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    """A folder with a tube, painted."""
    monkeypatch.chdir(tmp_path)
    trimesh.Trimesh(V, F, process=False).export("tube.off")
    np.savetxt("tube.sel", labels(), fmt="%d")


def labels():
    painted = np.ones(len(V), dtype=np.uint8)
    painted[BASE], painted[HANDLE] = 0, 2
    return painted


def run(*words):
    assert main([str(word) for word in words]) == 0


def crosses(U):
    return CrossingCheck(V, F).crosses(U)


def deformed(*words, turn=TURN):
    """The report of a deformation, and whether its shape crosses itself."""
    run("deform", *TUBE, f"--twist={turn}deg", *words, "-o", "out.off", "--report", "report.json")
    report = json.loads(Path("report.json").read_text(encoding="utf-8"))
    return report, crosses(apd_viewer.open_mesh("out.off").V)


def rows(path):
    with Path(path).open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def swept(*words, steps=4, turn=TURN):
    """Last volume of a sweep, and whether its shape crosses itself."""
    how = ("--methods", "exact", "--steps", steps, "--meshes", *words)
    run("sweep", *TUBE, f"--twist={turn}deg", *how, "-o", "swept")
    last = apd_viewer.open_mesh(f"swept/meshes/exact-{steps:03d}.off")
    return float(rows("swept/sweep.csv")[-1]["volume_capped"]), crosses(last.V)


def studied(*words, turn=TURN):
    """Row of the results of a case of a designed plan."""
    given = ("--mesh", "tube.off", "--selection", "tube.sel", "--set", "steps=4", *words)
    run("study", "design", *given, "--vary", f"motion=twist {turn}deg", "-o", "plan.csv", "--method", "grid")
    run("study", "plan.csv", "-o", "study", "--processes", "1")
    (row,) = rows("study/results.csv")
    return row


def in_python(turn=TURN, **said):
    turns = [rotation([0, 0, 1], np.radians(turn * k / 6)) for k in range(1, 7)]
    way = np.array([np.vstack([V[BASE], V[HANDLE] @ turn.T]) for turn in turns])
    return apd_viewer.deform(V, F, np.concatenate([BASE, HANDLE]), way, handle=HANDLE, **said)


def replayed(turn=TURN, **changed):
    """What the window does with a typed motion: a session of it, solved from rest."""
    state = initial_state(apd_viewer.open_mesh("tube.off"), labels())
    document = state.document.with_settings(**changed)
    motion = [MotionStep(0, MOTIONS["TWIST"], (np.radians(turn),))]
    save_session(
        "new.apd", state.updated(document_along_paths(document, motion_paths(document, motion))), View()
    )
    return replay_session("new.apd", from_rest=True)[1]


BOTH_WAYS = pytest.mark.parametrize("turn", [TURN, pytest.param(-TURN, marks=pytest.mark.night)])


@pytest.mark.night
@BOTH_WAYS
def test_contact_by_default_gives_the_same_volume_by_every_way_without_a_crossing(turn):
    report, crossed = deformed(turn=turn)
    same = pytest.approx(report["volume_capped"], rel=0.01)
    assert not crossed
    assert report["share_reached"] == 1.0
    assert report["turned_held"] == pytest.approx([turn], abs=1e-6)
    for other in (in_python(turn), replayed(turn)):
        assert (other.volume_capped, crosses(other.U)) == (same, False)
        assert other.turned_held == pytest.approx((turn,), abs=1e-6)
    for steps in (1, 4):
        assert swept(steps=steps, turn=turn) == (same, False)
    row = studied(turn=turn)
    assert (row["contact"], float(row["volume_capped"]), row["crossings"]) == ("auto", same, "0")


@BOTH_WAYS
def test_pass_through_warnings_say_by_each_way_what_was_lost_without_contact(turn, capsys):
    lost = f"The surface holds {turn - np.sign(turn) * 360} of the {turn} degrees asked: without contact"
    report, _ = deformed("--no-contact", turn=turn)
    assert report["least_gap"] is None
    assert lost in capsys.readouterr().out
    same = pytest.approx(report["volume_capped"], rel=1e-3)
    for other in (in_python(turn, contact=False), replayed(turn, contact=False)):
        assert other.volume_capped == same
        assert any(lost in said for said in other.warnings)
    capsys.readouterr()
    swept("--no-contact", turn=turn)
    assert lost in capsys.readouterr().out
    assert lost in studied("--set", "contact=no", turn=turn)["sentence"]


@pytest.mark.night
def test_contact_option_gives_another_volume_when_turned_off():
    kept = deformed()[0]["volume_capped"]
    for unwound in (deformed("--no-contact")[0]["volume_capped"], swept("--no-contact")[0]):
        assert abs(unwound / kept - 1) > 0.05


def test_deform_takes_a_thickness_without_a_word_of_contact(capsys):
    report, crossed = deformed("--thickness", "0.05")
    assert not crossed
    assert 0.01 < report["least_gap"] <= 0.05
    for words in (["--no-contact"], ["--iterations", "5"], ["--method", "paper"]):
        assert main(["deform", *TUBE, "--twist=90deg", "--thickness", "0.05", *words, "-o", "x.off"]) == 2
        assert "--thickness is the distance" in capsys.readouterr().err


def test_contact_by_default_is_off_for_large_meshes_which_say_how_it_is_turned_on(monkeypatch, capsys):
    monkeypatch.setattr(methods, "MOST_VERTICES_IN_CONTACT", len(V) - 1)
    report, _ = deformed()
    assert any("Walls may pass through each other" in said for said in report["warnings"])
    capsys.readouterr()
    swept()
    assert capsys.readouterr().out.count("turn it on by --contact") == 1
    swept("--no-contact")
    assert "Walls" not in capsys.readouterr().out
