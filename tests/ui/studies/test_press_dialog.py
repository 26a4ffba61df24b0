"""The dialog that presses a mesh between plates: in a real window."""

import csv
import io
import json
import re
import shutil
from contextlib import redirect_stdout
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh
from driving import document, idle
from meshes import box, sphere, tube
from PySide6.QtCore import QSize, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QFileDialog
from study_driving import click, finish

from apd_viewer.__main__ import main
from apd_viewer.commands.buckle_command import buckle_parser
from apd_viewer.commands.press_command import press_parser
from apd_viewer.errors import InputError
from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.geometry.energy.wall_map import wall_map_of
from apd_viewer.geometry.goals.target_values import percentage
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.solver.methods import DEFAULT_METHOD, METHODS
from apd_viewer.session.model.view import View
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.wall import NO_WALL, WallText
from apd_viewer.session.quantities.wall_distribution import WallDistribution, read_distribution
from apd_viewer.session.quantities.wall_material import WALL_MATERIALS, parse_pressure_difference
from apd_viewer.ui.filing import file_controller
from apd_viewer.ui.filing.file_controller import UnsavedAnswer
from apd_viewer.ui.studies import run_dialog
from apd_viewer.ui.studies.press_dialog import PressDialog
from apd_viewer.ui.widgets import box_layouts


@pytest.fixture
def window(kept_window):
    """The window of all tests of the file."""
    return kept_window


@pytest.fixture
def asked(window, qtbot, tmp_path, monkeypatch):
    """Open the dialog of a mesh; and the options that it would run the command with."""
    dialogs = []

    def ask(V, F, unit="", wall=NO_WALL, **changes):
        state_of = window.session.store
        window.session.files.open_mesh(Mesh(V, F))
        idle(qtbot, window)
        changed = state_of.state.document.with_settings(**changes)
        state = state_of.state.updated(document=changed)
        dialog = PressDialog(window.shell, state, View(unit=unit, wall=wall), window.preferences)
        dialogs.append(dialog)
        dialog.show()
        return dialog

    def options(dialog):
        begun = []
        with monkeypatch.context() as patch:
            patch.setattr(dialog.run, "begin", lambda words: begun.append(words(tmp_path, tmp_path / "out")))
            click(dialog.run.start)
        return press_parser().parse_args(begun[0][1:])

    yield ask, options
    for dialog in dialogs:
        dialog.close()


@pytest.fixture
def ball(qtbot, window):
    """The dialog of a small ball with nothing painted, quick."""
    window.session.files.open_mesh(Mesh(*sphere(2)))
    idle(qtbot, window)
    window.actions_.simulate.press.trigger()
    dialog = window.runs.dialogs["press"]
    dialog.steps.setValue(2)
    dialog.to.setValue(80)
    return dialog


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """What the command writes of the small ball, and what it says."""
    folder, said = tmp_path_factory.mktemp("press"), io.StringIO()
    mesh, results = Mesh(*sphere(2)), folder / "results"
    save_mesh(mesh, mesh.V, folder / "mesh.obj")
    results.mkdir()
    files = {"-o": "pressed.obj", "--curve": "curve.csv", "--figure": "press.png", "--report": "report.json"}
    options = [word for option, name in files.items() for word in (option, str(results / name))]
    with redirect_stdout(said):
        main(["press", str(folder / "mesh.obj"), "--to", "80%", "--steps", "2", *options])
    return results, said.getvalue()


def end_run(dialog, written, scratch):
    """Have the dialog find what a command has written."""
    dialog.run.scratch_folder = scratch
    shutil.copytree(written[0], dialog.run.results_folder)
    dialog.run.command.ended.emit(written[1])


def texts(choice):
    return [choice.itemText(k) for k in range(choice.count())]


def test_run_controller_press_takes_any_mesh_even_if_nothing_is_painted(qtbot, window):
    action = window.actions_.simulate.press
    assert not action.isEnabled()
    window.session.files.open_mesh(Mesh(*box(1, 1, 1)))
    idle(qtbot, window)
    assert document(window).paint_problem
    assert action.isEnabled()
    action.trigger()
    assert window.runs.dialogs["press"].isVisible()
    assert window.notice.text == ""


