"""A session that remembers what it said, and the bar that tests deform."""

import threading
import time
from collections.abc import Callable
from dataclasses import fields

import in_thread
import numpy as np
import pytest
from meshes import box, ends, rotation
from new_threads import new_threads

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, HANDLE
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.state import State, initial_state
from apd_viewer.session.model.view import CameraPose, View
from apd_viewer.session.session import Session
from apd_viewer.session.state_store import Listener

LONG = 120.0  # seconds; nothing here should come near it, on a slow machine either


class Driven(Session):
    """A session that remembers all it tells its listener, with gestures in one call.

    Attributes
    ----------
    changes : list of (State or None, State)
    told, failed : list of str
    woken : list of str
        Names of the threads that called wake.
    """

    def __init__(self) -> None:
        self.changes: list[tuple[State | None, State]] = []
        self.told: list[str] = []
        self.failed: list[str] = []
        self.woken: list[str] = []
        self.on_changed: Callable[[], object] = lambda: None
        self.on_failed: Callable[[], object] = lambda: None
        listener = Listener(
            wake=lambda: self.woken.append(threading.current_thread().name),
            changed=self._note_change,
            status_changed=lambda: None,
            message_sent=self.told.append,
            failed=self._note_failure,
        )
        super().__init__(listener)

    def _note_change(self, old: State | None, new: State) -> None:
        self.changes.append((old, new))
        self.on_changed()

    def _note_failure(self, sentence: str) -> None:
        self.failed.append(sentence)
        self.on_failed()

    def settle(self) -> None:
        assert self.wait_idle(LONG), "the session did not come to rest"

    def until(self, happened: Callable[[], object], seconds: float = LONG) -> None:
        """Receive until something has happened."""
        end = time.monotonic() + seconds
        while not happened():
            assert time.monotonic() < end, "it did not happen"
            self.receive_results()
            time.sleep(0.001)

    def listen(self, seconds: float) -> None:
        """Receive for so long."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.receive_results()
            time.sleep(0.001)

    def show_now(self, mesh: Mesh) -> None:
        self.files.open_mesh(mesh)
        self.until(lambda: self.jobs.current is None)

    def stroke(self, ids: np.ndarray, label: int) -> None:
        self.gestures.begin()
        self.painting.paint(ids, label)
        self.painting.end_stroke("Paint")

    def paint_ends(self) -> None:
        base, handle = ends(self.store.state.document.mesh.V)
        self.stroke(base, BASE)
        self.stroke(handle, HANDLE)

    def drag(self, *poses: np.ndarray, which: int = 0) -> None:
        self.gestures.begin()
        for pose in poses:
            self.handles.drag(pose, which)
        self.handles.end_drag(which)

    @property
    def U(self) -> np.ndarray:
        return self.store.state.frame.U

    @property
    def handle_at(self) -> np.ndarray:
        """Centroid of the handle on screen."""
        return self.U[self.store.state.document.labels == HANDLE].mean(axis=0)


def pose(angle: float = 0.0, shift: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> np.ndarray:
    """Turn about y through (1, 1, 6), the middle of the bar's upper end, then shift."""
    P, centre = np.eye(4), np.array([1.0, 1.0, 6.0])
    P[:3, :3] = rotation((0, 1, 0), angle)
    P[:3, 3] = centre - P[:3, :3] @ centre + shift
    return P


BENT = pose(0.6, (0.5, 0.0, 0.2))


def bar() -> Mesh:
    return Mesh(*box(2, 2, 6))


def solver_threads() -> list[threading.Thread]:
    return new_threads(in_thread.NAME)


def ready(session: Driven) -> None:
    """Wait until the worker has factored for what is painted now: its first frame says so."""
    session.drag(pose(0.01))
    session.settle()


VIEW = View(
    CameraPose((0.1, -2.0, 30.0), (0.0, 1 / 3, 0.0), (0.0, 1.0, -0.0), 0.5235987755982988),
    "mm",
    overlay="bending",
)


def check_equal(found: State, saved: State) -> None:
    """That two states say the same, bit for bit where it was said and to rounding where it was measured."""
    a, b = found.document, saved.document
    assert a.mesh.digest == b.mesh.digest
    for name in ("labels", "member", "initial_positions"):
        check_same_array(getattr(a, name), getattr(b, name))
    assert [part.name for part in a.handles] == [part.name for part in b.handles]
    for mine, other in zip(a.handles, b.handles, strict=True):
        check_same_array(mine.pose, other.pose)
        assert (mine.pivot is None) == (other.pivot is None)
        if mine.pivot is not None:
            check_same_array(mine.pivot, other.pivot)
    assert [(part.name, part.area) for part in a.regions] == [(part.name, part.area) for part in b.regions]
    assert a.flags == b.flags
    assert (a.target_shape and a.target_shape.mesh.digest) == (b.target_shape and b.target_shape.mesh.digest)
    check_same_obstacles(a, b)
    names = "labels", "member", "initial_positions", "handles", "regions", "target_shape", "obstacles"
    for field in fields(a):
        if field.name not in ("mesh", *names):
            assert getattr(a, field.name) == getattr(b, field.name), field.name
    assert (a.initial_positions is a.mesh.V) == (b.initial_positions is b.mesh.V)
    assert (found.frame.U is a.mesh.V) == (saved.frame.U is b.mesh.V)
    check_same_array(found.frame.U, saved.frame.U)
    for field in fields(found.frame):
        if field.name in ("U", "total", "gap"):  # the latter two are of the solver, not of the shape
            continue
        mine, other = getattr(found.frame, field.name), getattr(saved.frame, field.name)
        if isinstance(other, np.ndarray):
            check_same_array(mine, other)
        elif isinstance(other, float) or field.name == "regions":
            assert mine == pytest.approx(other, rel=1e-12, abs=1e-13), field.name
        else:
            assert mine == other, field.name


def check_same_obstacles(a: Document, b: Document) -> None:
    for mine, other in zip(a.obstacles, b.obstacles, strict=True):
        assert (mine.name, mine.kind) == (other.name, other.kind)
        assert (mine.radius, mine.length) == (other.radius, other.length)
        for name in ("place", "axis", "shift"):
            check_same_array(getattr(mine, name), getattr(other, name))


def check_same_array(mine: np.ndarray, other: np.ndarray) -> None:
    assert (mine.dtype, mine.shape, mine.tobytes()) == (other.dtype, other.shape, other.tobytes())
    assert not mine.flags.writeable


def document(method: str = "paper", at: np.ndarray = BENT) -> Document:
    mesh = Mesh(*box(2, 2, 6))
    base, handle = ends(mesh.V)
    rest = initial_state(mesh).document.with_label(base, BASE).with_label(handle, HANDLE)
    return rest.with_pose(0, at).with_settings(method=method)
