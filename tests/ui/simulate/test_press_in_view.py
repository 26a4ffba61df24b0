"""A press in a real window: with counted inputs, paused, gone back in, opened again and exported."""

import csv
import json
import re

import numpy as np
import pytest
from driving import Mouse, document, idle, work_off
from meshes import sphere
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QFileDialog, QMessageBox

from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.analysis.deviation import tightest_bend
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, FREE
from apd_viewer.geometry.solver.pressed_mesh import press
from apd_viewer.session.model.named_obstacle import ObstacleKind
from apd_viewer.session.model.obstacle_pair import PROPOSED_STIFFNESS, obstacle_pair
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.wall import WallText
from apd_viewer.session.quantities.wall_material import WALL_MATERIALS
from apd_viewer.ui.filing import file_controller
from apd_viewer.ui.plots.chart_drawing import Chart
from apd_viewer.ui.tools.tool_modes import Tool

ASK = file_controller.ask_before_leaving  # before the fixture of the window answers by itself
BALL = Mesh(*sphere(2))
WAIT = 60_000
TITLES = "Load", "Volume", "Area", "Tightest bend"


@pytest.fixture
def window(qtbot, kept_window):
    """The window, with a ball that nothing holds, and its dock closed in the end."""
    kept_window.session.files.open_mesh(BALL)
    idle(qtbot, kept_window)
    kept_window.shell.activateWindow()
    qtbot.waitUntil(kept_window.shell.isActiveWindow)
    yield kept_window
    kept_window.session.player.clear()
    kept_window.docks["timeline"].hide()
    idle(qtbot, kept_window)


def player(window):
    return window.session.player


def steps(window):
    return window.session.player.timeline.steps


def reading(window, title):
    """Value and note of a reading of the panel, of the shape on screen."""
    return four_labels(window, title)[:2]


def other_reading(window, title):
    """Value and note of a reading of the other solution of the step on screen."""
    return four_labels(window, title)[2:]


def plate_loads(window, unit):
    """Loads beside the plates in the panel, which agree within a thousandth: figures of three digits."""
    texts = [row.reading.text() for row in window.panel.obstacles.list.rows]
    assert all(text.startswith("load ") and text.endswith(unit) for text in texts)
    return [float(text[5 : -len(unit)]) for text in texts]


def four_labels(window, title):
    labels = {row[0].text(): row[1:] for row in window.press.panel.reading_rows}
    return tuple(label.text() for label in labels[title] if label.isVisible())


def headings(window):
    """Names of the columns of readings; none where there is one column."""
    return [label.text() for label in window.press.panel.solution_names if label.isVisible()]


def percent(text):
    return float(text.split("\u00a0")[0].split(" ")[0].replace("−", "-"))


def left_percent(state):
    return 100.0 * state.frame.volume / state.inspection.volume


def check_readings_are_of_the_screen(window):
    """That volume and area beside the timeline are those of the panel of the shape on screen."""
    shown = window.session.store.state
    millilitres = float(reading(window, "Volume")[0].removesuffix("\u00a0ml"))
    assert millilitres == pytest.approx(shown.frame.volume, 1e-3), "the mesh is in centimetres"
    assert reading(window, "Area")[0] == window.panel.area.percent.text()
    assert percent(reading(window, "Volume")[1]) == pytest.approx(left_percent(shown), abs=0.1)
    name = "Wall 0.3 mm" if shown.document.settings.traits.is_wall else "Exact"
    assert window.press.panel.shape_choice.currentText() == name
    assert headings(window)[:1] in ([], [f"{name}, on screen"])


def bend_of_screen(window):
    return tightest_bend(BALL.V, BALL.joined_F, window.session.store.state.frame.U)


def tool_button(window):
    return window.actions_.bar.widgetForAction(window.actions_.simulate.press_live)


def pressed(qtbot, window, end="80", count=3):
    """Press the ball with the fields of the panel."""
    window.actions_.simulate.press_live.trigger()
    panel = window.press.panel
    panel.steps.setValue(count)
    panel.end.setText(end)
    panel.press.click()
    qtbot.waitUntil(lambda: not player(window).is_playing, timeout=WAIT)
    work_off()
    return panel