def test_press_dialog_knows_the_mesh_and_its_unit(qtbot, window):
    window.session.files.open_mesh(Mesh(*box(1, 2, 4)))
    idle(qtbot, window)
    window.choose_unit(Unit.CENTIMETRE)
    window.actions_.simulate.press.trigger()
    dialog = window.runs.dialogs["press"]
    assert texts(dialog.direction) == ["X (1.000\xa0cm)", "Y (2.000\xa0cm)", "Z (4.000\xa0cm)"]
    assert "0.5000\xa0cm apart" in dialog.distance.text()
    dialog.direction.setCurrentIndex(2)
    assert "2.000\xa0cm apart" in dialog.distance.text()
    dialog.to.setValue(25)
    assert "1.000\xa0cm apart" in dialog.distance.text()
    assert dialog.wall.text() == "not known, so no newtons and no creases"


def test_press_dialog_leaves_loose_vertices_out_of_the_extent(asked):
    V, F = box(1, 2, 4)
    dialog = asked[0](np.vstack([V, [[50.0, 50.0, 50.0]]]), F)
    assert texts(dialog.direction) == ["X (1.000)", "Y (2.000)", "Z (4.000)"]


def test_press_dialog_says_as_it_stands_what_the_command_says_without_options(asked):
    ask, options = asked
    said, plain = options(ask(*sphere(2))), press_parser().parse_args(["m.obj", "--to", "50%", "-o", "o.obj"])
    assert (said.method, plain.method) == (DEFAULT_METHOD, None), "which without a wall is the same"
    for name in ("axis", "to", "steps", "iterations", "area_stiffness", "shear_stiffness"):
        assert getattr(said, name) == getattr(plain, name), name
    assert said.thickness is said.volume is said.material is None
    assert percentage(said.area, "the area") == 100.0


def test_press_dialog_proposes_the_settings_of_the_document(asked, tmp_path):
    ask, options = asked
    settings = {"method": "local", "stiffness": 0.02, "area_stiffness": 3.0, "shear_stiffness": 0.5}
    dialog = ask(*tube(), **settings, thickness=0.0125)
    dialog.direction.setCurrentIndex(1)
    said = options(dialog)
    assert {name: getattr(said, name) for name in settings} == settings
    assert (said.axis, said.thickness) == ("y", "0.0125")
    assert said.output == tmp_path / "out" / "pressed.obj"
    assert said.curve == tmp_path / "out" / "curve.csv"
    assert trimesh.load(said.mesh, process=False).vertices == pytest.approx(tube()[0], abs=1e-12)


def test_press_dialog_proposes_a_little_stiffness_without_any_and_says_why(asked):
    dialog = asked[0](*sphere(2), stiffness=0.0)
    assert dialog.stiffness.value() == 0.001
    dialog.stiffness.setValue(0.0)
    assert dialog.hint.isVisible()
    assert "loads mean little" in dialog.hint.text()


def test_press_dialog_expects_an_excess_of_loads_by_stiffness_and_method(asked):
    """0.75 h^2 over D, a tenth of it for local; edges of a sphere are nearly alike."""
    V, F = sphere(3)
    dialog = asked[0](V, F, stiffness=0.001, method="exact")
    square = (trimesh.Trimesh(V, F, process=False).edges_unique_length ** 2).mean()

    def said():
        return float(re.search(r"expected excess of loads ([\d.]+) %", dialog.hint.text())[1])

    known = 100.0 * 0.75 * square / (2.0 * 0.001 * trimesh.Trimesh(V, F, process=False).area)
    assert said() == pytest.approx(known, rel=0.07)
    dialog.stiffness.setValue(0.002)
    assert said() == pytest.approx(known / 2.0, rel=0.07)
    dialog.method.setCurrentIndex(dialog.method.findData("local"))
    assert said() == pytest.approx(known / 20.0, rel=0.07)


@pytest.mark.parametrize("method", METHODS)
def test_press_dialog_offers_only_methods_that_keep_walls_apart(method, asked):
    dialog = asked[0](*sphere(2), method=method)
    offered = [dialog.method.itemData(k) for k in range(dialog.method.count())]
    assert offered == [name for name, traits in METHODS.items() if traits.may_use_contact]
    assert dialog.method.currentData() == (method if method in offered else "exact")


