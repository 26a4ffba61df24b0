"""An opened animation in a real window: scrubbed, played, exported, and pressed on from."""

import numpy as np
import pytest
from animated import animated
from driving import Mouse, idle, work_off
from meshes import sphere
from PySide6.QtWidgets import QFileDialog

from apd_viewer.files.animations.animation_files import write_animation
from apd_viewer.files.animations.animation_reading import open_animation
from apd_viewer.geometry.mesh.mesh import Mesh

WAIT = 60_000


@pytest.fixture
def window(qtbot, kept_window, tmp_path):
    """The window with a series of four shapes, and its dock closed in the end."""
    animation, _ = animated(Mesh(*sphere(2)), tmp_path / "shapes")
    write_animation(animation, tmp_path / "a.pvd")
    kept_window.shell.requests.open_path(tmp_path / "a.pvd")
    idle(qtbot, kept_window)
    yield kept_window
    kept_window.session.player.clear()
    kept_window.docks["timeline"].hide()
    idle(qtbot, kept_window)


def reading(window, title):
    """Value and note of a reading of the panel."""
    labels = {row[0].text(): row[1:] for row in window.press.panel.reading_rows}
    return tuple(label.text() for label in labels[title])


def steps(window):
    return window.session.player.timeline.steps


def test_animation_in_view_shows_its_steps_at_once(window):
    panel = window.press.panel
    assert panel.isVisible()
    assert not panel.controls.isVisible(), "there are no plates"
    assert panel.position.text() == "1 of 4"
    assert [row[0].text() for row in panel.reading_rows][:2] == ["Area", "Volume"]
    assert panel.reading_rows[0][1].text() == "100.000 %"
    assert panel.calm.text() == "As it is in the file."
    assert panel.size_view.isVisible()
    assert not panel.load_view.isVisible()
    assert "a.pvd" in window.shell.windowTitle()


def test_animation_in_view_is_among_the_recent_files(window, tmp_path):
    assert window.preferences.recent_files[0] == tmp_path / "a.pvd"
    assert window.preferences.last_folder == tmp_path


def test_animation_in_view_is_scrubbed_and_played(qtbot, window):
    panel, mouse = window.press.panel, Mouse(window.press.panel.slider)
    middle = panel.slider.height() / 2
    mouse.press((panel.slider.knob_position(2), middle))
    mouse.release((panel.slider.knob_position(2), middle))
    assert window.session.store.state is steps(window)[2].state
    charts = window.press.step_charts
    chart = charts.size_chart()
    area, volume = chart.readings
    shown, charts.shown_number = charts.shown_number, None
    assert [color for _, color in charts.size_chart().readings] == [area[1], volume[1]], (
        "the key to the curves"
    )
    charts.shown_number = shown
    assert chart.x_title == "Step"
    frame, rest = steps(window)[2].state.frame, steps(window)[2].state.inspection
    assert float(area[0].split()[1]) == pytest.approx(100 * (1 + frame.area_error), abs=0.001)
    assert float(volume[0].split()[1]) == pytest.approx(100 * frame.volume / rest.volume, abs=0.05)
    percent = reading(window, "Volume")[1]
    assert volume[0] == f"volume {percent}", "one notation in chart and readings"
    assert area[0] == f"area {reading(window, 'Area')[0]}"
    assert chart.vertical_lines[0].place == 3.0
    panel.replay.click()
    qtbot.waitUntil(lambda: window.session.player.shown_step == 3, timeout=WAIT)
    qtbot.waitUntil(lambda: window.session.gestures.state_before is None, timeout=WAIT)
    assert not panel.forward.isEnabled()


def test_animation_in_view_is_exported_again(qtbot, window, tmp_path, monkeypatch):
    path = tmp_path / "b.pvd"
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (str(path), ""))
    window.press.panel.export.click()
    idle(qtbot, window)
    shapes = [step.state.frame.U for step in steps(window)]
    assert np.array_equal(list(open_animation(path).shapes), shapes)


def test_animation_in_view_gives_way_to_a_press(qtbot, window):
    window.actions_.simulate.press_live.trigger()
    work_off()
    panel = window.press.panel
    assert panel.controls.isVisible()
    assert panel.load_view.isVisible()
    assert [row[0].text() for row in panel.reading_rows][:2] == ["Distance", "Load"]
