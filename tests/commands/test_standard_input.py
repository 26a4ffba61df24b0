"""Meshes and plans from the standard input, by pipes as a shell makes them."""

import csv
import io
import json
import subprocess
import sys

import numpy as np
import pytest
import trimesh
from meshes import box

from apd_viewer.__main__ import main
from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.mesh.mesh import Mesh

V, F = box(2, 2, 4)
APD = sys.executable, "-m", "apd_viewer"
DESIGN = ("study", "design", "--mesh", "bar.off", "--selection", "bar.sel", "--vary", "twist=1..9deg")
DESIGN = (*DESIGN, "--set", "steps=1", "--samples", "2", "-o", "-")


def apd(*words, content=b"", folder=None):
    return subprocess.run([*APD, *words], input=content, capture_output=True, cwd=folder, check=False)


@pytest.fixture
def folder(tmp_path):
    """A folder with a bar and its paint."""
    save_mesh(Mesh(V, F), V, tmp_path / "bar.off")
    np.savetxt(tmp_path / "bar.sel", np.digitize(V[:, 2], [0.5, 3.5]), fmt="%d")
    return tmp_path


@pytest.fixture
def run(folder, monkeypatch, capsys):
    """Run a command in the folder on some content; its status, output and errors."""
    monkeypatch.chdir(folder)

    def run_on(content, *words):
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(content)))
        status = main([*words])
        return status, *capsys.readouterr()

    return run_on


@pytest.mark.parametrize("command", ["info", "volumes"])
@pytest.mark.parametrize("suffix", [".obj", ".off", ".ply", ".stl", ".glb"])
def test_standard_input_is_a_mesh_of_any_format(command, suffix, run, folder):
    save_mesh(Mesh(V, F), V, folder / f"bar{suffix}")
    status, out, err = run((folder / f"bar{suffix}").read_bytes(), command, "-", "--json")
    assert (status, err) == (0, "")
    volume = json.loads(out)["volume" if command == "info" else "enclosed_volume"]
    assert volume == pytest.approx(trimesh.Trimesh(V, F).volume)


def test_standard_input_is_a_mesh_for_deform(run, folder):
    words = "--selection", "bar.sel", "--twist", "9deg", "-o", "out.off"
    assert run((folder / "bar.off").read_bytes(), "deform", "-", *words)[0] == 0
    piped = open_mesh(folder / "out.off").V
    assert run(b"", "deform", "bar.off", *words)[0] == 0
    assert np.array_equal(open_mesh(folder / "out.off").V, piped)
    assert not np.allclose(piped, V)


@pytest.mark.parametrize(
    ("content", "words", "said"),
    [
        (b"", ("info", "-"), "standard input is empty"),
        (b"nothing known", ("info", "-"), "format of the standard input is not recognized"),
        (b"", ("study", "-", "-o", "out"), "standard input is empty"),
        (b"mesh,colour\n", ("study", "-", "-o", "out"), "unknown column “colour”"),
    ],
)
def test_standard_input_is_refused_in_a_sentence(content, words, said, run):
    status, out, err = run(content, *words)
    assert (status, out) == (2, "")
    assert said in err
    assert len(err.splitlines()) == 1


def test_standard_input_is_a_mesh_of_a_pipe(folder):
    done = apd("info", "-", content=(folder / "bar.off").read_bytes())
    assert done.returncode == 0
    assert done.stdout.startswith(b"standard-input.off: 42 vertices")


def test_standard_input_is_a_plan_that_design_has_written(folder):
    with subprocess.Popen([*APD, *DESIGN], stdout=subprocess.PIPE, cwd=folder) as design:
        words = [*APD, "study", "-", "-o", "out", "--processes", "1", "--dry-run", "--json"]
        left = subprocess.run(words, stdin=design.stdout, capture_output=True, cwd=folder, check=True)
    assert design.returncode == 0
    assert left.stderr == b""
    assert json.loads(left.stdout)["cases"] == 2


def test_study_design_prints_nothing_but_the_table_it_would_write(folder):
    printed = apd(*DESIGN, folder=folder).stdout
    assert apd(*DESIGN[:-1], "plan.csv", folder=folder).returncode == 0
    assert printed == (folder / "plan.csv").read_bytes()
    rows = list(csv.DictReader(io.StringIO(printed.decode())))
    assert [row["mesh"] for row in rows] == ["bar.off"] * 2