@pytest.mark.parametrize(
    ("typed", "words"),
    [("9 mm2", "is unknown"), ("0", "greater than 0"), ("-1", "greater than 0"), ("7", "check the unit")],
)
def test_press_dialog_refuses_at_once_a_wall_that_cannot_be(typed, words, ball):
    ball.show_wall(WallText(typed))
    click(ball.run.start)
    assert words in ball.run.message.text()
    assert not ball.run.is_running
    assert ball.run.start.isVisible()


def test_press_dialog_does_not_press_a_flat_mesh_across(asked):
    V, F = box(1, 2, 4)
    dialog = asked[0](V * [1.0, 1.0, 0.0], F)
    dialog.direction.setCurrentIndex(2)
    click(dialog.run.start)
    assert "greater than 0" in dialog.run.message.text()
    assert not dialog.run.is_running


def test_press_dialog_draws_a_press_and_saves_it_in_the_format_of_the_mesh(
    qtbot, here, window, tmp_path, monkeypatch
):
    """By the command in this process; that of a study has its own."""
    V, F = sphere(2)
    save_mesh(Mesh(V, F), V, tmp_path / "ball.off")
    window.session.files.open(tmp_path / "ball.off")
    qtbot.waitUntil(lambda: window.session.store.state is not None)
    idle(qtbot, window)
    window.actions_.simulate.press.trigger()
    dialog = window.runs.dialogs["press"]
    dialog.steps.setValue(2)
    dialog.direction.setCurrentIndex(2)
    click(dialog.run.start)
    assert not dialog.steps.isEnabled()
    assert dialog.run.cancel.isVisible()
    finish(qtbot, dialog)
    assert dialog.figure.has_picture
    assert dialog.summary.text().startswith("load ")
    assert "pressed.off" not in dialog.summary.text()
    assert dialog.steps.isEnabled()
    monkeypatch.setattr(QFileDialog, "getExistingDirectory", lambda *_: str(tmp_path))
    click(dialog.run.save)
    finish(qtbot, dialog)
    folder = tmp_path / "ball-press"
    names = {"pressed.off", "curve.csv", "press.png", "press.svg", "report.json"}
    assert {path.name for path in folder.iterdir()} == names
    with (folder / "curve.csv").open(encoding="utf-8") as stream:
        assert [line["settled"] for line in csv.DictReader(stream)] == ["1", "1", "1"]
    report = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    assert (report["mesh"], report["vertices"], report["stiffness"]) == ("ball.off", len(V), 0.001)
    assert report["distance"] == pytest.approx(1.0, abs=1e-9)
    assert np.ptp(trimesh.load(folder / "pressed.off", process=False).vertices[:, 2]) < 1.0


def test_press_dialog_opens_the_pressed_mesh_in_the_window_once_saved(
    qtbot, window, ball, written, tmp_path, monkeypatch
):
    """It asks about unsaved work, keeps the unit and can be undone."""
    window.choose_unit(Unit.CENTIMETRE)
    ball.close()
    window.actions_.simulate.press.trigger()
    dialog = window.runs.dialogs["press"]
    assert dialog.run.open_mesh.isHidden()
    end_run(dialog, written, tmp_path / "scratch")
    assert dialog.run.open_mesh.isHidden()
    dialog.run.save_in(tmp_path)
    finish(qtbot, dialog)
    before = document(window).mesh
    window.session.gestures.begin()
    window.session.painting.paint(np.arange(3), 0)
    window.session.painting.end_stroke("Paint")
    assert window.session.saved_work.is_unsaved
    with monkeypatch.context() as patch:
        patch.setattr(file_controller, "ask_before_leaving", lambda *_: UnsavedAnswer.CANCEL)
        click(dialog.run.open_mesh)
        idle(qtbot, window)
    assert document(window).mesh is before
    assert dialog.isVisible()
    click(dialog.run.open_mesh)
    qtbot.waitUntil(lambda: document(window).mesh is not before)
    assert window.runs.dialogs == {}
    saved = tmp_path / "mesh-press" / "pressed.obj"
    assert document(window).mesh.path == saved
    assert np.ptp(document(window).mesh.V[:, 0]) < 0.9 * np.ptp(before.V[:, 0])
    assert window.session.store.unit is Unit.CENTIMETRE
    assert window.preferences.recent_files[0] == saved
    idle(qtbot, window)
    window.session.gestures.undo()
    assert document(window).mesh is before


