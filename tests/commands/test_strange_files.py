"""What is strange about a file is said by every command that works on its mesh."""

from pathlib import Path

import numpy as np
import pytest
import trimesh
from meshes import ends, sphere
from seams import halves

from apd_viewer.__main__ import main
from apd_viewer.files.meshes import open_mesh

TWIST = ("--selection", "part.sel", "--twist=10deg")
COMMANDS = {
    "deform": (*TWIST, "-o", "out.off"),
    "sweep": (*TWIST, "--steps", "1", "--methods", "exact", "-o", "out"),
    "deck": (*TWIST, "-o", "out.inp"),
    "volumes": (),
    "press": ("--axis", "z", "--to", "95%", "--steps", "1", "--iterations", "5", "-o", "out.off"),
}


@pytest.fixture(params=COMMANDS)
def said(request, tmp_path, monkeypatch, capsys):
    """Paint a file by its lowest and highest vertices, run a command with it; the lines that it says."""
    monkeypatch.chdir(tmp_path)

    def run(name):
        V = open_mesh(name).V
        labels = np.ones(len(V), dtype=int)
        labels[ends(V)[0]], labels[ends(V)[1]] = 0, 2
        np.savetxt("part.sel", labels, fmt="%d")
        assert main([request.param, name, *COMMANDS[request.param]]) == 0
        return capsys.readouterr().out.splitlines()

    return run


def test_commands_say_a_remark_on_the_file_once(said):
    tail = b"written by a program"
    content = trimesh.Trimesh(*sphere(2), process=False).export(file_type="stl")
    Path("part.stl").write_bytes(content + tail)
    (remark,) = open_mesh("part.stl").remarks
    assert f"{len(tail)} bytes" in remark
    assert sum(line.endswith(remark) for line in said("part.stl")) == 1


def test_commands_say_once_that_seams_are_open(said):
    trimesh.Trimesh(*halves(1e-5), process=False).export("part.off")
    lines = said("part.off")
    assert sum("boundary edges lie on others without being joined" in line for line in lines) == 1
