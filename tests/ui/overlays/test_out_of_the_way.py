"""Notices, hints and the legend leave the mesh to the eye and the mouse."""

from pathlib import Path

import numpy as np
import pytest
from driving import Mouse, document, idle, settle, work_off
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QDesktopServices
from PySide6.QtTest import QTest

from apd_viewer.files.scalar_files import ScalarRows
from apd_viewer.presentation.scales import Measure
from apd_viewer.ui.tools.tool_modes import Tool


def typed(qtbot, window, text="60deg"):
    field = window.panel.handles.motion
    field.choice.setCurrentIndex(field.choice.findData("TWIST"))
    QTest.keyClicks(field.amount, text)
    qtbot.keyClick(field.amount, Qt.Key.Key_Return)
    idle(qtbot, window)


def show_area(qtbot, window):
    window.actions_.display.measures[Measure.AREA].trigger()
    qtbot.waitUntil(lambda: window.display_options.overlay.reading.values is not None, timeout=60_000)
    settle(qtbot, window.canvas.viewport)


def test_notice_is_low_and_lets_clicks_through(qtbot, bottle):
    bottle.notice.show_failure("Something was not done; try again.")
    view, notice = bottle.canvas.viewport, bottle.notice
    assert notice.geometry().top() > view.height() / 2
    assert not notice.geometry().intersects(bottle.invitation.geometry())
    beside = notice.geometry().center()
    assert view.childAt(beside) is None
    assert view.childAt(notice.close_button.geometry().center()) is notice.close_button
    assert notice.geometry().contains(notice.close_button.geometry())
    QTest.mouseClick(notice.close_button, Qt.MouseButton.LeftButton)
    assert notice.isHidden()
    assert notice.close_button.isHidden()


def test_notice_offers_to_open_the_file_that_it_tells_of_and_no_other(qtbot, bottle, tmp_path, monkeypatch):
    opened, notice, path = [], bottle.notice, tmp_path / "scalars.csv"
    monkeypatch.setattr(QDesktopServices, "openUrl", lambda url: opened.append(Path(url.toLocalFile())))
    bottle.session.files.export_scalars(path, ScalarRows.VERTICES)
    idle(qtbot, bottle)
    assert notice.text.startswith("Exported scalars")
    for button in (notice.open_file, notice.show_folder):
        place = button.mapTo(bottle.canvas.viewport, button.rect().center())
        assert bottle.canvas.viewport.childAt(place) is button
        assert notice.geometry().contains(place)
        QTest.mouseClick(button, Qt.MouseButton.LeftButton)
    assert opened == [path, tmp_path]
    notice.show_message("Something else.")
    assert not notice.open_file.isVisible()


@pytest.mark.parametrize("size", [(800, 640), (1024, 700), (1280, 800)])
def test_notice_covers_nothing_else(qtbot, bottle, size):
    bottle.shell.resize(*size)
    show_area(qtbot, bottle)
    bottle.tools.choose_tool(Tool.BASE)
    bottle.notice.show_failure("The mesh was not exported: the disk is full; free some space and try again.")
    bottle.actions_.select.by_expression.trigger()
    work_off()
    card, bar = bottle.edits.text_entries.vertices, bottle.mode_bar
    assert bar.isVisible()
    assert not card.geometry().intersects(bar.geometry())
    for other in (bottle.invitation, bottle.display_options.cards, card, bar):
        assert other.isHidden() or not bottle.notice.geometry().intersects(other.geometry())
    assert bottle.canvas.viewport.rect().contains(bottle.notice.geometry())


@pytest.mark.parametrize("size", [(1024, 700), (1280, 800)])
def test_notice_and_hint_spare_the_foot_of_the_mesh_above_an_open_timeline(qtbot, bottle, size):
    bottle.shell.resize(*size)
    work_off()
    bottle.actions_.simulate.press_live.trigger()
    settle(qtbot, bottle.canvas.viewport)
    assert bottle.canvas.viewport.camera_controller.is_framing
    points = bottle.canvas.viewport.camera_controller.camera.project(document(bottle).mesh.V)
    assert bottle.notice.isVisible()
    assert bottle.invitation.isVisible()
    for over in (bottle.notice, bottle.invitation):
        room = over.geometry()
        assert bottle.canvas.viewport.rect().contains(room)
        assert not any(room.contains(QPointF(x, y).toPoint()) for x, y in points)
    assert not bottle.notice.geometry().intersects(bottle.invitation.geometry())
    bottle.docks["timeline"].hide()
    work_off()
    assert abs(bottle.invitation.geometry().center().x() - bottle.canvas.viewport.rect().center().x()) <= 1


