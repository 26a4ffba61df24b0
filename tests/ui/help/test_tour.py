"""The tour around the bottle: it points, follows what is done, blocks nothing, and comes once."""

import gc

import meshes
import numpy as np
import pytest
from driving import LEFT, Mouse, arrow_grip, document, drag, idle, ring_grip, show, work_off
from kept_window import opened_in, widened
from PySide6.QtCore import QPoint, QRect, QSize, Qt

from apd_viewer.files.samples import resource_path
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.solver.convergence import Convergence
from apd_viewer.session.model.state import initial_state
from apd_viewer.ui.application import build_workbench
from apd_viewer.ui.help.tour_card import card_placement
from apd_viewer.ui.shell import Shell
from apd_viewer.ui.tools.tool_modes import Tool


@pytest.fixture
def bottle(qtbot, kept_window, painted_bottle):
    """A coarser one in the place of the sample: the tour is about no other mesh."""
    mesh, labels = painted_bottle.document.mesh, painted_bottle.document.labels
    there = resource_path("bottle.obj")
    return opened_in(qtbot, kept_window, lambda: initial_state(Mesh(mesh.V, mesh.F, there), labels))


@pytest.fixture
def toured(qtbot, bottle):
    """The bottle, with the tour at its first step."""
    bottle.actions_.help["tour"].trigger()
    assert bottle.help.tour.step_number == 0
    return bottle


@pytest.fixture
def first(qtbot, settings):
    """Starts the program once more with the same settings, on the bottle or on a mesh of its own."""
    made = []

    def begin(on_bottle=True):
        shell = Shell(settings)
        show(qtbot, shell, shell.canvas.viewport)
        if on_bottle:
            shell.requests.open_sample("bottle")
        else:
            shell.requests.show_mesh(Mesh(*meshes.sphere(2)))
        window = build_workbench(shell, None, on_bottle)
        made.append(window)
        gc.unfreeze()
        idle(qtbot, window)
        work_off()
        return window

    yield begin
    for window in made:
        window.files.may_discard_work = lambda *_, **__: True
        window.shell.close()
        window.shell.deleteLater()
    work_off()


def go_to(qtbot, window, number):
    while window.help.tour.step_number < number:
        qtbot.mouseClick(window.help.tour.card.next, LEFT)


def card(window):
    return window.help.tour.card


def turn(qtbot, window):
    drag(qtbot, window, ring_grip(window, 1), (60, 0), steps=6)


# When it comes


def test_tour_comes_at_the_first_start_of_all_and_never_again(qtbot, first, settings):
    window = first()
    assert window.help.tour.step_number == 0
    assert card(window).isVisible()
    assert settings.value("tour", type=bool)
    window.shell.close()
    assert first().help.tour.is_active is False


def test_tour_bothers_nobody_who_opens_a_file_at_the_first_start(qtbot, first):
    window = first(on_bottle=False)
    assert not window.help.tour.is_active
    window.files.open_sample("bottle")
    idle(qtbot, window)
    work_off()
    assert not window.help.tour.is_active
    window.shell.close()
    assert not first().help.tour.is_active


def test_tour_is_not_begun_by_a_window_alone(qtbot, bottle, settings):
    assert not bottle.help.tour.is_active
    assert settings.value("tour") is None
    assert bottle.invitation.isVisible()


def test_tour_can_be_asked_for_on_the_bottle_and_on_another_mesh(qtbot, bottle):
    before = document(bottle).mesh
    bottle.actions_.help["tour"].trigger()
    assert bottle.help.tour.step_number == 0
    assert document(bottle).mesh is before, "nothing is opened that is open already"
    qtbot.keyClick(card(bottle), Qt.Key.Key_Escape)
    bottle.files.open_sample("duck")
    idle(qtbot, bottle)
    bottle.actions_.help["tour"].trigger()
    assert not bottle.help.tour.is_active, "it waits for the bottle"
    idle(qtbot, bottle)
    qtbot.waitUntil(lambda: bottle.help.tour.step_number == 0)
    assert document(bottle).mesh.path.name == "bottle.obj"


@pytest.mark.parametrize(("method", "holds"), [("exact", True), ("arap", False), ("paper", True)])
def test_tour_says_what_the_method_does_to_the_area(qtbot, toured, method, holds):
    toured.session.settings.change(method=method)
    go_to(qtbot, toured, 2)
    assert ("the area does not" in card(toured).sentence.text()) is holds
    assert ("Exact keeps it" in card(toured).sentence.text()) is not holds
    toured.session.settings.change(method="exact")
    qtbot.waitUntil(lambda: "the area does not" in card(toured).sentence.text())