def test_press_in_view_shows_the_load_after_four_inputs(qtbot, window):
    qtbot.mouseClick(tool_button(window), Qt.MouseButton.LeftButton)  # 1
    panel = window.press.panel
    qtbot.waitUntil(panel.end.hasFocus)
    assert panel.isVisible()
    QTest.keyClicks(panel.end, "40")  # 2 and 3
    panel.steps.setValue(2)  # for the pace of the test alone
    QTest.keyClick(panel.end, Qt.Key.Key_Return)  # 4
    assert player(window).is_playing
    qtbot.waitUntil(lambda: not player(window).is_playing, timeout=WAIT)
    extent = np.ptp(BALL.V[:, 0])
    assert panel.end.text() == "40 %"
    told = press(BALL.V, BALL.F, (1, 0, 0), 0.4 * extent, 2, stiffness=PROPOSED_STIFFNESS)
    value, note = reading(window, "Load")
    assert float(value.removesuffix(" at stiffness 1")) == pytest.approx(told.steps[-1].load_low, 0.01)
    assert note.startswith("excess")
    assert reading(window, "Distance")[1] == "40.0 %"
    left = 100.0 * told.steps[-1].volume / told.steps[0].volume
    assert float(reading(window, "Volume")[1].removesuffix(" %")) == pytest.approx(left, abs=0.1)
    assert drawn(panel.volume_view.chart())[1][0] == reading(window, "Volume")[1]
    assert reading(window, "Area")[0].startswith("100.")
    assert panel.calm.text() == "At rest."
    assert len(steps(window)) == 3


def test_press_in_view_begins_with_enter_in_the_number_of_steps(qtbot, window):
    window.actions_.simulate.press_live.trigger()
    panel = window.press.panel
    panel.end.setText("80")
    panel.steps.selectAll()
    QTest.keyClicks(panel.steps, "2")
    QTest.keyClick(panel.steps, Qt.Key.Key_Return)
    assert player(window).is_playing
    qtbot.waitUntil(lambda: not player(window).is_playing, timeout=WAIT)
    assert len(steps(window)) == 3


def test_press_in_view_puts_plates_into_the_hand_and_lets_paint_go(qtbot, window):
    window.session.gestures.begin()
    window.session.painting.paint(np.flatnonzero(BALL.V[:, 2] < -0.8), BASE)
    window.session.painting.end_stroke("Paint")
    painted = document(window)
    window.actions_.simulate.press_live.trigger()
    assert obstacle_pair(document(window)) is not None
    assert (document(window).labels == FREE).all()
    assert document(window).settings.stiffness == PROPOSED_STIFFNESS
    assert window.notice.text.startswith("Base and handles are let go")
    assert window.canvas.tool is Tool.MOVE
    assert window.parts.obstacle is not None
    window.press.panel.direction.activated.emit(2)
    assert np.abs(obstacle_pair(document(window)).axis).tolist() == [0.0, 0.0, 1.0]
    up = window.canvas.viewport.camera_controller.camera.up_axis.index
    titles = [window.press.panel.direction.itemText(k).partition(" (")[0] for k in range(3)]
    assert titles[up] == f"{'XYZ'[up]}, top load"
    assert sum("side load" in title for title in titles) == 2
    assert window.press.panel.direction.count() == 5, "two more are by fingers, from the sides"
    assert window.press.panel.direction.itemText(3).startswith("X, two fingers (")
    window.press.panel.direction.activated.emit(3)
    assert window.notice.text.startswith("The lowest part is held")
    finger = document(window).obstacles[0]
    assert (len(document(window).obstacles), finger.kind) == (2, ObstacleKind.SPHERE)
    height = document(window).mesh.V[:, up]
    np.testing.assert_array_equal(
        document(window).labels == BASE, height <= height.min() + 0.05 * np.ptp(height)
    )
    window.session.gestures.undo()
    assert len(document(window).obstacles) == 2, "the plates are put anew"
    window.session.gestures.undo()
    window.session.gestures.undo()
    assert document(window) is painted


