"""The command line: what it writes, what it says, and that it says no in one line."""

import json
import os
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh
from meshes import box, ends, grid, rotation, sphere, tube

import apd_viewer
from apd_viewer.__main__ import main, parse_arguments
from apd_viewer.commands import deform_command, result_output
from apd_viewer.commands.replay_command import replay_session
from apd_viewer.files.mesh_writing import WRITABLE_FORMATS, save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.analysis import shape_check
from apd_viewer.geometry.analysis.inspection import inspect
from apd_viewer.geometry.analysis.self_intersections import crossings
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.pose.constraints import transform
from apd_viewer.geometry.solver.deformation_result import deform
from apd_viewer.geometry.solver.methods import METHODS
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.model.view import View
from apd_viewer.session.storage.session_file import open_session, save_session

PNG = b"\x89PNG\r\n\x1a\n"
ENTRY = Path(sys.executable).parent / "apd-viewer"
PLAIN = [name for name, method in METHODS.items() if not method.is_wall]


def pose(angle=0.6, shift=(0.3, 0.1, -0.4)):
    M = np.eye(4)
    M[:3, :3], M[:3, 3] = rotation((1, 2, 0), angle), shift
    return M


class Case:
    """A mesh, its labels and a transform, as arrays and as files in a folder."""

    def __init__(self, folder, V, F, labels=None, M=None):
        self.folder, self.V, self.F = folder, V, F
        if labels is None:
            base, handle = ends(V)
            labels = np.ones(len(V), dtype=int)
            labels[base], labels[handle] = 0, 2
        self.labels, self.M = labels, pose() if M is None else M
        self.mesh, self.out, self.report = folder / "in.obj", folder / "out.obj", folder / "r.json"
        text = [f"v {x!r} {y!r} {z!r}" for x, y, z in V.tolist()]
        text += ["f {} {} {}".format(*f) for f in (F + 1).tolist()]
        self.mesh.write_text("\n".join(text))
        (folder / "s.sel").write_text("# labels\n" + "\n".join(map(str, labels)))
        np.savetxt(folder / "t.def", self.M, fmt="%.17g", header="handle")

    @property
    def fixed(self):
        return np.flatnonzero(self.labels != 1)

    @property
    def handle(self):
        return np.flatnonzero(self.labels == 2)

    @property
    def targets(self):
        moved = np.where((self.labels == 2)[:, None], transform(self.M, self.V), self.V)
        return moved[self.fixed]

    def words(self, *more, **named):
        """The words of a ``deform`` command; keywords replace its files."""
        files = {
            "mesh": self.mesh,
            "sel": self.folder / "s.sel",
            "def": self.folder / "t.def",
            "out": self.out,
        }
        files |= named
        words = [files["mesh"], "--selection", files["sel"], "--transform", files["def"], "-o", files["out"]]
        return [str(word) for word in ("deform", *words, *more)]


@pytest.fixture
def bar(tmp_path):
    """A closed bar, twisted and bent."""
    return Case(tmp_path, *box(2, 2, 5))


@pytest.fixture
def two_pieces(tmp_path):
    """The bar and, between its vertices, a ball that nothing holds."""
    V, F = box(2, 2, 5)
    W, G = sphere(1)
    at = 10  # vertices of the ball come after the tenth of the bar
    F, G = np.where(at <= F, F + len(W), F), G + at
    base, handle = ends(V)
    labels = np.ones(len(V), dtype=int)
    labels[base], labels[handle] = 0, 2
    case = Case(
        tmp_path,
        np.vstack([V[:at], W + [9.1, 0, 0], V[at:]]),
        np.vstack([G[:7], F, G[7:]]),
        np.concatenate([labels[:at], np.ones(len(W), dtype=int), labels[at:]]),
    )
    case.loose = slice(at, at + len(W))
    return case


@pytest.fixture
def command(capsys):
    """Run the command line here; return its status and what it said."""

    def run(*words):
        capsys.readouterr()
        try:
            status = main([str(word) for word in words])
        except SystemExit as end:  # argparse ends the process for --help and wrong options
            status = end.code or 0
        said = capsys.readouterr()
        return status, said.out, said.err

    return run


@pytest.fixture
def deformed(command):
    """Run ``deform`` with a report; return the report, the mesh written and what was said."""

    def run(case, *more):
        status, out, err = command(*case.words("--report", case.report, *more))
        assert (status, err) == (0, ""), err
        return json.loads(case.report.read_text()), open_mesh(case.out), out

    return run


def process(*words, env=None, without=()):
    """Run a real process; return its status, stdout and stderr."""
    environment = {k: v for k, v in {**os.environ, **(env or {})}.items() if k not in without}
    done = subprocess.run(
        [str(word) for word in words], env=environment, capture_output=True, check=False, timeout=60
    )
    return done.returncode, done.stdout.decode(), done.stderr.decode()


# ---- deform


@pytest.mark.parametrize("method", PLAIN)
@pytest.mark.parametrize("iterations", [1, 5])
def test_deform_gives_what_python_gives_bit_for_bit_for_a_count_of_iterations(
    method, iterations, bar, deformed
):
    report, _, _ = deformed(bar, "--method", method, "--iterations", iterations)
    result = deform(bar.V, bar.F, bar.fixed, bar.targets, method, iterations, handle=bar.handle)
    save_mesh(open_mesh(bar.mesh), result.U, bar.folder / "api.obj")
    assert bar.out.read_bytes() == (bar.folder / "api.obj").read_bytes()
    assert report["iterations"] == iterations
    for field in ("area_rest", "area", "area_error", "volume_rest", "volume", "energy", "handle_drift"):
        assert report[field] == getattr(result, field), field


def test_deform_keeps_held_vertices_where_they_were_put(bar, deformed):
    _, mesh, _ = deformed(bar, "--method", "arap", "--iterations", 3)
    np.testing.assert_allclose(mesh.V[bar.fixed], bar.targets, rtol=0, atol=1e-13)
    np.testing.assert_array_equal(mesh.F, bar.F)


@pytest.mark.parametrize("suffix", WRITABLE_FORMATS)
def test_deform_writes_every_format(suffix, bar, command):
    bar.out = bar.folder / f"out{suffix}"
    status, out, err = command(*bar.words("--method", "arap", "--iterations", 2))
    assert (status, err) == (0, "")
    assert str(bar.out) in out
    expected = deform(bar.V, bar.F, bar.fixed, bar.targets, "arap", 2).U
    np.testing.assert_allclose(open_mesh(bar.out).V[open_mesh(bar.out).F], expected[bar.F], atol=1e-6)