def test_tour_ends_with_another_mesh(qtbot, toured):
    toured.files.open_sample("duck")
    idle(qtbot, toured)
    assert not toured.help.tour.is_active
    assert not card(toured).isVisible()


# Going through it


def test_tour_goes_on_and_back_to_the_end(qtbot, toured):
    tour, said = toured.help.tour, []
    assert not card(toured).back.isVisible()
    for number in range(5):
        assert tour.step_number == number
        said.append(card(toured).sentence.text())
        assert f"{number + 1} of 5" in card(toured).accessibleName()
        if number < 4:
            qtbot.mouseClick(card(toured).next, LEFT)
    assert len(set(said)) == 5
    assert card(toured).next.text() == "Done"
    qtbot.mouseClick(card(toured).back, LEFT)
    assert tour.step_number == 3
    assert card(toured).sentence.text() == said[3]
    go_to(qtbot, toured, 4)
    qtbot.mouseClick(card(toured).next, LEFT)
    assert not tour.is_active
    assert not card(toured).isVisible()
    assert not card(toured).tip.isVisible()


@pytest.mark.parametrize("way", ["skip", "esc", "esc on the canvas"])
def test_tour_is_skipped(qtbot, toured, way):
    go_to(qtbot, toured, 1)
    if way == "skip":
        qtbot.mouseClick(card(toured).skip, LEFT)
    elif way == "esc":
        qtbot.keyClick(card(toured).next, Qt.Key.Key_Escape)
    else:
        toured.canvas.viewport.setFocus()
        qtbot.keyClick(toured.canvas.viewport, Qt.Key.Key_Escape)
    assert not toured.help.tour.is_active
    assert not card(toured).isVisible()
    assert toured.canvas.tool is Tool.MOVE
    assert toured.shell.focusWidget() is toured.canvas.viewport


def test_tour_card_is_used_by_keys_alone(qtbot, toured):
    toured.shell.activateWindow()
    qtbot.waitUntil(toured.shell.isActiveWindow)
    card(toured).next.setFocus()
    qtbot.keyClick(card(toured).next, Qt.Key.Key_Return)
    assert toured.help.tour.step_number == 1
    qtbot.keyClick(card(toured).next, Qt.Key.Key_Tab, Qt.KeyboardModifier.ShiftModifier)
    assert toured.shell.focusWidget() is card(toured).back
    qtbot.keyClick(card(toured).back, Qt.Key.Key_Space)
    assert toured.help.tour.step_number == 0


def test_tour_moves_on_with_a_turn_of_the_ring_and_a_look_at_the_area(qtbot, toured):
    tour = toured.help.tour
    toured.session.settings.change(convergence=Convergence(energy_tolerance=1e-3))  # it rests the sooner
    go_to(qtbot, toured, 1)
    drag(qtbot, toured, arrow_grip(toured, 0), (30, 0), steps=3)
    assert tour.step_number == 1, "a move is no turn"
    turn(qtbot, toured)
    assert tour.step_number == 2
    idle(qtbot, toured)
    work_off()
    tour.update_target()
    assert tour.step_number == 2, "it is asked for once more"
    turn(qtbot, toured)
    assert tour.step_number == 2, "the area is there to be read"
    idle(qtbot, toured)
    qtbot.waitUntil(lambda: tour.step_number == 3)


def test_tour_does_not_move_on_with_a_turn_that_is_taken_back(qtbot, toured):
    go_to(qtbot, toured, 1)
    mouse, at = Mouse(toured.canvas.viewport), np.asarray(ring_grip(toured, 1))
    mouse.move(at)
    mouse.press(at)
    mouse.move(at + (30, 0))
    toured.canvas.viewport.setFocus()
    qtbot.keyClick(toured.canvas.viewport, Qt.Key.Key_Escape)
    mouse.release(at + (30, 0))
    assert toured.help.tour.step_number == 1, "Esc gave the drag up, and no more"


# What it leaves alone


def test_next_step_hint_is_silent_during_the_tour(qtbot, toured):
    assert not toured.invitation.isVisible()
    toured.tools.choose_tool(Tool.BASE)
    toured.tools.choose_tool(Tool.MOVE)
    assert not toured.invitation.isVisible()
    qtbot.mouseClick(card(toured).skip, LEFT)
    assert toured.invitation.isVisible()


