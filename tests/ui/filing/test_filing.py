"""Sessions and selections through the window: saved, opened, and the same picture."""

import numpy as np
import pytest
from decks import ReadDeck
from driving import idle, show, work_off
from PySide6.QtCore import QSettings
from PySide6.QtWidgets import QFileDialog

from apd_viewer.geometry.pose.constraints import BASE, HANDLE
from apd_viewer.presentation.scales import Measure
from apd_viewer.session.model.view import View
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.filing import file_dialogs
from apd_viewer.ui.shell import Shell
from apd_viewer.ui.workbench import Workbench


@pytest.fixture
def chosen(monkeypatch):
    """What the next file dialogs answer."""
    answers = {}
    names = "ask_where_to_save_session", "ask_for_selection", "ask_where_to_save_selection", "ask_for_mesh"
    for name in names:
        monkeypatch.setattr(file_dialogs, name, lambda *_, name=name: answers[name])
    return answers


def test_open_path_shows_the_same_picture_of_a_saved_session_again(qtbot, bottle, tmp_path, chosen):
    path = tmp_path / "twisted.apd"
    bottle.session.handles.move_by(MOTIONS["TWIST"], "45", 0)
    bottle.choose_unit(Unit.INCH)
    bottle.canvas.viewport.camera_controller.camera = bottle.canvas.viewport.camera_controller.camera.orbited(
        60, 20
    )
    idle(qtbot, bottle)
    chosen["ask_where_to_save_session"] = path, False
    bottle.actions_.file.save.trigger()
    idle(qtbot, bottle)
    assert path.name in bottle.notice.text
    before, picture = bottle.session.store.state, bottle.canvas.viewport.screenshot()

    bottle.files.open_sample("duck")
    idle(qtbot, bottle)
    assert bottle.session.store.unit is Unit.CENTIMETRE
    chosen["ask_for_mesh"] = path
    bottle.actions_.file.open.trigger()
    idle(qtbot, bottle)
    after = bottle.session.store.state
    np.testing.assert_array_equal(after.frame.U, before.frame.U)
    np.testing.assert_array_equal(after.document.handles[0].pose, before.document.handles[0].pose)
    assert bottle.session.store.unit is Unit.INCH
    again = bottle.canvas.viewport.screenshot()
    # Points are drawn in single precision, seen from the middle of the shape that was opened.
    assert np.abs(again.astype(int) - picture).max() <= 1
    assert path in bottle.preferences.recent_files


def test_save_writes_to_where_the_session_is_and_asks_only_once(qtbot, bottle, tmp_path, chosen):
    path = tmp_path / "s.apd"
    chosen["ask_where_to_save_session"] = path, True
    bottle.actions_.file.save.trigger()
    idle(qtbot, bottle)
    size = path.stat().st_size
    chosen["ask_where_to_save_session"] = None
    bottle.session.handles.move_by(MOTIONS["TWIST"], "5", 0)
    idle(qtbot, bottle)
    bottle.actions_.file.save.trigger()
    idle(qtbot, bottle)
    assert path.stat().st_size > size, "the shape is in it now, and the mesh still"
    assert not bottle.session.saved_work.is_unsaved
    bottle.files.open_sample("duck")
    idle(qtbot, bottle)
    bottle.actions_.file.save.trigger()  # another mesh is another session: asked again, nothing chosen
    idle(qtbot, bottle)
    assert bottle.session.jobs.current is None


def test_file_requests_open_a_session_at_the_start_of_a_window(qtbot, bottle, tmp_path, chosen):
    path = tmp_path / "s.apd"
    chosen["ask_where_to_save_session"] = path, False
    bottle.session.handles.move_by(MOTIONS["TWIST"], "30", 0)
    idle(qtbot, bottle)
    bottle.actions_.file.save.trigger()
    idle(qtbot, bottle)
    shell = Shell(QSettings(str(tmp_path / "other.ini"), QSettings.Format.IniFormat))
    shell.requests.open_path(path)
    other = Workbench(shell)
    show(qtbot, other.shell, other.canvas.viewport)
    idle(qtbot, other)
    np.testing.assert_array_equal(other.session.store.state.frame.U, bottle.session.store.state.frame.U)
    other.shell.close()
    other.shell.deleteLater()
    work_off()


