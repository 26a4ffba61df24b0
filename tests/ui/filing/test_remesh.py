"""The command Remesh in the window: asks for an edge length and a file, and opens it."""

import numpy as np
import pytest
from meshes import sphere
from PySide6.QtWidgets import QInputDialog

from apd_viewer.files.formats import cad
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.mesh.arrays import diagonal
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.filing import file_dialogs


@pytest.fixture
def asked(monkeypatch):
    """Dialogs answered with an edge length of 0.7, and what they were given."""
    given = []

    def length(_parent, _title, _label, *numbers):
        given.append(numbers)
        return 0.7, True

    monkeypatch.setattr(QInputDialog, "getDouble", length)
    return given


def test_file_controller_remeshes_into_a_file_that_it_opens(bottle, qtbot, tmp_path, monkeypatch, asked):
    before, path = bottle.session.store.state.document.mesh, tmp_path / "even.ply"
    edges = []

    def even(_V, _F, edge):
        edges.append(edge)
        return *sphere(2), edge

    monkeypatch.setattr(cad, "check_remeshing", lambda: None)
    monkeypatch.setattr(cad, "even_triangles", even)
    monkeypatch.setattr(file_dialogs, "ask_for_format", lambda *_: path)
    bottle.files.remesh()
    qtbot.waitUntil(lambda: bottle.session.store.state.document.mesh.path == path)
    assert edges == [0.7]
    ((usual, least, most, _),) = asked
    assert least < usual < most
    assert usual == pytest.approx(diagonal(before.V) / 60)
    assert len(bottle.session.store.state.document.mesh.V) == len(open_mesh(path).V) == len(sphere(2)[0])


def test_file_controller_asks_nothing_without_the_library_for_remeshing(bottle, monkeypatch, asked):
    monkeypatch.setattr(cad, "find_spec", lambda _: None)
    before = bottle.session.store.state
    bottle.files.remesh()
    assert "apd-viewer[cad]" in bottle.notice.text
    assert asked == []
    assert bottle.session.store.state is before


def test_file_controller_remeshes_into_metres_by_the_unit_chosen(bottle, qtbot, tmp_path, monkeypatch, asked):
    path = tmp_path / "even.glb"
    monkeypatch.setattr(cad, "check_remeshing", lambda: None)
    monkeypatch.setattr(cad, "even_triangles", lambda *_: (*sphere(2), 0.7))
    monkeypatch.setattr(file_dialogs, "ask_for_format", lambda *_: path)
    bottle.session.store.unit = Unit.CENTIMETRE
    bottle.files.remesh()
    qtbot.waitUntil(lambda: bottle.session.store.state.document.mesh.path == path)
    assert np.ptp(open_mesh(path).V, axis=0) == pytest.approx(0.01 * np.ptp(sphere(2)[0], axis=0))