def test_tour_blocks_nothing(qtbot, toured):
    before = toured.canvas.viewport.camera_controller.camera.key
    Mouse(toured.canvas.viewport).drag((30, 500), (80, 520), (120, 520))
    assert toured.canvas.viewport.camera_controller.camera.key != before
    toured.actions_.tools[Tool.HANDLE].trigger()
    assert toured.canvas.tool is Tool.HANDLE
    tip, area = card(toured).tip.geometry(), card(toured).geometry()
    beside = tip.center()
    assert not area.contains(beside)
    assert toured.shell.childAt(beside) is not card(toured).tip, "the mouse goes through the tip"
    assert toured.help.tour.is_active


def test_tour_takes_the_ring_into_the_hand_and_says_where_it_is_gone(qtbot, toured):
    toured.tools.choose_tool(Tool.BASE)
    go_to(qtbot, toured, 1)
    assert toured.canvas.tool is Tool.MOVE
    sentence = card(toured).sentence.text()
    toured.tools.choose_tool(Tool.ORBIT)
    toured.help.tour.update_target()
    assert "Move handle" in card(toured).sentence.text()
    assert not card(toured).tip.isVisible()
    toured.tools.choose_tool(Tool.MOVE)
    toured.help.tour.update_target()
    assert card(toured).sentence.text() == sentence


def test_tour_says_where_the_area_is_when_the_readings_are_hidden(qtbot, toured):
    go_to(qtbot, toured, 2)
    toured.docks["readings"].hide()
    qtbot.waitUntil(lambda: "View menu" in card(toured).sentence.text())


def test_tour_hides_for_a_while_beneath_the_sheet_of_shortcuts(qtbot, toured):
    toured.actions_.help["shortcuts"].trigger()
    assert not card(toured).isVisible()
    assert not card(toured).tip.isVisible()
    qtbot.keyClick(toured.help.sheet.search, Qt.Key.Key_Escape)
    assert card(toured).isVisible()
    toured.help.tour.update_target()
    assert card(toured).tip.isVisible()
    toured.actions_.help["shortcuts"].trigger()
    toured.actions_.help["tour"].trigger()
    assert not toured.help.sheet.isVisible()
    assert toured.help.tour.step_number == 0


# Where it stands


@pytest.mark.parametrize("size", [(800, 640), (1280, 800)])
def test_tour_card_stays_within_the_window_beside_what_it_speaks_of(qtbot, toured, size):
    toured.shell.resize(*size)
    work_off()
    tour, places = toured.help.tour, toured.help.tour.targets
    targets = places.mesh, places.rings, places.area, places.brushes, places.export
    for number, place in enumerate(targets):
        assert tour.step_number == number
        work_off()
        tour.update_target()
        work_off()
        area, target = card(toured).geometry(), place()
        assert toured.shell.rect().contains(area)
        assert not area.intersects(target)
        tip = card(toured).tip
        assert tip.isVisible()
        assert toured.shell.rect().contains(tip.geometry())
        assert tip.geometry().adjusted(-2, -2, 2, 2).intersects(target), "it reaches what it points at"
        if number in (1, 2):
            assert not area.intersects(places.gizmo()), "the ring can be dragged"
        text = card(toured).sentence
        text.setMinimumHeight(0)
        assert text.height() == text.heightForWidth(text.width()), "no more and no less"
        qtbot.mouseClick(card(toured).next, LEFT)


def test_tour_card_follows_what_it_points_at(qtbot, toured):
    widened(qtbot, toured)
    go_to(qtbot, toured, 1)
    before = card(toured).pos()
    view = toured.canvas.viewport
    view.camera_controller.camera = view.camera_controller.camera.panned(60, 30)
    qtbot.waitUntil(lambda: card(toured).pos() != before)
    assert (card(toured).pos() - before - QPoint(60, 30)).manhattanLength() < 8


@pytest.mark.parametrize("target", [QRect(0, 0, 40, 40), QRect(760, 600, 40, 40), QRect(300, 200, 200, 400)])
def test_card_placement_puts_a_card_beside_its_target_wherever_that_is(target):
    room = QRect(8, 30, 784, 580)
    rect, _ = card_placement(QSize(288, 120), target, room, QRect())
    assert room.contains(rect)
    assert not rect.intersects(target)