def test_deform_moves_nothing_without_transform_and_iterations(tmp_path, deformed):
    case = Case(tmp_path, *box(2, 2, 5), M=np.eye(4))
    report, mesh, _ = deformed(case)
    np.testing.assert_allclose(mesh.V, case.V, atol=1e-9)
    assert report["converged"] is True
    assert report["energy"] == pytest.approx(0, abs=1e-12)


PROMISED = {
    "vertices": int,
    "faces": int,
    "method": str,
    "iterations": int,
    "converged": bool,
    "area_rest": float,
    "area": float,
    "area_error": float,
    "volume_rest": float,
    "volume": float,
    "energy": float,
    "handle_drift": float,
    "seconds": float,
    "factor_seconds": float,
    "seconds_per_iteration": float,
    "warnings": list,
}


def energy(V, F, U):
    """Eq. 1 with optimal rotations, each undirected edge counted twice; in plain NumPy."""
    n = len(V)
    W = np.zeros((n, n))
    for c in range(3):
        k, i, j = F[:, c], F[:, (c + 1) % 3], F[:, (c + 2) % 3]
        a, b = V[i] - V[k], V[j] - V[k]
        cot = (a * b).sum(axis=1) / np.linalg.norm(np.cross(a, b), axis=1)
        np.add.at(W, (i, j), np.maximum(cot, 0) / 2)
    W += W.T
    v, u = V[:, None] - V, U[:, None] - U
    A, _, Bt = np.linalg.svd(np.einsum("ij,ija,ijb->iab", W, u, v))
    A[:, :, 2] *= np.sign(np.linalg.det(A @ Bt))[:, None]
    return (W * ((u - np.einsum("iab,ijb->ija", A @ Bt, v)) ** 2).sum(axis=2)).sum()


@pytest.mark.parametrize("method", METHODS)
def test_deform_reports_what_is_in_the_file(method, bar, deformed):
    report, mesh, _ = deformed(bar, "--method", method)
    assert set(PROMISED) <= set(report)
    assert {key: type(report[key]) for key in PROMISED} == PROMISED
    rest, after = (trimesh.Trimesh(X, bar.F, process=False) for X in (bar.V, mesh.V))
    assert report["vertices"] == len(bar.V)
    assert report["faces"] == len(bar.F)
    assert report["method"] == method
    assert report["converged"] is True
    assert report["iterations"] >= 1
    assert report["area_rest"] == pytest.approx(rest.area, rel=1e-12)
    assert report["area"] == pytest.approx(after.area, rel=1e-12)
    assert report["area_error"] == pytest.approx(report["area"] / report["area_rest"] - 1, abs=1e-15)
    assert report["volume_rest"] == pytest.approx(rest.volume, rel=1e-12)
    assert report["volume"] == pytest.approx(after.volume, rel=1e-12)
    assert report["energy"] == pytest.approx(energy(bar.V, bar.F, mesh.V), rel=1e-9)
    assert report["energy"] > 1e-3
    wanted, got = transform(bar.M, bar.V[bar.handle]).mean(axis=0), mesh.V[bar.handle].mean(axis=0)
    assert report["handle_drift"] == pytest.approx(np.linalg.norm(wanted - got), abs=1e-12)
    assert 0 < report["factor_seconds"] < report["seconds"]
    assert 0 < report["seconds_per_iteration"] * report["iterations"] <= report["seconds"] * (1 + 1e-9)
    assert report["warnings"] == []


def test_deform_by_the_paper_s_method_keeps_the_area_and_moves_the_handle_for_it(bar, deformed):
    plain, _, _ = deformed(bar, "--method", "arap")
    report, _, _ = deformed(bar, "--method", "paper", "--tolerance", "1e-4")
    assert abs(plain["area_error"]) > 1e-3 > 1e-4 >= abs(report["area_error"])
    assert plain["handle_drift"] < 1e-12 < report["handle_drift"]


def test_deform_is_exact_by_default_and_takes_targets(bar, deformed):
    report, mesh, out = deformed(bar, "--area", 105, "--volume", 95, "--stiffness", 0.01)
    assert report["method"] == "exact"
    assert report["converged"] is True
    after = trimesh.Trimesh(mesh.V, bar.F, process=False)
    assert after.area == pytest.approx(1.05 * report["area_rest"], rel=1e-9)
    assert after.volume == pytest.approx(0.95 * report["volume_rest"], rel=1e-9)
    assert report["area_target"] == pytest.approx(1.05 * report["area_rest"], rel=1e-12)
    assert report["volume_target"] == pytest.approx(0.95 * report["volume_rest"], rel=1e-12)
    assert report["handle_drift"] == 0.0
    assert report["local_change"] >= 0.05
    edges = after.edges_unique
    before, now = (np.linalg.norm(X[edges[:, 0]] - X[edges[:, 1]], axis=1) for X in (bar.V, mesh.V))
    assert report["largest_edge_strain"] == pytest.approx(max(now / before - 1.0, key=abs), rel=1e-6)
    assert 0.0 < report["mean_edge_strain"] < abs(report["largest_edge_strain"])
    assert f"largest edge strain {100 * report['largest_edge_strain']:+.3g} %" in out
    assert "(+5.000 %)" in out
    assert "(-5.000 %)" in out


def test_deform_changes_the_shape_by_stiffness_and_the_stiffnesses_of_local(bar, deformed):
    shapes = [
        deformed(bar, "--method", "local", "--iterations", 5, *words)[1].V
        for words in ([], ["--stiffness", 0.05], ["--area-stiffness", 1], ["--shear-stiffness", 5])
    ]
    for i, shape in enumerate(shapes):
        assert all(np.abs(shape - other).max() > 1e-3 for other in shapes[:i])


def test_deform_keeps_walls_apart_when_asked(tmp_path, deformed):
    V, F = tube(12, 12)
    wrung = np.eye(4)
    wrung[:3, :3], wrung[2, 3] = rotation((0, 0, 1), 2.8), -0.3 * V[:, 2].max()
    case = Case(tmp_path, V, F, M=wrung)
    plain, mesh, _ = deformed(case, "--no-contact")
    assert len(crossings(mesh.V, F)) == plain["self_intersections"] > 0
    assert (plain["share_reached"], plain["least_gap"], plain["pairs_in_contact"]) == (1.0, None, 0)
    kept, mesh, _ = deformed(case, "--contact", "--thickness", 0.02)
    assert kept["self_intersections"] == 0
    assert 0.0 < kept["least_gap"] < 0.02
    assert kept["pairs_in_contact"] > 0
    assert abs(kept["area_error"]) <= 1e-9