def test_press_in_view_scrubs_to_a_step_by_mouse_and_makes_it_current(qtbot, window):
    panel = pressed(qtbot, window)
    slider, mouse = panel.slider, Mouse(panel.slider)
    last = window.session.store.state
    middle = slider.height() / 2
    mouse.press((slider.knob_position(3), middle))
    for k in (2, 1):
        mouse.move((slider.knob_position(k), middle))
        assert window.session.store.state is steps(window)[k].state
    assert panel.position.text() == "2 of 4"
    mouse.release((slider.knob_position(1), middle))
    idle(qtbot, window)
    assert window.session.store.state is steps(window)[1].state
    assert window.session.gestures.history.undo_names[-1] == "Press to 80\u00a0%"
    mouse.press((slider.knob_position(2), middle))
    QTest.keyClick(slider, Qt.Key.Key_Escape)
    assert window.session.store.state is steps(window)[1].state
    panel.forward.click()
    panel.forward.click()
    assert window.session.store.state is last
    assert not panel.forward.isEnabled()


def test_press_in_view_plays_the_timeline_and_stays_at_its_end(qtbot, window):
    panel = pressed(qtbot, window)
    seen = set()
    window.signals.changed.connect(lambda _, new: seen.add(id(new)))
    panel.replay.click()
    qtbot.waitUntil(lambda: player(window).shown_step == 3 and not panel.loop.isChecked(), timeout=WAIT)
    qtbot.waitUntil(lambda: window.session.gestures.state_before is None, timeout=WAIT)
    assert {id(step.state) for step in steps(window)} <= seen
    panel.back.click()
    panel.back.click()
    panel.replay.click()  # from there on, and stopped before the end
    qtbot.waitUntil(lambda: player(window).shown_step == 2, timeout=WAIT)
    panel.replay.click()
    assert window.session.store.state is steps(window)[2].state
    assert window.session.gestures.state_before is None


def test_press_in_view_ends_a_repeated_replay_of_steps_that_are_cleared(qtbot, window):
    panel = pressed(qtbot, window, count=2)
    panel.loop.setChecked(True)
    panel.replay.click()
    qtbot.waitUntil(lambda: player(window).shown_step == 1, timeout=WAIT)
    player(window).clear()
    qtbot.waitUntil(lambda: window.session.gestures.state_before is None, timeout=WAIT)
    panel.loop.setChecked(False)


def test_press_in_view_pauses_goes_on_and_stops(qtbot, window):
    window.actions_.simulate.press_live.trigger()
    panel = window.press.panel
    panel.steps.setValue(50)
    panel.press.click()
    qtbot.waitUntil(lambda: player(window).done > 0, timeout=WAIT)
    assert "of 50" in panel.progress.text()
    panel.press.click()
    assert player(window).is_paused
    assert panel.press.text() == "Continue"
    done = player(window).done
    panel.press.click()
    qtbot.waitUntil(lambda: player(window).done > done, timeout=WAIT)
    panel.stop.click()
    qtbot.waitUntil(lambda: not player(window).is_playing, timeout=WAIT)
    assert panel.press.text() == "Press"
    assert len(steps(window)) < 50


@pytest.mark.night
def test_press_in_view_opens_the_plates_and_keeps_the_crushed_shape(qtbot, window):
    panel = pressed(qtbot, window)
    crushed = window.session.store.state
    assert panel.open.isEnabled()
    panel.open.click()
    qtbot.waitUntil(lambda: not player(window).is_playing, timeout=WAIT)
    assert steps(window)[3].state is crushed
    assert reading(window, "Load") == ("0", "")
    assert not panel.open.isEnabled(), "they are open"


@pytest.mark.parametrize(
    ("typed", "shown"),
    [("60", "60 %"), ("62,5", "62,5 %"), ("60 %", "60 %"), ("30mm", "30mm"), ("0.5", "0.5"), ("x", "x")],
)
def test_press_in_view_writes_the_sign_after_a_percentage(qtbot, window, typed, shown):
    qtbot.mouseClick(tool_button(window), Qt.MouseButton.LeftButton)
    end = window.press.panel.end
    qtbot.waitUntil(end.hasFocus)
    QTest.keyClicks(end, typed)
    QTest.keyClick(end, Qt.Key.Key_Tab)
    assert end.text() == shown
    assert end.shown_unit == ("%" if shown == "0.5" else ""), "it could be meant as a factor"


