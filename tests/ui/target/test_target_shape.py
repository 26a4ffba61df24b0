"""A target shape in the window: loaded, seen, measured, saved, cleared, by real menus."""

import dataclasses

import numpy as np
import pytest
from driving import document, idle, settle
from meshes import box, sphere
from page_parts import PageParts

from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.presentation.scales import Measure
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.filing import file_dialogs

CLOSEST, VERTEX = Measure.TARGET_DISTANCE, Measure.TARGET_DISPLACEMENT


@pytest.fixture
def window(kept_window):
    """The window of all tests of the file."""
    return kept_window


@pytest.fixture
def globe(qtbot, window):
    """A window on a sphere of radius one, in millimetres, with its measurements in sight."""
    window.files.show_mesh(Mesh(*sphere(3)))
    idle(qtbot, window)
    window.choose_unit(Unit.MILLIMETRE)
    window.panel.pages.setCurrentWidget(window.panel.measurements)
    return window


@pytest.fixture
def file(tmp_path):
    """The sphere of radius 1.2, with the same triangles."""
    mesh, path = Mesh(*sphere(3)), tmp_path / "larger.obj"
    save_mesh(mesh, 1.2 * mesh.V, path)
    return path


def load(qtbot, window, monkeypatch, path):
    monkeypatch.setattr(file_dialogs, "ask_for_target_shape", lambda *_: path)
    window.actions_.file.load_target.trigger()
    idle(qtbot, window)


def measured(qtbot, window):
    heat, section = window.display_options.overlay, window.panel.target
    qtbot.waitUntil(lambda: heat.reading.values is not None, timeout=60_000)
    qtbot.waitUntil(lambda: section.closest[0].text() not in "–…", timeout=60_000)
    settle(qtbot, window.canvas.viewport)


def said(labels):
    return [float(label.text().split()[0]) for label in labels]


def shown(window):
    """What legend and menu offer."""
    choice, measures = window.display_options.legend.choice, window.actions_.display.measures
    titles = [choice.itemText(k) for k in range(choice.count())]
    assert titles == [measure.traits.title for measure in Measure if measures[measure].isEnabled()]
    return [measure for measure in (CLOSEST, VERTEX) if measures[measure].isEnabled()]


def drawn(window):
    """How many actors are seen, but for the shadow on the ground."""
    view = window.canvas.viewport
    return sum(actor.GetVisibility() for actor in view.renderer.GetActors() if actor not in view.backdrop)


def test_target_controller_offers_nothing_without_a_target(globe):
    assert shown(globe) == []
    assert not globe.panel.target.isVisible()
    assert not globe.actions_.file.clear_target.isEnabled()
    assert not globe.actions_.display.switches["target_ghost"].isEnabled()
    globe.display_options.overlay.choose_measure(CLOSEST)
    assert globe.display_options.overlay.measure is None, "a session may say so whose target is missing"


def test_target_controller_shows_measures_and_clears_a_target(qtbot, globe, file, monkeypatch, tmp_path):
    heat, section, looks = globe.display_options.overlay, globe.panel.target, globe.actions_.display
    load(qtbot, globe, monkeypatch, file)
    assert heat.measure is CLOSEST, "what was loaded is shown"
    measured(qtbot, globe)
    assert section.isVisible()
    assert "larger.obj" in section.name.text()
    assert said(section.closest) == pytest.approx([0.2, 0.2, 0.2], abs=0.006)
    assert said(section.vertex) == pytest.approx([0.2, 0.2, 0.2], abs=1e-4)
    assert globe.display_options.legend.largest.text().startswith("0.19")
    assert shown(globe) == [CLOSEST, VERTEX]
    assert drawn(globe) == 2, "the shape, and its target"
    looks.switches["target_ghost"].trigger()
    assert drawn(globe) == 1

    looks.measures[VERTEX].trigger()
    qtbot.waitUntil(lambda: heat.reading.values is not None)
    np.testing.assert_allclose(heat.reading.values, 0.2, atol=1e-7)

    # Another shape is measured anew, and another unit written.
    store, V = globe.session.store, document(globe).mesh.V
    frame = dataclasses.replace(store.state.frame, U=frozen(1.1 * V))
    store.set_state(store.state.updated(frame=frame))
    measured(qtbot, globe)
    assert said(section.vertex) == pytest.approx([0.1, 0.1, 0.1], abs=1e-4)
    globe.choose_unit(Unit.CENTIMETRE)
    assert section.vertex[0].text().endswith("cm")

    page = tmp_path / "report.html"
    globe.reports.write_report(page)
    idle(qtbot, globe)
    rows = PageParts(page.read_text(encoding="utf-8")).rows["Target shape"]
    assert rows["File"] == "larger.obj"
    assert float(rows["RMS, same vertex"].split()[0]) == pytest.approx(0.1, abs=1e-4)
    assert "Largest, closest point of this shape" in rows

    assert globe.actions_.display.switches["target_ghost"].isEnabled()
    globe.actions_.file.clear_target.trigger()
    assert document(globe).target_shape is None
    assert not globe.actions_.display.switches["target_ghost"].isEnabled()
    assert heat.measure is None
    assert not globe.display_options.legend.isVisible()
    assert not section.isVisible()
    assert shown(globe) == []
    globe.actions_.undo.trigger()
    assert section.isVisible()
    section.clear.click()
    assert document(globe).target_shape is None


def test_target_controller_offers_the_closest_point_alone_for_other_triangles(
    qtbot, globe, tmp_path, monkeypatch
):
    cube, path = Mesh(*box(2, 2, 2)), tmp_path / "cube.obj"
    save_mesh(cube, cube.V - 1.0, path)
    load(qtbot, globe, monkeypatch, path)
    measured(qtbot, globe)
    section = globe.panel.target
    assert shown(globe) == [CLOSEST]
    assert section.closest[0].isVisible()
    assert not section.vertex[0].isVisible()
    away = 1.0 - np.abs(document(globe).mesh.V).max(axis=1)  # from the nearest side of the cube
    assert said(section.closest)[0] == pytest.approx(away.max(), rel=1e-3)

    # A session keeps the target and its overlay; without the file it opens all the same, and says so.
    session = tmp_path / "a.apd"
    globe.session.files.save(session, globe.view())
    idle(qtbot, globe)
    globe.files.show_mesh(Mesh(*box(1, 1, 1)))
    idle(qtbot, globe)
    assert globe.display_options.overlay.measure is None
    globe.files.open_path(session)
    idle(qtbot, globe)
    assert globe.display_options.overlay.measure is CLOSEST
    assert document(globe).target_shape.mesh.path == path
    path.unlink()
    globe.files.open_path(session)
    idle(qtbot, globe)
    assert globe.display_options.overlay.measure is None
    assert "cube.obj, a mesh of a.apd, is missing" in globe.notice.text
    assert "cube.obj" in section.name.text()
    assert not section.closest[0].isVisible()
    assert globe.actions_.file.clear_target.isEnabled()


def test_target_controller_changes_nothing_for_an_unreadable_target(qtbot, globe, tmp_path, monkeypatch):
    path = tmp_path / "points.obj"
    path.write_text("v 0 0 0\nv 1 0 0\n")
    load(qtbot, globe, monkeypatch, path)
    assert globe.notice.isVisible()
    assert "points.obj" in globe.notice.text or "faces" in globe.notice.text
    assert not globe.panel.target.isVisible()
    assert globe.display_options.overlay.measure is None
