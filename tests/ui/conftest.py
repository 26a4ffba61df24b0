"""A real application, a real mouse, and windows that leave nothing behind."""

import os
from functools import partial

import numpy as np
import pytest
import trimesh
from choosing import Theatre
from driving import Mouse, grey, idle, settle, show
from in_thread import LateSolver, ServedInThread
from kept_window import at_rest, bottle_in, close_window, lasting_window, open_window, settings_in
from meshes import sample_bottle
from PySide6.QtWidgets import QMainWindow
from shiboken6 import isValid

from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.picking.surface_index import SurfaceIndex
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.processes import (
    geodesic_finder,
    geodesic_main,
    shape_check_main,
    shape_checker,
    solver_main,
)
from apd_viewer.ui.application import HARMLESS_MESSAGE
from apd_viewer.ui.filing import file_controller
from apd_viewer.ui.filing.file_controller import UnsavedAnswer
from apd_viewer.ui.scene import surface_shading
from apd_viewer.ui.scene.surface import Surface
from apd_viewer.ui.scene.viewport import Viewport
from apd_viewer.ui.shell import Shell
from apd_viewer.ui.workbench import Workbench


def pytest_configure(config):
    config.addinivalue_line("qt_log_ignore", HARMLESS_MESSAGE)
    if os.environ.get("QT_QPA_PLATFORM") == "offscreen":  # all but the pixels works without OpenGL
        config.addinivalue_line("qt_log_ignore", "QOpenGLWidget")


@pytest.fixture
def qtbot(qtbot):
    """One that is patient: a busy machine is slow, and a wait for what comes ends when it has come."""
    qtbot.waitUntil = partial(qtbot.waitUntil, timeout=60_000)
    return qtbot


@pytest.fixture(autouse=True)
def smooth_frames(monkeypatch):
    """A view at rest is not drawn once more, with smooth edges, unless the test is about that."""
    monkeypatch.setattr(surface_shading, "IDLE_DELAY", 10**6)


@pytest.fixture(autouse=True)
def solver_prepares_late(monkeypatch):
    """The solver that is a thread prepares nothing ahead."""
    monkeypatch.setattr(solver_main, "RequestSolver", LateSolver)


@pytest.fixture(autouse=True)
def found_by_threads(monkeypatch):
    """Threads check shapes and find geodesics; processes would load their libraries for each report."""
    for client, main in ((shape_checker, shape_check_main), (geodesic_finder, geodesic_main)):
        monkeypatch.setattr(client, "ChildProcess", partial(ServedInThread, main.serve))


@pytest.fixture
def mouse():
    """Factory of a mouse for a widget."""
    return Mouse


@pytest.fixture
def view(qtbot):
    """A viewport in a shown window, 640 x 480, without a scene."""
    window = QMainWindow()
    view = Viewport(window)
    window.setCentralWidget(view)
    window.resize(640, 480)
    show(qtbot, window, view)
    yield view
    view.close()
    window.close()
    window.deleteLater()
    qtbot.waitUntil(lambda: not isValid(window))


@pytest.fixture(scope="session")
def ball():
    """A sphere of radius one with 10242 vertices: (F, U)."""
    mesh = trimesh.creation.icosphere(subdivisions=5)
    return np.array(mesh.faces), np.array(mesh.vertices)


@pytest.fixture
def surface(qtbot, view, ball):
    """The ball in the viewport, seen from the front."""
    F, U = ball
    surface = Surface(view)
    surface.set_mesh(SurfaceIndex.from_triangles(F, len(U)), U, grey(len(U)))
    view.camera_controller.show_standard_view("front")
    view.camera_controller.frame(U)
    settle(qtbot, view)
    return surface


@pytest.fixture(scope="session")
def stored(tmp_path_factory):
    """The settings of all windows."""
    return settings_in(tmp_path_factory.mktemp("settings"))


@pytest.fixture
def settings(stored):
    """They, empty."""
    yield stored
    stored.clear()


@pytest.fixture
def unasked(monkeypatch):
    """Windows do not ask before they are closed."""
    monkeypatch.setattr(file_controller, "ask_before_leaving", lambda *_: UnsavedAnswer.DISCARD)


@pytest.fixture(scope="session")
def kept(qapp, stored):
    """The window of all files of tests: to open one takes half a second of the processor."""
    with lasting_window(stored) as kept:
        yield kept


@pytest.fixture(scope="module")
def unused(qapp, stored):
    """A window that no other file of tests has used."""
    with lasting_window(stored) as kept:
        yield kept
    stored.clear()


@pytest.fixture
def window(qtbot, settings, unasked):
    """A window of the test's own, without a mesh."""
    window = open_window(qtbot, settings)
    yield window
    close_window(qtbot, window)


@pytest.fixture
def kept_window(qtbot, kept, unasked):
    """The window of all tests, as it was opened, for one that opens a mesh."""
    yield kept.opened(qtbot)
    kept.reset(qtbot)


@pytest.fixture(scope="session")
def painted_bottle(tmp_path_factory):
    """State of the sample bottle with a ninth of its vertices, painted."""
    V, F, labels = sample_bottle(edge=3.0)
    path = tmp_path_factory.mktemp("sample") / "bottle.obj"
    save_mesh(Mesh(V, F), V, path)
    return initial_state(open_mesh(path), labels.astype(np.uint8))


@pytest.fixture
def bottle(qtbot, kept_window, painted_bottle):
    """The window of all tests on the bottle, painted, as if it had just been opened."""
    return bottle_in(qtbot, kept_window, painted_bottle)


@pytest.fixture
def new_bottle(qtbot, window, painted_bottle):
    """A window of the test's own on the bottle, painted."""
    return bottle_in(qtbot, window, painted_bottle)


@pytest.fixture
def sample(qtbot, kept_window):
    """The window of all tests on the sample bottle itself, painted."""
    kept_window.session.files.open_sample("bottle")
    return at_rest(qtbot, kept_window)


@pytest.fixture
def folder(tmp_path):
    """Where windows keep what is done, for the case of a crash."""
    return tmp_path / "recovery"


@pytest.fixture
def started(qtbot, folder, settings, unasked, painted_bottle):
    """Starts a window on a bottle in no file that keeps what is done in the folder, and closes it at last."""
    windows, document = [], painted_bottle.document

    def start():
        shell = Shell(settings)
        window = Workbench(shell, folder)
        mesh = Mesh(document.mesh.V, document.mesh.F)
        window.session.files.open_result("bottle", lambda: initial_state(mesh, document.labels))
        show(qtbot, shell, window.canvas.viewport)
        idle(qtbot, window)
        windows.append(window)
        return window

    yield start
    for window in windows:
        close_window(qtbot, window)


@pytest.fixture(scope="module")
def theatre(qapp, tmp_path_factory):
    """A window for all tests of a file in which vertices are chosen."""
    yield from Theatre.opened(tmp_path_factory.mktemp("settings"))


@pytest.fixture
def scene(qtbot, theatre):
    """The rabbit in it, as it was when it was opened."""
    return theatre.scene(qtbot)