def test_study_dialog_lets_the_figure_give_way_on_a_low_screen_and_not_the_fields(
    qtbot, ball, written, tmp_path, monkeypatch
):
    low = QSize(1280, 760)
    for module in (run_dialog, box_layouts):
        monkeypatch.setattr(module, "largest_on_screen", lambda _: low)
    end_run(ball, written, tmp_path / "scratch")
    qtbot.waitUntil(lambda: ball.height() <= low.height())
    qtbot.waitUntil(ball.options.isVisible)
    assert not ball.options.isChecked()
    assert not ball.to.isVisible()
    assert ball.figure.height() == ball.figure.heightForWidth(ball.figure.width()), "the figure is whole"
    ball.options.click()
    qtbot.waitUntil(lambda: ball.to.isVisible() and ball.height() <= low.height())
    height = ball.figure.height()
    for field in (ball.to, ball.steps, ball.stiffness):
        assert field.height() >= field.minimumSizeHint().height()
    ball.figure.shrink_by(0)
    natural = ball.figure.heightForWidth(ball.figure.width())
    assert ball.figure.minimumHeight() < height < natural


def test_press_dialog_can_save_again_after_a_folder_that_cannot_be_written(
    qtbot, ball, written, tmp_path, monkeypatch
):
    def full(_):
        raise InputError("The disk is full.")

    end_run(ball, written, tmp_path / "scratch")
    with monkeypatch.context() as patch:
        patch.setattr(run_dialog, "staging_folder", full)
        ball.run.save_in(tmp_path)
        qtbot.waitUntil(lambda: ball.run.message.text() == "The disk is full.")
    assert ball.run.save.isVisible()
    assert ball.run.save.isEnabled()
    ball.run.save_in(tmp_path)
    finish(qtbot, ball)
    assert (tmp_path / "mesh-press" / "pressed.obj").exists()


def test_press_dialog_has_the_window_tell_of_a_pressed_mesh_that_is_gone(
    qtbot, window, ball, written, tmp_path
):
    end_run(ball, written, tmp_path / "scratch")
    ball.run.save_in(tmp_path)
    finish(qtbot, ball)
    (tmp_path / "mesh-press" / "pressed.obj").unlink()
    before = document(window).mesh
    click(ball.run.open_mesh)
    qtbot.waitUntil(lambda: "pressed.obj" in window.notice.text)
    assert document(window).mesh is before


@pytest.mark.night
def test_press_dialog_leaves_nothing_after_cancel(qtbot, ball):
    click(ball.run.start)
    scratch = ball.run.scratch_folder
    assert scratch.exists()
    click(ball.run.cancel)  # while the mesh is written
    assert not scratch.exists()
    ball.steps.setValue(200)
    click(ball.run.start)
    qtbot.waitUntil(lambda: ball.run.bar.value() > 0, timeout=60_000)
    scratch = ball.run.scratch_folder
    assert "pressing" in ball.run.message.text()
    click(ball.run.cancel)
    assert not scratch.exists()
    assert not ball.run.is_running
    assert "nothing was written" in ball.run.message.text()
    assert ball.figure is None
    assert ball.steps.isEnabled()


def test_press_dialog_ends_the_run_when_closed(qtbot, window, ball):
    click(ball.run.start)
    qtbot.waitUntil(lambda: ball.run.command.is_running)
    scratch = ball.run.scratch_folder
    qtbot.keyClick(ball, Qt.Key.Key_Escape)
    assert window.runs.dialogs == {}
    assert not scratch.exists()