def test_deform_reads_measures_and_keeps_regions(bar, deformed):
    z = bar.V[:, 2]
    for name, inside in (("low", z <= 2), ("high", z >= 3)):
        (bar.folder / f"{name}.txt").write_text("\n".join(map(str, inside.astype(int))))
    low, high = bar.folder / "low.txt", bar.folder / "high.txt"
    report, mesh, out = deformed(bar, "--region", "neck", high, 110, "--region", "label", low)
    (neck, label) = report["regions"]
    faces = bar.F[(z[bar.F] >= 3).all(axis=1)]
    assert neck["name"] == "neck"
    assert neck["area"] == pytest.approx(1.1 * trimesh.Trimesh(bar.V, faces, process=False).area, rel=1e-9)
    assert neck["area"] == pytest.approx(trimesh.Trimesh(mesh.V, faces, process=False).area, rel=1e-9)
    assert neck["area_target"] == pytest.approx(neck["area"], rel=1e-9)
    assert label["area_target"] is None
    assert abs(report["area_error"]) <= 1e-9
    assert "“neck”" in out


def test_deform_moves_two_handles_each_by_its_motion(bar, deformed):
    labels = np.where((bar.labels == 2) & (bar.V[:, 0] > 0.5), 3, bar.labels)
    (bar.folder / "s.sel").write_text("\n".join(map(str, labels)))
    other = pose(-0.3, (-0.2, 0.0, 0.5))
    np.savetxt(bar.folder / "other.def", other, fmt="%.17g")
    # The halves of the end are drawn apart through each other.
    report, mesh, _ = deformed(bar, "--transform", bar.folder / "other.def", "--no-contact")
    for label, M in ((2, bar.M), (3, other)):
        ids = np.flatnonzero(labels == label)
        assert np.abs(mesh.V[ids] - transform(M, bar.V[ids])).max() <= 1e-12
    assert report["handle_drift"] == 0.0
    assert abs(report["area_error"]) <= 1e-9


def test_deform_says_what_is_out_of_reach_and_writes_the_shape(bar, deformed):
    report, mesh, out = deformed(bar, "--area", "5%", "--no-contact")
    assert report["converged"] is False
    assert "Out of reach in this pose: the area is at" in report["warnings"][-1]
    assert report["warnings"][-1] in out
    assert "not converged" in out
    assert np.isfinite(mesh.V).all()


def test_deform_says_that_intersections_are_not_known(bar, deformed, monkeypatch):
    monkeypatch.setattr(result_output, "crossings", lambda *_: None)
    *_, out = deformed(bar, "--iterations", 1)
    assert "self-intersections: not checked" in out


def test_deform_says_that_a_shape_has_not_converged(bar, deformed):
    report, _, out = deformed(bar, "--method", "paper", "--iterations", 1)
    assert report["converged"] is False
    assert "not converged after 1 iterations" in out


def test_deform_gives_an_open_mesh_no_volume_and_tells_why(tmp_path, deformed):
    V, F = grid(4, 6)
    case = Case(tmp_path, V, F, labels=np.clip(1 + (V[:, 1] == 6) - (V[:, 1] == 0), 0, 2).astype(int))
    report, mesh, out = deformed(case, "--method", "arap", "--iterations", 2)
    assert report["volume"] is None
    assert report["volume_rest"] is None
    (warning,) = report["warnings"]
    assert re.search(r"no volume: the surface is open \(20 boundary edges\)", warning)
    assert warning in out
    assert "volume  " not in out
    assert report["area"] == pytest.approx(trimesh.Trimesh(mesh.V, F, process=False).area, rel=1e-12)


def test_deform_takes_a_piece_that_nothing_holds_along(two_pieces, deformed):
    report, mesh, _ = deformed(two_pieces)
    (warning,) = report["warnings"]
    assert warning.startswith(
        "1 connected part without base or handle; it goes along with the nearest surface. Contact keeps them"
    )
    assert np.abs(mesh.V[two_pieces.loose] - two_pieces.V[two_pieces.loose]).max() > 0.01


@pytest.mark.parametrize("method", PLAIN)
def test_deform_can_let_a_piece_that_nothing_holds_stay_bit_for_bit(method, two_pieces, deformed):
    report, _, out = deformed(two_pieces, "--method", method, "--iterations", 3, "--loose", "stay")
    (warning,) = report["warnings"]
    assert warning == "1 connected part without base or handle; it stays where it is."
    assert warning in out.splitlines()
    result = deform(
        two_pieces.V,
        two_pieces.F,
        two_pieces.fixed,
        two_pieces.targets,
        method,
        3,
        handle=two_pieces.handle,
        loose="stay",
    )
    assert np.array_equal(result.U[two_pieces.loose], two_pieces.V[two_pieces.loose])
    # Nothing was changed between Python and the file, but for the digits that the format has.
    save_mesh(open_mesh(two_pieces.mesh), result.U, two_pieces.folder / "api.obj")
    assert two_pieces.out.read_bytes() == (two_pieces.folder / "api.obj").read_bytes()


def test_deform_says_in_its_summary_what_the_report_says(bar, deformed):
    report, _, out = deformed(bar, "--method", "arap", "--iterations", 4)
    assert f"{report['area']:.6g} of {report['area_rest']:.6g}" in out
    assert f"({100 * report['area_error']:+.3f} %)" in out
    assert f"{report['volume']:.6g} of {report['volume_rest']:.6g}" in out
    assert "arap" in out
    assert "4 iterations" in out


def test_deform_may_write_the_mesh_over_itself(bar, command):
    expected = deform(bar.V, bar.F, bar.fixed, bar.targets, "arap", 2).U
    assert command(*bar.words("--method", "arap", "--iterations", 2, out=bar.mesh))[0] == 0
    np.testing.assert_allclose(open_mesh(bar.mesh).V, expected, rtol=0, atol=1e-13)


