"""Nothing that lies on the canvas covers another, leaves it or is cut; no window grows off the screen."""

import numpy as np
import pytest
from driving import Mouse, idle, settle, work_off
from grid_figures import figures
from PySide6.QtCore import QPointF, QRect, QSize
from PySide6.QtWidgets import QDialog, QToolButton, QWidget
from resting import Watch

from apd_viewer.presentation.scales import Measure
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.ui.tools.tool_modes import SelectionMode, Tool
from apd_viewer.ui.widgets.box_layouts import STRETCH, resize_on_screen, row_layout
from apd_viewer.ui.widgets.theme import DARK, LIGHT
from apd_viewer.ui.widgets.thin_bar import ElidedLabel


@pytest.fixture
def full(qtbot, bottle):
    """The bottle with a tool that paints, and all that can be switched on."""
    looks = bottle.actions_.display
    bottle.tools.choose_tool(Tool.HANDLE)
    looks.measures[Measure.AREA].trigger()
    for switch in ("ghost", "compare", "cut", "ground"):
        looks.switches[switch].trigger()
    work_off()
    return bottle


def on_canvas(window):
    """What lies on the canvas, by its name, in the canvas' coordinates."""
    parts = {
        "ways": window.mode_bar,
        "invitation": window.invitation,
        "notice": window.notice,
        "findings": window.findings.list,
        "compare": window.display_options.before_after,
        "cut": window.display_options.cutting_plane,
        "legend": window.display_options.legend,
    }
    view = window.canvas.viewport
    return {
        name: QRect(part.mapTo(view, part.rect().topLeft()), part.size())
        for name, part in parts.items()
        if part.isVisible()
    }


@pytest.mark.parametrize("plots", [False, True])
@pytest.mark.parametrize("size", [(1280, 720), (800, 640)])
def test_workbench_lets_nothing_on_the_canvas_meet_or_be_cut_with_everything_on(qtbot, full, size, plots):
    full.shell.resize(*size)
    full.docks["plots"].setVisible(plots)
    full.invitation.show_text("")
    work_off()
    found = on_canvas(full)
    assert {"ways", "compare", "cut", "legend"} <= set(found)
    for name, room in found.items():
        assert full.canvas.viewport.rect().contains(room), name
        for other, others in found.items():
            assert name == other or not room.intersects(others), (name, other)
    for card in (
        full.display_options.before_after,
        full.display_options.cutting_plane,
        full.display_options.legend,
    ):
        assert card.height() == card.sizeHint().height(), "neither squeezed nor spread"
        for part in card.findChildren(QWidget):
            if part.isVisible() and part.parent() is card:
                assert card.rect().contains(part.geometry())


def test_cards_do_not_cover_what_is_typed_into(qtbot, full):
    full.shell.resize(1280, 720)
    full.actions_.select.by_expression.trigger()
    card, cards = full.edits.text_entries.vertices, full.display_options.cards
    qtbot.waitUntil(lambda: card.isVisible() and not card.geometry().intersects(cards.geometry()))
    assert full.canvas.viewport.rect().contains(cards.geometry())


def test_click_selector_says_so_where_there_is_no_border(full):
    full.tools.choose_mode(SelectionMode.LOOP)
    view = full.canvas.viewport
    x, y = view.camera_controller.camera.project(full.canvas.surface.U[:1])[0]
    mouse = Mouse(view)
    full.actions_.display.switches["cut"].trigger()
    mouse.move((x, y - 60))
    mouse.drag((x, y - 60), (x, y - 60))
    assert full.canvas.surface.hit(QPointF(x, y - 60)) is not None
    assert "no boundary" in full.notice.text


def test_legend_lines_come_back_with_the_room(qtbot, full):
    legend = full.display_options.legend
    full.shell.resize(1280, 720)
    full.docks["plots"].show()
    qtbot.waitUntil(lambda: not legend.neutral.isVisible())
    assert legend.bar.isVisible()
    full.docks["plots"].hide()
    qtbot.waitUntil(legend.neutral.isVisible)
    legend.measure_chosen.emit(Measure.DISPLACEMENT)
    work_off()
    assert not legend.neutral.isVisible(), "there is none on this scale"
    assert legend.reach.isVisible()


def test_cards_lay_out_one_that_comes_back_alone_for_its_own_size(qtbot, full):
    looks = full.actions_.display
    looks.switches["compare"].trigger()
    looks.switches["cut"].trigger()
    work_off()
    looks.no_overlay.trigger()
    work_off()
    looks.switches["cut"].trigger()
    work_off()
    cut = full.display_options.cutting_plane
    assert cut.rect().contains(cut.slider.geometry())
    assert cut.rect().contains(cut.axes[0].geometry())


def test_tool_bar_has_an_overflow_button_that_is_seen_on_a_dark_ground(bottle):
    bars = bottle.actions_.bar, bottle.mode_bar, bottle.kind_bar
    before = bottle.shell.theme
    try:
        for theme, is_light in ((DARK, True), (LIGHT, False)):
            for bar in bars:
                bar.set_theme(theme)
                drawn = bar.findChild(QToolButton, "qt_toolbar_ext_button").icon().pixmap(32, 32).toImage()
                inked = [drawn.pixelColor(x, y) for x in range(32) for y in range(32)]
                grey = [color.lightness() for color in inked if color.alpha() > 200]
                assert (np.mean(grey) > 128) == is_light
    finally:
        for bar in bars:
            bar.set_theme(before)