def test_press_dialog_hands_creases_and_release_to_the_command(asked):
    ask, options = asked
    dialog = ask(*box(1, 2, 4))
    plain = options(dialog)
    assert plain.yield_radius is None
    assert not plain.release
    assert plain.crushed is None
    assert dialog.run.mesh == "pressed.obj"
    dialog.show_wall(WallText(yield_radius="6"))
    dialog.release.click()
    creased = options(dialog)
    assert float(creased.yield_radius) == pytest.approx(6.0)
    assert creased.release
    assert Path(creased.crushed).name == dialog.run.mesh == "crushed.obj"


@pytest.mark.parametrize(
    ("typed", "stiffness", "words"), [("0", 0.001, "greater than 0"), ("2", 0.0, "stiffness")]
)
def test_press_dialog_refuses_at_once_a_yield_radius_that_cannot_be(typed, stiffness, words, ball):
    ball.show_wall(WallText(yield_radius=typed))
    ball.stiffness.setValue(stiffness)
    click(ball.run.start)
    assert not ball.run.is_running
    assert words in ball.run.message.text()


PET = WallText(material=WALL_MATERIALS[0])


def test_press_dialog_presses_with_the_material_of_the_panel(asked):
    ask, options = asked
    dialog = ask(*box(1, 2, 4), unit="cm", wall=PET)
    assert dialog.wall.text() == "PET, wall of a bottle, 0.3\xa0mm"
    own = 0.03**2 / (6.0 * (1.0 - 0.38**2) * 28.0)
    dialog.method.setCurrentIndex(dialog.method.findData("exact"))
    assert f"this wall has {own:.1g}" in dialog.hint.text()
    dialog.method.setCurrentIndex(dialog.method.findData("local"))
    assert f"this wall has {1.1825 / 4.0 * own:.1g}" in dialog.hint.text()
    said = options(dialog)
    assert (said.material, said.unit) == ("pet-bottle", "cm")
    assert said.thickness is said.young is said.yield_radius is None, "they follow from the material"
    dialog.show_wall(PET._replace(thickness="0.4mm"))
    assert float(options(dialog).thickness) == pytest.approx(0.04)


@pytest.mark.parametrize(
    ("wall", "unit", "stiffness"),
    [(NO_WALL, "cm", 0.0), (PET, "", 0.0), (PET, "cm", 0.0), (PET, "cm", 0.02), (WallText("1mm"), "cm", 0.0)],
)
def test_press_dialog_proposes_the_method_that_the_command_takes(asked, wall, unit, stiffness, tmp_path):
    dialog = asked[0](*box(1, 2, 4), unit=unit, wall=wall, method="local", stiffness=stiffness)
    known = wall.material is not None and unit != ""
    assert dialog.method.currentData() == ("wall" if known and not stiffness else "local")


def test_press_dialog_leaves_a_method_that_was_chosen(asked):
    dialog = asked[0](*box(1, 2, 4), unit="cm")
    dialog.show_wall(PET)
    assert dialog.method.currentData() == "wall"
    dialog.show_wall(NO_WALL)
    assert dialog.method.currentData() == DEFAULT_METHOD
    dialog.method.setFocus()
    QTest.keyClick(dialog.method, Qt.Key.Key_Down)
    chosen = dialog.method.currentData()
    assert chosen not in (DEFAULT_METHOD, "wall")
    dialog.show_wall(PET)
    assert dialog.method.currentData() == chosen


def test_press_dialog_presses_with_a_wall_of_the_users_own(asked):
    ask, options = asked
    wall = WallText("0.4mm", "0.96 g/cm³", "1.08GPa", "0.42", "9.26mm")
    dialog = ask(*box(1, 2, 4), unit="cm", wall=wall)
    said = options(dialog)
    assert said.material is None
    assert (said.young, said.poisson) == ("1.08GPa", "0.42")
    lengths = [float(text) for text in (said.thickness, said.density, said.yield_radius)]
    assert lengths == pytest.approx([0.04, 0.96, 0.926])
    dialog.method.setCurrentIndex(dialog.method.findData("wall"))
    assert float(options(dialog).yield_radius) == pytest.approx(0.926)


