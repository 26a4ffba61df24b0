"""The volume, the room and the mass, in a real window: against other libraries and closed forms."""

from dataclasses import replace

import meshes
import numpy as np
import pytest
import pyvista as pv
import trimesh
from driving import Mouse, document, idle
from PySide6.QtCore import QPoint, QPointF, Qt

from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.geometry.analysis.hull_readings import hull_readings
from apd_viewer.geometry.analysis.self_intersections import crossings
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.session.model.state import initial_state, shape_frame
from apd_viewer.session.processes import shape_checker
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.wall import NO_WALL, WallText
from apd_viewer.ui.preferences.preferences import Preferences

CM = Unit.CENTIMETRE


@pytest.fixture
def window(kept_window):
    """The window of all tests of this file."""
    return kept_window


@pytest.fixture(scope="module")
def kept(unused):
    """Another window may still wait for its first check."""
    return unused


@pytest.fixture(autouse=True)
def at_once(monkeypatch):
    monkeypatch.setattr(shape_checker, "FIRST_PAUSE", 0.0)
    monkeypatch.setattr(shape_checker, "NEXT_PAUSE", 0.0)


def known(qtbot, window):
    """Wait until the shape rests and is known."""
    idle(qtbot, window)
    qtbot.waitUntil(lambda: window.session.shape_checks.shape_check is not None, timeout=30_000)


def crush(qtbot, window, by):
    session, pose = window.session, np.eye(4)
    session.gestures.begin()
    pose[1, 3] = -by
    session.handles.drag(pose)
    idle(qtbot, window)
    session.gestures.end("Move handle")


def passing(mesh, labels):
    """New work in which walls may pass through each other."""
    state = initial_state(mesh, frozen(labels))
    return state.updated(state.document.with_settings(contact=False))


def coarse_bottle(qtbot, window, open_top=False):
    V, F, labels = meshes.sample_bottle(3.0)
    if open_top:
        F = F[(V[F][:, :, 1] < V[:, 1].max() - 1e-6).any(axis=1)]
    mesh = Mesh(V, F)
    window.session.files.open_result("bottle", lambda: passing(mesh, labels))
    idle(qtbot, window)
    window.choose_unit(CM)
    return mesh


@pytest.fixture
def crushed(qtbot, window):
    """A coarse bottle, crushed by half along its axis: it passes through itself."""
    mesh = coarse_bottle(qtbot, window)
    crush(qtbot, window, np.ptp(mesh.V[:, 1]) / 2)
    known(qtbot, window)
    return window


def number(text):
    return float(text.replace("−", "-").split()[0])


def test_volume_section_of_the_crushed_bottle_has_the_volume_of_the_exported_mesh(crushed, tmp_path):
    state, panel = crushed.session.store.state, crushed.panel
    save_mesh(state.document.mesh, state.frame.U, tmp_path / "crushed.off")
    other, rest = (
        trimesh.load(tmp_path / "crushed.off", process=False),
        trimesh.Trimesh(state.document.mesh.V, state.document.mesh.F, process=False),
    )
    assert state.frame.volume == pytest.approx(other.volume, rel=1e-6)
    assert number(panel.volume.volume.text()) == pytest.approx(other.volume, rel=1e-5)
    assert panel.volume.volume.text().endswith(f"of {rest.volume:.3f}\u00a0cm³")
    assert panel.volume.litres.text().startswith(f"{other.volume / 1000:.4f} of")
    assert number(panel.volume.change) == pytest.approx(100 * (other.volume / rest.volume - 1), abs=0.005)
    room = panel.measures
    extents = [float(part) for part in room.extent.text().removesuffix("\u00a0cm").split("×")]
    assert extents == pytest.approx(other.extents, rel=5e-3)
    assert number(room.box.text()) == pytest.approx(np.prod(other.extents), rel=1e-3)
    assert number(room.packed.text()) == pytest.approx(hull_readings(state.frame.U).box, rel=1e-3)
    change = 100 * (hull_readings(state.frame.U).box / hull_readings(rest.vertices).box - 1)
    assert room.heading.reading == f"smallest box {change:.1f} %".replace("-", "−")
    assert number(room.compact.text()) == pytest.approx(
        36 * np.pi * other.volume**2 / other.area**3, abs=6e-4
    )


