"""A window that can be seen before it can work."""

import re
import subprocess
import sys

import numpy as np
import pytest
from driving import Mouse, centre, document, idle, settle, show
from PySide6.QtCore import QPoint
from PySide6.QtGui import QGuiApplication

from apd_viewer.files.samples import open_sample
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.ui.tools.toolbox import Tool
from apd_viewer.ui.window import Window


@pytest.fixture
def early(qtbot, settings):
    """A window that has not started."""
    window = Window(settings)
    show(qtbot, window, window.canvas.viewport)
    yield window
    window.close()
    window.deleteLater()
    qtbot.wait(10)


def test_the_last_wish_is_opened_at_the_start(qtbot, early):
    early.filing.open_path("gone.obj")
    early.filing.open_sample("bottle")
    early.filing.show_mesh(Mesh(np.eye(3), np.array([[0, 1, 2]])))
    early.filing.open_sample("duck")
    early.start()
    idle(qtbot, early)
    assert document(early).mesh.path.name == "duck.obj"
    assert not early.notice.text


def test_nothing_breaks_before_the_start(qtbot, early):
    for action in (*early.actions_.tools.values(), early.actions_.undo, *early.actions_.pose.parts):
        action.trigger()
    mouse = Mouse(early.canvas.viewport)
    mouse.drag(centre(early.canvas.viewport), QPoint(30, 30))
    assert not early.panel.isEnabled()
    early.start()
    assert early.panel.isEnabled() is False
    assert early._empty.isVisible(), "there is nothing to show, and that is said"


def test_a_window_that_is_closed_before_the_start_starts_nothing(early):
    early.filing.open_sample("bottle")
    assert early.close()
    early.start()
    assert not hasattr(early, "session")


def test_the_bottle_is_seen_before_the_start_and_not_touched(qtbot, early):
    view = early.canvas.viewport
    mesh, labels = open_sample("bottle")
    empty = view.screenshot().copy() if QGuiApplication.platformName() != "offscreen" else None
    early.canvas.sketch(mesh, labels)
    early.filing.open_sample("bottle")
    settle(qtbot, view)
    early.take(Tool.BASE)
    mouse, framed = Mouse(view), view.eye.key
    mouse.drag(centre(view), centre(view) + QPoint(20, 0))  # which is no stroke, but turns the camera
    moved = view.eye.key
    early.start()
    idle(qtbot, early)
    assert moved != framed
    assert view.eye.key == moved, "the camera stays where it was turned to"
    assert np.array_equal(document(early).labels, labels)
    if empty is not None:
        view._still.stop()
        assert (view.screenshot() != empty).any()


def test_the_sketch_and_the_opened_mesh_look_alike(qtbot, early):
    if QGuiApplication.platformName() == "offscreen":
        pytest.skip("the offscreen platform has no OpenGL, so there is no picture to compare")
    view = early.canvas.viewport
    early.canvas.sketch(*open_sample("bottle"))
    early.filing.open_sample("bottle")
    sketch = view.screenshot().astype(int)
    early.start()
    idle(qtbot, early)
    assert np.abs(view.screenshot().astype(int) - sketch).max() <= 3


def test_the_sketch_leaves_room_for_the_gizmo(qtbot, early):
    early.canvas.sketch(*open_sample("bottle"))
    early.filing.open_sample("bottle")
    sketched = early.canvas.viewport.eye
    early.start()
    idle(qtbot, early)
    early.canvas.frame_mesh()
    np.testing.assert_allclose(early.canvas.viewport.eye.position, sketched.position, rtol=1e-9)


def test_another_mesh_than_the_sketched_one_is_framed(qtbot, early):
    early.canvas.sketch(*open_sample("bottle"))
    early.filing.open_sample("duck")
    before = early.canvas.viewport.eye.key
    early.start()
    idle(qtbot, early)
    assert early.canvas.viewport.eye.key != before


MISSING = """
import sys
sys.modules[{!r}] = None
from apd_viewer.__main__ import main
sys.exit(main([]))
"""


@pytest.mark.parametrize("library", ["numba", "cholespy", "pyvistaqt"])
def test_a_library_that_is_missing_behind_the_first_picture_is_a_sentence_too(library):
    done = subprocess.run(
        [sys.executable, "-c", MISSING.format(library)],
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    assert done.returncode == 2
    assert re.fullmatch(rf"error: The window needs a library that is missing .*{library}.+\n", done.stderr)