@pytest.mark.parametrize("terminal", [True, False])
def test_deform_draws_progress_on_a_terminal_only(terminal, bar, monkeypatch, capsys):
    monkeypatch.setattr(sys.stderr, "isatty", lambda: terminal, raising=False)
    assert main(bar.words("--method", "arap", "--iterations", "45")) == 0
    said = capsys.readouterr().err
    if terminal:
        assert re.findall(r"\riteration (\d+) of 45 ", said) == ["20", "40", "45"]
        assert said.endswith("\n")
    else:
        assert said == ""


# ---- what is refused: status 2, one line, and the folder as it was


@pytest.fixture
def refused(bar, command):
    """Run ``deform`` with something wrong; return the one line."""
    bar.out.write_text("precious")
    bar.report.write_text("precious too")

    def run(*more, **files):
        before = {path: path.read_bytes() for path in bar.folder.rglob("*") if path.is_file()}
        status, out, err = command(*bar.words("--report", bar.report, *more, **files))
        assert status == 2
        assert out == ""
        assert re.fullmatch(r"error: .+\n", err)  # a dot is no line end
        assert "Traceback" not in err
        assert {path: path.read_bytes() for path in bar.folder.rglob("*") if path.is_file()} == before
        return err

    return run


def one(label):
    return lambda labels: np.full_like(labels, label)


WRONG_SELECTIONS = {
    "one too few": (lambda labels: labels[1:], r"for a mesh of \d+ vertices, but this mesh has \d+"),
    "one too many": (lambda labels: [*labels, 1], r"for a mesh of \d+ vertices, but this mesh has \d+"),
    "another label": (lambda labels: np.where(labels == 2, 12, labels), "a label other than 0"),
    "two handles": (lambda labels: np.where(labels == 2, 3, labels), "There are 2 handles but one motion"),
    "a negative label": (lambda labels: np.where(labels == 2, -1, labels), "a label other than 0"),
    "words": (lambda labels: ["free"] * len(labels), "is not a selection"),
    "no base": (lambda labels: np.maximum(labels, 1), "There is no base"),
    "no handle": (lambda labels: np.minimum(labels, 1), "There is no handle"),
    "nothing painted": (one(1), "There is no base"),
    "everything painted": (lambda labels: np.where(labels == 1, 0, labels), "Everything is painted"),
}


@pytest.mark.parametrize("case", WRONG_SELECTIONS)
def test_deform_refuses_a_wrong_selection(case, bar, refused):
    change, words = WRONG_SELECTIONS[case]
    (bar.folder / "s.sel").write_text("\n".join(map(str, change(bar.labels))))
    assert re.search(words, refused())


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("1 0 0 0 0 1 0 0 0 0 1 0 0 0 0", "is not a 4x4 matrix"),
        ("1 0 0 0 0 nan 0 0 0 0 1 0 0 0 0 1", "is not a 4x4 matrix"),
        ("1 0 0 0 0 1 0 0 0 0 1 0 0 0 0.5 1", "is not an affine transform"),
        ("a letter", "is not a transform"),
        ("", "is not a 4x4 matrix"),
    ],
)
def test_deform_refuses_a_wrong_transform(content, words, bar, refused):
    (bar.folder / "t.def").write_text(content)
    assert words in refused()


@pytest.mark.parametrize("file", ["mesh", "sel", "def"])
def test_deform_refuses_a_missing_file(file, bar, refused):
    assert re.search(r"There is no file .*gone\.obj", refused(**{file: bar.folder / "gone.obj"}))


@pytest.mark.parametrize("file", ["sel", "def"])
def test_deform_refuses_a_folder_in_place_of_a_file(file, bar, refused):
    assert "is a folder, a pipe or a device; name a file instead" in refused(**{file: bar.folder})


@pytest.mark.parametrize(
    ("out", "words"),
    [
        ("out.xyz", "does not have a supported ending"),
        ("out", "does not have a supported ending"),
        ("gone/out.obj", "There is no folder"),
        ("in.obj/out.obj", "There is no folder"),
        ("x" * 300 + ".obj", "cannot be written"),
        (("x" * 300) + "/out.obj", "error: "),
    ],
)
def test_deform_refuses_a_wrong_output(out, words, bar, refused):
    assert words in refused(out=bar.folder / out)


@pytest.mark.parametrize(("place", "words"), [(".", "it is a folder"), ("gone/r.json", "There is no folder")])
def test_deform_names_a_report_that_cannot_be_written_at_once(place, words, bar, refused, monkeypatch):
    monkeypatch.setattr("apd_viewer.commands.deform_command.deform", None)  # nothing is deformed before
    assert words in refused("--report", bar.folder / place)


@pytest.mark.parametrize("option", ["--report", "--scalars"])
def test_deform_refuses_a_file_to_be_written_twice(option, bar, refused):
    out = bar.folder / "out.ply"
    assert "out.ply would be written twice" in refused(option, bar.folder / "." / out.name, out=out)


@pytest.mark.parametrize(
    ("option", "value", "words"),
    [
        ("--method", "magic", "invalid choice: 'magic'"),
        ("--iterations", "0", "at least 1"),
        ("--iterations", "-3", "at least 1"),
        ("--iterations", "2.5", "invalid int value: '2.5'"),
        ("--iterations", "many", "invalid int value: 'many'"),
        ("--tolerance", "0", "tolerance must be a number from"),
        ("--tolerance", "-1", "tolerance must be a number from"),
        ("--tolerance", "nan", "tolerance must be a number from"),
        ("--tolerance", "small", "invalid float value: 'small'"),
        ("--stiffness", "-1", "stiffness must be a number from 0 to 1e+09"),
        ("--area-stiffness", "nan", "area_stiffness must be a number from 0 to 1e+09"),
        ("--thickness", "0.1", "add --contact"),
        ("--thickness", "thin", "invalid float value: 'thin'"),
        ("--area", "0", "The target of the area must be a percentage from 1 to 1000"),
        ("--volume", "-10", "The target of the volume must be a percentage from 1 to 1000"),
        ("--area", "1.1", "1.1 can mean 110 % or 1.1 %; write 110% or 1.1%."),
        ("--volume", "0.98", "The target of the volume must be a percentage from 1 to 1000"),
        ("--volume", "2", "2 can mean 200 % or 2 %; write 200% or 2%."),
        ("--region", "lid", "--region takes a name, a file"),
        ("--unknown", "1", "unrecognized arguments: --unknown 1"),
        ("--picture", "picture.jpg", "use .png"),
    ],
)
def test_deform_refuses_a_wrong_option(option, value, words, refused):
    assert words in refused("--iterations", "1", option, value)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--iterations", "1"], "no number of plain iterations"),
        (["--method", "paper"], "Contact needs one of the methods Exact, Local, Wall and ARAP"),
        (["--thickness", "0"], "thickness must be a length"),
        (["--thickness", "nan"], "thickness must be a length"),
    ],
)
def test_deform_refuses_contact_that_cannot_be_had(words, said, refused):
    assert said in refused("--contact", *words)


