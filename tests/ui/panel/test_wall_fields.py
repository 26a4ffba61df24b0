"""The wall in the panel: chosen once, and used by all that knows a wall."""

from dataclasses import replace

import numpy as np
import pytest
from driving import document, idle
from meshes import sphere
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QInputDialog

from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.operators import face_areas
from apd_viewer.geometry.pose.constraints import BASE, HANDLE
from apd_viewer.presentation.scales import Measure
from apd_viewer.session.model.view import View
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.wall import NO_WALL, WallText, parse_wall
from apd_viewer.session.quantities.wall_distribution import WallDistribution
from apd_viewer.session.quantities.wall_material import WALL_MATERIALS
from apd_viewer.ui.filing import file_dialogs
from apd_viewer.ui.preferences.preferences import Preferences

CM, MM = Unit.CENTIMETRE, Unit.MILLIMETRE
PET, _, HDPE, *_ = WALL_MATERIALS


@pytest.fixture
def fields(bottle):
    """The fields, unfolded, of a bottle in centimetres."""
    bottle.choose_unit(CM)
    bottle.panel.measures.reveal()
    return bottle.panel.measures.wall_fields


def choose(fields, material):
    """Choose a material with keys; None is one of the user's own."""
    fields.material.setFocus()
    QTest.keyClick(fields.material, Qt.Key.Key_Home)
    for _ in range(fields.material.findData(material)):
        QTest.keyClick(fields.material, Qt.Key.Key_Down)


def type_into(field, text):
    field.setFocus()
    field.selectAll()
    QTest.keyClicks(field, text)
    QTest.keyClick(field, Qt.Key.Key_Return)


def texts(fields):
    return [field.text() for field in (fields.density, fields.young, fields.poisson, fields.yield_radius)]


def test_wall_fields_give_the_mass_as_soon_as_a_material_is_chosen(bottle, fields):
    room, area = bottle.panel.measures, bottle.session.store.state.frame.area
    assert fields.density.isVisible(), "of one's own material"
    choose(fields, PET)
    assert room.mass.text() == f"{area * 0.03 * 1.36:.2f}\xa0g"
    assert fields.thickness.placeholderText() == "0.3\xa0mm"
    assert texts(fields) == ["1.36 g/cm³", "3.4 GPa", "0.38", "0.857 cm"]
    assert "Callister" in fields.source.text()
    assert not fields.density.isVisible(), "they follow from the material"
    type_into(fields.thickness, "0.25mm")
    assert room.mass.text() == f"{area * 0.025 * 1.36:.2f}\xa0g"
    assert fields.value == WallText("0.25mm", material=PET)
    assert fields.yield_radius.text() == "0.714 cm"
    bottle.choose_unit(MM)
    assert fields.yield_radius.text() == "7.14 mm"


def test_wall_fields_make_a_material_of_the_users_own_of_what_is_typed(bottle, fields):
    choose(fields, HDPE)
    fields.heading.click()
    type_into(fields.density, "1.2")
    assert fields.material.currentText() == "Custom"
    assert fields.value == WallText("0.5 mm", "1.2", "1.08 GPa", "0.42", "0.926 cm")
    assert not fields.source.isVisible()
    choose(fields, PET)
    assert fields.value == WallText(material=PET), "nobody has typed the thickness"


def test_wall_fields_leave_a_wall_of_the_users_own_as_it_stands(fields):
    choose(fields, PET)
    choose(fields, None)
    assert fields.value == WallText("0.3 mm", "1.36 g/cm³", "3.4 GPa", "0.38", "0.857 cm")
    assert fields.density.isVisible()


def test_wall_fields_keep_the_contact_distance_where_no_thickness_is_typed(bottle, fields):
    bottle.session.settings.set_contact(True)
    before = document(bottle)
    choose(fields, PET)
    assert document(bottle) is before
    type_into(fields.thickness, "0.2mm")
    assert document(bottle).settings.thickness == pytest.approx(0.02)


def test_wall_fields_say_the_units_of_bare_numbers(bottle, fields):
    choose(fields, None)
    for text in ("0.25", "0.25mm"):
        for field in (fields.thickness, fields.density, fields.young, fields.poisson, fields.yield_radius):
            type_into(field, text)
        units = "cm", "g/cm³", "GPa", "", "cm"
        assert [
            field.shown_unit
            for field in (fields.thickness, fields.density, fields.young, fields.poisson, fields.yield_radius)
        ] == (list(units) if text == "0.25" else [""] * 5)
    type_into(fields.thickness, "0.25")
    bottle.choose_unit(MM)
    assert fields.thickness.shown_unit == "mm"
    assert fields.value.thickness == "0.25", "the unit is no part of the text"


