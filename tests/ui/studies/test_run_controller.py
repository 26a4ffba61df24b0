"""The dialogs that sweep and re-run the paper's tables: in a real window."""

import csv
import os

import numpy as np
import pytest
from driving import document, idle, work_off
from meshes import box
from PIL import Image
from process_tree import tree_of
from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QColor, QDesktopServices
from PySide6.QtWidgets import QFileDialog, QLabel
from study_driving import click, finish, open_bar

from apd_viewer.commands.sweep_command import sweep_parser
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.session.storage.session_file import open_session
from apd_viewer.ui.widgets.figure_view import FigureView
from apd_viewer.ui.widgets.theme import DARK


@pytest.fixture
def window(kept_window):
    """The window of all tests of the file."""
    return kept_window


@pytest.fixture
def bar(qtbot, window):
    """A window on a bar, painted."""
    open_bar(qtbot, window)
    return window


@pytest.fixture
def dialog(bar):
    """The sweep of the bar, quick."""
    bar.actions_.simulate.sweep.trigger()
    dialog = bar.runs.dialogs["sweep"]
    dialog.steps.setValue(2)
    for name, check in dialog.methods.items():
        check.setChecked(name == "exact")
    return dialog


@pytest.fixture(params=["here", pytest.param("process", marks=pytest.mark.night)])
def command(request):
    """Where the command runs; by day the one of a study has a process of its own."""
    if request.param == "here":
        request.getfixturevalue("here")


