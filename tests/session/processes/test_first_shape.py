"""What a solver does ahead of the first shape of a drag."""

import numpy as np
import pytest
from driven_session import pose
from meshes import box
from remote_factor_double import Elsewhere

from apd_viewer.geometry.energy import solve_mesh
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, HANDLE
from apd_viewer.geometry.solver import coarse_level
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.processes import request_solver
from apd_viewer.session.processes.mailbox import Mailbox
from apd_viewer.session.processes.request_and_reply import Request
from apd_viewer.session.processes.request_solver import RequestSolver

MESH = Mesh(*box(20, 20, 40))


class Far(Elsewhere):
    """A factor that never comes."""

    there = False

    def begin(self):
        pass

    def close(self):
        pass


@pytest.fixture
def prolongations(monkeypatch):
    """Interpolations to fine surfaces that are computed."""
    found, plain = [], coarse_level.Prolongation
    for module in (coarse_level, solve_mesh):
        monkeypatch.setattr(module, "Prolongation", lambda *given: found.append(given) or plain(*given))
    monkeypatch.setattr(request_solver, "REMOTE_FACTOR_ROWS", 2500)
    monkeypatch.setattr(request_solver, "RemoteFactor", Far)
    return found


def painted():
    z = MESH.V[:, 2]
    document = initial_state(MESH).document.with_settings(contact=False)
    document = document.with_label(np.flatnonzero(z == z.min()), BASE)
    return document.with_label(np.flatnonzero(z == z.max()), HANDLE)


def test_request_solver_prepares_the_first_shape_once_all_is_painted(prolongations):
    requests, document, shapes = Mailbox(), painted(), []
    dragged = Request(document.with_pose(0, pose(0.3)), 0, MESH.V, iterate=True)

    def take(reply):
        if reply.frame is not None:
            shapes.append(reply.frame.U)
            requests.put(dragged)  # ends the iterations, which would wait for a factor

    solver = RequestSolver(requests, take)
    solver.answer(Request(document, 0, MESH.V, iterate=False))
    assert len(prolongations) == 1
    assert not shapes
    solver.answer(dragged)
    assert len(prolongations) == 1
    assert np.abs(shapes[0] - MESH.V).max() > 0.1


def test_request_solver_prepares_nothing_for_who_waits_already(prolongations, monkeypatch):
    requests, prepared = Mailbox(), []
    monkeypatch.setattr(request_solver, "prepare_previews", prepared.append)
    requests.put(Request(painted().with_pose(0, pose(0.3)), 0, MESH.V, iterate=True))
    RequestSolver(requests, lambda _: None).answer(Request(painted(), 0, MESH.V, iterate=False))
    assert not prepared