def test_method_section_says_the_unit_of_the_thickness_of_a_wall(bottle, fields):
    numbers = bottle.panel.method.numbers
    lengths = {name for name, number in numbers.items() if number.suffix() == "\u00a0cm"}
    assert "wall_thickness" in lengths
    assert "poisson" not in lengths
    bottle.choose_unit(MM)
    assert {name for name, number in numbers.items() if number.suffix() == "\u00a0mm"} == lengths


@pytest.mark.parametrize(
    ("text", "radius"), [("8.6mm", 0.86), ("0.5 cm", 0.5), ("1/4 in", 0.635), ("2e-1", 0.2)]
)
def test_method_section_takes_a_length_in_any_unit_and_0_as_a_word(bottle, fields, text, radius):
    bottle.session.settings.change(method="wall")
    field = bottle.panel.method.numbers["yield_radius"]
    assert (field.text(), field.value()) == ("none", 0.0)
    type_into(field, text)
    assert document(bottle).settings.yield_radius == pytest.approx(radius, abs=5e-5)
    assert field.text() == f"{radius:g}\xa0cm"
    type_into(field, "8.6 bushels")
    assert document(bottle).settings.yield_radius == pytest.approx(radius, abs=5e-5)
    assert "bushels" in field.error.text()
    type_into(field, "None")
    assert document(bottle).settings.yield_radius is None
    assert field.text() == "none"


def test_method_section_takes_the_yield_radius_of_the_wall_with_a_click(bottle, fields):
    choose(fields, PET)
    button = bottle.panel.method.wall_creases
    bottle.session.settings.change(method="wall")
    assert document(bottle).settings.yield_radius is None, "bends by hand are elastic until one asks"
    assert "0.857\xa0cm" in button.toolTip()
    button.click()
    radius = PET.yield_radius(0.03)
    assert document(bottle).settings.yield_radius == radius
    type_into(fields.thickness, "0.6mm")
    assert document(bottle).settings.yield_radius == pytest.approx(2 * radius), "it follows the wall"
    bottle.session.gestures.undo()
    choose(fields, WALL_MATERIALS[-1])
    assert not button.isEnabled()
    assert "has no yield radius" in button.toolTip()


def test_volume_controller_remembers_materials_with_the_file_and_keeps_them_in_sessions(
    qtbot, new_bottle, settings, tmp_path
):
    window, path, saved = new_bottle, tmp_path / "ball.obj", tmp_path / "ball.apd"
    save_mesh(Mesh(*sphere(2)), sphere(2)[0], path)
    fields, own = window.panel.measures.wall_fields, WallText("0.4mm", "1", "2GPa", "0.3", "5mm")
    for wall in (WallText("0.25mm", material=PET), own):
        window.files.open_path(path)
        idle(qtbot, window)
        window.panel.measures.show_wall(wall)
        fields.entered.emit(wall)
        assert Preferences(settings).walls == {path.resolve(): wall}
        window.session.files.save(saved, replace(window.view(), unit=CM.value))
        idle(qtbot, window)
        window.panel.measures.show_wall(NO_WALL)
        fields.entered.emit(NO_WALL)
        window.files.open_path(saved)
        idle(qtbot, window)
        assert fields.value == wall


def test_open_sample_bottle_is_of_pet_and_keeps_its_contact_distance(qtbot, new_bottle):
    """Its area is 407.117 cm², its wall 0.3 mm thick, and PET has 1.36 g/cm³."""
    new_bottle.files.open_sample("bottle")
    idle(qtbot, new_bottle)
    room, settings = new_bottle.panel.measures, document(new_bottle).settings
    assert new_bottle.panel.unit is CM
    assert room.wall_fields.value == WallText(material=PET)
    assert room.mass.text() == "16.61\xa0g"
    assert room.heading.reading == "16.61\xa0g"
    assert (settings.contact, settings.thickness, settings.yield_radius) == (True, None, None)
    new_bottle.files.open_sample("duck")
    idle(qtbot, new_bottle)
    assert room.wall_fields.value == NO_WALL