def rows(path):
    with path.open(encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def test_sweep_dialog_draws_a_sweep_and_saves_it_where_the_user_says(
    qtbot, command, bar, dialog, tmp_path, monkeypatch
):
    dialog.twist.setText("200deg")
    click(dialog.run.start)
    assert not dialog.steps.isEnabled()
    assert dialog.run.cancel.isVisible()
    finish(qtbot, dialog)
    assert dialog.figure.has_picture
    assert "Exact: area 0.00 % at the end" in dialog.summary.text()
    assert dialog.steps.isEnabled()
    (tmp_path / "mesh-sweep").mkdir()
    monkeypatch.setattr(QFileDialog, "getExistingDirectory", lambda *_: str(tmp_path))
    click(dialog.run.save)
    finish(qtbot, dialog)
    folder = tmp_path / "mesh-sweep-2"
    assert {path.name for path in folder.iterdir()} == {"sweep.csv", "sweep.png", "sweep.svg"}
    assert [float(line["degrees"]) for line in rows(folder / "sweep.csv")] == pytest.approx([0, 100, 200])
    opened = []
    monkeypatch.setattr(QDesktopServices, "openUrl", lambda url: opened.append(url.toLocalFile()))
    assert dialog.run.open_mesh.isHidden()
    click(dialog.run.open)
    assert opened == [str(folder)]


def test_sweep_dialog_sweeps_the_motion_of_the_handle_if_it_has_one(qtbot, bar, tmp_path, monkeypatch):
    bar.session.handles.move_by(MOTIONS["MOVE_X"], "0.5", 0)
    idle(qtbot, bar)
    bar.actions_.simulate.sweep.trigger()
    dialog = bar.runs.dialogs["sweep"]
    assert dialog.twist.isHidden()
    dialog.steps.setValue(3)
    dialog.to.setValue(150)
    assert not dialog.format.isEnabled()
    dialog.animation.setChecked(True)
    assert dialog.format.isEnabled()
    assert dialog.format.currentData() == ".gif"
    dialog.meshes.setChecked(True)
    monkeypatch.setattr(dialog.run, "begin", lambda words: begun.append(words(tmp_path, tmp_path / "out")))
    begun = []
    click(dialog.run.start)
    options = sweep_parser().parse_args(begun[0][1:])
    assert (options.steps, options.to, options.iterations) == (3, 1.5, 500)
    assert options.methods == "exact,paper,arap"
    assert options.meshes
    assert options.output == tmp_path / "out"
    assert options.animation == [tmp_path / "out" / "sweep.gif"]
    assert options.motion == []
    for k in range(dialog.format.count()):
        dialog.format.setCurrentIndex(k)
        click(dialog.run.start)
        asked = sweep_parser().parse_args(begun[-1][1:]).animation
        assert asked == [tmp_path / "out" / f"sweep{dialog.format.itemData(k)}"]
    state, view = open_session(options.file)
    np.testing.assert_array_equal(state.document.handles[0].pose, document(bar).handles[0].pose)
    assert view.camera == bar.canvas.view.saved_view("").camera


def test_sweep_dialog_solves_the_motion_in_the_view_from_rest(qtbot, bar):
    bar.session.handles.move_by(MOTIONS["MOVE_X"], "0.5", 0)
    idle(qtbot, bar)
    before = bar.session.store.state
    bar.actions_.simulate.sweep.trigger()
    dialog = bar.runs.dialogs["sweep"]
    dialog.steps.setValue(3)
    click(dialog.in_view)
    assert not dialog.isVisible()
    player = bar.session.player
    qtbot.waitUntil(lambda: not player.is_playing, timeout=60_000)
    idle(qtbot, bar)
    assert bar.press.panel.isVisible()
    states = [step.state for step in player.timeline.steps]
    assert [state.document.handles[0].pose[0, 3] for state in states] == pytest.approx(
        [0, 0.5 / 3, 1 / 3, 0.5]
    )
    assert states[0].frame.U is before.document.mesh.V
    np.testing.assert_allclose(states[-1].frame.U, before.frame.U, atol=1e-3)
    assert bar.session.gestures.history.undo_names[-1] == "Motion in steps"
    bar.session.gestures.undo()
    assert bar.session.store.state is before
    player.clear()
    bar.docks["timeline"].hide()


def test_sweep_dialog_shows_in_the_view_nothing_of_another_mesh(bar, dialog):
    dialog.twist.setText("much")
    click(dialog.in_view)
    assert dialog.isVisible()
    assert dialog.run.message.text()
    dialog.twist.setText("90deg")
    bar.session.shapes.weld()
    bar.session.wait_idle(20.0)
    click(dialog.in_view)
    assert bar.notice.text == "Another mesh has been opened; open the dialog again."
    assert not bar.session.player.is_playing


def test_sweep_dialog_sweeps_the_motion_of_obstacles_where_nothing_is_painted(qtbot, here, bar):
    bar.session.painting.clear_all()
    bar.session.obstacles.add_plates(np.eye(3)[0])
    bar.session.obstacles.move(0, np.array([0.05, 0.0, 0.0]))
    idle(qtbot, bar)
    bar.actions_.simulate.sweep.trigger()
    dialog = bar.runs.dialogs["sweep"]
    assert dialog.motion.currentText() == "current motion of the handles and obstacles"
    assert dialog.motion.count() == 1
    assert not dialog.methods["paper"].isEnabled()  # it knows no contact
    assert not dialog.methods["paper"].isChecked()
    for name, check in dialog.methods.items():
        check.setChecked(name == "exact")
    dialog.steps.setValue(2)
    click(dialog.run.start)
    finish(qtbot, dialog)
    assert dialog.figure.has_picture


def test_sweep_dialog_leaves_nothing_after_cancel(qtbot, dialog):
    click(dialog.run.start)
    qtbot.waitUntil(lambda: dialog.run.command.is_running)
    scratch = dialog.run.scratch_folder
    assert scratch.exists()
    click(dialog.run.cancel)
    assert not scratch.exists()
    assert not dialog.run.is_running
    assert "nothing was written" in dialog.run.message.text()
    assert dialog.run.save.isHidden()
    assert dialog.run.start.isVisible()
    assert dialog.steps.isEnabled()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda dialog: dialog.twist.setText("9 mm"), "unit of length"),
        (lambda dialog: dialog.twist.setText("0"), "No handle has moved"),
        (lambda dialog: dialog.methods["exact"].setChecked(False), "at least one"),
    ],
)
def test_sweep_dialog_says_at_once_what_cannot_be_swept(change, words, bar, dialog):
    change(dialog)
    click(dialog.run.start)
    assert words in dialog.run.message.text()
    assert not dialog.run.is_running


