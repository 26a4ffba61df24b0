"""CAD models: divided in a process of their own, in mm, closed, with even triangles."""

import json
import os
import time
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from cad_contents import box_corners, divided_into, iges_box, step_boxes, step_cylinder
from mesh_contents import CUBE, QUADS, binary_stl, obj

from apd_viewer.__main__ import main
from apd_viewer.commands.remesh_command import worst_aspect
from apd_viewer.errors import InputError
from apd_viewer.files.formats import cad
from apd_viewer.files.mesh_formats import CAD_FORMATS
from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh, read_mesh
from apd_viewer.geometry.analysis.inspection import inspect
from apd_viewer.geometry.mesh.arrays import diagonal
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.background_job import Jobs
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.model.view import View
from apd_viewer.session.storage.session_file import open_session_file, save_session

BOX = box_corners((40, 30, 20))
BOX_EDGES = [(a, b) for a in range(8) for b in range(a) if np.count_nonzero(BOX[a] - BOX[b]) == 1]
CYLINDER = np.pi * 15**2 * 40
SOLIDS = {
    "box.step": (step_boxes(BOX), 24_000),
    "in metres.STEP": (step_boxes(BOX / 1000, unit="$"), 24_000),
    "apart.step": (step_boxes(BOX, BOX + (50, 0, 0)), 48_000),
    "cylinder.stp": (step_cylinder(15, 40), CYLINDER),
    "box.igs": (iges_box(BOX), 24_000),
    "in inches.iges": (iges_box(BOX, "1,4HINCH"), 24_000 * 25.4**3),
}

STEP = SOLIDS["cylinder.stp"][0]


@pytest.fixture
def installed(monkeypatch):
    """As if the extra were installed."""
    monkeypatch.setattr(cad, "find_spec", lambda library: library)


@pytest.mark.parametrize("name", ["a.step", "a.stp", "a.igs", "a.iges"])
def test_read_cad_names_the_extra_where_it_is_missing(name, tmp_path, monkeypatch):
    (tmp_path / name).write_bytes(SOLIDS["box.step"][0])
    monkeypatch.setattr(cad, "find_spec", {}.get)
    with pytest.raises(InputError, match=r'pip install "apd-viewer\[cad\]"'):
        open_mesh(tmp_path / name)


def test_read_cad_outlives_a_process_that_crashes(tmp_path, monkeypatch, installed):
    monkeypatch.setattr(cad, "START_SCRIPT", "import os; os._exit(139)")
    (tmp_path / "a.step").write_bytes(SOLIDS["box.step"][0])
    with pytest.raises(InputError, match=r"a\.step is not a valid STEP file \(it is damaged"):
        open_mesh(tmp_path / "a.step")


def test_read_cad_ends_its_process_when_it_is_cancelled(tmp_path, monkeypatch, installed):
    """As soon as it is asked, and not after the minute that the process would take."""
    script = f"import os, pathlib, time; pathlib.Path({str(tmp_path / 'pid')!r}).write_text(str(os.getpid()))"
    monkeypatch.setattr(cad, "START_SCRIPT", f"{script}; time.sleep(60)")
    (tmp_path / "a.step").write_bytes(STEP)
    failed, told = [], []
    jobs = Jobs(lambda: None, failed.append, told.append, lambda: None)
    jobs.run("Opening a.step", lambda: open_mesh(tmp_path / "a.step"), failed.append)
    job = jobs.current
    until(lambda: (tmp_path / "pid").exists() and (tmp_path / "pid").read_text())
    jobs.cancel()
    job.join(20)
    assert not is_running(int((tmp_path / "pid").read_text()))
    jobs.receive_outcomes()
    assert (failed, told) == ([], ["Opening a.step: cancelled."])


def until(happened):
    end = time.monotonic() + 20
    while not happened():
        assert time.monotonic() < end
        time.sleep(0.01)