@pytest.mark.parametrize("option", ["--report", "--picture"])
def test_deform_refuses_a_missing_folder_for_what_comes_beside_the_mesh(option, bar, refused):
    assert "There is no folder" in refused("--iterations", "1", option, bar.folder / "gone" / "a.png")


def test_deform_leaves_no_report_either_if_the_mesh_cannot_be_written(bar, refused):
    (bar.folder / "taken.obj").mkdir()
    refused("--iterations", "1", out=bar.folder / "taken.obj")


def test_deform_leaves_no_picture_either_if_the_report_cannot_be_written(bar, refused, monkeypatch):
    from apd_viewer.commands import deform_command

    def drawn(_, pictures, *__):  # the real one takes its time
        return bool(pictures[0].path.write_bytes(PNG))

    monkeypatch.setattr(deform_command, "draw_shapes", drawn)
    refused(
        "--iterations", "1", "--picture", bar.folder / "p.png", "--report", bar.folder / "gone" / "r.json"
    )


def test_deform_refuses_a_full_disk_and_leaves_files_as_they_were(refused, monkeypatch):
    def full(descriptor):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    assert "No space left on device" in refused("--iterations", "1")


def test_deform_writes_nothing_when_interrupted(bar, command, monkeypatch):
    def interrupted(*args, **kwargs):
        raise KeyboardInterrupt

    monkeypatch.setattr(deform_command, "deform", interrupted)
    before = sorted(bar.folder.iterdir())
    assert command(*bar.words()) == (130, "", "interrupted; no file is left unfinished\n")
    assert sorted(bar.folder.iterdir()) == before


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["deform"], "required: MESH, -o/--output; see apd-viewer deform --help"),
        (["deform", "a.obj"], "required: -o/--output"),
        (["info"], "required: MESH; see apd-viewer info --help"),
        (["replay", "a.apd"], "required: -o/--output; see apd-viewer replay --help"),
        (["info", "a.obj", "b.obj"], "unrecognized arguments: b.obj"),
        (["--unknown"], "unrecognized arguments: --unknown; see apd-viewer --help"),
        (["a.obj", "b.obj"], "unrecognized arguments: b.obj"),
        (["presss", "a.obj"], "“presss” is neither a file nor a command; see apd-viewer --help"),
        (["info", "two\nlines.obj"], "There is no file"),
    ],
)
def test_main_refuses_wrong_words_in_one_line(words, said, command):
    status, out, err = command(*words)
    assert (status, out) == (2, "")
    assert re.fullmatch(r"error: .+\n", err)
    assert said in err


# ---- replay


@pytest.fixture
def saved(bar):
    """A session on the bar with its handle moved, and its shape still at rest."""
    state = initial_state(open_mesh(bar.mesh), frozen(bar.labels.astype(np.uint8)))
    state = replace(state, document=state.document.with_pose(0, bar.M)).as_unsettled()
    save_session(bar.folder / "a.apd", state, View())
    return bar.folder / "a.apd"


def test_replay_session_from_rest_does_what_deform_does(bar, saved, deformed, command):
    expected, _, summary = deformed(bar)
    content = bar.out.read_bytes()
    bar.out.unlink()
    status, out, err = command("replay", saved, "-o", bar.out, "--report", bar.report, "--from-rest")
    assert (status, err) == (0, "")
    assert bar.out.read_bytes() == content
    report = json.loads(bar.report.read_text())
    assert list(report) == list(expected)
    assert set(PROMISED) <= set(report)
    timed = {"seconds", "factor_seconds", "seconds_per_iteration"}
    assert {key: report[key] for key in report if key not in timed} == {
        key: expected[key] for key in expected if key not in timed
    }
    first, *others = out.splitlines()
    assert first.startswith(f"{bar.out}: exact, converged after {report['iterations']} iterations in ")
    assert others == summary.splitlines()[1:]


def test_replay_session_goes_on_and_then_leaves_the_shape_as_it_is(bar, saved, command):
    assert command("replay", saved, "-o", bar.out)[0] == 0
    mesh = open_mesh(bar.mesh)
    state, _ = open_session(saved)
    document, result = replay_session(saved)
    frame = replace(state.frame, U=result.U, settled=True, converged=True)
    save_session(saved, replace(state, frame=frame), View())
    save_mesh(document.mesh, result.U, bar.folder / "expected.obj")
    assert bar.out.read_bytes() == (bar.folder / "expected.obj").read_bytes()
    np.testing.assert_allclose(open_mesh(bar.out).V[bar.fixed], bar.targets, rtol=0, atol=1e-13)
    again = bar.folder / "again.obj"
    status, out, _ = command("replay", saved, "-o", again, "--report", bar.report)
    assert status == 0
    assert "converged after 0 iterations" in out
    assert again.read_bytes() == bar.out.read_bytes()
    assert json.loads(bar.report.read_text())["energy"] == pytest.approx(energy(mesh.V, mesh.F, result.U))


@pytest.mark.parametrize("terminal", [True, False])
def test_replay_session_draws_progress_on_a_terminal_only(terminal, bar, saved, monkeypatch, capsys):
    monkeypatch.setattr(sys.stderr, "isatty", lambda: terminal, raising=False)
    assert main(["replay", str(saved), "-o", str(bar.out)]) == 0
    assert ("\riteration " in capsys.readouterr().err) is terminal


@pytest.mark.night  # by day the architecture has it: of a replay in a process that has a display
def test_replay_session_needs_neither_a_display_nor_qt(bar, saved):
    script = "import sys; from apd_viewer.__main__ import main; status = main(sys.argv[1:]);"
    script += "sys.exit(status or any(name in sys.modules for name in ('PySide6', 'vtkmodules', 'pyvista')))"
    words = ["replay", saved, "-o", bar.out]
    status, out, err = process(sys.executable, "-c", script, *words, without=DISPLAY)
    assert (status, err) == (0, "")
    assert str(bar.out) in out


def _gone(case, path):
    path.unlink()


def _empty(case, path):
    path.write_bytes(b"")


def _without_mesh(case, path):
    case.mesh.unlink()


