"""A session on a mesh far from the origin: dragged, saved, exported and written as a deck."""

import numpy as np
from driven_session import BENT, Driven
from meshes import box

from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.presentation.obstacle_readings import coordinates_text
from apd_viewer.session.model.view import View
from apd_viewer.session.storage.session_file import open_session, save_session

V, F = box(2, 2, 6)
FAR = 2.0**23 * np.array([1.0, 0.5, -1.0])


def dragged(session: Driven, place):
    """The session on the bar at a place, its upper end moved."""
    session.show_now(Mesh(V + place, F))
    session.paint_ends()
    session.settings.set_contact(True)
    pose = BENT.copy()
    pose[:3, 3] += place - pose[:3, :3] @ place
    session.drag(pose)
    session.settle()
    return session.store.state


def test_handle_editor_drag_far_away_is_the_drag_near(empty, tmp_path):
    near = dragged(empty, np.zeros(3)).frame
    state = dragged(empty, FAR)
    far = state.frame
    assert far.converged
    assert abs(far.area_error) < 1e-9
    assert np.abs(far.U - FAR - near.U).max() < 1e-6, "the pose itself is rounded"
    save_session(tmp_path / "far.apd", state, View())
    assert np.array_equal(open_session(tmp_path / "far.apd")[0].frame.U, far.U)
    save_mesh(state.document.mesh, far.U, tmp_path / "far.obj")
    assert np.abs(open_mesh(tmp_path / "far.obj").V - far.U).max() < 1e-8, "it has 15 digits"


def test_coordinates_text_keep_the_digits_of_typed_places():
    place = FAR + [0.125, 0.0625, -0.03125]
    said = [float(word) for word in coordinates_text(place, 6.0, 5).split(",")]
    assert np.abs(said - place).max() < 1e-4 * 6.0
    assert coordinates_text(np.array([1.5, -20.0, 0.0]), 6.0, 5) == "1.5, -20, 0"
