"""Where the deformed mesh is written, and what is said before something of the file is lost."""

from pathlib import Path

import pytest
from mesh_contents import CUBE, QUADS, vtp
from PySide6.QtWidgets import QFileDialog, QMessageBox, QWidget

from apd_viewer.files.meshes import open_mesh
from apd_viewer.ui.filing.file_dialogs import ask_where_to_save_mesh
from apd_viewer.ui.plots.plots import ask_where_to_save_plots

CORNERS = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
OBJ = "mtllib a.mtl\n" + CORNERS + "vt 0 0\nusemtl red\nf 1/1 3/1 2/1\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
YES, NO = QMessageBox.StandardButton.Save, QMessageBox.StandardButton.Cancel


@pytest.fixture
def mesh(tmp_path):
    path = tmp_path / "part.obj"
    path.write_text(OBJ)
    return open_mesh(path)


@pytest.fixture
def ask(qtbot, mesh, tmp_path, monkeypatch):
    """Choose a name, answer what is asked, and return the target with the questions."""
    parent = QWidget()
    qtbot.addWidget(parent)

    def choose(name, answer, chosen="OBJ (*.obj)"):
        asked, offered = [], []

        def dialog(*words):
            offered.append(words)
            return (str(tmp_path / name) if name else "", chosen)

        monkeypatch.setattr(QFileDialog, "getSaveFileName", dialog)
        monkeypatch.setattr(QMessageBox, "question", lambda *words: asked.append(words[2]) or answer)
        return ask_where_to_save_mesh(parent, tmp_path, mesh), asked, offered[0]

    return choose


def test_ask_where_to_save_mesh_loses_nothing_and_asks_nothing_in_the_own_format(ask, tmp_path):
    target, asked, offered = ask("out.obj", NO)
    assert (target, asked) == (tmp_path / "out.obj", [])
    assert Path(offered[2]).name == "part-deformed.obj", "its own format comes first"
    assert offered[3].startswith("OBJ (*.obj);;")
    assert "gltf" not in offered[3], "only what was a glTF can become one"


@pytest.mark.parametrize(("answer", "written"), [(YES, True), (NO, False)])
@pytest.mark.parametrize("name", ["out.stl", "out"])
def test_ask_where_to_save_mesh_says_before_what_a_format_cannot_hold(ask, tmp_path, name, answer, written):
    target, asked, _ = ask(name, answer, "STL (*.stl)")
    assert target == (tmp_path / "out.stl" if written else None)
    assert len(asked) == 1
    assert "texture coordinates and materials" in asked[0]
    assert "Exporting as OBJ loses nothing." in asked[0]


def test_ask_where_to_save_mesh_gives_and_asks_nothing_when_one_thinks_better_of_it(ask):
    target, asked, _ = ask("", YES)
    assert (target, asked) == (None, [])


@pytest.mark.parametrize("answer", [QMessageBox.StandardButton.Yes, QMessageBox.StandardButton.No])
def test_ask_where_to_save_plots_replaces_no_file_without_being_asked(qtbot, tmp_path, monkeypatch, answer):
    """Whoever types plots gets plots.csv, of which the dialog knows nothing."""
    parent, asked = QWidget(), []
    qtbot.addWidget(parent)
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (str(tmp_path / "plots"), ""))
    monkeypatch.setattr(QMessageBox, "question", lambda *words: asked.append(words[2]) or answer)
    assert ask_where_to_save_plots(parent, tmp_path, "bar-plots", ".csv") == tmp_path / "plots.csv"
    assert asked == []
    (tmp_path / "plots.csv").write_text("of before")
    chosen = ask_where_to_save_plots(parent, tmp_path, "bar-plots", ".csv")
    assert chosen == (tmp_path / "plots.csv" if answer == QMessageBox.StandardButton.Yes else None)
    assert asked == ["plots.csv already exists. Replace it?"]


@pytest.mark.parametrize(("chosen", "loses"), [("VTP (*.vtp)", False), ("OBJ (*.obj)", True)])
def test_ask_where_to_save_mesh_proposes_vtk_for_a_surface_of_vtk_and_tells_the_loss_elsewhere(
    chosen, loses, qtbot, tmp_path, monkeypatch
):
    (tmp_path / "part.vtp").write_bytes(vtp(CUBE, QUADS))
    mesh, parent, asked = open_mesh(tmp_path / "part.vtp"), QWidget(), []
    qtbot.addWidget(parent)

    def dialog(_parent, _title, proposed, filters, first):
        assert proposed.endswith("part-deformed.vtp")
        assert filters.startswith(first)
        assert first == "VTP (*.vtp)"
        return str(tmp_path / "out"), chosen

    monkeypatch.setattr(QFileDialog, "getSaveFileName", dialog)
    monkeypatch.setattr(QMessageBox, "question", lambda *words: asked.append(words[2]) or YES)
    assert ask_where_to_save_mesh(parent, tmp_path, mesh) == tmp_path / f"out.{'obj' if loses else 'vtp'}"
    assert ["point data (heat) and cell data (layer)" in said for said in asked] == [True] * loses
