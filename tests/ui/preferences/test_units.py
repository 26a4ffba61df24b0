"""The unit of length: chosen where sizes are read, used wherever one is written, remembered by file."""

import re

import meshes
import numpy as np
import pytest
from answering import once_shown
from driving import document, idle, work_off
from PySide6.QtCore import QPoint, Qt

from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.samples import SAMPLES, resource_path
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.storage.session_file import open_session
from apd_viewer.ui.preferences import preferences
from apd_viewer.ui.preferences.preferences import Preferences
from apd_viewer.ui.preferences.unit_button import Units

MM, CM, M, NONE = Unit.MILLIMETRE, Unit.CENTIMETRE, Unit.METRE, Unit.NONE


@pytest.fixture
def window(kept_window):
    """The window of all tests of this file."""
    return kept_window


@pytest.fixture
def files(tmp_path):
    """Three files of the user's."""
    paths = [tmp_path / f"part {name}.obj" for name in "abc"]
    for path in paths:
        mesh = Mesh(*meshes.sphere(2))
        save_mesh(mesh, mesh.V, path)
    return paths


def open_file(qtbot, window, path):
    window.files.open_path(path)
    idle(qtbot, window)


def choose(window, unit):
    """Take a unit from the menu, as a hand does."""
    actions = {action.data(): action for action in window.panel.area.unit.menu().actions()}
    actions[unit.value].trigger()


def readings(window):
    """All that is written of areas, volumes and lengths."""
    panel = window.panel
    return {
        "area": panel.area.area.text(),
        "volume": panel.volume.volume.text(),
        "drift": panel.strain.drift.text(),
        "moved": panel.handles.list.rows[0].details.text().split(",")[0],
        "region": panel.regions.list.rows[0].reading.toolTip(),
        "extent": window.status.extent.toolTip().split(" at rest")[0],
    }


POWERS = {"area": 2, "volume": 3, "drift": 1, "moved": 1, "region": 2, "extent": 1}


@pytest.fixture
def twisted(qtbot, bottle):
    """The bottle with a region, moved a little by the method that lets the handle drift."""
    session = bottle.session
    session.settings.change(method="paper")
    session.parts.add_region()
    session.gestures.begin()
    session.painting.paint_region(np.flatnonzero(abs(document(bottle).mesh.V[:, 1] - 10) < 2), 1)
    session.painting.end_stroke("Paint")
    session.gestures.begin()
    pose = np.eye(4)
    pose[0, 3] = 0.2
    session.handles.drag(pose)
    session.gestures.end("Move handle")
    idle(qtbot, bottle)
    return bottle


def test_measure_in_gives_each_reading_with_a_dimension_the_unit_and_keeps_its_figures(twisted):
    bare = readings(twisted)
    percentages = twisted.panel.area.percent.text(), twisted.panel.area.verdict.text()
    assert not any(re.search(r"\d\s*(mm|cm|m)\b", text) for text in bare.values())
    for unit in (MM, CM, M):
        choose(twisted, unit)
        for name, text in readings(twisted).items():
            ending = unit.value + {1: "", 2: "²", 3: "³"}[POWERS[name]]
            assert text == f"{bare[name]}\u00a0{ending}"
    assert (twisted.panel.area.percent.text(), twisted.panel.area.verdict.text()) == percentages
    choose(twisted, NONE)
    assert readings(twisted) == bare


def test_panel_reads_new_frames_and_exports_in_the_unit_too(qtbot, twisted, tmp_path):
    choose(twisted, CM)
    before = readings(twisted)
    session = twisted.session
    session.gestures.begin()
    pose = np.eye(4)
    pose[0, 3] = 0.4
    session.handles.drag(pose)
    session.gestures.end("Move handle")
    idle(qtbot, twisted)
    assert readings(twisted)["area"] != before["area"]
    assert readings(twisted)["area"].endswith("cm²")
    assert readings(twisted)["moved"] == "moved 0.4000\u00a0cm"
    session.files.export(tmp_path / "out.obj")
    idle(qtbot, twisted)
    assert re.search(r"area [\d.]+\u00a0cm²", twisted.notice.text)


def test_unit_button_is_used_with_the_mouse_or_the_keys(qtbot, bottle):
    button = bottle.panel.area.unit
    assert (button.text(), button.accessibleName()) == ("no unit", "Unit of length: no unit")
    assert button.isVisible()
    menu = button.menu()
    for use in (
        lambda: qtbot.mouseClick(button, Qt.MouseButton.LeftButton),
        lambda: qtbot.keyClick(button, Qt.Key.Key_Space),
    ):
        seen = []

        def take(seen=seen):
            seen.append(menu.isVisible())
            menu.setActiveAction(menu.actions()[1])
            qtbot.keyClick(menu, Qt.Key.Key_Return)

        choose(bottle, NONE)
        once_shown(menu, take)
        use()
        qtbot.waitUntil(lambda seen=seen: bool(seen))
        assert seen == [True]
        assert (button.text(), button.accessibleName()) == ("mm", "Unit of length: mm")
        assert [action.isChecked() for action in menu.actions()] == [False, True, False, False, False, False]


