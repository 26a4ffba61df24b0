"""Exporting an animation from the File menu: in a real window, with a real process."""

import numpy as np
import pytest
import pyvista
from animated import read_pc2
from driving import idle
from PySide6.QtWidgets import QFileDialog
from study_driving import click, finish, open_bar

from apd_viewer.figures.rendered_pictures import no_pictures_reason
from apd_viewer.session.posing.motion import MOTIONS


@pytest.fixture
def window(kept_window):
    """The window of all tests of the file."""
    return kept_window


@pytest.fixture
def bar(qtbot, window):
    """A window on a bar, its handle moved twice."""
    open_bar(qtbot, window)
    for way in (MOTIONS["MOVE_X"], MOTIONS["MOVE_Y"]):
        window.session.handles.move_by(way, "0.5", 0)
        idle(qtbot, window)
    return window


@pytest.fixture
def dialog(bar):
    bar.actions_.file.animation.trigger()
    dialog = bar.runs.dialogs["animate"]
    dialog.steps.setValue(2)
    return dialog


@pytest.fixture
def answer(monkeypatch):
    """Answer the question for a file."""

    def to(path):
        monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (str(path or ""), ""))

    return to


def handle_of(bar, shapes):
    """Mean place of the handle in each shape, (s, 3)."""
    return shapes[:, bar.session.store.state.document.labels == 2].mean(axis=1)


def check_export(qtbot, bar, dialog, path, motion, way):
    """Export a motion and see the handle go its way."""
    state = bar.session.store.state
    dialog.motion.setCurrentIndex(motion)
    dialog.format.setCurrentIndex(dialog.format.findData(".pc2"))
    click(dialog.run.start)
    assert dialog.run.cancel.isVisible()
    finish(qtbot, dialog)
    assert dialog.run.message.text() == "Exported a.pc2."
    places = handle_of(bar, read_pc2(path))
    np.testing.assert_allclose(places - places[0], np.outer([0, 0.5, 1], way), atol=1e-6)
    end = state.frame.U[state.document.labels == 2].mean(axis=0)
    np.testing.assert_allclose(places[-1], end, atol=1e-6)


@pytest.mark.night
def test_animation_dialog_exports_the_whole_motion(qtbot, bar, dialog, answer, tmp_path):
    answer(tmp_path / "a.pc2")
    assert dialog.motion.itemText(0) == "current motion of the handles"
    check_export(qtbot, bar, dialog, tmp_path / "a.pc2", 0, [0.5, 0.5, 0.0])


def test_animation_dialog_exports_the_last_step_from_where_the_one_before_had_ended(
    qtbot, here, bar, dialog, answer, tmp_path
):
    answer(tmp_path / "a.pc2")
    assert bar.session.gestures.history.next_undo_name in dialog.motion.itemText(1)
    check_export(qtbot, bar, dialog, tmp_path / "a.pc2", 1, [0.0, 0.5, 0.0])


def test_animation_dialog_exports_a_series_with_its_folder(qtbot, here, dialog, answer, tmp_path):
    dialog.format.setCurrentIndex(dialog.format.findData(".pvd"))
    (tmp_path / "out").mkdir()
    answer(tmp_path / "out" / "a.pvd")
    click(dialog.run.start)
    finish(qtbot, dialog)
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["a", "a.pvd"]
    assert pyvista.get_reader(tmp_path / "out" / "a.pvd").time_values == [0.0, 0.5, 1.0]


def test_animation_dialog_writes_nothing_when_cancelled(qtbot, dialog, answer, tmp_path):
    answer(None)
    click(dialog.run.start)
    assert not dialog.run.is_running
    before = sorted(tmp_path.iterdir())
    answer(tmp_path / "a.glb")
    click(dialog.run.start)
    qtbot.waitUntil(lambda: dialog.run.command.is_running)
    click(dialog.run.cancel)
    assert not dialog.run.is_running
    assert sorted(tmp_path.iterdir()) == before
    assert "nothing was written" in dialog.run.message.text()


@pytest.mark.night
def test_animation_dialog_leaves_nothing_when_cancelled_while_it_writes(
    qtbot, dialog, answer, tmp_path, monkeypatch
):
    """Neither beside the file nor among the temporary files; what other programs write stays."""
    (tmp_path / "tmp").mkdir()
    monkeypatch.setenv("TMPDIR", str(tmp_path / "tmp"))
    theirs = tmp_path / "out" / ".apd-viewer-1-theirs.part"
    theirs.mkdir(parents=True)
    dialog.format.setCurrentIndex(dialog.format.findData(".gif"))
    answer(tmp_path / "out" / "a.gif")
    click(dialog.run.start)
    qtbot.waitUntil(lambda: len(list((tmp_path / "out").iterdir())) > 1, timeout=60_000)
    click(dialog.run.cancel)
    assert list((tmp_path / "out").iterdir()) == [theirs]
    assert not any((tmp_path / "tmp").iterdir())


def test_animation_dialog_says_at_once_what_cannot_be_written(dialog, answer, tmp_path):
    dialog.format.setCurrentIndex(dialog.format.findData(".pvd"))
    (tmp_path / "a").write_text("mine")
    answer(tmp_path / "a.pvd")
    click(dialog.run.start)
    assert "which is a file" in dialog.run.message.text()
    assert not dialog.run.is_running


def test_animation_dialog_does_not_call_a_film_exported_that_is_not_drawn(
    dialog, answer, tmp_path, monkeypatch
):
    """What is there is an old one."""
    (tmp_path / "a.gif").write_text("old")
    dialog.format.setCurrentIndex(dialog.format.findData(".gif"))
    answer(tmp_path / "a.gif")
    monkeypatch.setattr(dialog.run, "begin", lambda *_, **__: None)
    click(dialog.run.start)
    dialog.run.ended.emit(tmp_path, f"results\n{no_pictures_reason()}")
    assert "were not drawn" in dialog.summary.text()
    assert dialog.run.message.text() == ""


def test_open_animation_has_nothing_to_export_without_a_motion(qtbot, window):
    assert not window.actions_.file.animation.isEnabled()
    open_bar(qtbot, window)
    window.actions_.file.animation.trigger()
    assert "animate" not in window.runs.dialogs
    assert "No handle has moved" in window.notice.text


def test_animation_dialog_offers_the_last_step_alone_where_the_handle_is_back(qtbot, bar):
    """A handle back at rest has no motion, but the step that led there has."""
    bar.session.handles.reset_handle(0)
    idle(qtbot, bar)
    bar.actions_.file.animation.trigger()
    dialog = bar.runs.dialogs["animate"]
    assert dialog.motion.count() == 1
    assert dialog.motion.itemText(0).startswith("last step")