def test_run_controller_sweep_opens_no_dialog_for_what_is_not_painted(qtbot, window):
    window.actions_.simulate.sweep.trigger()
    assert window.runs.dialogs == {}
    V, F = box(1, 1, 1)
    window.session.files.open_mesh(Mesh(V, F))
    idle(qtbot, window)
    window.actions_.simulate.sweep.trigger()
    assert window.runs.dialogs == {}
    assert "There is no base" in window.notice.text


def test_sweep_dialog_is_closed_by_esc_and_by_the_window_and_its_work_ends(qtbot, bar, dialog):
    click(dialog.run.start)
    qtbot.waitUntil(lambda: dialog.run.command.is_running)
    number, scratch = dialog.run.command.process_id, dialog.run.scratch_folder
    qtbot.keyClick(dialog, Qt.Key.Key_Escape)
    assert bar.runs.dialogs == {}
    assert not scratch.exists()
    assert number not in tree_of(os.getpid())
    bar.actions_.simulate.sweep.trigger()
    assert bar.runs.dialogs["sweep"].isVisible()
    bar.shell.close()
    assert bar.runs.dialogs == {}


def test_run_controller_have_each_dialog_once(bar, dialog):
    bar.actions_.simulate.sweep.trigger()
    assert bar.runs.dialogs["sweep"] is dialog


def test_run_controller_shows_no_dialog_of_a_motion_that_has_passed(qtbot, bar, dialog):
    bar.session.handles.move_by(MOTIONS["MOVE_X"], "0.5", 0)
    idle(qtbot, bar)
    bar.actions_.simulate.sweep.trigger()
    other = bar.runs.dialogs["sweep"]
    assert other is not dialog
    work_off()  # the first is deleted
    assert bar.runs.dialogs["sweep"] is other
    assert other.isVisible()


def test_run_controller_keeps_a_dialog_that_runs(qtbot, bar, dialog):
    click(dialog.run.start)
    qtbot.waitUntil(lambda: dialog.run.command.is_running)
    bar.session.handles.move_by(MOTIONS["MOVE_X"], "0.5", 0)
    idle(qtbot, bar)
    bar.actions_.simulate.sweep.trigger()
    assert bar.runs.dialogs["sweep"] is dialog
    assert dialog.run.command.is_running


def test_paper_dialog_cuts_off_no_word_about_the_tables_while_they_are_run(qtbot, window):
    next(action for action in window.actions_.help.values() if "tables" in action.text()).trigger()
    dialog = window.runs.dialogs["paper"]
    words = next(label for label in dialog.findChildren(QLabel) if "Li and Hui" in label.text())
    for _ in range(2):
        click(dialog.run.start)
        qtbot.waitUntil(dialog.run.bar.isVisible)
        work_off()
        assert words.height() >= words.heightForWidth(words.width())
        click(dialog.run.cancel)