def _other_mesh(case, path):
    case.mesh.write_text(case.mesh.read_text().replace("v 0.0 0.0 0.0", "v 0.0 0.0 0.1"))


def _unpainted(case, path):
    save_session(path, initial_state(open_mesh(case.mesh)), View())


WRONG_SESSIONS = {
    "gone": (_gone, "There is no file .*a.apd; check the name"),
    "empty": (_empty, "a.apd is not a valid session .its archive is damaged.; save it again"),
    "without its mesh": (_without_mesh, "in.obj, a mesh of a.apd, is missing"),
    "with another mesh": (_other_mesh, "in.obj is not the mesh that a.apd was saved with .it has been"),
    "not painted": (_unpainted, "a.apd: There is no base: paint the part"),
}


@pytest.fixture
def refused_replay(bar, saved, command):
    """Replay with something wrong; return the one line."""
    bar.out.write_text("precious")
    bar.report.write_text("precious too")

    def run(*more, out=bar.out):
        before = {path: path.read_bytes() for path in bar.folder.rglob("*") if path.is_file()}
        status, said, err = command("replay", saved, "-o", out, "--report", bar.report, *more)
        assert (status, said) == (2, "")
        assert re.fullmatch(r"error: .+\n", err)
        assert {path: path.read_bytes() for path in bar.folder.rglob("*") if path.is_file()} == before
        return err

    return run


def test_replay_session_refuses_a_mesh_as_no_session(bar, command):
    (bar.folder / "plain.off").write_text("OFF")
    status, _, err = command("replay", bar.folder / "plain.off", "-o", bar.out)
    assert (status, err) == (2, "error: plain.off is not a session; give a .apd file.\n")


def test_deform_refuses_a_selection_without_a_motion(bar, command):
    (bar.folder / "s.sel").write_text("\n".join(map(str, bar.labels)))
    status, _, err = command("deform", bar.mesh, "--selection", bar.folder / "s.sel", "-o", bar.out)
    assert status == 2
    assert "give --selection with --transform or a motion such as --twist" in err.lower().replace(
        "error: ", ""
    )


@pytest.mark.parametrize("case", WRONG_SESSIONS)
def test_replay_session_refuses_a_wrong_session(case, bar, saved, refused_replay):
    change, words = WRONG_SESSIONS[case]
    change(bar, saved)
    assert re.search(words, refused_replay())


def test_replay_session_refuses_wrong_words(bar, refused_replay):
    assert "does not have a supported ending" in refused_replay(out=bar.folder / "out.xyz")
    assert "There is no folder" in refused_replay(out=bar.folder / "gone" / "out.obj")
    assert "There is no folder" in refused_replay("--report", bar.folder / "gone" / "r.json")
    assert "unrecognized arguments: --method" in refused_replay("--method", "arap")


# ---- info


def test_info_describes_a_mesh_as_json(bar, command):
    status, out, err = command("info", bar.mesh, "--json")
    assert (status, err) == (0, "")
    found, other = json.loads(out), trimesh.Trimesh(bar.V, bar.F, process=False)
    assert found["vertices"] == len(bar.V)
    assert found["faces"] == len(bar.F)
    assert found["pieces"] == other.body_count == 1
    assert found["area"] == pytest.approx(other.area)
    assert found["volume"] == pytest.approx(other.volume)
    assert found["size"] == pytest.approx(other.extents.tolist())
    assert found["why_no_volume"] is None
    assert found["findings"] == []
    assert found["mesh"] == str(bar.mesh)


def test_info_describes_a_mesh_for_people(bar, command):
    status, out, err = command("info", bar.mesh)
    assert (status, err) == (0, "")
    assert f"in.obj: {len(bar.V)} vertices, {len(bar.F)} triangles, 1 connected part(s)" in out
    assert "2 x 2 x 5" in out
    assert re.search(r"(?m)^area +48$", out)
    assert re.search(r"(?m)^volume +20$", out)
    assert "No issues" in out


def test_info_says_that_intersections_are_not_known(bar, command, monkeypatch):
    monkeypatch.setattr(shape_check, "crossings", lambda *_: None)
    out = command("info", bar.mesh)[1]
    assert "self-intersections: not checked" in out
    assert "No issues" not in out


def test_info_tells_everything_that_can_be_found_on_a_mesh(tmp_path, command):
    V, F = grid(2, 2)
    V = np.vstack([V, V[:1], [[5, 5, 5]], V + [10, 0, 0]])
    F = np.vstack([F, F + 11, [[9, 1, 1]]])  # 9 repeats 0; 10 is in no face; the last has no area
    path = Case(tmp_path, V, F).mesh
    found = json.loads(command("info", path, "--json")[1])
    assert found["pieces"] == 2
    assert found["volume"] is None
    assert "open (16 boundary edges)" in found["why_no_volume"]
    said = command("info", path)[1]
    for words in (
        "1 vertex has the same position as another",
        "1 loose vertex",
        "1 degenerate face",
        "2 connected parts",
    ):
        assert sum(words in finding["sentence"] for finding in found["findings"]) == 1, words
        assert words in said
    assert re.search(r"(?m)^volume +none: the surface is open", said)
    assert "No issues" not in said


def test_info_measures_a_bottle_without_a_cap_and_tells_of_one_that_passes_through_itself(tmp_path, command):
    V, F = box(2, 2, 5)
    mouth = (V[F][:, :, 2] == 5).all(axis=1)
    found = json.loads(command("info", Case(tmp_path, V, F[~mouth]).mesh, "--json")[1])
    assert found["volume"] is None
    assert (found["volume_capped"], found["openings"]) == (pytest.approx(20), 1)
    assert found["packed_volume"] == pytest.approx(found["box_volume"]) == pytest.approx(20)
    assert found["hull_volume"] == pytest.approx(20)
    assert (found["minimum_width"], found["packed_sides"]) == (pytest.approx(2), pytest.approx([2, 2, 5]))
    low, high = found["bulk_volume_range"]
    assert 20 < low < found["bulk_volume"] < high
    assert found["self_intersections"] == 0
    assert "20 with its opening capped flat" in command("info", tmp_path / "in.obj")[1]
    W, G = np.vstack([V, V + [0.6, 0.7, 4.1]]), np.vstack([F, F + len(V)])
    found = json.loads(command("info", Case(tmp_path, W, G).mesh, "--json")[1])
    (place,) = (each for each in found["findings"] if each["kind"] == "self-intersections")
    assert place["vertex_count"] >= found["self_intersections"] / 2 > 2
    assert f"{found['self_intersections']} intersecting triangles" in place["sentence"]
    assert place["sentence"] in command("info", tmp_path / "in.obj")[1]
    (exempt,) = (each for each in found["findings"] if each["kind"] == "exempt from contact")
    assert exempt["vertex_count"] > place["vertex_count"]
    assert f"the {exempt['vertex_count']} vertices" in exempt["sentence"]