@pytest.mark.parametrize("what", ["a setting", "a stroke"])
def test_replay_gives_way_to_what_changes_the_shape_it_shows(qtbot, window, what):
    session, panel = window.session, pressed(qtbot, window)
    session.settings.change(stiffness=0.02)  # that state is on no step
    idle(qtbot, window)
    before = session.store.state.document
    panel.replay.click()
    qtbot.waitUntil(lambda: player(window).shown_step == 1)
    if what == "a setting":
        session.settings.change(stiffness=0.01)
    else:
        session.gestures.begin()
        session.painting.paint(np.arange(4), BASE)
        qtbot.wait(600)  # ticks of the replay
        session.painting.paint(np.arange(8), BASE)
        session.painting.end_stroke("Paint base")
    idle(qtbot, window)
    names = "Change stiffness" if what == "a setting" else "Paint base"
    assert session.gestures.history.undo_names[-2:] == ["Go to another step", names]
    assert session.gestures.state_before is None
    assert what == "a setting" or (session.store.state.document.labels[:8] == BASE).all()
    for _ in range(2):
        session.gestures.undo()
    assert session.store.state.document is before


def test_press_in_view_puts_plates_beside_a_filled_shape_and_presses_at_once(qtbot, window):
    window.session.settings.change(filled_volume=0.9 * window.session.store.state.inspection.volume)
    window.docks["timeline"].show()
    window.press.panel.end.setText("80")
    window.press.panel.press.click()
    assert player(window).is_playing
    assert not window.press.panel.problem.isVisible()


def test_press_in_view_refuses_what_plates_cannot_do(qtbot, window):
    window.actions_.simulate.press_live.trigger()
    panel = window.press.panel
    for text in ("0", "150 %", "flat"):
        panel.end.setText(text)
        panel.press.click()
        assert panel.problem.isVisible()
        assert not player(window).is_playing


def test_press_in_view_exports_a_table_and_an_animation(qtbot, window, tmp_path, monkeypatch):
    window.session.store.unit = Unit.CENTIMETRE
    window.panel.measures.show_wall(WallText("0.3mm", material=WALL_MATERIALS[0]))
    panel = pressed(qtbot, window)
    for name in ("steps.csv", "steps.glb"):
        path = tmp_path / name
        monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_, path=path: (str(path), ""))
        panel.export.click()
        idle(qtbot, window)
    rows = list(csv.DictReader((tmp_path / "steps.csv").read_text(encoding="utf-8").splitlines()))
    readings = [obstacle_pair(step.state.document).reading(step.state) for step in steps(window)]
    assert [float(row["load_low"]) for row in rows] == [one.load_low for one in readings]
    assert [float(row["volume"]) for row in rows] == [step.state.frame.volume for step in steps(window)]
    factor = window.press.known_wall.newtons(steps(window)[-1].state).newtons_per_load
    newtons = [float(row["load_high_newton"]) for row in rows]
    assert newtons == pytest.approx([factor * one.load_high for one in readings])
    assert {row["volume_capped"] for row in rows} == {""}, "the mesh is closed"
    assert {row["unit"] for row in rows} == {"cm"}
    assert (tmp_path / "steps.glb").stat().st_size > 10_000


def test_press_in_view_has_its_steps_in_the_report(qtbot, window, tmp_path):
    pressed(qtbot, window, "80", 2)
    path = tmp_path / "report.html"
    window.reports.write_report(path)
    qtbot.waitUntil(path.exists, timeout=WAIT)
    table = path.read_text(encoding="utf-8").partition("<h2>Steps</h2>")[2].partition("</table>")[0]
    lines = [
        [re.sub("<[^>]*>", " ", cell).split() for cell in re.findall("<t[hd].*?</t[hd]>", row, re.DOTALL)]
        for row in re.findall("<tr>.*?</tr>", table, re.DOTALL)
    ]
    assert [line[0] for line in lines] == [["Step"], ["0", "Exact"], ["1", "Exact"], ["2", "Exact"]]
    for title, cell in zip(lines[0], lines[-1], strict=True):
        if title[0] not in ("Step", "State"):
            assert cell == " ".join(reading(window, title[0])).split()
    assert lines[-1][-1] == ["At", "rest."]
    captions = re.findall("<figcaption>(.*?)</figcaption>", table)
    curves = ["Load over the way of the plates", "Volume over the way of the plates"]
    assert captions == ["Step 0", "Step 1", "Step 2", *curves]
    loads = [each.frame.loads for each in (step.non_wall_state for step in steps(window))]
    assert len({row.tobytes() for row in loads}) == 3, "each picture is of another shape"
    pictures = re.findall('base64,([^"]*)', table.partition("<svg")[0])
    assert len(set(pictures)) == 3
    view = json.loads(
        re.search('<script type="application/json">(.*?)</script>', path.read_text(encoding="utf-8"))[1]
    )
    assert [shape["name"] for shape in view["shapes"]] == ["Step 0", "Step 1", "Step 2"]
    sizes = [np.ptp(step.non_wall_state.frame.U, axis=0) for step in steps(window)]
    np.testing.assert_allclose([shape["size"] for shape in view["shapes"]], sizes)
    notes = path.read_text(encoding="utf-8").partition("<h2>Assumptions</h2>")[2].partition("</section>")[0]
    assert "without gravity and friction" in notes
    assert "Loads are relative" in notes, "the thickness of the wall is not known"