def test_press_dialog_presses_with_a_wall_distribution(asked, tmp_path):
    ask, options = asked
    V, F = box(1, 2, 4)
    thickness = wall_map_of(np.linspace(0.2, 0.5, len(F)), V, F)
    wall = PET._replace(thickness=WallDistribution("walls.csv", thickness, "mm"))
    dialog = ask(V, F, unit="cm", wall=wall)
    assert "walls.csv" in dialog.wall.text()
    table = Path(options(dialog).thickness)
    assert table.parent == tmp_path
    found = read_distribution(table, Mesh(V, F), Unit.CENTIMETRE)
    assert np.array_equal(found.thickness.triangles, wall.thickness.in_unit(Unit.CENTIMETRE).triangles)


def test_press_dialog_presses_several_dented_walls_where_their_thickness_is_known(asked):
    ask, options = asked
    dialog = ask(*box(1, 2, 4), unit="cm")
    assert not dialog.runs.isEnabled()
    assert "thickness known" in dialog.band_hint.text()
    dialog.show_wall(PET)
    assert dialog.runs.isEnabled()
    assert not dialog.dents.isEnabled()
    assert (options(dialog).runs, options(dialog).dents) == (1, None)
    dialog.runs.setValue(10)
    assert (options(dialog).runs, options(dialog).dents) == (10, 10.0)
    dialog.dents.setValue(25)
    assert options(dialog).dents == 25.0
    dialog.method.setCurrentIndex(dialog.method.findData("local"))
    assert not dialog.runs.isEnabled()
    assert (options(dialog).runs, options(dialog).dents) == (1, None)


def test_press_dialog_finds_buckling_modes_of_the_wall_without_a_press(asked, tmp_path, monkeypatch):
    ask, _ = asked
    dialog = ask(*box(1, 2, 4), unit="cm")
    assert not dialog.modes.isEnabled()
    dialog.show_wall(PET)
    dialog.runs.setValue(10)
    dialog.release.click()
    begun = []
    monkeypatch.setattr(dialog.run, "begin", lambda words: begun.append(words(tmp_path, tmp_path / "out")))
    click(dialog.modes)
    assert begun[0][0] == "buckle"
    said = buckle_parser().parse_args(begun[0][1:])
    assert (said.axis, said.unit, said.material, said.modes) == ("x", "cm", "pet-bottle", 4)
    assert said.output == tmp_path / "out" / "mode.obj"
    assert dialog.run.mesh == "mode-1.obj"
    click(dialog.run.start)
    assert begun[1][0] == "press"
    again = press_parser().parse_args(begun[1][1:])
    assert (again.runs, again.release) == (10, True)


def test_run_controller_gives_reports_the_last_press_of_the_mesh(qtbot, window, ball, written, tmp_path):
    mesh = document(window).mesh
    assert window.runs.pressed_blocks(mesh) == ()
    end_run(ball, written, tmp_path / "scratch")
    picture, *notes = window.runs.pressed_blocks(mesh)
    assert picture.pictures[0].png == (written[0] / "press.png").read_bytes()
    assert "\n".join(note.text for note in notes) == ball.summary.text()
    assert window.runs.pressed_blocks(Mesh(*sphere(1))) == ()
    window.reports.write_report(tmp_path / "report.html")
    idle(qtbot, window)
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "<h2>Press between plates</h2>" in page
    assert notes[0].text in page
    ball.close()
    window.session.files.open_mesh(Mesh(*sphere(1)))
    idle(qtbot, window)
    window.actions_.simulate.press.trigger()
    end_run(window.runs.dialogs["press"], written, tmp_path / "other")
    assert list(window.runs.pressed_blocks(document(window).mesh)[1:]) == notes
    assert window.runs.pressed_blocks(mesh)[0] is picture, "as after undo"


def test_press_dialog_leads_to_the_fields_of_the_wall_and_takes_what_is_chosen_there(qtbot, window, ball):
    fields = window.panel.measures.wall_fields
    window.panel.measures.is_folded = True
    click(ball.change)
    qtbot.waitUntil(lambda: not fields.material.visibleRegion().isEmpty())
    fields.material.setFocus()
    QTest.keyClick(fields.material, Qt.Key.Key_Down)
    assert ball.wall.text().startswith("PET, wall of a bottle")
    window.panel.measures.is_folded = True