@pytest.mark.parametrize(("keys", "symbol"), [("c", "cm"), ("i", "in"), ("f", "ft"), ("n", "no unit")])
def test_unit_button_takes_a_unit_by_its_letter(qtbot, bottle, keys, symbol):
    choose(bottle, CM if symbol == "no unit" else NONE)
    button = bottle.panel.area.unit
    once_shown(button.menu(), lambda: (qtbot.keyClicks(button.menu(), keys), button.menu().close()))
    qtbot.mouseClick(button, Qt.MouseButton.LeftButton)
    assert button.text() == symbol


def test_units_keep_that_of_a_file_from_one_window_to_the_next(qtbot, window, files, settings):
    open_file(qtbot, window, files[0])
    choose(window, CM)
    open_file(qtbot, window, files[1])
    assert window.panel.unit is window.session.store.unit is NONE, "one choice is no habit"
    open_file(qtbot, window, files[0])
    assert window.panel.unit is window.session.store.unit is CM
    window.session.gestures.undo()
    assert window.panel.unit is window.session.store.unit is NONE, "undo brings back the mesh and its unit"
    assert Preferences(settings).units == {files[0].resolve(): CM}
    assert Units(Preferences(settings)).unit_of(Mesh(*meshes.sphere(1), path=files[0])) is CM


def test_units_of_guesses_for_the_next_file_the_same_unit_twice_running(settings, files):
    V, F = meshes.sphere(1)
    a, b, c = (Mesh(V, F, path=path) for path in files)
    units = Units(Preferences(settings))
    units.set_unit(a, MM)
    assert units.unit_of(b) is NONE
    units.set_unit(b, MM)
    assert units.unit_of(c) is MM.as_guess
    assert set(Preferences(settings).units) == {files[0].resolve(), files[1].resolve()}
    units.set_unit(c, MM)
    assert Units(Preferences(settings)).unit_of(Mesh(V, F, path=files[2])) is MM, (
        "a confirmed one is remembered"
    )


def test_units_set_unit_lets_a_guess_never_confirm_itself(settings, files, tmp_path):
    V, F = meshes.sphere(1)
    units = Units(Preferences(settings))
    units.set_unit(Mesh(V, F, path=files[0]), MM)
    units.set_unit(Mesh(V, F, path=files[1]), CM)
    units.set_unit(Mesh(V, F, path=files[2]), MM.as_guess)  # as a session has it
    assert units.unit_of(Mesh(V, F, path=tmp_path / "d.obj")) is NONE


def test_units_of_puts_what_a_file_states_before_a_guess_and_after_a_choice(settings, files, tmp_path):
    V, F = meshes.sphere(1)
    units = Units(Preferences(settings), lambda: CM)
    for path in files[:2]:
        units.set_unit(Mesh(V, F, path=path), MM)
    stated = Mesh(V, F, path=files[2], unit="m")
    assert units.unit_of(stated) is M
    assert units.unit_of(stated.baked(stated.V)) is units.unit_of(stated.without_path()) is M
    units.set_unit(stated, MM)
    assert units.unit_of(Mesh(V, F, path=files[2], unit="m")) is MM
    assert units.unit_of(Mesh(V, F, path=tmp_path / "d.obj")) is CM, "that of new files, as set"


def test_unit_button_marks_a_guess_until_it_is_confirmed(qtbot, window, files, settings):
    for path in files[:2]:
        open_file(qtbot, window, path)
        choose(window, CM)
    open_file(qtbot, window, files[2])
    button, panel = window.panel.area.unit, window.panel
    assert (button.text(), panel.unit) == ("cm?", CM.as_guess)
    assert "guess" in button.toolTip()
    assert panel.area.area.text().endswith("cm²?")
    assert window.status.extent.toolTip().split(" at rest")[0].endswith("cm?")
    menu = button.menu()

    def press():
        menu.setActiveAction(preselected[0])  # unless the pointer happens to be over another one
        qtbot.keyClick(menu, Qt.Key.Key_Return)

    preselected = []
    menu.aboutToShow.connect(lambda: preselected.append(menu.activeAction()))
    once_shown(menu, press)
    qtbot.mouseClick(button, Qt.MouseButton.LeftButton)
    assert (button.text(), panel.unit) == ("cm", CM)
    assert "guess" not in button.toolTip()
    assert panel.area.area.text().endswith("cm²")
    assert Preferences(settings).units[files[2].resolve()] is CM


