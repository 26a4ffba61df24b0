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
from apd_viewer.geometry.solver import methods
from apd_viewer.session.model.state import opened
from apd_viewer.session.model.view import View
from apd_viewer.session.posing.motion_path import motion_paths, posed_along
from apd_viewer.session.posing.motion_step import MotionStep
from apd_viewer.session.storage.session_file import save_session
from apd_viewer.session.studies.replay import replay

V, F = tube(16, 14)
BASE, HANDLE = ends(V)
TURN = 240  # degrees: without contact the tube unwinds by passing through itself
TUBE = ("tube.off", "--selection", "tube.sel", f"--twist={TURN}deg")


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


def deformed(*words):
    """The report of a deformation, and whether its shape crosses itself."""
    run("deform", *TUBE, *words, "-o", "out.off", "--report", "report.json")
    crosses = CrossingCheck(V, F).crosses(apd_viewer.open_mesh("out.off").V)
    return json.loads(Path("report.json").read_text(encoding="utf-8")), crosses


def rows(path):
    with Path(path).open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def swept(*words, steps=4):
    run("sweep", *TUBE, "--methods", "exact", "--steps", steps, *words, "-o", "swept")
    return float(rows("swept/sweep.csv")[-1]["volume_capped"])


def studied():
    """Last volume and number of crossings of a case of a designed plan."""
    given = ("--mesh", "tube.off", "--selection", "tube.sel", "--set", "steps=4")
    run("study", "design", *given, "--vary", f"motion=twist {TURN}deg", "-o", "plan.csv", "--method", "grid")
    run("study", "plan.csv", "-o", "study", "--processes", "1")
    (row,) = rows("study/results.csv")
    assert row["contact"] == "auto"
    return float(row["volume_capped"]), int(row["crossings"])


def in_python(**said):
    turns = [rotation([0, 0, 1], np.radians(TURN * k / 6)) for k in range(1, 7)]
    way = np.array([np.vstack([V[BASE], V[HANDLE] @ turn.T]) for turn in turns])
    return apd_viewer.deform(V, F, np.concatenate([BASE, HANDLE]), way, handle=HANDLE, **said)


def replayed():
    """What the window does with a typed motion: a session of it, solved from rest."""
    state = opened(apd_viewer.open_mesh("tube.off"), labels())
    motion = [MotionStep(0, "twist", (np.radians(TURN),))]
    posed = posed_along(state.document, motion_paths(state.document, motion))
    save_session("new.apd", state.at(posed), View())
    return replay("new.apd", from_rest=True)[1]


def test_every_way_gives_the_same_volume_without_a_crossing():
    report, crosses = deformed()
    volume = report["volume_capped"]
    assert not crosses
    assert report["share_reached"] == 1.0
    for other in (in_python(), replayed()):
        assert other.volume_capped == pytest.approx(volume, rel=0.01)
        assert not CrossingCheck(V, F).crosses(other.U)
    assert swept() == pytest.approx(volume, rel=0.01)
    assert swept(steps=1) == pytest.approx(volume, rel=0.01)
    assert studied() == (pytest.approx(volume, rel=0.01), 0)


def test_without_contact_it_is_said():
    report, _ = deformed("--no-contact")
    assert report["least_gap"] is None
    unwound = report["volume_capped"]
    assert unwound == pytest.approx(in_python(contact=False).volume_capped, rel=1e-6)
    kept = deformed()[0]["volume_capped"]
    assert abs(unwound / kept - 1) > 0.05
    assert abs(swept("--no-contact") / kept - 1) > 0.05


def test_a_thickness_needs_no_word_of_contact(capsys):
    report, crosses = deformed("--thickness", "0.05")
    assert not crosses
    assert 0.01 < report["least_gap"] <= 0.05
    for words in (["--no-contact"], ["--iterations", "5"], ["--method", "paper"]):
        assert main(["deform", *TUBE[:3], "--twist=90deg", "--thickness", "0.05", *words, "-o", "x.off"]) == 2
        assert "--thickness is the distance" in capsys.readouterr().err


def test_large_meshes_say_how_contact_is_turned_on(monkeypatch, capsys):
    monkeypatch.setattr(methods, "MOST_IN_CONTACT", len(V) - 1)
    report, _ = deformed()
    assert any("Walls may pass through each other" in said for said in report["warnings"])
    capsys.readouterr()
    swept()
    assert capsys.readouterr().out.count("turn it on by --contact") == 1
    swept("--no-contact")
    assert "Walls" not in capsys.readouterr().out
