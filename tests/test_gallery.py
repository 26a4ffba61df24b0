"""The entries of the gallery run as they are printed, on coarse meshes, and their sessions open.

By day one of each kind does, and the lines of the others are only read.
"""

import json
import shlex
import zipfile
from pathlib import Path

import numpy as np
import pytest
import trimesh
from entries import ENTRIES, GROUPS
from gallery_page import gallery_page, printed
from make_glb import write_bottle
from make_sessions import SESSIONS

from apd_viewer.__main__ import parse_arguments
from apd_viewer.files.animations.animation_reading import open_animation
from apd_viewer.geometry.mesh.arrays import diagonal
from apd_viewer.session.storage.session_file import open_session

COUNT = 600  # vertices, about
MOST = 4_200_000  # bytes of all sessions
DAILY = {"bottle_twisted", "bottle_label", "falloff"}
NAMES = [pytest.param(name, marks=() if name in DAILY else pytest.mark.night) for name in ENTRIES]


def test_gallery_has_many_entries_and_each_is_short():
    assert len(ENTRIES) == sum(map(len, GROUPS.values())) >= 24
    for entry in ENTRIES.values():
        assert len(entry.code.splitlines()) <= 5
        assert entry.sentence.endswith(".")
        assert entry.sentence.count(".") <= 3


def test_gallery_has_the_sessions_of_its_entries():
    assert {path.stem for path in SESSIONS.glob("*.apd")} == set(ENTRIES)
    assert sum(path.stat().st_size for path in SESSIONS.iterdir()) <= MOST


def test_gallery_page_has_picture_code_and_session_of_each_entry():
    page = gallery_page()
    for entry in ENTRIES.values():
        assert f"```{entry.language}\n{printed(entry)}\n```" in page
        assert printed(entry).replace(" \\\n   ", "") == entry.code
        assert f"(pictures/gallery_{entry.name}.webp)" in page
        assert f"(gallery/sessions/{entry.name}.apd)" in page


@pytest.mark.parametrize("name", ENTRIES)
def test_gallery_has_lines_that_can_be_read(name):
    entry = ENTRIES[name]
    if entry.language == "python":
        compile(entry.quick_code, name, "exec")
        return
    for line in entry.quick_code.replace("\\\n", " ").splitlines():
        parse_arguments(shlex.split(line)[1:])


def in_place(state):
    """Largest distance of a held vertex from where the handles of a state want it, in diagonals."""
    held, U = state.document.constraints(), state.frame.U
    away = np.linalg.norm(U[held.fixed] - held.targets, axis=1)
    return away.max() / diagonal(state.document.mesh.V)


def place_of_mesh(session):
    """Where a session says that its mesh is; in the gallery that names no folder."""
    with zipfile.ZipFile(session) as archive:
        return Path(json.loads(archive.read("session.json"))["mesh"]["path"])


@pytest.mark.parametrize("name", NAMES)
def test_gallery_has_lines_that_run_and_a_session_that_says_the_same(name, compiled, tmp_path):
    entry = ENTRIES[name]
    state = entry.run(tmp_path, COUNT, quickly=True)
    document = state.document
    assert np.isfinite(state.frame.U).all()
    assert not np.array_equal(state.frame.U, document.mesh.V)
    if not document.paint_problem and not document.has_active_obstacles:
        assert in_place(state) < (0.1 if document.settings.traits.moves_handles else 1e-5)
    path = entry.save(state, tmp_path)
    assert place_of_mesh(path) == Path(tmp_path.anchor) / document.mesh.name
    np.testing.assert_array_equal(open_session(path)[0].frame.U, state.frame.U)


@pytest.mark.parametrize("name", NAMES)
def test_gallery_session_to_download_opens_and_can_be_replayed_unless_it_is_pressed(name):
    state, view = open_session(SESSIONS / f"{name}.apd")
    assert bool(state.document.paint_problem) == ENTRIES[name].code.startswith("apd-viewer press")
    assert place_of_mesh(SESSIONS / f"{name}.apd").as_posix() == f"/{state.document.mesh.name}"
    assert view.unit == ENTRIES[name].unit
    assert 500 < len(state.document.mesh.V) < 7000
    assert not np.array_equal(state.frame.U, state.document.mesh.V)
    if not state.document.paint_problem and not state.document.has_active_obstacles:
        assert in_place(state) < (0.1 if state.document.settings.traits.moves_handles else 1e-5)


@pytest.mark.night
def test_gallery_has_a_script_that_crushes_a_bottle_into_a_gltf_in_metres(compiled, tmp_path):
    path = tmp_path / "bottle.glb"
    write_bottle(path, steps=2, vertices=COUNT)
    content = path.read_bytes()
    size = int.from_bytes(content[12:16], "little")
    document = json.loads(content[20 : 20 + size])
    (buffer,), views = document["buffers"], document["bufferViews"]
    assert len(content) == 28 + size + buffer["byteLength"]
    widths = {"SCALAR": 4, "VEC3": 12}
    for accessor in document["accessors"]:
        view = views[accessor["bufferView"]]
        assert view["byteOffset"] % 4 == 0
        assert accessor["count"] * widths[accessor["type"]] == view["byteLength"]
        assert view["byteOffset"] + view["byteLength"] <= buffer["byteLength"]
    (surface,) = document["meshes"][0]["primitives"]
    vertices = {
        document["accessors"][number]["count"]
        for attributes in (surface["attributes"], *surface["targets"])
        for number in attributes.values()
    }
    assert len(vertices) == 1
    numbers = np.frombuffer(content, "<f4", offset=28 + size + views[0]["byteLength"])
    assert np.isfinite(numbers).all()
    rest = trimesh.load(path, force="mesh", process=False)
    assert rest.extents.max() == pytest.approx(0.217, abs=0.001)  # metres: a bottle of half a litre
    shapes = list(open_animation(path).shapes)
    assert len(shapes) == 3
    volumes = [trimesh.Trimesh(U, rest.faces, process=False).volume for U in shapes]
    assert volumes[0] == pytest.approx(0.5e-3, rel=0.03)  # as coarse as here
    assert volumes[2] < 0.9 * volumes[0]
