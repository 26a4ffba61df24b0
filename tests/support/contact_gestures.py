"""Whatever a user does to a surface with contact on: no frame may ever cross itself."""

import time

import ipctk
import numpy as np
from interleavings import User
from meshes import rotation, tube

from apd_viewer.geometry.analysis.self_intersections import crossings
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.state_store import Activity

TUBE = Mesh(*tube(16, 16))
EDGES = ipctk.edges(np.asfortranarray(TUBE.F))
_ENOUGH_IN_TOUCH, _MOST_ROUNDS = 5, 10
CHECKED = ipctk.CollisionMesh(np.asfortranarray(TUBE.V), EDGES, np.asfortranarray(TUBE.F))


class TouchingUser(User):
    """Twists, pushes and paints a tube so far that its wall would pass through itself."""

    touched = 0

    def look(self) -> None:
        U = self.store.state.frame.U
        assert not ipctk.has_intersections(CHECKED, np.asfortranarray(U)), "a frame that crosses itself"
        assert not len(crossings(U, TUBE.F)), "a frame that crosses itself, by our own check"
        self.touched += (
            self.store.state.frame.contact is not None and self.store.state.frame.contact.pairs > 0
        )
        self.frames += 1

    def open_mesh(self) -> None:
        self.show_now(TUBE)
        self.paint_ends()
        self.settings.set_contact(True)

    def ring(self) -> None:
        z = TUBE.V[:, 2]
        levels = np.unique(z)
        ring = np.flatnonzero(np.abs(z - self.random.choice(levels[2:-2])) < 1e-9)
        self.stroke(ring, self.random.choice([0, 1]))

    def drag_on(self) -> None:
        self.gestures.begin()
        turn = self.random.choice([-70.0, 40.0, 70.0])
        rise = self.random.uniform(-0.12, 0.04) * np.ptp(TUBE.V[:, 2])
        pose = self.store.state.document.handles[0].pose
        for _ in range(self.random.randint(1, 5)):
            step = np.eye(4)
            step[:3, :3] = rotation((0, 0, 1), np.radians(turn))
            step[2, 3] = rise
            pose = step @ pose
            self.handles.drag(pose)
            self.listen(self.random.choice([0.0, 0.01, 0.05]))
        if self.random.random() < 0.2:
            self.gestures.cancel()
        else:
            self.gestures.end("Move handle")

    @property
    def at_rest(self) -> bool:
        return self.store.activity is not Activity.REFINING

    def other_area(self) -> None:
        self.settings.change(area=self.random.choice([90.0, 100.0, 110.0]))

    def other_thickness(self) -> None:
        self.settings.set_contact(True, self.random.choice([None, 0.002, 0.02]))

    def act(self, verb) -> None:
        verb()

    def play(self, verbs: int = 12) -> None:
        """So many gestures, one after another."""
        done = [self.drag_on] * 9 + [self.ring, self.other_method, self.other_area, self.other_thickness]
        done += [self.pause, self.gestures.undo, self.gestures.redo, self.shapes.restore]
        for _ in range(verbs):
            before = self.frames
            self.random.choice(done)()
            self.until(lambda before=before: self.frames > before + 9 or self.at_rest)
        assert self.failed == []


def play(gestures: int, seed: int = 1) -> tuple[int, int]:
    """Gestures until enough frames are in touch; numbers of frames seen, and of those in touch."""
    user = TouchingUser(seed)
    try:
        user.open_mesh()
        user.drag(np.eye(4) + 0.01 * np.eye(4, k=3))
        user.until(lambda: user.store.state.frame.iteration, seconds=120.0)  # kernels are compiled first
        for _ in range(_MOST_ROUNDS):
            began = time.monotonic()
            user.play(gestures)
            assert time.monotonic() - began < 3.0 * gestures, "it hangs"
            # How far the worker comes between two gestures is a matter of the machine.
            if user.touched > _ENOUGH_IN_TOUCH:
                break
        return user.frames, user.touched
    finally:
        user.close()