def test_deform_reports_a_shape_that_passes_through_itself_with_its_volume(tmp_path, deformed):
    """The bar's end is pushed in and past its base."""
    M = np.eye(4)
    M[:3, 3] = 0.3, 0.2, -6.5
    report, mesh, out = deformed(Case(tmp_path, *box(2, 2, 5), M=M), "--iterations", 50)
    assert report["self_intersections"] == len(crossings(mesh.V, mesh.F)) > 0
    assert report["self_intersections_rest"] == 0
    assert f"{report['self_intersections']} intersecting triangles" in out
    assert report["volume"] == pytest.approx(trimesh.Trimesh(mesh.V, mesh.F, process=False).volume, rel=1e-6)


def test_deform_reports_the_volume_of_an_open_mesh_with_its_mouth_capped(tmp_path, deformed):
    V, F = box(2, 2, 5)
    report, mesh, out = deformed(Case(tmp_path, V, F[~(V[F][:, :, 2] == 5).all(axis=1)]))
    assert report["volume"] is report["volume_rest"] is None
    capped = inspect(mesh)
    assert report["volume_capped_rest"] == pytest.approx(20)
    assert report["volume_capped"] == pytest.approx(capped.volume_capped, rel=1e-9)
    assert report["openings"] == 1
    assert re.search(r"(?m)^volume .* of 20 \(.*\)\n +with its opening capped flat$", out)
    assert report["self_intersections"] == report["self_intersections_rest"] == 0
    assert report["packed_volume"] <= report["box_volume"] == pytest.approx(np.prod(np.ptp(mesh.V, axis=0)))
    assert report["hull_volume_rest"] == pytest.approx(20)
    assert capped.volume_capped < report["hull_volume"] < report["packed_volume"]
    assert report["warnings"] == []


# ---- help, version and the window


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (
            ["--help"],
            ["apd-viewer [FILE]", "apd-viewer deform", "apd-viewer info", "apd-viewer replay", "--version"],
        ),
        (["-h"], ["apd-viewer [FILE]"]),
        (
            ["deform", "--help"],
            ["--selection", "--transform", "--output", "--method", "--iterations", "--tolerance", *METHODS]
            + ["--report", "--picture", "0 base, 1 free, 2 handle", "0.1 %"],
        ),
        (["info", "--help"], ["MESH", "--json"]),
        (["replay", "--help"], ["SESSION", "--output", "--report", "--from-rest", "--animation"]),
        (
            ["sweep", "--help"],
            ["SESSION", "--steps", "--to", "--methods", "--twist", "--meshes", "--animation"],
        ),
        (["paper", "--help"], ["--output"]),
        (["--version"], [f"apd-viewer {apd_viewer.__version__}"]),
    ],
)
def test_main_tells_help_and_version(words, said, command):
    status, out, err = command(*words)
    assert (status, err) == (0, "")
    assert all(word in out for word in said), out


@pytest.mark.parametrize("given", [[], ["in.obj"]])
def test_main_opens_the_window_on_a_file_or_nothing(given, command, monkeypatch):
    shown = []
    monkeypatch.setattr(apd_viewer, "show_window", lambda mesh, _: shown.append(mesh))
    assert command(*given) == (0, "", "")
    assert shown == (given or [None])


def test_main_says_in_a_sentence_that_a_library_of_the_window_is_missing(command, monkeypatch):
    monkeypatch.setitem(sys.modules, "apd_viewer.ui.application", None)
    status, out, err = command()
    assert (status, out) == (2, "")
    assert re.fullmatch(r"error: A library that the window needs is missing .+README.+\n", err)


DISPLAY = ("DISPLAY", "WAYLAND_DISPLAY", "QT_QPA_PLATFORM")


def test_main_says_in_a_sentence_that_no_display_is_available():
    status, out, err = process(ENTRY, without=DISPLAY)
    assert (status, out) == (2, "")
    assert re.fullmatch(r"error: No display is available .+ apd-viewer deform --help\.\n", err)


def test_main_says_that_a_file_is_missing_also_without_a_display(tmp_path):
    status, out, err = process(sys.executable, "-m", "apd_viewer", tmp_path / "gone.obj", without=DISPLAY)
    assert (status, out) == (2, "")
    assert re.fullmatch(r"error: There is no file .*gone\.obj; check the name\.\n", err)


def test_main_runs_as_a_module_like_the_command():
    said = (0, f"apd-viewer {apd_viewer.__version__}\n", "")
    for program in ([ENTRY], [sys.executable, "-m", "apd_viewer"]):
        assert process(*program, "--version") == said


@pytest.mark.night
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full, a device that is always full")
def test_main_fails_without_a_traceback_if_the_standard_output_is_full(bar):
    with open("/dev/full", "w") as full:  # noqa: PTH123
        done = subprocess.run(
            [ENTRY, "info", bar.mesh], stdout=full, stderr=subprocess.PIPE, check=False, timeout=60
        )
    assert done.returncode != 0
    assert b"Traceback" not in done.stderr


def test_deform_draws_a_picture_without_a_display(bar, command, monkeypatch):
    from PySide6.QtGui import QImage

    path = bar.folder / "Bild é.png"
    words = bar.words("--method", "arap", "--iterations", "3", "--picture", path)
    for name in DISPLAY:
        monkeypatch.delenv(name, raising=False)
    status, _, err = command(*words)
    assert (status, err) == (0, "")
    assert path.read_bytes().startswith(PNG)
    image = QImage(str(path)).convertToFormat(QImage.Format.Format_RGB888)
    assert (image.width(), image.height()) == (1600, 1000)
    pixels = np.frombuffer(image.constBits(), np.uint8).reshape(1000, image.bytesPerLine())[:, :4800]
    pixels = pixels.reshape(1000, 1600, 3).astype(int)
    halves = pixels[100:, :800], pixels[100:, 800:]  # below the captions
    red, green, blue = np.moveaxis(halves[0], 2, 0)
    assert (red - blue > 60).sum() > 500, "no handle is to be seen"
    assert (blue - red > 60).sum() > 500, "no base is to be seen"
    red, green, blue = np.moveaxis(halves[1], 2, 0)
    assert (green - red > 20).sum() > 500, "no growth is to be seen"
    assert all((half.min(axis=2) == 255).mean() > 0.3 for half in halves), "no background is to be seen"
    # Written whole, like everything else.
    assert not [p for p in bar.folder.iterdir() if p.name.startswith(".")]