@pytest.mark.parametrize(
    ("typed", "words"),
    [
        ({"young": "2 GPa"}, "thickness of the wall"),
        ({"young": "hard", "thickness": "0.01"}, "not a unit of Young"),
        ({"young": "2 GPa", "thickness": "0.01"}, "unit of the mesh"),
        ({"density": "0"}, "out of range"),
    ],
)
def test_press_dialog_refuses_at_once_a_material_that_cannot_be(typed, words, ball):
    ball.show_wall(WallText(**typed))
    click(ball.run.start)
    assert not ball.run.is_running
    assert words in ball.run.message.text()


def test_press_dialog_needs_newtons_for_air_inside(asked, ball):
    ask, options = asked
    ball.air.setCurrentIndex(1)
    click(ball.run.start)
    assert not ball.run.is_running
    assert "in newtons" in ball.run.message.text()
    dialog = ask(*sphere(2), unit="cm", wall=PET)
    assert options(dialog).gas is None
    dialog.air.setCurrentIndex(1)
    assert options(dialog).gas == "1atm"


def test_press_dialog_holds_a_pressure_by_the_method_wall(asked):
    ask, options = asked
    dialog = ask(*sphere(2), unit="cm", wall=PET)
    assert not dialog.pressure.isEnabled()
    assert options(dialog).pressure is None
    dialog.air.setCurrentIndex(2)
    assert dialog.pressure.isEnabled()
    for typed, pascals in (("-50 mbar", -5000.0), ("0.3bar", 30_000.0)):
        dialog.pressure.setText(typed)
        said = options(dialog)
        assert parse_pressure_difference(said.pressure) == pytest.approx(pascals)
        assert (said.method, said.gas) == ("wall", None)
    for typed, method, words in (("30", "wall", "needs a unit"), ("1bar", "exact", "Only the method Wall")):
        dialog.pressure.setText(typed)
        dialog.method.setCurrentIndex(dialog.method.findData(method))
        click(dialog.run.start)
        assert not dialog.run.is_running
        assert words in dialog.run.message.text()


def test_press_dialog_proposes_the_pressure_of_the_document(asked):
    ask, options = asked
    thickness = 0.03
    held = {"method": "wall", "wall_thickness": thickness, "pressure": -5000.0 * 4.0 / (3.4e9 * thickness)}
    dialog = ask(*sphere(2), unit="cm", wall=PET, **held)
    assert dialog.pressure.text() == "-50 mbar"
    assert parse_pressure_difference(options(dialog).pressure) == pytest.approx(-5000.0)
    assert options(ask(*sphere(2), unit="cm", wall=PET, **held | {"method": "exact"})).pressure is None


def test_press_dialog_hands_the_targets_of_the_document_to_the_command(asked):
    ask, options = asked
    said = options(ask(*sphere(2), method="exact", area=98.0, volume=100.0))
    assert [percentage(x, "") for x in (said.area, said.volume)] == [98.0, 100.0]
    assert options(ask(*sphere(2), method="local", hold_area=False)).area is None
    assert options(ask(*sphere(2), method="local", hold_area=True)).area == "100.0%"


def test_press_dialog_presses_the_current_shape_where_it_is_asked_for(qtbot, here, window, ball, asked):
    """A session with the shape goes to the command; at rest there is nothing to begin from."""
    assert not ball.from_current.isEnabled()
    state = window.session.store.state
    V = state.document.mesh.V
    moved = state.updated(frame=replace(state.frame, U=V * [1.0, 1.0, 1.0] + [0.0, 0.0, 3.0]))
    dialog = PressDialog(window.shell, moved, View(), window.preferences)
    dialog.show()
    dialog.from_current.click()
    dialog.steps.setValue(1)
    dialog.to.setValue(90)
    click(dialog.run.start)
    finish(qtbot, dialog)
    report = json.loads((dialog.run.results_folder / "report.json").read_text(encoding="utf-8"))
    pressed = trimesh.load(dialog.run.results_folder / "pressed.obj", process=False).vertices
    assert report["settled"]
    assert pressed[:, 2].mean() == pytest.approx(3.0, abs=0.1)
    dialog.close()