def test_load_selection_brings_a_saved_selection_back_as_one_step(qtbot, bottle, tmp_path, chosen):
    path = tmp_path / "paint.json"
    chosen["ask_where_to_save_selection"] = chosen["ask_for_selection"] = path
    before = bottle.session.store.state.document.labels
    bottle.actions_.select.files[1].trigger()
    idle(qtbot, bottle)
    bottle.session.gestures.begin()
    bottle.session.painting.paint(np.flatnonzero(before == HANDLE), BASE)
    bottle.session.painting.end_stroke("Paint base")
    painted = bottle.session.store.state
    bottle.actions_.select.files[0].trigger()
    idle(qtbot, bottle)
    np.testing.assert_array_equal(bottle.session.store.state.document.labels, before)
    assert bottle.session.gestures.history.next_undo_name == "Load selection"
    bottle.session.gestures.undo()
    assert bottle.session.store.state is painted


def test_load_selection_tells_of_a_bad_selection_and_changes_nothing(qtbot, bottle, tmp_path, chosen):
    path = tmp_path / "paint.sel"
    path.write_text("0\n1\n2\n")
    chosen["ask_for_selection"] = path
    before = bottle.session.store.state
    bottle.actions_.select.files[0].trigger()
    idle(qtbot, bottle)
    assert bottle.session.store.state is before
    assert "paint.sel" in bottle.notice.text


# Without a target shape and a wall distribution.
LACKING = Measure.TARGET_DISTANCE, Measure.TARGET_DISPLACEMENT, Measure.THICKNESS
WITHOUT_TARGET = [measure for measure in Measure if measure not in LACKING]


@pytest.mark.parametrize(
    "measure",
    [
        None,
        *(pytest.param(each, marks=pytest.mark.night) for each in WITHOUT_TARGET[:-1]),
        WITHOUT_TARGET[-1],
    ],
)
def test_restore_view_shows_the_overlay_that_was_shown_with_a_session(qtbot, bottle, tmp_path, measure):
    heat, path = bottle.display_options.overlay, tmp_path / "a.apd"
    heat.choose_measure(measure)
    bottle.session.files.save(path, bottle.view())
    idle(qtbot, bottle)
    heat.choose_measure(Measure.STRAIN if measure is Measure.AREA else Measure.AREA)
    bottle.files.open_path(path)
    qtbot.waitUntil(lambda: heat.measure is measure)
    assert bottle.actions_.display.no_overlay.isChecked() == (measure is None)


@pytest.mark.parametrize("said", [None, "what a later version shows"])
def test_restore_view_leaves_the_overlay_for_a_session_that_says_none_that_there_is(bottle, said):
    bottle.display_options.overlay.choose_measure(Measure.AREA)
    bottle.volume.restore_view(View(overlay=said))
    assert bottle.display_options.overlay.measure is Measure.AREA


@pytest.mark.parametrize(
    ("rows", "first"), [("per vertex", "vertex,x,y,z"), ("per triangle", "triangle,a,b,c")]
)
def test_ask_for_scalars_exports_the_table_chosen(rows, first, qtbot, bottle, tmp_path, monkeypatch):
    target = tmp_path / "s.csv"

    def dialog(_parent, _title, _proposed, filters):
        return str(target), next(each for each in filters.split(";;") if rows in each)

    monkeypatch.setattr(QFileDialog, "getSaveFileName", dialog)
    bottle.actions_.file.scalars.trigger()
    idle(qtbot, bottle)
    assert target.read_text().startswith(first)
    assert bottle.notice.text == "Exported scalars to s.csv."


def test_ask_for_deck_exports_an_fe_deck_of_the_pose(qtbot, bottle, tmp_path, monkeypatch):
    target = tmp_path / "bottle.inp"
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (str(target), ""))
    document = bottle.session.store.state.document
    bottle.actions_.file.deck.trigger()
    idle(qtbot, bottle)
    deck = ReadDeck(target.read_text(encoding="ascii"))
    corners = range(1, len(document.mesh.V) + 1)
    assert {node for element in deck.elements.values() for node in element[:3]} == set(corners)
    held = {node for node in deck.ends() if node in corners}
    assert held == set((np.flatnonzero(document.labels != 1) + 1).tolist())
    assert bottle.notice.text.startswith("bottle.inp: ")