def test_selection_mode_bar_has_ways_for_which_there_is_no_room_in_a_menu(qtbot, full):
    more = full.mode_bar.findChild(QToolButton, "qt_toolbar_ext_button")
    full.shell.resize(1280, 720)
    qtbot.waitUntil(lambda: not more.isVisible())
    full.docks["plots"].show()
    qtbot.waitUntil(more.isVisible)
    assert not more.icon().isNull()


def test_ground_writes_no_figure_over_another(qtbot, bottle, monkeypatch):
    bottle.actions_.display.switches["ground"].trigger()
    written = []
    for axis in ("front", "side", "top", "-front"):
        bottle.canvas.viewport.camera_controller.show_standard_view(axis)
        settle(qtbot, bottle.canvas.viewport)
        taken = [room for _, room in figures(bottle)]
        written += taken
        assert not any(a.intersects(b) for a in taken for b in taken if a is not b)
    assert written


def test_resize_on_screen_keeps_a_window_that_grows_on_the_screen(qtbot):
    window = QDialog()
    qtbot.addWidget(window)
    screen = window.screen().availableGeometry()
    window.setGeometry(screen.right() - 200, screen.bottom() - 150, 180, 120)
    window.show()
    qtbot.waitExposed(window)
    resize_on_screen(window, QSize(500, 400))
    qtbot.waitUntil(lambda: screen.contains(window.frameGeometry()))
    assert window.size() == QSize(500, 400)
    resize_on_screen(window, 2 * screen.size())
    qtbot.waitUntil(lambda: screen.contains(window.frameGeometry()))
    assert np.prod(window.size().toTuple()) > 0.8 * np.prod(screen.size().toTuple())


def test_status_bar_shows_the_hint_before_the_pace_in_a_narrow_window(qtbot, bottle):
    bottle.shell.resize(800, 640)
    bottle.session.handles.move_by(MOTIONS["TWIST"], "10deg", 0)
    idle(qtbot, bottle)
    hint, pace = bottle.status.findChildren(ElidedLabel)
    bottle.status.show_hint("A hint that is longer than there is room. " * 5)
    work_off()
    count, _, rate = pace.text().partition(",")
    assert rate.endswith("ms per iteration")
    assert pace.fontMetrics().horizontalAdvance(f"{count}…") <= pace.width() - 16
    assert pace.width() < pace.sizeHint().width()
    assert pace.toolTip() == pace.text()
    assert hint.width() > pace.width()


@pytest.mark.parametrize("width", [960, 1024, 1366])
def test_status_bar_cuts_no_text_beside_free_room(qtbot, bottle, width):
    bottle.shell.resize(width, 680)
    hint, pace = bottle.status.findChildren(ElidedLabel)
    for n in range(20, 140, 10):
        bottle.status.show_hint("n" * n)
        work_off()
        right = min(label.x() for label in (bottle.status.extent, pace) if label.isVisible())
        is_cut = hint.width() < hint.room_for(hint.text())
        assert not is_cut or right - hint.geometry().right() < 10, "there is room to the right"
        assert not is_cut or pace.width() <= pace.room_for("iteration 99,999…"), "the pace gives way first"
        assert hint.toolTip() == hint.text()
    assert is_cut or width > 1024


def test_status_bar_counts_without_laying_out_the_window(qtbot, bottle, monkeypatch):
    """Each layout would have the whole window composed once more, for every shape of the solver."""
    bottle.session.handles.move_by(MOTIONS["TWIST"], "10deg", 0)
    idle(qtbot, bottle)
    pace, counts, texts = bottle.status.findChildren(ElidedLabel)[1], [], set()
    for speed in (0.0123, 0.0122, 0.0121):
        monkeypatch.setattr(bottle.session.store, "seconds_per_iteration", speed)
        watch = Watch()
        bottle.status.show_session(bottle.session)
        counts.append(sum(kind == "LayoutRequest" and who == "Shell" for who, kind in watch.count(0.05)))
        texts.add(pace.text())
    assert len(texts) == 3
    assert counts[1:] == [0, 0]


def test_status_bar_says_a_cut_message_in_its_tip_and_leaves_the_pace_the_rest(qtbot, bottle):
    bottle.session.handles.move_by(MOTIONS["TWIST"], "10deg", 0)
    idle(qtbot, bottle)
    _, pace = bottle.status.findChildren(ElidedLabel)
    bottle.status.show_hint("A hint that is longer than there is room. " * 5)
    work_off()
    assert pace.width() < pace.room_for(pace.text())
    bottle.status.showMessage("A prompt")
    work_off()
    assert bottle.status.toolTip() == "A prompt"
    assert pace.width() >= pace.room_for(pace.text())
    bottle.status.clearMessage()
    assert bottle.status.toolTip() == ""


def test_elided_label_has_room_for_its_text_where_nothing_takes_it(qtbot):
    window, label = QWidget(), ElidedLabel()
    row_layout(label, STRETCH, parent=window)
    qtbot.addWidget(window)
    label.setText("Wall 0.3 mm: step 3 of 16, about 2 minutes left")
    window.resize(900, 40)
    window.show()
    assert label.width() >= label.room_for(label.text())
    assert label.toolTip() == label.text()