def test_press_in_view_reads_newtons_of_a_known_wall(qtbot, window, monkeypatch):
    window.session.store.unit = Unit.CENTIMETRE
    pressed(qtbot, window)
    bare = float(reading(window, "Load")[0].removesuffix(" at stiffness 1"))
    tips = [row[1].toolTip() for row in window.press.panel.reading_rows if row[0].text() == "Load"]
    assert "A hand grips" not in tips[0], "newtons are not known"
    assert drawn(window.press.charts.load_chart())[0][0] == "Load, at stiffness 1"
    assert plate_loads(window, " at stiffness 1") == pytest.approx([bare] * 2, rel=2e-3)
    radius, note = reading(window, "Tightest bend")
    assert float(radius.removesuffix("\u00a0cm")) == pytest.approx(bend_of_screen(window), 0.01)
    assert note == "", "no wall is known"
    wall = WallText("0.3mm", material=WALL_MATERIALS[0])
    window.panel.measures.show_wall(wall)
    window.press.refresh()
    window.obstacles.refresh()
    state = window.session.store.state
    newtons = window.press.known_wall.newtons(state)
    assert reading(window, "Load")[0].endswith(" N")
    assert float(reading(window, "Load")[0][:-2]) == pytest.approx(newtons.newtons_per_load * bare, 0.01)
    assert drawn(window.press.charts.load_chart())[1][0] == reading(window, "Load")[0]
    load = float(reading(window, "Load")[0][:-2])
    assert plate_loads(window, " N") == pytest.approx([load] * 2, rel=2e-3), "one notation for one load"
    (tip,) = [row[1].toolTip() for row in window.press.panel.reading_rows if row[0].text() == "Load"]
    for said in (tip, window.panel.obstacles.list.rows[0].reading.toolTip()):
        assert "A hand grips with at most 500\u00a0N" in said
    # A closed shape cannot be unrolled, so a wall much thinner than its cells is much stiffer.
    factor = newtons.underestimate_factor()
    assert factor > 2.0
    assert reading(window, "Load")[1] == f"up to {factor:.2g} times too low"
    # A wall of 0.3 mm that yields at 1.75 % does so below 0.3 mm / (2 * 0.0175) = 8.57 mm.
    assert reading(window, "Tightest bend")[1] == "creases below 0.857\u00a0cm"


def test_press_in_view_reads_newtons_of_the_method_wall_as_thick_as_it_is(window):
    window.session.store.unit = Unit.CENTIMETRE
    window.panel.measures.show_wall(WallText("0.02", material=WALL_MATERIALS[0]))
    state = window.session.store.state
    for thickness in (0.02, 0.04):
        thin = state.document.with_settings(method="wall", wall_thickness=thickness, poisson=0.38)
        newtons = window.press.known_wall.newtons(state.updated(document=thin))
        assert newtons.matches_wall is (thickness == 0.02)


def drawn(chart: Chart):
    return chart.readings


def test_press_charts_break_the_curve_between_runs_and_mark_what_is_not_at_rest(qtbot, window):
    pressed(qtbot, window, "80", 2)
    player(window).show_step(1)
    player(window).accept_shown_step()
    pressed(qtbot, window, "70", 1)
    chart = window.press.charts.load_chart()
    (curve,) = chart.curves
    assert [step.begins_run for step in steps(window)] == [True, False, False, True, False]
    assert np.flatnonzero(np.isnan(curve.y)).tolist() == [0, 4]
    assert len(chart.dots.x) == 1
    assert len(chart.dots.crosses) == 0
    assert chart.vertical_lines[0].place == pytest.approx(chart.dots.x[0])


