"""A session saved by the program of version 0.1.0, with most that can be said in it; never make it anew.

The numbers were read by that program from its own file.
"""

import json
import zipfile
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pytest
from driven_session import check_equal, check_same_array

from apd_viewer.__main__ import main
from apd_viewer.commands.replay_command import replay_session
from apd_viewer.files.meshes import open_mesh
from apd_viewer.files.storage.json_fields import JsonFields
from apd_viewer.geometry.solver.convergence import DEFAULT_CONVERGENCE
from apd_viewer.geometry.solver.settings import DEFAULT_SETTINGS, SETTINGS
from apd_viewer.session.model.view import CameraPose, View
from apd_viewer.session.quantities.wall import WallText
from apd_viewer.session.storage.session_file import open_session, save_session
from apd_viewer.session.storage.session_json import settings_from_json, settings_to_json

OLD = Path(__file__).with_name("version-1-posed.apd")

LEFT = [
    [0.9396926207859084, 0.0, 0.3420201433256687, -2.2231309316168466],
    [0.0, 1.0, 0.0, 0.0],
    [-0.3420201433256687, 0.0, 0.9396926207859084, 0.391997964891595],
    [0.0, 0.0, 0.0, 1.0],
]
RIGHT = [
    [0.9668467499028772, 0.2552975334611641, 0.005525541682853791, 0.38063954579369863],
    [-0.2552975334611641, 0.9659258262890683, 0.042549588910194, 0.08086147022075688],
    [0.005525541682853791, -0.042549588910194, 0.9990790763861911, 0.019893409034383552],
    [0.0, 0.0, 0.0, 1.0],
]
HIP = [[1.0, 0.0, 0.0, -0.25], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]]


def test_open_session_reads_all_that_an_old_session_said():
    state, view = open_session(OLD)
    document = state.document
    mesh = document.mesh
    assert (mesh.name, len(mesh.V), len(mesh.F)) == ("post.obj", 94, 184)
    assert mesh.V.sum() == pytest.approx(400.64905636129845, rel=1e-14), "the rest shape was baked"
    assert document.initial_positions is mesh.V
    assert [part.name for part in document.handles] == ["left ear", "right ear", "hip ü"]
    assert [part.pose.tolist() for part in document.handles] == [LEFT, RIGHT, HIP]
    left, right, hip = (part.pivot for part in document.handles)
    assert (left.tolist(), right.tolist(), hip) == ([0.0, 0.5, 6.5], [1.5, 0.5, 6.0], None)
    assert [part.falloff for part in document.handles] == [0.0, 0.0, 1.25]
    assert [(part.name, part.area) for part in document.regions] == [("foot", 98.0), ("waist", 104.0)]
    assert np.bincount(document.labels).tolist() == [12, 67, 6, 6, 3]
    assert np.bincount(document.member).tolist() == [22, 32, 40]
    assert (document.settings.method, document.settings.hold_area, document.settings.tolerance) == (
        "local",
        True,
        0.003,
    )
    weights = document.settings.stiffness, document.settings.area_stiffness, document.settings.shear_stiffness
    assert weights == (0.002, 5.0, 0.5)
    assert (document.settings.area, document.settings.volume) == (102.0, 97.0)
    camera = CameraPose((6.0, -14.0, 5.0), (0.75, 0.5, 3.0), (0.0, 0.0, 1.0), 0.5)
    assert view == View(camera, "mm", WallText("1.2", "1.04 g/cm3"), overlay="bending")


def test_open_session_measures_the_shape_of_an_old_session_as_it_was():
    frame = open_session(OLD)[0].frame
    assert frame.U.sum() == pytest.approx(396.1641370810066, rel=1e-14)
    assert frame.U[-1].tolist() == [2.1193604542063014, 0.919138529779243, 5.980106590965617]
    assert (frame.iteration, frame.settled, frame.converged, frame.unreached) == (38, True, True, None)
    assert frame.area == pytest.approx(33.660000002313325, rel=1e-12)
    assert frame.area_error == pytest.approx(0.020000000001470175, rel=1e-9)
    assert frame.volume == pytest.approx(8.518432297710332, rel=1e-12)
    assert frame.regions == pytest.approx((8.85066618548365, 11.599446686539974), rel=1e-12)
    assert frame.energy == pytest.approx(2.9413715154653604, rel=1e-12)


def test_replay_session_leads_an_old_session_to_the_same_shape(tmp_path):
    U = open_session(OLD)[0].frame.U
    check_same_array(replay_session(OLD)[1].U, U)
    again = replay_session(OLD, from_rest=True)[1]
    assert again.converged
    assert np.abs(again.U - U).max() < 0.05, "it is stiff, and bending has had another energy since"
    assert main(["replay", str(OLD), "-o", str(tmp_path / "post.obj")]) == 0
    assert np.abs(open_mesh(tmp_path / "post.obj").V - U).max() < 1e-6


def test_save_session_saves_an_old_session_with_the_same_content(tmp_path):
    state, view = open_session(OLD)
    save_session(tmp_path / "again.apd", state, view, embed=True)
    check_equal(open_session(tmp_path / "again.apd")[0], state)
    old, new = (zipfile.ZipFile(path) for path in (OLD, tmp_path / "again.apd"))
    assert new.namelist() == old.namelist()
    for name in old.namelist():
        if name != "session.json":
            assert new.read(name) == old.read(name), name
    said, again = (json.loads(archive.read("session.json")) for archive in (old, new))
    for each in (said, again):
        for where in ("path", "relative"):  # of the mesh's file, which is elsewhere
            each["mesh"].pop(where)
    # What it did not say, and is always said today.
    added = {name: again["document"].pop(name) for name in set(again["document"]) - set(said["document"])}
    unset = (
        "contact",
        "calm",
        "thickness",
        "yield_radius",
        "gas",
        "pressure",
        "tension_field",
        "filled_volume",
        "hardening",
    )
    assert not any(added.pop(name) for name in unset)
    defaults = {name: getattr(DEFAULT_SETTINGS, name) for name in ("wall_thickness", "poisson")}
    assert added == {"convergence": DEFAULT_CONVERGENCE._asdict(), **defaults}
    assert [again["frame"].pop(name) for name in ("stable", "saddle_escapes")] == [None, 0]
    assert (said.pop("program"), again.pop("program")) == ("0.1.0", version("apd-viewer"))
    assert again == said


@pytest.mark.parametrize("name", SETTINGS)
def test_settings_from_json_reads_a_setting_that_is_missing_as_its_default(name):
    said = settings_to_json(DEFAULT_SETTINGS)
    del said[name]
    found = vars(settings_from_json(JsonFields(said, "document")))
    # Calm parts were not kept before they could be.
    assert found == vars(DEFAULT_SETTINGS) | ({"calm": False} if name == "calm" else {})