@pytest.mark.parametrize("size", [(800, 640), (1024, 700), (1280, 800)])
def test_canvas_hint_and_notice_keep_off_a_framed_mesh_whatever_their_length(qtbot, bottle, size):
    bottle.shell.resize(*size)
    work_off()
    view = bottle.canvas.viewport
    bottle.tools.choose_tool(Tool.BASE)
    bottle.actions_.view.camera.directions["front"].trigger()
    for words in (6, 20):
        bottle.invitation.show_text(" ".join(["Bereichsauswahl"] * words))
        bottle.notice.show_message(" ".join(["Bereichsauswahl"] * words))
        work_off()
        points = view.camera_controller.camera.project(document(bottle).mesh.V)
        for over in (bottle.notice, bottle.invitation):
            room = over.geometry()
            assert over.isVisible()
            assert view.rect().contains(room)
            inside = [room.contains(QPointF(x, y).toPoint()) for x, y in points]
            assert not any(inside) or size == (800, 640)
        assert not bottle.notice.geometry().intersects(bottle.invitation.geometry())
        assert not bottle.invitation.geometry().intersects(bottle.mode_bar.geometry())


def test_canvas_hint_stays_over_a_mesh_that_leaves_no_room_beside_it(bottle):
    view, V = bottle.canvas.viewport, document(bottle).mesh.V
    view.camera_controller.frame(V.mean(axis=0) + 0.3 * (V - V.mean(axis=0)))
    bottle.invitation.show_text("Drag something")
    assert bottle.invitation.isVisible()
    assert abs(bottle.invitation.geometry().center().x() - view.rect().center().x()) <= 1
    bottle.canvas.frame_mesh()


def test_canvas_hint_is_dropped_where_no_room_is_left_beside_the_mesh(qtbot, bottle):
    view = bottle.canvas.viewport
    view.spares_mesh = True
    try:
        V = document(bottle).mesh.V
        view.camera_controller.frame(V.mean(axis=0) + 0.3 * (V - V.mean(axis=0)))
        bottle.invitation.show_text("Drag something")
        assert bottle.invitation.isHidden()
        bottle.canvas.frame_mesh()
        assert bottle.invitation.isVisible()
    finally:
        view.spares_mesh = False


def test_next_step_hint_takes_the_first_hint_away_when_a_handle_was_moved_in_any_way(qtbot, bottle):
    assert "ring" in bottle.invitation.text()
    typed(qtbot, bottle)
    assert bottle.invitation.isHidden()
    bottle.tools.choose_tool(Tool.ORBIT)
    assert bottle.invitation.isHidden()


def test_legend_is_not_over_the_bottle_in_a_small_window(qtbot, bottle):
    bottle.shell.resize(1024, 700)
    bottle.invitation.show_text("")
    work_off()
    show_area(qtbot, bottle)
    work_off()
    room, eye = bottle.display_options.cards.geometry(), bottle.canvas.viewport.camera_controller.camera
    points = eye.project(document(bottle).mesh.V)
    assert not any(room.contains(QPointF(x, y).toPoint()) for x, y in points)


def test_legend_folds_and_comes_to_rest(qtbot, new_bottle):
    # In a window of its own: one that was folded by hand stays so.
    legend = new_bottle.display_options.legend
    for width in (800, 900, 1024, 1100, 1280):
        new_bottle.shell.resize(width, 700)
        show_area(qtbot, new_bottle)
        work_off()
    heights = []
    for _ in range(3):
        legend.fold_button.click()
        work_off()
        heights.append((legend.height(), legend.neutral.isVisible()))
        assert legend.rect().contains(legend.bar.geometry())
    assert heights[0] == heights[2] != heights[1]
    assert {shown for _, shown in heights} == {False, True}


def test_legend_is_dragged_away_and_put_back_by_a_double_click(qtbot, bottle):
    show_area(qtbot, bottle)
    cards, view = bottle.display_options.cards, bottle.canvas.viewport
    home, eye = cards.pos(), view.camera_controller.camera.key
    mouse, grip = Mouse(bottle.display_options.legend), QPoint(4, 4)
    mouse.press(grip)
    mouse.move(grip + QPoint(100, -90))
    mouse.release(grip)
    assert cards.pos() == home + QPoint(100, -90)
    mouse.press(grip)
    mouse.move(grip + QPoint(9000, -9000))
    mouse.release(grip)
    assert view.rect().contains(cards.geometry())
    assert view.camera_controller.camera.key == eye
    bottle.shell.resize(1000, 700)
    work_off()
    assert view.rect().contains(cards.geometry())
    mouse.double_click(grip)
    assert cards.x() == home.x()


def test_deviation_overlay_fits_the_range_when_an_overlay_is_first_shown(qtbot, bottle):
    typed(qtbot, bottle)
    heat, legend = bottle.display_options.overlay, bottle.display_options.legend
    show_area(qtbot, bottle)
    largest = np.abs(heat.reading.span).max()
    assert heat.scale.end * 0.4 < largest < heat.scale.end * 1.3
    assert heat.scales == {}, "it is the user's who changes it"
    assert legend.reach.value() == pytest.approx(100 * heat.scale.reach)
    legend.scale_changed.emit(0.5, 0.01)
    bottle.actions_.display.no_overlay.trigger()
    show_area(qtbot, bottle)
    assert heat.scale.reach == 0.5