@pytest.fixture
def walled(qtbot, window):
    """The window, with a wall of PET of 0.3 mm, that has begun to follow a press to 90 %."""
    window.session.store.unit = Unit.CENTIMETRE
    window.panel.measures.show_wall(WallText("0.3mm", material=WALL_MATERIALS[0]))
    pressed(qtbot, window, "90", 2)
    return window


def solved(qtbot, window):
    """Wait until the wall is solved."""
    qtbot.waitUntil(lambda: not window.session.wall_run.is_running, timeout=WAIT)
    work_off()


def answers(window):
    return [step.wall_result for step in steps(window)]


@pytest.mark.night
def test_press_in_view_lets_the_wall_follow_in_the_same_curves(qtbot, walled):
    panel, charts, shown = walled.press.panel, walled.press.charts, walled.session.store.state
    assert walled.session.wall_run.is_running
    assert panel.progress.text() == "Wall 0.3 mm: step 1 of 2"
    assert (panel.wall.text(), panel.wall.isVisible()) == ("Stop", True)
    assert reading(walled, "Load")[1].endswith("times too low"), "the first answer is there at once"
    solved(qtbot, walled)
    assert walled.session.store.state is shown, "the view stays"
    assert not panel.wall.isVisible()
    newtons = walled.press.known_wall.newtons_as_pressed
    loads = [obstacle_pair(one.document).reading(one).load for one in answers(walled)]
    forces = [newtons(one).newtons_per_load * load for one, load in zip(answers(walled), loads, strict=True)]
    first, wall = charts.load_chart().curves
    assert (first.has_dots, wall.has_dots) == (False, True)
    assert wall.y[1:] == pytest.approx(forces)
    check_readings_are_of_the_screen(walled)
    assert headings(walled) == ["Exact, on screen", "Wall 0.3 mm"]
    assert float(other_reading(walled, "Load")[0][:-2]) == pytest.approx(forces[-1], 0.01)
    left = left_percent(answers(walled)[-1])
    assert percent(other_reading(walled, "Volume")[1]) == pytest.approx(left, abs=0.1)
    value, other = panel.reading_rows[2][1], panel.reading_rows[2][3]
    assert (value.font(), value.palette().windowText()) == (other.font(), other.palette().windowText())
    of_screen = [reading(walled, title)[0] for title in TITLES]
    of_wall = [other_reading(walled, title)[0] for title in TITLES]
    panel.shape_choice.activated.emit(1)
    work_off()
    check_readings_are_of_the_screen(walled)
    assert headings(walled) == ["Wall 0.3 mm, on screen", "Exact"]
    assert [reading(walled, title)[0] for title in TITLES] == of_wall
    assert [
        other_reading(walled, title)[0] for title in ("Load", "Volume", "Area", "Tightest bend")
    ] == of_screen
    assert [text for text, _ in drawn(charts.load_chart())] == ["Load", "Exact", "\u25cf\xa0Wall 0.3 mm"]
    words = "  ".join(text for text, _ in drawn(charts.load_chart()))
    assert panel.load_view.fontMetrics().horizontalAdvance(words) <= 220, "no room is lost at 1024 px"
    area = panel.load_view.chart_area
    x, y = area.pixel_positions(wall.x[1:2], wall.y[1:2])[0]
    beside = panel.load_view.grab().toImage().pixelColor(round(x - 1.5), round(y - 0.5))
    assert beside.lightness() < 160, "the curve begins with a dot"
    volumes = np.array([one.frame.volume for one in answers(walled)])
    assert charts.volume_chart().curves[1].y[1:] == pytest.approx(100.0 * volumes / volumes[0])


@pytest.mark.night
def test_press_in_view_shows_the_shapes_of_the_wall_and_presses_on_from_the_first(qtbot, walled):
    panel = walled.press.panel
    solved(qtbot, walled)
    assert [panel.shape_choice.itemText(k) for k in range(2)] == ["Exact", "Wall 0.3 mm"]
    force = other_reading(walled, "Load")[0]
    panel.shape_choice.activated.emit(1)
    assert walled.session.store.state is answers(walled)[-1]
    assert reading(walled, "Load")[0] == force
    panel.back.click()
    assert walled.session.store.state is answers(walled)[1]
    assert panel.position.text() == "2 of 3"
    pressed(qtbot, walled, "85", 1)
    assert panel.shape_choice.currentIndex() == 0
    assert [step.state.document.settings.method for step in steps(walled)] == ["exact"] * len(steps(walled))


