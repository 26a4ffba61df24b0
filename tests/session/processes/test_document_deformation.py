"""Shapes that walk along winding paths with contact."""

import numpy as np
import pytest
from meshes import ends, tube

from apd_viewer.geometry.analysis.self_intersections import crossings
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, HANDLE
from apd_viewer.geometry.pose.transforms import twist
from apd_viewer.geometry.solver.path_iteration import PathIteration
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.processes.document_deformation import deformation_of, document_iteration


def twisted_tube(degrees: int) -> Document:
    mesh = Mesh(*tube(8, 5))
    base, top = ends(mesh.V)
    document = initial_state(mesh).document.with_label(base, BASE).with_label(top, HANDLE)
    middles = mesh.V[base].mean(axis=0), mesh.V[top].mean(axis=0)
    for angle in range(0, degrees + 1, 20):
        document = document.with_handle_moved(0, twist(*middles, np.deg2rad(angle)))
    return document.with_settings(contact=True)


def walked(document: Document) -> PathIteration:
    """A walk to its end, every third shape on the way and the last one looked at."""
    solver = deformation_of(document, document.constraints())
    walk = document_iteration(solver, document)
    for count in range(8000):
        walk.iterate()
        done = walk.has_arrived and solver.settled
        assert (count % 3 and not done) or len(crossings(walk.frame().U, document.mesh.joined_F)) == 0
        if done:
            break
    return walk


def test_document_iteration_reaches_each_stop_before_it_aims_at_the_next():
    document = twisted_tube(220)
    assert document.has_half_turn
    frame = walked(document).frame()
    held = document.constraints()
    assert np.abs(frame.U[held.fixed] - held.targets).max() < 1e-12
    assert (frame.share_reached, frame.unreached) == (1.0, None)


@pytest.mark.night
def test_document_iteration_that_contact_stops_ends_there_and_tells_the_share_of_the_whole():
    document = twisted_tube(720)
    walk = walked(document)
    frame = walk.frame()
    assert walk.has_arrived
    assert frame.settled
    assert not frame.converged
    assert frame.unreached == f"Contact stops the handle at {int(100 * frame.share_reached)} % of the path."
    turned = 720.0 * frame.share_reached
    assert 180.0 < turned < 720.0
    top = document.labels == HANDLE
    here, rest = frame.U[top][:, :2], document.mesh.V[top][:, :2]
    here, rest = here - here.mean(axis=0), rest - rest.mean(axis=0)
    far = np.argmax(np.linalg.norm(rest, axis=1))
    angle = np.arctan2(*here[far][::-1]) - np.arctan2(*rest[far][::-1])
    assert np.cos(angle - np.deg2rad(turned)) == pytest.approx(1.0, abs=1e-3)
