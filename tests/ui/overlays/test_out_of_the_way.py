"""Notices, hints and the legend leave the mesh to the eye and the mouse."""

import numpy as np
import pytest
from driving import Mouse, document, idle, settle, work_off
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtTest import QTest

from apd_viewer.presentation.scales import Measure
from apd_viewer.ui.tools.toolbox import Tool


def typed(qtbot, window, text="60deg"):
    field = window.panel.handles.motion
    field.choice.setCurrentIndex(field.choice.findData("TWIST"))
    QTest.keyClicks(field.amount, text)
    qtbot.keyClick(field.amount, Qt.Key.Key_Return)
    idle(qtbot, window)


def show_area(qtbot, window):
    window.actions_.looks.measures[Measure.AREA].trigger()
    qtbot.waitUntil(lambda: window.looks.heat.reading.values is not None, timeout=60_000)
    settle(qtbot, window.canvas.viewport)


def test_notice_is_low_and_lets_clicks_through(qtbot, bottle):
    bottle.notice.fail("Something was not done; try again.")
    view, notice = bottle.canvas.viewport, bottle.notice
    assert notice.geometry().top() > view.height() / 2
    assert not notice.geometry().intersects(bottle.invitation.geometry())
    beside = notice.geometry().center()
    assert view.childAt(beside) is None
    assert view.childAt(notice.cross.geometry().center()) is notice.cross
    assert notice.geometry().contains(notice.cross.geometry())
    QTest.mouseClick(notice.cross, Qt.MouseButton.LeftButton)
    assert notice.isHidden()
    assert notice.cross.isHidden()


@pytest.mark.parametrize("size", [(800, 640), (1024, 700), (1280, 800)])
def test_notice_covers_nothing_else(qtbot, bottle, size):
    bottle.shell.resize(*size)
    show_area(qtbot, bottle)
    bottle.notice.fail("The mesh was not exported: the disk is full; free some space and try again.")
    bottle.actions_.select.numbers.trigger()
    work_off()
    for other in (bottle.invitation, bottle.looks.cards, bottle.editing.typed.vertices):
        assert other.isHidden() or not bottle.notice.geometry().intersects(other.geometry())
    assert bottle.canvas.viewport.rect().contains(bottle.notice.geometry())


def test_next_step_takes_the_first_hint_away_when_a_handle_was_moved_in_any_way(qtbot, bottle):
    assert "ring" in bottle.invitation.text()
    typed(qtbot, bottle)
    assert bottle.invitation.isHidden()
    bottle.tools.take(Tool.ORBIT)
    assert bottle.invitation.isHidden()


def test_legend_is_not_over_the_bottle_in_a_small_window(qtbot, bottle):
    bottle.shell.resize(1024, 700)
    bottle.invitation.say("")
    work_off()
    show_area(qtbot, bottle)
    work_off()
    room, eye = bottle.looks.cards.geometry(), bottle.canvas.viewport.look.eye
    points = eye.project(document(bottle).mesh.V)
    assert not any(room.contains(QPointF(x, y).toPoint()) for x, y in points)


def test_legend_folds_and_comes_to_rest(qtbot, bottle):
    legend = bottle.looks.legend
    for width in (800, 900, 1024, 1100, 1280):
        bottle.shell.resize(width, 700)
        show_area(qtbot, bottle)
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
    cards, view = bottle.looks.cards, bottle.canvas.viewport
    home, eye = cards.pos(), view.look.eye.key
    mouse, grip = Mouse(bottle.looks.legend), QPoint(4, 4)
    mouse.press(grip)
    mouse.move(grip + QPoint(100, -90))
    mouse.release(grip)
    assert cards.pos() == home + QPoint(100, -90)
    mouse.press(grip)
    mouse.move(grip + QPoint(9000, -9000))
    mouse.release(grip)
    assert view.rect().contains(cards.geometry())
    assert view.look.eye.key == eye
    bottle.shell.resize(1000, 700)
    work_off()
    assert view.rect().contains(cards.geometry())
    mouse.double_click(grip)
    assert cards.x() == home.x()


def test_heat_map_fits_the_range_when_an_overlay_is_first_shown(qtbot, bottle):
    typed(qtbot, bottle)
    heat, legend = bottle.looks.heat, bottle.looks.legend
    show_area(qtbot, bottle)
    largest = np.abs(heat.reading.span).max()
    assert heat.scale.end * 0.4 < largest < heat.scale.end * 1.3
    assert heat.scales == {}, "it is the user's who changes it"
    assert legend.reach.value() == pytest.approx(100 * heat.scale.reach)
    legend.scaled.emit(0.5, 0.01)
    bottle.actions_.looks.off.trigger()
    show_area(qtbot, bottle)
    assert heat.scale.reach == 0.5