def test_method_wall_is_as_thick_as_the_wall_unless_that_is_typed(bottle, fields):
    method, undo = bottle.panel.method, bottle.actions_.undo.trigger

    def found():
        settings = document(bottle).settings
        return settings.wall_thickness, settings.poisson

    choose(fields, PET)
    steps = len(bottle.session.gestures.history.undo_names)
    method.changed.emit("method", "wall")
    assert found() == (pytest.approx(0.03), 0.38)
    assert len(bottle.session.gestures.history.undo_names) == steps + 1
    type_into(fields.thickness, "0.2mm")
    assert found() == (pytest.approx(0.02), 0.38)
    choose(fields, HDPE)
    assert found() == (pytest.approx(0.02), 0.42)
    method.changed.emit("wall_thickness", 0.05)
    type_into(fields.thickness, "0.1mm")
    assert found() == (0.05, 0.42), "the settings have their own"
    undo()
    undo()
    assert found() == (pytest.approx(0.02), 0.42)


def test_press_takes_creases_from_the_material(bottle, fields):
    choose(fields, PET)
    bottle.press.begin()
    wall = parse_wall(fields.value, CM)
    assert document(bottle).settings.yield_radius == wall.yield_radius
    choose(fields, HDPE)
    assert document(bottle).settings.yield_radius == pytest.approx(0.05 / (2 * HDPE.yield_strain))


def load(monkeypatch, window, path):
    monkeypatch.setattr(file_dialogs, "ask_for_wall_distribution", lambda *_: path)
    window.panel.measures.wall_fields.from_file.trigger()


def test_wall_fields_take_a_wall_distribution_from_a_file(qtbot, bottle, fields, tmp_path, monkeypatch):
    """It counts for mass and solver, is an overlay, and is kept in the view; typed lengths replace it."""
    heat, mesh = bottle.display_options.overlay, document(bottle).mesh
    thickness = Measure.THICKNESS
    assert thickness not in heat.offered_measures
    choose(fields, PET)
    y = mesh.V[:, 1]
    path = tmp_path / "walls.csv"
    path.write_text(f"y,thickness (mm)\n{y.min()},0.2\n{y.max()},0.6\n")
    load(monkeypatch, bottle, path)
    assert fields.thickness.text() == "walls.csv"
    expected = 0.02 + 0.04 * (y - y.min()) / np.ptp(y)
    areas = face_areas(mesh.V, mesh.F)
    grams = 1.36 * float((areas * expected[mesh.F].mean(axis=1)).sum())
    assert bottle.panel.measures.mass.text() == f"{grams:.2f}\xa0g"
    assert heat.measure is thickness
    qtbot.waitUntil(lambda: heat.reading.values is not None, timeout=60_000)
    assert np.abs(heat.reading.values - expected).max() < 0.001
    assert expected.max() <= heat.scale.end <= 2.0 * expected.max()
    bottle.session.settings.change(method="wall", **bottle.volume.wall_settings("wall_thickness"))
    assert document(bottle).settings.wall_thickness.triangles == pytest.approx(expected[mesh.F].mean(axis=1))
    view = bottle.volume.with_wall_and_overlay(View(unit="cm"))
    assert view.wall.thickness.thickness.triangles == pytest.approx(10.0 * expected[mesh.F].mean(axis=1))
    turned = replace(mesh, V=frozen(2.0 * mesh.V))
    bottle.volume.show_mesh_wall(turned)
    carried = fields.value.thickness
    assert carried.thickness.triangles == pytest.approx(view.wall.thickness.thickness.triangles)
    bottle.volume.show_mesh_wall(mesh)
    type_into(fields.thickness, "0.3mm")
    assert document(bottle).settings.wall_thickness == pytest.approx(0.03)
    assert (heat.measure, thickness in heat.offered_measures) == (None, False)
    bottle.volume.restore_view(view)
    assert heat.measure is thickness
    assert fields.value == view.wall


def offered(window, part):
    """Action of a part in the menu of ways to a thickness from place to place."""
    menu = window.panel.measures.wall_fields.places.menu()
    menu.aboutToShow.emit()
    return next(action for action in menu.actions() if part in action.text())