@pytest.mark.usefixtures("without_opengl")
def test_deform_writes_the_mesh_and_not_the_picture_without_opengl(bar, capsys):
    path = bar.folder / "picture.png"
    path.write_bytes(b"of yesterday")
    assert main([*map(str, bar.words("--iterations", "3", "--picture", path))]) == 0
    assert "The shapes were not drawn: off-screen OpenGL is not available" in capsys.readouterr().out
    assert path.read_bytes() == b"of yesterday"
    assert bar.out.exists()


# Scalars


def columns_of(path):
    head, *rows = path.read_text().splitlines()
    return head.split(","), np.array([[float(x or "nan") for x in row.split(",")] for row in rows])


def test_deform_writes_scalars_of_a_result_beside_it(bar, command):
    vertices, triangles = bar.folder / "v.csv", bar.folder / "t.csv"
    options = "--scalars", vertices, "--triangle-scalars", triangles, "--method", "arap"
    status, _, err = command(*bar.words(*options))
    assert (status, err) == (0, "")
    mesh = open_mesh(bar.out)
    names, rows = columns_of(vertices)
    assert names[:6] == ["vertex", "x", "y", "z", "apd_label", "apd_region"]
    np.testing.assert_allclose(rows[:, 1:4], mesh.V, rtol=0, atol=1e-12)
    assert np.array_equal(rows[:, 4], bar.labels)
    names, rows = columns_of(triangles)
    areas = rows[:, names.index("area_rest")], rows[:, names.index("area")]
    assert areas[1].sum() == pytest.approx(trimesh.Trimesh(mesh.V, mesh.F, process=False).area, rel=1e-9)
    np.testing.assert_allclose(rows[:, names.index("area_change")], areas[1] / areas[0] - 1.0, atol=1e-9)


def test_replay_session_writes_scalars_too(bar, saved, command):
    path = bar.folder / "s.ply"
    assert command("replay", saved, "-o", bar.out, "--scalars", path)[0] == 0
    np.testing.assert_allclose(open_mesh(path).V, open_mesh(bar.out).V, rtol=0, atol=1e-12)


@pytest.mark.parametrize("option", [("--scalars", "s.obj"), ("--triangle-scalars", "t.ply")])
def test_deform_refuses_scalars_in_another_kind_of_file_before_anything_is_done(option, bar, command):
    name, path = option
    status, _, err = command(*bar.words(name, bar.folder / path))
    assert status == 2
    assert err.startswith("error: ")
    assert not bar.out.exists()


def test_info_measures_the_distance_from_another_mesh(bar, command):
    away = bar.folder / "away.obj"
    save_mesh(open_mesh(bar.mesh), bar.V + [0.0, 0.0, 0.25], away)
    said = json.loads(command("info", bar.mesh, "--compare", away, "--json")[1])
    assert said["largest_distance"] == pytest.approx(0.25)
    assert said["largest_distance_back"] == pytest.approx(0.25)
    assert 0.0 < said["mean_distance"] < said["rms_distance"] < 0.25
    assert said["largest_distance_by_vertex"] == pytest.approx(0.25)
    assert said["rms_distance_by_vertex"] == pytest.approx(0.25)
    assert "apart   0.25 at most" in command("info", bar.mesh, "--compare", away)[1]


def test_deform_compares_a_result_with_a_target_shape(bar, command):
    other, report, scalars = (bar.folder / name for name in ("away.obj", "r.json", "s.csv"))
    save_mesh(open_mesh(bar.mesh), bar.V + [0.0, 0.0, 0.25], other)
    status, *_ = command(*bar.words("--compare", other, "--report", report, "--scalars", scalars))
    assert status == 0
    said, (names, rows) = json.loads(report.read_text()), columns_of(scalars)
    away = np.linalg.norm(open_mesh(bar.out).V - bar.V - [0.0, 0.0, 0.25], axis=1)
    assert said["target_shape"] == "away.obj"
    assert said["largest_distance_by_vertex"] == pytest.approx(away.max(), rel=1e-6)
    np.testing.assert_allclose(rows[:, names.index("target_displacement")], away, rtol=0, atol=1e-6)
    assert rows[:, names.index("target_distance")].max() == pytest.approx(said["largest_distance"], rel=1e-9)


def test_deform_sets_and_reports_convergence(bar, command):
    report = bar.folder / "r.json"
    criteria = ("--most-iterations", 3, "--energy-tolerance", "1e-9", "--step-tolerance", "1e-6")
    disturbance = ("--imperfection", "0.002", "--seed", 5)
    status, out, _ = command(*bar.words(*criteria, *disturbance, "--report", report))
    assert status == 0
    said = json.loads(report.read_text())
    assert said["iterations"] == 3
    criteria = {"most_iterations": 3, "energy_tolerance": 1e-9, "step_tolerance": 1e-6}
    assert said["convergence"] == criteria | {"imperfection": 0.002, "seed": 5}
    assert "did not converge within 3 iterations" in out
    bar.out.unlink()
    status, _, err = command(*bar.words("--energy-tolerance", "0"))
    assert status == 2
    assert err.startswith("error: The tolerances of convergence")
    assert not bar.out.exists()


def test_main_names_the_environment_variables_of_the_manual(capsys):
    manual = (
        Path(__file__).parents[2].joinpath("docs", "reference", "settings.md").read_text(encoding="utf-8")
    )
    named = dict(re.findall(r"^\| `([A-Z_]+)` \| (.+?) \|$", manual, re.MULTILINE))
    assert "APD_VIEWER_LANGUAGE" in named
    with pytest.raises(SystemExit):
        main(["--help"])
    *_, said = capsys.readouterr().out.partition("environment variables:")
    found = dict(re.findall(r"^  ([A-Z_]+) +(.+(?:\n {4,}.+)*)$", said, re.MULTILINE))
    assert {name: " ".join(about.split()) for name, about in found.items()} == named
    assert vars(parse_arguments([])).keys() == {"file", "log_level", "clicked", "run"}, "they are no options"
