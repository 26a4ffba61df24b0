"""A typed motion in steps in a real window: paused, stopped, looked at, and exported."""

import csv

import numpy as np
import pytest
from driving import document, idle
from meshes import sphere
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QFileDialog

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.posing.motion import MOTIONS

BALL = Mesh(*sphere(2))
LABELS = np.where(np.abs(BALL.V[:, 2]) < 0.7, 1, np.where(BALL.V[:, 2] > 0, 2, 0)).astype(np.uint8)
WAIT = 60_000


@pytest.fixture
def window(qtbot, kept_window):
    """The window, with a ball held at both poles, and its dock closed in the end."""
    kept_window.session.files.open_result("ball", lambda: initial_state(BALL, LABELS))
    idle(qtbot, kept_window)
    yield kept_window
    kept_window.session.player.clear()
    kept_window.docks["timeline"].hide()
    idle(qtbot, kept_window)


def type_twist(window, text, count):
    """Type a twist in steps, as a user does; the panel of the timeline."""
    window.panel.focus_motion_field()
    field = window.panel.handles.motion
    field.choice.setCurrentIndex(list(MOTIONS).index("TWIST"))
    field.steps.setValue(count)
    field.amount.setFocus()
    QTest.keyClicks(field.amount, text)
    QTest.keyClick(field.amount, Qt.Key.Key_Return)
    return window.press.panel


def test_motion_in_view_fills_the_timeline(qtbot, window, tmp_path, monkeypatch):
    player = window.session.player
    panel = type_twist(window, "60", 3)
    assert panel.isVisible()
    assert player.is_playing
    assert panel.controls.isVisible()
    assert panel.stop.isVisible()
    assert not panel.fields.isVisible(), "there are no plates"
    qtbot.waitUntil(lambda: not player.is_playing, timeout=WAIT)
    idle(qtbot, window)
    assert panel.position.text() == "4 of 4"
    assert not panel.controls.isVisible()
    assert panel.calm.text() == "At rest."
    energies = [step.state.frame.energy for step in player.timeline.steps]
    assert energies == sorted(energies)
    assert window.press.step_charts.effort_chart().readings[0][0] == "Energy"
    path = tmp_path / "steps.csv"
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (str(path), ""))
    panel.export.click()
    idle(qtbot, window)
    rows = list(csv.DictReader(path.read_text(encoding="utf-8").splitlines()))
    assert [float(row["volume"]) for row in rows] == [
        each.state.frame.volume for each in player.timeline.steps
    ]
    assert {row["distance"] for row in rows} == {""}


def test_motion_in_view_comes_back_with_its_session(qtbot, window, tmp_path):
    player = window.session.player
    panel = type_twist(window, "60", 2)
    qtbot.waitUntil(lambda: not player.is_playing, timeout=WAIT)
    panel.back.click()
    window.session.files.save(tmp_path / "a.apd", window.view(), embed=True)
    idle(qtbot, window)
    shapes = [step.state.frame.U for step in player.timeline.steps]
    player.clear()
    window.docks["timeline"].hide()
    window.shell.requests.open_path(tmp_path / "a.apd")
    idle(qtbot, window)
    assert panel.isVisible()
    assert panel.position.text() == "2 of 3"
    assert np.array_equal([step.state.frame.U for step in player.timeline.steps], shapes)
    assert not window.shell.isWindowModified()


def test_motion_in_view_is_paused_and_stopped(qtbot, window):
    player = window.session.player
    panel = type_twist(window, "60", 200)
    qtbot.waitUntil(lambda: player.done > 0, timeout=WAIT)
    assert "of 200" in panel.progress.text()
    panel.press.click()
    assert player.is_paused
    assert panel.press.text() == "Continue"
    panel.press.click()
    panel.stop.click()
    qtbot.waitUntil(lambda: not player.is_playing, timeout=WAIT)
    assert 2 <= len(player.timeline.steps) < 200


def test_motion_in_view_shows_what_is_wrong_with_the_amount(window):
    panel = type_twist(window, "much", 3)
    assert window.panel.handles.motion.problem.isVisible()
    assert not window.session.player.is_playing
    assert not panel.isVisible()
    assert not document(window).is_posed
