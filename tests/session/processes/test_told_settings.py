"""A change of a setting is never ignored: a running solver is told it, or is replaced."""

import numpy as np
import pytest
from driven_session import pose
from meshes import box

from apd_viewer.geometry.energy.wall_map import wall_map_of
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, HANDLE
from apd_viewer.geometry.pose.frame import Frame
from apd_viewer.geometry.solver.convergence import Convergence
from apd_viewer.geometry.solver.settings import SETTINGS
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.processes.mailbox import Mailbox
from apd_viewer.session.processes.request_and_reply import Reply, Request
from apd_viewer.session.processes.request_solver import RequestSolver

FREE, LOCAL, WALL = {"contact": False}, {"method": "local"}, {"method": "wall"}
SOON = {"convergence": Convergence(40)}  # enough for a difference, where coming to rest takes long
# For each setting others by which it matters, and a value that is not the default.
CHANGES = {
    "method": (FREE, "arap"),
    "stiffness": (FREE, 0.1),
    "area_stiffness": (FREE | LOCAL, 2.0),
    "shear_stiffness": (FREE | LOCAL, 2.0),
    "wall_thickness": (FREE | WALL, 0.2),
    "poisson": (FREE | WALL, 0.1),
    "tension_field": (FREE | WALL | SOON, True),
    "area": (FREE, 120.0),
    "volume": (FREE, 80.0),
    "filled_volume": (FREE, 7.0),
    "tolerance": (FREE | {"method": "paper"}, 0.1),
    "hold_area": (FREE | LOCAL, True),
    "calm": (FREE, False),
    "contact": (FREE, True),
    "thickness": ({"contact": True}, 0.3),
    "yield_radius": ({"contact": True, "stiffness": 0.01}, 5.0),
    "hardening": (WALL | SOON | {"contact": True, "wall_thickness": 0.2, "yield_radius": 30.0}, 0.5),
    "gas": ({"contact": True}, 0.5),
    "pressure": (FREE | WALL, 0.5),
    "convergence": (FREE, Convergence(3)),
}


class Asked:
    """A solver that answers at once."""

    def __init__(self) -> None:
        self._replies: list[Reply] = []
        self._solver = RequestSolver(Mailbox(), self._replies.append)

    def last_frame(self, document: Document, generation: int) -> Frame:
        self._solver.answer(Request(document, generation, document.mesh.V, iterate=True))
        return self._replies[-1].frame


def folded() -> Document:
    """A bar, folded so that its walls touch; both of its ends are free, and calm."""
    mesh = Mesh(*box(2, 2, 10))
    z = mesh.V[:, 2]
    document = initial_state(mesh).document.with_label(np.flatnonzero(z == 2.0), BASE)
    return document.with_label(np.flatnonzero(z == 7.0), HANDLE).with_pose(0, pose(2.0))


@pytest.mark.parametrize("name", SETTINGS)
def test_request_solver_gives_after_any_change_of_a_setting_what_a_new_one_gives(name):
    others, value = CHANGES[name]
    before = folded().with_settings(**others)
    after = before.with_settings(**{name: value})
    running = Asked()
    first, expected = running.last_frame(before, 0), Asked().last_frame(after, 0)
    assert np.abs(first.U - expected.U).max() > 1e-3, "it makes a difference"
    assert np.abs(running.last_frame(after, 1).U - expected.U).max() < 1e-9


def test_request_solver_notices_another_wall_map_of_the_same_mean():
    mesh = folded().mesh
    height = mesh.V[:, 2] / mesh.V[:, 2].max()
    maps = [wall_map_of(values, mesh.V, mesh.F) for values in (0.1 + 0.2 * height, 0.3 - 0.2 * height)]
    before, after = (folded().with_settings(**FREE, **WALL, wall_thickness=each) for each in maps)
    running = Asked()
    first, expected = running.last_frame(before, 0), Asked().last_frame(after, 0)
    assert np.abs(first.U - expected.U).max() > 1e-3
    assert np.abs(running.last_frame(after, 1).U - expected.U).max() < 1e-9
