"""Costs of a frame, a move of the mouse and a picture, counted and not timed."""

import dataclasses
import threading

import numpy as np
import pytest
from driving import Mouse, arrow_grip, document, idle, on_screen, settle, stroke, work_off
from kept_window import widened

from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.picking import surface_index as skins
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE
from apd_viewer.session.processes.solver_worker import SolverWorker
from apd_viewer.ui.tools.tool_modes import Tool


@pytest.fixture
def bottle(new_bottle):
    """A window of each test's own: its solver is kept from answering."""
    return new_bottle


@pytest.fixture
def work(bottle, monkeypatch):
    """What the surface of the bottle is made to do, by name; a colouring by its number of vertices."""
    done, surface = [], bottle.canvas.surface
    set_points, set_colors = surface.set_points, surface.set_colors
    monkeypatch.setattr(surface, "set_points", lambda U: done.append("points") or set_points(U))
    monkeypatch.setattr(
        surface, "set_colors", lambda rgba, ids=None: done.append(len(rgba)) or set_colors(rgba, ids)
    )
    monkeypatch.setattr(
        skins, "block_boxes", lambda U, F, make=skins.block_boxes: done.append("boxes") or make(U, F)
    )
    return done


def answer(window, U):
    """Show a shape as a frame of the worker is shown."""
    stage = window.session.store
    stage.set_state(stage.state.updated(frame=dataclasses.replace(stage.state.frame, U=frozen(U))))


def test_viewport_draws_nothing_for_a_move_of_the_handle_until_there_is_a_frame(
    qtbot, bottle, work, monkeypatch
):
    view = bottle.canvas.viewport
    settle(qtbot, view)
    monkeypatch.setattr(SolverWorker, "put_request", lambda *_: None)
    mouse, at = Mouse(view), arrow_grip(bottle, 0)
    mouse.move(at)
    mouse.press(at)
    draws = view.draw_count
    for k in range(1, 6):
        mouse.move(at + [10.0 * k, 0.0])
        work_off()
    assert document(bottle).is_posed
    assert (work, view.draw_count) == ([], draws)
    answer(bottle, document(bottle).mesh.V * [1.1, 1.0, 1.0])
    settle(qtbot, view)
    assert (work, view.draw_count) == (["points"], draws + 1)
    mouse.release(at + [50.0, 0.0])


def test_document_does_not_look_again_at_what_a_frame_leaves_as_it_is(bottle, monkeypatch):
    bottle.actions_.display.switches["shadow"].trigger()  # which counts, too
    before = document(bottle)
    held = before.label_counts, before.centre(0), before.paint_problem
    bincount, here = np.bincount, threading.get_ident()

    def not_here(*args, **options):  # the solver is a thread here, and may count as it likes
        assert threading.get_ident() != here
        return bincount(*args, **options)

    monkeypatch.setattr(np, "bincount", not_here)
    monkeypatch.setattr(SolverWorker, "put_request", lambda *_: None)
    for k in range(3):
        bottle.session.gestures.begin()
        bottle.session.handles.drag((1.0 + 0.01 * k) * np.eye(4))
        answer(bottle, before.mesh.V * (1.0 + 0.01 * k))
    now = document(bottle)
    assert now is not before
    assert all(
        a is b for a, b in zip((now.label_counts, now.centre(0), now.paint_problem), held, strict=True)
    )


def test_coloring_colors_what_a_stroke_paints_and_leaves_the_points(qtbot, bottle, work):
    widened(qtbot, bottle)
    work.clear()
    bottle.tools.choose_tool(Tool.BASE)
    V, before = document(bottle).mesh.V, document(bottle).labels
    front = np.flatnonzero((V[:, 2] > 0.5) & (abs(V[:, 0]) < 0.3) & (before == FREE))
    middle = front[np.argmin(abs(V[front, 1] - np.median(V[front, 1])))]
    stroke(qtbot, bottle, on_screen(bottle, middle))
    painted = np.flatnonzero(document(bottle).labels != before)
    colored = [count for count in work if count not in ("boxes", "points")]
    assert len(painted) > 20
    assert sum(colored) == len(painted)
    assert "points" not in work
    rgba = np.asarray(bottle.canvas.surface.arrays.rgba)
    assert len(np.unique(rgba[document(bottle).labels == BASE], axis=0)) == 1
    assert len(np.unique(rgba[document(bottle).labels == HANDLE], axis=0)) == 1


def test_surface_shares_the_boxes_of_a_shape_between_rays(bottle, work):
    bottle.tools.choose_tool(Tool.BASE)
    mouse, view = Mouse(bottle.canvas.viewport), bottle.canvas.viewport
    middle = np.array([view.width() / 2, view.height() / 2])
    for k in range(5):
        mouse.move(middle + [k, 0])
    assert work.count("boxes") <= 1
    answer(bottle, document(bottle).mesh.V * 1.01)
    for k in range(5):
        mouse.move(middle + [k, 0])
    assert work.count("boxes") <= 2
    hit = bottle.canvas.surface.hit(view.rect().center())
    assert (
        np.linalg.norm(hit.point[[0, 2]])
        > 1.005 * np.linalg.norm(document(bottle).mesh.V[:, [0, 2]], axis=1).min()
    )


def test_viewport_box_that_the_camera_clips_at_is_that_of_the_shape(qtbot, bottle):
    """VTK is not asked for it: that costs a look at all triangles for each frame."""
    view = bottle.canvas.viewport
    bottle.actions_.display.switches["shadow"].trigger()
    answer(bottle, document(bottle).mesh.V * [3.0, 1.0, 5.0])
    settle(qtbot, view)
    np.testing.assert_allclose(view.box(), view.renderer.ComputeVisiblePropBounds(), atol=1e-5)
    near, far = view.renderer.GetActiveCamera().GetClippingRange()
    depth = view.camera_controller.camera.depth(bottle.session.store.state.frame.U)
    assert near <= depth.min()
    assert depth.max() <= far


def test_show_state_takes_a_mesh_that_was_made_ready_before_the_window_has_it(qtbot, bottle, monkeypatch):
    """Nothing that only depends on the triangles is found out on the thread of the window."""
    monkeypatch.setattr(skins.SurfaceIndex, "from_triangles", None)
    state = bottle.session.store.state
    for _ in range(2):
        bottle.canvas.show_state(None, state, 0, 0)
    assert bottle.canvas.surface.surface_index is state.surface_index
    idle(qtbot, bottle)