def test_files_save_keeps_a_guessed_unit_a_guess_in_a_session(qtbot, window, files, settings, tmp_path):
    for path in files[:2]:
        open_file(qtbot, window, path)
        choose(window, CM)
    open_file(qtbot, window, files[2])
    session = window.session
    session.files.save(tmp_path / "guessed.apd", window.view())
    idle(qtbot, window)
    _, view = open_session(tmp_path / "guessed.apd")
    assert Unit(view.unit) is CM.as_guess
    choose(window, CM)
    session.files.save(tmp_path / "confirmed.apd", window.view())
    idle(qtbot, window)
    _, view = open_session(tmp_path / "confirmed.apd")
    assert Unit(view.unit) is CM


def test_open_sample_gives_every_sample_the_unit_that_its_file_names(qtbot, window):
    """Each says "unit: centimetre" in a comment."""
    for name in SAMPLES:
        assert "unit: centimetre" in resource_path(f"{name}.obj").read_text()[:200]
        window.files.open_sample(name)
        idle(qtbot, window)
        assert window.panel.unit is CM, name
        assert window.panel.area.unit.text() == "cm"


def test_units_of_a_mesh_without_a_file_is_none_at_first(qtbot, bottle, settings, files):
    units = Units(Preferences(settings))
    V, F = meshes.sphere(1)
    for path in files[:2]:
        units.set_unit(Mesh(V, F, path=path), MM)
    assert units.unit_of(Mesh(V, F)) is NONE
    bottle.files.open_sample("duck")
    idle(qtbot, bottle)
    choose(bottle, M)
    assert set(Preferences(settings).units.values()) == {MM}, "none is kept for a sample"
    bottle.files.open_sample("bottle")
    idle(qtbot, bottle)
    assert bottle.panel.unit is CM
    bottle.session.gestures.undo()
    assert bottle.panel.unit is M


def test_preferences_bound_the_memory_of_units_and_overlook_what_they_cannot_read(settings, tmp_path):
    remembered = Preferences(settings)
    for k in range(preferences.MOST_REMEMBERED + 5):
        remembered.remember_unit(tmp_path / f"part, {k} mm.obj", (NONE, MM, CM, M)[k % 4])
    units = remembered.units
    assert len(units) == preferences.MOST_REMEMBERED
    last = preferences.MOST_REMEMBERED + 4
    assert next(iter(units)) == (tmp_path / f"part, {last} mm.obj").resolve()
    assert units[(tmp_path / "part, 6 mm.obj").resolve()] is CM
    settings.setValue("units", ["furlong /a.obj", "mm", "", "cm /b c.obj"])
    assert {str(path): unit for path, unit in remembered.units.items()} == {"/b c.obj": CM}
    settings.setValue("units", "m /one.obj")
    assert list(remembered.units.values()) == [M]


@pytest.mark.parametrize("size", [(800, 640), pytest.param((1280, 800), marks=pytest.mark.night)])
@pytest.mark.parametrize("scheme", [Qt.ColorScheme.Light, Qt.ColorScheme.Dark])
def test_unit_button_stands_beside_the_area_whatever_its_size(qtbot, window, size, scheme):
    window.shell.resize(*size)
    window.actions_.view.schemes[scheme].trigger()
    V, F = meshes.sphere(2)
    window.files.show_mesh(Mesh(V * 3.3e5, F))
    idle(qtbot, window)
    choose(window, MM)
    work_off()
    panel, button = window.panel, window.panel.area.unit
    place = button.mapTo(panel, QPoint(0, 0))
    assert panel.rect().contains(place)
    assert place.x() + button.width() <= panel.width()
    beside = panel.area.area
    assert beside.geometry().right() < button.geometry().left()
    assert beside.height() >= beside.heightForWidth(beside.width())


def test_units_go_with_a_mesh_whose_rest_shape_is_another(qtbot, window, files):
    """A baked shape is a mesh of its own, and undo goes back to the one before."""
    window.session.files.open_sample("bottle")
    idle(qtbot, window)
    choose(window, MM)
    window.session.shapes.bake()
    idle(qtbot, window)
    open_file(qtbot, window, files[0])
    window.edits.undo()
    idle(qtbot, window)
    assert window.session.store.unit is MM
    open_file(qtbot, window, files[0])
    window.session.shapes.bake()
    idle(qtbot, window)
    choose(window, M)
    window.edits.undo()
    open_file(qtbot, window, files[1])
    window.edits.undo()
    idle(qtbot, window)
    assert window.session.store.unit is M