def test_paper_dialog_shows_the_papers_tables_beside_ours(qtbot, window, tmp_path):
    """With what the command would have written: it takes a minute."""
    action = next(action for action in window.actions_.help.values() if "tables" in action.text())
    action.trigger()
    dialog = window.runs.dialogs["paper"]
    scratch = tmp_path / "scratch"
    results = scratch / "results"
    results.mkdir(parents=True)
    head = "case,method,area_rest,area,area_error,handle_drift,iterations,move,said_area_rest,said_area,"
    lines = [
        head + "said_area_error,within_tolerance",
        "a,arap,1,1.01,0.0085,0,9,bottle twisted by 60°,79.305,77.781,-0.0192,0",
        "a,paper,1,1.0001,0.00099,0.386,9,bottle twisted by 60°,79.305,79.231,-0.00093,1",
    ]
    (results / "tables.csv").write_text("\n".join(lines), encoding="utf-8")
    bar_picture = np.zeros((20, 40, 3), np.uint8)
    from PIL import Image

    Image.fromarray(bar_picture).save(results / "handle.png")
    dialog.run.scratch_folder = scratch
    dialog.run.command.ended.emit("Table 1: twisting\n\n| move |\n\nPass: in all 1 moves APD keeps the area.")
    cells = [
        dialog.table.itemAtPosition(2, column).widget().text() for column in range(dialog.table.columnCount())
    ]
    assert cells == [
        "bottle twisted by 60°", "+0.85 %", "−1.92 %", "+0.099 %", "−0.093 %", "0.39 cm", "pass",
    ]  # fmt: skip
    assert [figure.has_picture for figure in dialog.figures] == [True]
    assert dialog.run.save.isVisible()
    said = [label.text() for label in dialog.findChildren(type(dialog.run.message), "verdict")]
    assert said == ["Pass: in all 1 moves APD keeps the area."]


def test_figure_view_keeps_the_shape_of_a_figure_and_stands_on_white(qtbot, tmp_path):
    Image.new("RGB", (200, 100), (0, 114, 178)).save(tmp_path / "a.png")
    view = FigureView(tmp_path / "a.png", "words")
    qtbot.addWidget(view)
    view.resize(424, view.heightForWidth(424))
    assert view.height() == 12 + 200 + 12
    view.show()
    image = view.grab().toImage()
    scale = image.width() / view.width()

    def color(x, y):
        return image.pixelColor((QPointF(x, y) * scale).toPoint()).getRgb()[:3]

    assert color(212, 112) == pytest.approx((0, 114, 178), abs=8)  # scaled
    assert color(212, 5) == (255, 255, 255)


@pytest.mark.parametrize("is_drawn", [True, False])
def test_figure_view_shows_drawn_figures_light_on_dark_in_dark_windows(qtbot, window, tmp_path, is_drawn):
    picture = np.full((100, 300, 3), 255, np.uint8)
    picture[:, 100:200], picture[:, 200:] = 0, (0, 114, 178)
    Image.fromarray(picture).save(tmp_path / "a.png")
    view = FigureView(tmp_path / "a.png", "words", is_drawn)
    qtbot.addWidget(view)
    view.resize(324, 124)
    view.show()

    def colors():
        image = view.grab().toImage()
        scale = image.width() / view.width()
        return [image.pixelColor((QPointF(x, 62) * scale).toPoint()) for x in (5, 62, 162, 262)]

    window.actions_.view.schemes[Qt.ColorScheme.Light].trigger()
    card, white, black, blue = colors()
    assert card.lightnessF() == white.lightnessF() == 1.0
    assert black.lightnessF() == 0.0
    window.actions_.view.schemes[Qt.ColorScheme.Dark].trigger()
    work_off()
    card, white, black, after = colors()
    if is_drawn:
        for shown, wanted in ((card, DARK.raised), (white, DARK.raised), (black, DARK.ink)):
            assert shown.getRgb() == pytest.approx(QColor(wanted).getRgb(), abs=8), "of 16 bits under Xvfb"
        assert after.hueF() == pytest.approx(blue.hueF(), abs=0.05)
        assert after.lightnessF() > blue.lightnessF()
    else:
        assert [one.name() for one in (card, white, black)] == ["#ffffff", "#ffffff", "#000000"]


def test_sweep_dialog_lists_the_methods_in_the_order_of_the_panel(bar, dialog):
    menu = bar.panel.method.method
    order = [menu.itemData(k) for k in range(menu.count())]
    assert len(dialog.methods) > 2
    assert list(dialog.methods) == [name for name in order if name in dialog.methods]
