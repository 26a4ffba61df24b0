"""Whatever a user does in whatever order on two meshes, and what must never be seen meanwhile."""

import random
import time
from contextlib import closing
from unittest.mock import patch

import numpy as np
from driven_session import LONG, Driven
from meshes import box

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE
from apd_viewer.session.state_store import Activity

MESHES = Mesh(*box(2, 2, 6)), Mesh(*box(4, 4, 12))
METHODS = ("exact", "arap", "local")  # these have the handle exactly where it was put


class User(Driven):
    """Does this and that, and looks at every frame.

    Every pose that is said is somewhere else along x, so the handle in a frame tells which pose it is of.
    """

    def __init__(self, seed: int) -> None:
        super().__init__()
        self._count_jumps()
        self.random = random.Random(seed)
        self.on_changed = self.look
        self.poses = 0
        self.frames = 0
        self.allowed: set[float] = set()

    def _count_jumps(self) -> None:
        self.jumps, jump = 0, self.store.jump_to

        def counted(*args, **words) -> None:
            self.jumps += 1
            jump(*args, **words)

        self.store.jump_to = counted

    def look(self) -> None:
        state = self.store.state
        V, U = state.document.mesh.V, state.frame.U
        assert U.shape == V.shape, "a frame of the wrong mesh"
        if self.allowed and not state.document.paint_problem:
            x = self.handle_x(U)
            assert min(abs(x - a) for a in self.allowed) < 1e-9, "a frame of a pose that was undone"
        self.frames += 1

    def handle_x(self, U: np.ndarray) -> float:
        return float(U[-1, 0])  # a corner at the upper end, which always belongs to the handle

    def jumped(self) -> None:
        """From here on only what is on screen and what is asked may be seen."""
        document = self.store.state.document
        target = document.initial_positions[-1, 0] + document.handles[0].pose[0, 3]
        self.allowed = {self.handle_x(self.U), float(target)}

    def act(self, verb) -> None:
        before, jumps = self.allowed, self.jumps
        self.allowed = set()
        verb()
        if self.jumps == jumps:
            self.allowed = before  # there was nothing to go back to
        else:
            self.jumped()

    # Verbs

    def open_mesh(self) -> None:
        self.act(lambda: self.show_now(self.random.choice(MESHES)))
        self.act(self.paint_ends)

    def ring(self) -> None:
        z = self.store.state.document.mesh.V[:, 2]
        ring = np.flatnonzero(z == 1.0)
        label = FREE if self.store.state.document.labels[ring[0]] == BASE else BASE
        self.act(lambda: self.stroke(ring, label))

    def drag_on(self) -> None:
        self.gestures.begin()
        for _ in range(self.random.randint(1, 15)):
            self.poses += 1
            pose = np.eye(4)
            pose[0, 3] = 1e-3 * self.poses % 2.0
            self.allowed.add(float(self.store.state.document.initial_positions[-1, 0] + pose[0, 3]))
            self.handles.drag(pose)
            self.listen(self.random.choice([0.0, 0.0, 0.002, 0.01]))
        if self.random.random() < 0.2:
            self.act(self.gestures.cancel)
        else:
            self.gestures.end("Move handle")

    def other_method(self) -> None:
        self.settings.change(method=self.random.choice(METHODS))

    def pause(self) -> None:
        self.listen(self.random.choice([0.002, 0.02]))

    def play(self, verbs: int = 12) -> None:
        """One interleaving, which must come to rest where it was asked to."""
        self.open_mesh()
        for _ in range(verbs):
            self.random.choice(
                [
                    self.drag_on,
                    self.drag_on,
                    self.drag_on,
                    self.ring,
                    self.other_method,
                    self.pause,
                    lambda: self.act(self.gestures.undo),
                    lambda: self.act(self.gestures.redo),
                    lambda: self.act(self.shapes.restore),
                    self.open_mesh,
                ]
            )()
        self.settle()
        state = self.store.state
        if self.store.activity is Activity.SETTLED:
            held = state.document.constraints()
            assert np.allclose(self.U[held.fixed], held.targets, rtol=0, atol=1e-9)
        assert self.failed == []
        self.changes.clear()


def play(times: int, seed: int = 1) -> int:
    """So many interleavings, one after another in one session; the number of frames that were seen."""
    user = User(seed)
    # In contact the handle comes later than it is asked to.
    with patch("apd_viewer.geometry.solver.methods.MOST_VERTICES_IN_CONTACT", 0), closing(user):
        began = time.monotonic()
        for k in range(times):
            user.play()
            assert time.monotonic() - began < LONG * (k + 1), "it hangs"
        assert (HANDLE in user.store.state.document.labels) or user.store.state.document.paint_problem
        return user.frames
