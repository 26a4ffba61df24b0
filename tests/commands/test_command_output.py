"""Output of commands for scripts: JSON on the standard output, or in a file beside the text."""

import json
import sys
from dataclasses import replace

import pytest
from meshes import sphere
from painted_meshes import write_bar

from apd_viewer.__main__ import COMMANDS, main
from apd_viewer.commands import paper_command
from apd_viewer.commands.desktop import desktop_command
from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.files.selections.selection_files import read_selection_file
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.model.document_parts import with_selection
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.model.view import View
from apd_viewer.session.storage.session_file import save_session
from apd_viewer.verification import case_table
from apd_viewer.verification.case_table import CASES

ASKED = {
    "buckle": "ball.off --axis z --modes 1",
    "deck": "bar.apd --twist 20 -o bar.inp",
    "deform": "bar.off --selection bar.sel --twist 20 --iterations 3 -o out.obj",
    "desktop": "--install",
    "info": "bar.off",
    "paper": "",
    "press": "ball.off --to 95% --steps 1 --iterations 5",
    "remesh": "ball.off -o even.off",
    "replay": "bar.apd -o out.obj",
    "study": "plan.csv -o out --processes 1",
    "study design": "--mesh bar.off --vary twist=0..90deg --motion twist --samples 3 -o design.csv",
    "sweep": "bar.off --selection bar.sel --twist 20 --steps 1 --iterations 3 --methods exact -o out",
    "thumbnail": "bar.off bar.png",
    "verify": "--case K",
    "volumes": "ball.off",
}
KEYS = {
    "buckle": {"mesh", "buckling_loads", "buckling_deflections"},
    "deck": {"shells", "held_nodes", "steps"},
    "deform": {"area", "area_rest", "converged"},
    "desktop": {"folder", "missing_programs"},
    "info": {"area", "volume", "findings"},
    "press": {"apparent_stiffness", "volume"},
    "remesh": {"vertices", "worst_aspect", "edge"},
    "replay": {"area", "area_rest", "converged"},
    "study": {"results", "cases", "failed"},
    "study design": {"plan", "cases"},
    "sweep": {"folder", "steps", "warnings"},
    "thumbnail": {"picture", "size"},
    "volumes": {"enclosed_volume", "packed_volume"},
}


@pytest.fixture
def folder(tmp_path, monkeypatch, cases_run_here, undrawn_sweeps):
    """A folder with small inputs of all commands."""
    monkeypatch.chdir(tmp_path)
    remeshing = "apd_viewer.commands.remesh_command.even_triangles"  # by the library of an extra
    monkeypatch.setattr(remeshing, lambda V, F, edge, _: (V, F, edge or 1.0))
    write_bar(tmp_path)
    V, F = sphere(1)
    save_mesh(Mesh(V, F), V, tmp_path / "ball.off")
    state = initial_state(open_mesh(tmp_path / "bar.off"))
    painted = with_selection(state.document, read_selection_file(tmp_path / "bar.sel", state.document.mesh))
    save_session(tmp_path / "bar.apd", state.updated(painted), View())
    (tmp_path / "plan.csv").write_text("mesh,selection,motion,steps\nbar.off,bar.sel,twist 30,1\n")
    monkeypatch.setattr(paper_command, "PAPER_CASES", {})
    monkeypatch.setattr(case_table, "CASES", {"K": replace(CASES["K"], letter="K")})
    monkeypatch.setattr(desktop_command, "data_folder", lambda: tmp_path / "data")
    monkeypatch.setattr(sys, "platform", "linux")
    return tmp_path


def test_command_output_is_tried_for_every_command():
    # The standard output of these carries messages.
    assert {name.split()[0] for name in ASKED} == set(COMMANDS) - {"mcp", "serve"}


@pytest.mark.parametrize("name", ASKED)
def test_command_output_is_json_or_text_with_json_beside(name, folder, capsys):
    words = [*name.split(), *ASKED[name].split()]
    assert main([*words, "--json"]) == 0
    printed = capsys.readouterr().out
    said = json.loads(printed)
    assert KEYS[name] <= set(said) if name in KEYS else isinstance(said, list)
    assert main([*words, "--json", "told.json"]) == 0
    text = capsys.readouterr().out
    beside = json.loads((folder / "told.json").read_text(encoding="utf-8"))
    assert json.dumps(beside)
    assert type(beside) is type(said)
    assert "{" not in text