@pytest.mark.night
def test_press_in_view_ends_the_wall_where_it_becomes_another_one(qtbot, walled):
    panel = walled.press.panel
    walled.panel.measures.show_wall(WallText("0.5mm", material=WALL_MATERIALS[0]))
    walled.press.refresh()
    assert not walled.session.wall_run.is_running
    assert walled.notice.text == "The wall has changed: it is solved no further."
    assert reading(walled, "Load")[1].endswith("times too low"), "the first answer stays"
    assert (panel.wall.text(), panel.wall.isVisible()) == ("Solve as wall", True)
    panel.wall.click()
    assert panel.progress.text() == "Wall 0.5 mm: step 1 of 2"
    panel.wall.click()
    assert not walled.session.wall_run.is_running
    panel.shape_choice.activated.emit(1)
    assert panel.warning.text() == "The wall is not solved here: this is Exact."


@pytest.mark.night
def test_press_in_view_keeps_the_choice_of_the_wall_until_it_is_solved(qtbot, walled):
    panel, first = walled.press.panel, walled.session.store.state
    panel.shape_choice.setCurrentIndex(1)
    panel.shape_choice.activated.emit(1)
    assert panel.warning.text() == "The wall is not solved here: this is Exact."
    assert panel.warning.isVisible()
    assert walled.session.store.state is first
    solved(qtbot, walled)
    assert panel.shape_choice.currentText() == "Wall 0.3 mm"
    assert walled.session.store.state is answers(walled)[-1]
    assert not panel.warning.isVisible()
    check_readings_are_of_the_screen(walled)


@pytest.mark.night
def test_press_in_view_lets_the_wall_be_stopped_after_its_plates_are_undone(qtbot, walled):
    panel, undo = walled.press.panel, walled.session.gestures.undo
    undo()
    undo()
    work_off()
    assert obstacle_pair(document(walled)) is None
    assert walled.session.wall_run.is_running
    assert (panel.wall.text(), panel.wall.isVisible()) == ("Stop", True)
    assert panel.progress.text().startswith("Wall 0.3 mm: step ")
    assert not panel.press.isVisible(), "there are no plates"
    panel.wall.click()
    work_off()
    assert not walled.session.wall_run.is_running
    assert not panel.controls.isVisible()


def test_status_bar_tells_and_stops_the_run_of_the_wall_while_the_timeline_is_closed(walled):
    status, dock = walled.status, walled.docks["timeline"]
    shown = status.run, status.run_stop
    assert not any(one.isVisible() for one in shown), "the timeline tells"
    dock.hide()
    work_off()
    assert status.run.text().startswith("Wall 0.3 mm: step ")
    assert all(one.isVisible() for one in shown)
    dock.show()
    work_off()
    assert not any(one.isVisible() for one in shown)
    dock.hide()
    work_off()
    status.run_stop.click()
    work_off()
    assert not walled.session.wall_run.is_running
    assert not any(one.isVisible() for one in shown)


@pytest.mark.parametrize("shows_wall", [True, pytest.param(False, marks=pytest.mark.night)])
def test_press_in_view_opens_a_session_on_the_shape_that_was_saved(qtbot, walled, tmp_path, shows_wall):
    panel, session = walled.press.panel, walled.session
    solved(qtbot, walled)
    panel.shape_choice.activated.emit(int(shows_wall))
    # The wall that is typed now is not that of the shape.
    walled.panel.measures.show_wall(WallText("0.5mm", material=WALL_MATERIALS[0]))
    shown, path = session.store.state, tmp_path / "a.apd"
    session.files.save(path, walled.view(), embed=True)
    idle(qtbot, walled)
    volumes = [one.frame.volume for one in answers(walled)]
    for _ in range(2):
        session.files.open_mesh(BALL)
        idle(qtbot, walled)
        session.files.open(path)
        idle(qtbot, walled)
        qtbot.wait(50)
        assert np.array_equal(session.store.state.frame.U, shown.frame.U)
        assert session.store.state.document.settings == shown.document.settings
        assert (player(walled).shown_step, len(steps(walled))) == (2, 3)
        assert [one.frame.volume for one in answers(walled)] == pytest.approx(volumes)
        assert panel.shape_choice.currentText() == ("Wall 0.3 mm" if shows_wall else "Exact")
        assert (panel.calm.isVisible(), panel.warning.isVisible()) == (True, False)
        assert not session.wall_run.is_running, "nothing is solved again"