def is_running(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True


def test_read_cad_waits_no_longer_than_its_limit(tmp_path, monkeypatch, installed):
    monkeypatch.setattr(cad, "START_SCRIPT", "import time; time.sleep(60)")
    monkeypatch.setattr(cad, "TIME_LIMIT", 0.2)
    (tmp_path / "a.igs").write_bytes(SOLIDS["box.igs"][0])
    with pytest.raises(InputError, match="takes longer than"):
        open_mesh(tmp_path / "a.igs")


@pytest.mark.parametrize("suffix", CAD_FORMATS)
def test_save_mesh_says_that_cad_is_only_read(suffix, tmp_path):
    mesh = Mesh(CUBE, [[0, 1, 2]])
    with pytest.raises(InputError, match=rf"cannot be written: {CAD_FORMATS[suffix].name} is only read"):
        save_mesh(mesh, mesh.V, tmp_path / f"a{suffix}")


def test_open_session_file_has_the_triangles_of_a_cad_model_in_it(tmp_path, monkeypatch, installed):
    """Another version of the libraries would divide the model otherwise."""
    monkeypatch.setattr(cad, "START_SCRIPT", divided_into(np.eye(3)))
    (tmp_path / "a.step").write_bytes(STEP)
    mesh = open_mesh(tmp_path / "a.step")
    assert (mesh.unit, mesh.V.tolist()) == ("mm", np.eye(3).tolist())
    save_session(tmp_path / "a.apd", initial_state(mesh), View())
    monkeypatch.setattr(cad, "START_SCRIPT", divided_into(np.eye(3)[::-1]))
    state = open_session_file(tmp_path / "a.apd").state
    assert state.document.mesh.digest == mesh.digest


@pytest.mark.extra
@pytest.mark.parametrize("name", SOLIDS)
def test_read_cad_gives_closed_even_meshes_in_mm(name, tmp_path):
    content, volume = SOLIDS[name]
    (tmp_path / name).write_bytes(content)
    mesh = open_mesh(tmp_path / name)
    found = inspect(mesh)
    assert (mesh.unit, found.openings) == ("mm", 0)
    assert found.volume == pytest.approx(volume, rel=2e-3)
    assert worst_aspect(mesh.V, mesh.F) <= 10
    assert len(mesh.remarks) == 1
    assert read_mesh(tmp_path / name, content).digest == mesh.digest, "sessions must find their mesh again"


@pytest.mark.extra
def test_read_cad_stays_within_its_tolerance():
    mesh = read_mesh(Path("cylinder.step"), STEP)
    corners = mesh.V[mesh.F]
    points = np.vstack([mesh.V, corners.mean(axis=1), corners[:, :2].mean(axis=1)])
    side = np.abs(np.hypot(points[:, 0], points[:, 1]) - 15)
    apart = np.min([side, np.abs(points[:, 2]), np.abs(points[:, 2] - 40)], axis=0)
    assert apart.max() <= cad.CHORD_TOLERANCE * np.hypot(np.hypot(30, 30), 40)


def distance_to_segment(points, a, b):
    share = np.clip((points - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
    return np.linalg.norm(points - a - share[:, None] * (b - a), axis=1)


@pytest.mark.extra
def test_read_cad_keeps_sharp_edges(tmp_path):
    (tmp_path / "box.step").write_bytes(SOLIDS["box.step"][0])
    mesh = open_mesh(tmp_path / "box.step")
    allowed = 0.5 * cad.CHORD_TOLERANCE * diagonal(BOX)
    ridges = np.array([(mesh.V[[*pair]]) for pair in _ridges(mesh)])
    samples = np.vstack([ridges.mean(axis=1), ridges[:, 0]])
    apart = np.min([distance_to_segment(samples, BOX[a], BOX[b]) for a, b in BOX_EDGES], axis=0)
    assert apart.max() <= allowed
    length = np.linalg.norm(ridges[:, 0] - ridges[:, 1], axis=1).sum()
    assert length == pytest.approx(4 * (40 + 30 + 20), rel=1e-3), "all twelve edges are there"


def _ridges(mesh):
    """Edges whose triangles meet at more than 40 degrees."""
    corners = mesh.V[mesh.F]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    sides = {}
    for face, (a, b, c) in enumerate(mesh.F.tolist()):
        for edge in ((a, b), (b, c), (c, a)):
            sides.setdefault(tuple(sorted(edge)), []).append(face)
    return [edge for edge, (one, other) in sides.items() if normals[one] @ normals[other] < np.cos(0.7)]


def _flipped(seed):
    content = bytearray(SOLIDS["cylinder.stp"][0])
    random = np.random.default_rng(seed)
    for place in random.integers(len(content) // 4, len(content), 60):
        content[place] ^= int(random.integers(1, 256))
    return bytes(content)


DAMAGED = {
    "empty": b"",
    "blank": b" \n" * 50,
    "text": b"Dear Sir or Madam,\n",
    "zeros": bytes(5000),
    "only a head": STEP[: STEP.index(b"DATA;")],
    "no data": STEP[: STEP.index(b"DATA;")] + b"DATA;\nENDSEC;\nEND-ISO-10303-21;\n",
    "another head": b"ISO 10303 by hand\n" + STEP,
    "OBJ": obj(CUBE, QUADS).encode(),
    "STL": binary_stl(CUBE, [face[:3] for face in QUADS]),
    "IGES": SOLIDS["box.igs"][0],
    **{f"cut at {part} %": STEP[: len(STEP) * part // 100] for part in (20, 40, 60, 80)},
    **{f"flipped {seed}": _flipped(seed) for seed in range(8)},
}


@pytest.mark.extra
@pytest.mark.parametrize("name", DAMAGED)
def test_read_cad_says_what_is_wrong_with_a_damaged_file(name, tmp_path):
    (tmp_path / "a.step").write_bytes(DAMAGED[name])
    with pytest.raises(InputError, match=r"^[^\n]{20,300}\.$"):
        open_mesh(tmp_path / "a.step")


@pytest.mark.extra
@pytest.mark.parametrize("part", [0.2, 0.4, 0.6])
def test_read_cad_says_that_an_iges_file_is_cut(part, tmp_path):
    content = SOLIDS["box.igs"][0]
    (tmp_path / "a.igs").write_bytes(content[: int(part * len(content))])
    with pytest.raises(InputError, match="is not a valid IGES file"):
        open_mesh(tmp_path / "a.igs")


@pytest.mark.extra
def test_even_triangles_replace_needles():
    V = np.vstack([BOX, [(x, 0, 0) for x in np.linspace(0.001, 39.999, 40)]])
    rim = [0, *range(8, 48), 1]
    fan = [(a, b, 5) for a, b in pairwise(rim)] + [(0, 5, 4)]
    floor = [(b, a, 2) for a, b in pairwise(rim)] + [(0, 2, 3)]
    others = [(4, 5, 6), (4, 6, 7), (1, 2, 6), (1, 6, 5), (2, 3, 7), (2, 7, 6), (3, 0, 4), (3, 4, 7)]
    F = np.array([*fan, *floor, *others])
    assert worst_aspect(V, F) > 20
    even, triangles, edge = cad.even_triangles(V, F, 3.0)
    found = inspect(Mesh(even, triangles))
    assert edge == 3.0
    assert found.volume == pytest.approx(24_000, rel=1e-3)
    assert worst_aspect(even, triangles) <= 5
    lengths = np.linalg.norm(even[triangles] - even[np.roll(triangles, 1, axis=1)], axis=2)
    assert lengths.mean() == pytest.approx(3.0, rel=0.25)


def test_open_mesh_divides_only_cad_models(tmp_path):
    (tmp_path / "box.obj").write_text(obj(CUBE, QUADS))
    for given in ({"chord": 0.1}, {"edge": 0}):
        with pytest.raises(InputError, match="has triangles already"):
            open_mesh(tmp_path / "box.obj", **given)
    for given in ({"chord": 0}, {"chord": float("nan")}, {"edge": -1}, {"edge": "2"}):
        with pytest.raises(InputError, match="must be a"):
            open_mesh(tmp_path / "box.step", **given)


@pytest.mark.extra
def test_open_mesh_divides_a_cad_model_by_the_lengths_given(tmp_path, capsys):
    (tmp_path / "a.step").write_bytes(STEP)

    def off(mesh):
        """Largest distance of the middles of the edges from the cylinder, inside of it."""
        middles = 0.5 * (mesh.V[mesh.F] + mesh.V[np.roll(mesh.F, 1, axis=1)])
        r = np.hypot(middles[..., 0], middles[..., 1])
        around = (middles[..., 2] > 0.1) & (middles[..., 2] < 39.9)
        return (15 - r[around]).max()

    coarse, fine = (open_mesh(tmp_path / "a.step", chord=chord, edge=0) for chord in (0.8, 0.04))
    assert off(fine) <= 0.04 < off(coarse) <= 0.8
    assert worst_aspect(fine.V, fine.F) > 10, "no even triangles"
    even = open_mesh(tmp_path / "a.step", chord=0.4, edge=2)
    lengths = np.linalg.norm(even.V[even.F] - even.V[np.roll(even.F, 1, axis=1)], axis=2)
    assert lengths.mean() == pytest.approx(2, rel=0.3)
    assert off(even) <= 0.4
    assert main(["info", str(tmp_path / "a.step"), "--chord", "0.4", "--edge", "2"]) == 0
    assert f"{len(even.V):,} vertices" in capsys.readouterr().out
    with pytest.raises(InputError, match="edge length of at least"):
        open_mesh(tmp_path / "a.step", edge=1e-6)


@pytest.mark.extra
def test_remesh_command_writes_even_triangles(tmp_path, capsys):
    (tmp_path / "a.step").write_bytes(STEP)
    out = tmp_path / "out.ply"
    assert main(["remesh", str(tmp_path / "a.step"), "--edge", "3", "-o", str(out), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    even = open_mesh(out)
    assert told["vertices"] == len(even.V) < told["vertices_before"]
    assert inspect(even).volume == pytest.approx(CYLINDER, rel=5e-3)
    assert told["worst_aspect"] <= 10


def test_remesh_command_says_no_in_one_line(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(cad, "find_spec", {}.get)
    box = tmp_path / "box.obj"
    box.write_text(obj(CUBE, QUADS))
    for words, sentence in (
        (["-o", "out.step"], "is only read"),
        (["--edge", "0", "-o", "out.ply"], "above 0"),
        (["--chord", "nan", "-o", "out.ply"], "above 0"),
        (["-o", "out.ply"], 'pip install "apd-viewer[cad]"'),
    ):
        assert main(["remesh", str(box), *words[:-1], str(tmp_path / words[-1])]) == 2
        assert sentence in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["box.obj"]