def test_wall_fields_give_a_painted_part_a_thickness_of_its_own(bottle, fields, monkeypatch):
    """The rest stays as thick as it was; a second part adds to the first, and undo takes it back."""
    choose(fields, PET)
    mesh = document(bottle).mesh
    bottle.session.settings.change(method="wall", **bottle.volume.wall_settings("wall_thickness"))
    base = np.isin(mesh.F, np.flatnonzero(document(bottle).labels == BASE)).sum(axis=1) >= 2
    top = np.isin(mesh.F, np.flatnonzero(document(bottle).labels == HANDLE)).sum(axis=1) >= 2
    assert base.any()
    assert top.any()
    handle = document(bottle).handles[0].name
    for part, own in (("Base", "0.1mm"), (handle, "0.07cm")):
        monkeypatch.setattr(QInputDialog, "getText", lambda *_, own=own: (own, True))
        offered(bottle, part).trigger()
    expected = np.where(top, 0.07, np.where(base, 0.01, 0.03))
    assert document(bottle).settings.wall_thickness.triangles == pytest.approx(expected)
    assert fields.thickness.text() == "0.01 – 0.07\xa0cm"
    assert bottle.display_options.overlay.measure is Measure.THICKNESS
    bottle.session.gestures.undo()
    assert document(bottle).settings.wall_thickness.triangles == pytest.approx(np.where(base, 0.01, 0.03))
    before = fields.value
    for given, said in ((("thin", True), "thin"), (("0", True), "greater than 0"), (("1mm", False), "")):
        monkeypatch.setattr(QInputDialog, "getText", lambda *_, given=given: given)
        offered(bottle, "Base").trigger()
        assert said in bottle.notice.text
        assert fields.value == before


def test_wall_fields_say_why_a_file_is_no_wall_distribution(bottle, fields, tmp_path, monkeypatch):
    path = tmp_path / "walls.csv"
    path.write_text("vertex,thickness\n0,0.3\n")
    before = fields.value
    load(monkeypatch, bottle, path)
    assert "walls.csv: It has 1 rows" in bottle.notice.text
    assert fields.value == before


def test_wall_fields_ask_what_black_and_white_mean(qtbot, bottle, fields, tmp_path, monkeypatch):
    mesh = document(bottle).mesh
    grey = np.round(255 * (mesh.V[:, 1] - mesh.V[:, 1].min()) / np.ptp(mesh.V[:, 1])).astype(int)
    head = f"ply\nformat ascii 1.0\nelement vertex {len(grey)}\n"
    head += "".join(f"property double {axis}\n" for axis in "xyz")
    head += "".join(f"property uchar {part}\n" for part in ("red", "green", "blue"))
    head += f"element face {len(mesh.F)}\nproperty list uchar int vertex_indices\nend_header\n"
    rows = [[*X, g, g, g] for X, g in zip(mesh.V.tolist(), grey, strict=True)]
    rows += [[3, *T] for T in mesh.F]
    (tmp_path / "grey.ply").write_text(head + "\n".join(" ".join(map(str, row)) for row in rows) + "\n")
    before, answers = fields.value, [("", False)]
    monkeypatch.setattr(QInputDialog, "getText", lambda *_, **__: answers.pop(0))
    load(monkeypatch, bottle, tmp_path / "grey.ply")
    assert fields.value == before
    answers += [("0.2mm", True), ("0.2mm..0.7mm", True)]  # one number is asked for again
    load(monkeypatch, bottle, tmp_path / "grey.ply")
    assert fields.thickness.text() == "grey.ply:0.2mm..0.7mm"
    found = fields.value.thickness.thickness
    assert found.triangles == pytest.approx(0.02 + 0.05 * grey[mesh.F].mean(axis=1) / 255.0)
    assert bottle.display_options.overlay.measure is Measure.THICKNESS
    assert not answers


def test_wall_fields_keep_the_thickness_for_the_mesh_it_was_entered_for(qtbot, bottle, fields, monkeypatch):
    """A mesh may open under the dialog."""

    def open_another(*_):
        bottle.session.files.open_mesh(Mesh(*sphere(1)))
        idle(qtbot, bottle)
        bottle.choose_unit(CM)
        return "0.1mm", True

    monkeypatch.setattr(QInputDialog, "getText", open_another)
    offered(bottle, "Base").trigger()
    assert len(document(bottle).mesh.V) == len(sphere(1)[0])
    assert not isinstance(fields.value.thickness, WallDistribution)
    assert "enter the thickness again" in bottle.notice.text


def test_wall_fields_give_a_part_of_a_baked_shape_a_thickness(qtbot, bottle, fields, monkeypatch):
    choose(fields, PET)
    bottle.session.shapes.bake()
    idle(qtbot, bottle)
    monkeypatch.setattr(QInputDialog, "getText", lambda *_: ("0.1mm", True))
    offered(bottle, "Base").trigger()
    assert isinstance(fields.value.thickness, WallDistribution)