@pytest.mark.night
def test_press_in_view_asks_about_what_the_wall_solved_since_the_last_save(
    qtbot, walled, tmp_path, monkeypatch
):
    asked, path = [], tmp_path / "a.apd"

    def cancel(box):
        asked.append(box.informativeText())
        return 0

    monkeypatch.setattr(file_controller, "ask_before_leaving", ASK)
    monkeypatch.setattr(QMessageBox, "exec", cancel)
    walled.session.wall_run.stop()
    walled.session.files.save(path, walled.view(), embed=True)
    idle(qtbot, walled)
    unsaved = sum(one is None for one in answers(walled))
    assert walled.files.may_discard_work(lambda: None)
    assert not walled.shell.isWindowModified()
    walled.press.panel.wall.click()
    solved(qtbot, walled)
    assert walled.shell.isWindowModified()
    assert not walled.files.may_discard_work(lambda: None)
    assert asked[-1].endswith(f"Steps at which the wall is solved and not saved yet: {unsaved}.")
    walled.session.files.save(path, walled.view(), embed=True)
    idle(qtbot, walled)
    assert walled.files.may_discard_work(lambda: None)
    walled.session.files.open(path)
    idle(qtbot, walled)
    assert answers(walled)[-1] is not None
    assert walled.files.may_discard_work(lambda: None)
    assert len(asked) == 1


def test_press_in_view_speaks_of_no_wall_before_there_is_a_press(qtbot, walled):
    panel = walled.press.panel
    walled.session.wall_run.stop()
    panel.shape_choice.activated.emit(1)
    assert panel.warning.isVisible()
    player(walled).show_step(0)
    player(walled).accept_shown_step()
    assert len(headings(walled)) == 2
    work_off()
    wide = panel.reading_rows[0][0].parentWidget().width()
    for _ in range(2):
        walled.session.files.open_mesh(Mesh(*sphere(1)))
        idle(qtbot, walled)
        walled.actions_.simulate.press_live.trigger()
        work_off()
        assert not panel.warning.isVisible()
        assert headings(walled) == []
        qtbot.waitUntil(lambda: panel.reading_rows[0][0].parentWidget().width() < wide)


def test_press_in_view_exports_the_shape_on_screen(qtbot, walled, tmp_path):
    solved(qtbot, walled)
    for shows_wall in (True, False):
        walled.press.panel.shape_choice.activated.emit(int(shows_wall))
        path = tmp_path / f"{shows_wall}.obj"
        walled.session.files.export(path)
        idle(qtbot, walled)
        step = steps(walled)[-1]
        wanted = step.wall_result if shows_wall else step.state
        assert np.abs(open_mesh(path).V - wanted.frame.U).max() < 1e-9
        assert np.abs(step.wall_result.frame.U - step.state.frame.U).max() > 1e-3, "they are two shapes"


@pytest.mark.night
def test_press_in_view_exports_the_wall_in_columns_of_its_own(qtbot, walled, tmp_path, monkeypatch):
    qtbot.waitUntil(lambda: walled.session.wall_run.done == 1, timeout=WAIT)
    walled.session.wall_run.stop()
    path = tmp_path / "steps.csv"
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (str(path), ""))
    walled.press.panel.export.click()
    idle(qtbot, walled)
    rows = list(csv.DictReader(path.read_text(encoding="utf-8").splitlines()))
    answer = answers(walled)[1]
    found, own = obstacle_pair(answer.document).reading(answer), rows[1]
    factor = walled.press.known_wall.newtons_as_pressed(answer).newtons_per_load
    assert float(own["wall_distance"]) == float(own["distance"]) == found.distance
    assert float(own["wall_load_low"]) == found.load_low
    assert float(own["wall_load_low_newton"]) == pytest.approx(factor * found.load_low)
    assert float(own["wall_volume"]) == answer.frame.volume
    assert {value for name, value in rows[2].items() if name.startswith("wall_")} == {""}
    assert all(rows[2][name] for name in ("load_low", "load_low_newton", "volume"))
