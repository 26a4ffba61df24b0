"""Turns that the surface loses, said beneath the handles and in the report."""

import pytest
from driving import idle
from meshes import sample_bottle
from page_parts import PageParts
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.processes import shape_checker


@pytest.fixture(scope="module")
def kept(unused):
    """Another window may still wait for its first check."""
    return unused


@pytest.fixture(autouse=True)
def at_once(monkeypatch):
    monkeypatch.setattr(shape_checker, "FIRST_PAUSE", 0.0)
    monkeypatch.setattr(shape_checker, "NEXT_PAUSE", 0.0)


@pytest.fixture
def without_contact(qtbot, kept_window, tmp_path):
    """A kept_window on a coarse bottle whose walls pass through each other."""
    V, F, labels = sample_bottle(edge=3.0)
    save_mesh(Mesh(V, F), V, tmp_path / "bottle.obj")
    state = initial_state(open_mesh(tmp_path / "bottle.obj"), labels.astype("uint8"))
    state = state.updated(state.document.with_settings(contact=False))
    kept_window.session.files.open_result("bottle", lambda: state)
    idle(qtbot, kept_window)
    return kept_window


def twist(qtbot, window, text):
    field = window.panel.handles.motion
    field.choice.setCurrentIndex(field.choice.findData("TWIST"))
    field.amount.setFocus()
    field.amount.selectAll()
    QTest.keyClicks(field.amount, text)
    QTest.keyClick(field.amount, Qt.Key.Key_Return)
    idle(qtbot, window)
    qtbot.waitUntil(lambda: window.session.shape_checks.shape_check is not None, timeout=30_000)


def report(qtbot, window, path):
    window.reports.write_report(path)
    idle(qtbot, window)
    return PageParts(path.read_text(encoding="utf-8"))


def test_handle_section_says_a_lost_turn_until_it_is_undone(qtbot, without_contact, tmp_path):
    window, lost = without_contact, without_contact.panel.handles.crossing_signs
    assert lost.isHidden()
    twist(qtbot, window, "400")
    assert window.session.shape_checks.shape_check.turns[0].degrees == pytest.approx((400.0, 40.0))
    assert lost.isVisible()
    said = "The surface holds 40 of the 400 degrees asked: without contact it passed through itself; "
    assert lost.text() == said + "turn contact on."
    page = report(qtbot, window, tmp_path / "lost.html")
    assert lost.text() in page.notes["Shape"]
    assert "the surface holds 40.0°" in page.rows["Handles"]["Handle 1"]
    window.actions_.undo.trigger()
    qtbot.waitUntil(lost.isHidden, timeout=30_000)
    twist(qtbot, window, "100")
    assert window.session.shape_checks.shape_check.turns[0].degrees == pytest.approx((100.0, 100.0))
    assert lost.isHidden()
    page = report(qtbot, window, tmp_path / "kept.html")
    assert not any("holds" in note for note in page.notes.get("Shape", ()))
    assert "the surface holds 100.0°" in page.rows["Handles"]["Handle 1"]