def test_crossings_button_flags_counts_and_shows_where_a_mesh_passes_through_itself(qtbot, crushed):
    button, health, state = crushed.panel.volume.crossings, crushed.findings, crushed.session.store.state
    crossing = crossings(state.frame.U, state.document.mesh.F)
    assert len(crossing) > 20
    assert button.text() == f"{len(crossing):,} intersecting triangles"
    assert health.badge.text() == "1 issue"
    Mouse(button).drag(QPointF(button.width() / 3, button.height() / 2))
    assert np.array_equal(crushed.canvas.marks.ids, np.unique(state.document.mesh.F[crossing]))
    assert health.list.isVisible()
    crushed.actions_.undo.trigger()
    known(qtbot, crushed)
    assert button.text() == "no self-intersections"
    assert not button.isEnabled()
    assert crushed.canvas.marks.ids is None
    assert health.badge.text() == "No issues"


def test_findings_controller_names_and_shows_what_crosses_at_rest_while_contact_is_on(qtbot, window):
    V, F = meshes.sphere(3)
    mesh = Mesh(np.vstack([V, V + [1.7, 0.03, 0.02]]), np.vstack([F, F + len(V)]))
    labels = np.where(mesh.V[:, 2] < -0.8, BASE, np.where(mesh.V[:, 2] > 0.8, HANDLE, FREE))
    window.session.files.open_result("spheres", lambda: passing(mesh, labels.astype(np.uint8)))
    known(qtbot, window)
    health, box = window.findings, window.panel.method.contact
    count = int(health.badge.text().split()[0])
    qtbot.mouseClick(box, Qt.MouseButton.LeftButton, pos=QPoint(10, box.height() // 2))
    known(qtbot, window)
    assert health.badge.text() == f"{count + 1} issues"
    qtbot.mouseClick(health.badge, Qt.MouseButton.LeftButton)
    names = [row.accessibleName() for row in health.list.rows]
    (row,) = (row for row in health.list.rows if "cross at rest" in row.accessibleName())
    qtbot.mouseClick(row, Qt.MouseButton.LeftButton)
    crossing = crossings(mesh.V, mesh.F)
    assert f"{len(crossing)} triangles cross at rest" in row.accessibleName()
    shown = window.canvas.marks.ids
    assert f"the {len(shown)} vertices" in row.accessibleName(), names
    held = np.flatnonzero(labels != FREE)
    contact = Deformation(mesh.V, mesh.F, held, contact=True).contact
    assert np.array_equal(shown, contact.contact.exempt_vertices), "as the solver has it"
    qtbot.mouseClick(box, Qt.MouseButton.LeftButton, pos=QPoint(10, box.height() // 2))
    qtbot.waitUntil(lambda: health.badge.text().split()[0] == str(count), timeout=30_000)


def test_size_section_has_no_readings_of_what_moves_that_are_made_at_rest(qtbot, window):
    coarse_bottle(qtbot, window)
    known(qtbot, window)
    room, button = window.panel.measures, window.panel.volume.crossings
    assert room.packed.text() != "…"
    window.session.gestures.begin()
    pose = np.eye(4)
    pose[1, 3] = -1.0
    window.session.handles.drag(pose)
    idle(qtbot, window)
    assert [room.extent.text(), room.box.text(), room.packed.text()] == ["…"] * 3
    assert button.text() == "self-intersections: checked when it stops"
    window.session.gestures.end("Move handle")
    assert button.text() == "checking for self-intersections…"
    known(qtbot, window)
    assert button.text() == "no self-intersections"


def filled(U, F):
    """The volume after VTK has filled the hole, which is flat: any filling is the cap."""
    closed = pv.PolyData.from_regular_faces(U, F).fill_holes(1e3)
    other = trimesh.Trimesh(closed.points, closed.regular_faces)
    other.fix_normals()  # VTK leaves the filling turned as it happens
    assert other.is_watertight
    return other.volume


def test_volume_section_measures_an_open_bottle_with_its_mouth_capped_and_says_so(qtbot, window):
    mesh = coarse_bottle(qtbot, window, open_top=True)
    panel = window.panel.volume
    assert panel.change == "unchanged, capped"
    assert number(panel.volume.text()) == pytest.approx(filled(mesh.V, mesh.F), rel=1e-5)
    assert panel.litres.text().endswith("with its opening capped flat")
    assert not panel.keep.isEnabled()
    crush(qtbot, window, 1.5)
    U = window.session.store.state.frame.U
    assert panel.change.endswith("%, capped")
    assert number(panel.volume.text()) == pytest.approx(filled(U, mesh.F), rel=1e-5)


def type_into(qtbot, field, text):
    field.setFocus()
    field.selectAll()
    qtbot.keyClicks(field, text)
    qtbot.keyClick(field, Qt.Key.Key_Return)


def test_size_section_weighs_a_typed_wall_as_area_times_thickness_times_density(qtbot, bottle):
    room = bottle.panel.measures
    room.reveal()
    type_into(qtbot, room.wall_fields.thickness, "0.3mm")
    assert room.mass.text() == "–"
    assert "needs the unit of the mesh" in room.problem.text()
    bottle.choose_unit(CM)
    assert "needs a density" in room.problem.text()
    type_into(qtbot, room.wall_fields.density, "1380 kg/m3")
    assert room.problem.isHidden()
    grams = bottle.session.store.state.frame.area * 0.03 * 1.38
    assert room.mass.text() == f"{grams:.2f}\u00a0g"
    bottle.choose_unit(Unit.METRE)
    assert room.mass.text() == f"{bottle.session.store.state.frame.area * 3e-4 * 1380:.1f}\u00a0kg"
    type_into(qtbot, room.wall_fields.thickness, "thin")
    assert "“thin” is unknown" in room.problem.text()


def test_size_section_weighs_a_wall_by_its_rest_area_however_it_is_stretched(qtbot, window):
    V, F = meshes.sphere(2)
    window.files.show_mesh(Mesh(V, F))
    idle(qtbot, window)
    window.choose_unit(CM)
    room = window.panel.measures
    room.reveal()
    room.show_wall(WallText("1mm", "1"))
    at_rest, state = room.mass.text(), window.session.store.state
    U = frozen(V * [1.0, 1.0, 1.5])
    stretched = state.updated(frame=shape_frame(state.document.mesh, state.inspection, U))
    assert stretched.frame.area > 1.2 * state.frame.area
    room.show_readings(stretched, CM)
    assert room.mass.text() == at_rest == f"{0.1 * state.inspection.area:.3f}\u00a0g"


def test_size_section_weighs_the_material_of_a_vessel_with_two_walls(qtbot, window):
    V, F = meshes.cup(64)
    window.files.show_mesh(Mesh(V, F))
    idle(qtbot, window)
    room, wall = window.panel.measures, window.session.store.state.inspection.double_wall
    room.reveal()
    window.choose_unit(CM)
    type_into(qtbot, room.wall_fields.thickness, "0.5mm")
    type_into(qtbot, room.wall_fields.density, "1.36")
    assert room.mass.text() == f"{1000 * 1.36 * wall.material:.4g}\u00a0mg"
    assert room.two_walls.isVisible()
    assert f"holds {wall.capacity:.4g}\u00a0ml" in room.two_walls.text()
    window.files.open_sample("bottle")
    idle(qtbot, window)
    assert room.two_walls.isHidden()


def test_volume_controller_remembers_the_wall_with_the_file_and_keeps_it_in_sessions(
    qtbot, window, settings, tmp_path
):
    paths = [tmp_path / f"part, {name}.obj" for name in "ab"]
    for path in paths:
        save_mesh(Mesh(*meshes.sphere(2)), meshes.sphere(2)[0], path)
    room, wall = window.panel.measures, WallText("0.3mm", "1.38 g/cm³")

    def open_(path):
        window.files.open_path(path)
        idle(qtbot, window)

    open_(paths[0])
    type_into(qtbot, room.wall_fields.thickness, wall.thickness)
    type_into(qtbot, room.wall_fields.density, wall.density)
    open_(paths[1])
    assert room.wall_fields.value == NO_WALL
    open_(paths[0])
    assert room.wall_fields.value == wall
    assert Preferences(settings).walls == {paths[0].resolve(): wall}
    saved = tmp_path / "s.apd"
    window.session.files.save(saved, replace(window.view(), unit=CM.value))
    idle(qtbot, window)
    type_into(qtbot, room.wall_fields.thickness, "2mm")
    open_(saved)
    assert room.wall_fields.value == wall
    assert window.session.store.unit is CM
    assert document(window).mesh.path == paths[0]


def test_preferences_read_no_walls_from_settings_that_somebody_has_broken(settings):
    settings.setValue("walls", ["nonsense", "[1]", '["/a.obj", "1mm", "2"]'])
    assert list(Preferences(settings).walls.values()) == [WallText("1mm", "2")]


def test_size_section_is_on_the_page_of_measurements(qtbot, bottle):
    assert bottle.panel.folded_sections == []
    assert not bottle.panel.measures.mass.isVisible()
    tabs = bottle.panel.pages.tabBar()
    qtbot.mouseClick(tabs, Qt.MouseButton.LeftButton, pos=tabs.tabRect(1).center())
    assert bottle.panel.measures.mass.isVisible()
    assert bottle.panel.area.percent.isVisible()
