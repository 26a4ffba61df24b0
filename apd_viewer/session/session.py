"""The user's verbs. Owns the state, the history and the worker; knows no window.

All methods are called on one thread. Every verb ends in one private replacement of the state, which
tells the one listener what was and what is; it compares by identity and shows what differs.
"""

from __future__ import annotations

import queue
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import Enum
from pathlib import Path

import numpy as np

from apd_viewer.files.meshes import check_target, open_mesh, save_mesh
from apd_viewer.files.samples import SAMPLES, open_sample
from apd_viewer.geometry.mesh import Mesh, frozen
from apd_viewer.session.document import IDENTITY, Document, State, opened, rest_frame
from apd_viewer.session.errand import Errand, Outcome
from apd_viewer.session.history import History
from apd_viewer.session.worker import Reply, Request, Worker


class Activity(Enum):
    """What the worker is doing about the shape on screen."""

    IDLE = "idle"
    REFINING = "refining"
    SETTLED = "settled"
    UNREACHED = "not reached"


@dataclass(frozen=True)
class Listener:
    """Whom a session tells what happens. ``wake`` is called on other threads, the rest on the owner's.

    Attributes
    ----------
    wake : callable
        Something waits to be received: call :meth:`Session.receive` on the owner's thread.
    changed : callable
        ``changed(old, new)``: the state was replaced; old is None the first time.
    status_changed : callable
        Activity, errand or history may differ.
    told : callable
        ``told(sentence)``: something the user should read.
    failed : callable
        ``failed(sentence)``: something the user asked for was not done, and why.
    """

    wake: Callable[[], object]
    changed: Callable[[State | None, State], object]
    status_changed: Callable[[], object]
    told: Callable[[str], object]
    failed: Callable[[str], object]


class Session:
    """One mesh, what is painted on it, where its handle is, and the worker that answers."""

    def __init__(self, listener: Listener) -> None:
        self._listener = listener
        self._worker = Worker(listener.wake)
        self._outcomes: queue.SimpleQueue[Outcome] = queue.SimpleQueue()
        self._generation = 0
        self._gesture: State | None = None
        self._saved: list[np.ndarray] = []
        self.history = History()
        self._asked: Document | None = None
        self._closed = False
        self.state: State | None = None
        self.activity = Activity.IDLE
        self._warned: str | None = None
        self.seconds_per_iteration = 0.0
        self.errand: Errand | None = None

    # Opening and writing

    def open(self, path: str | Path) -> None:
        """Open the mesh at ``path``, in the background; what is open stays until the new one is there."""
        self._open(Path(path).name, lambda: opened(open_mesh(path)))

    def open_sample(self, name: str) -> None:
        """Open a sample, painted, in the background."""
        self._open(SAMPLES[name], lambda: opened(*open_sample(name)))

    def show(self, mesh: Mesh) -> None:
        """Open a mesh that is in memory already."""
        self._open(mesh.name, lambda: opened(mesh))

    def _open(self, name: str, work: Callable[[], State]) -> None:
        self._send(f"Opening {name}", work, lambda state: self._opened(state, name))

    def export(self, path: str | Path) -> None:
        """Write the shape on screen, in the background."""
        state = self._require_state()
        path, U = Path(path), state.frame.U

        def write() -> None:
            save_mesh(state.document.mesh, U, check_target(path))

        def written(_: object) -> None:
            self._saved.append(U)
            self._listener.told(f"Exported {path.name}: area {state.frame.area:.6g}.")

        self._send(f"Writing {path.name}", write, written, can_be_cancelled=False)

    def cancel_errand(self) -> None:
        """Forget the file that is being opened; a file being written is left to finish, whole."""
        if self.errand is not None and self.errand.can_be_cancelled:
            self._listener.told(f"{self.errand.title}: cancelled.")
            self.errand = None
            self._listener.status_changed()

    @property
    def unsaved(self) -> list[Mesh]:
        """The meshes, on screen or a few undos away, whose latest shape has not been exported."""
        states = [*self.history.past, *([self.state] if self.state else [])]
        latest = {id(state.document.mesh): state for state in states}
        return [
            state.document.mesh
            for state in latest.values()
            if not any(state.frame.U is kept for kept in (state.document.mesh.V, *self._saved))
        ]

    @property
    def moved(self) -> bool:
        """Whether anything is not as it was at rest."""
        state = self._require_state()
        return state.frame.U is not state.document.mesh.V or not np.array_equal(state.document.pose, IDENTITY)

    # Painting

    def begin_gesture(self) -> None:
        """Start something that will be one step of undo, such as a stroke or a drag."""
        self._gesture = self._require_state()

    def cancel_gesture(self) -> None:
        """Go back to where the gesture began."""
        if self._gesture is not None:
            before, self._gesture = self._gesture, None
            self._jump(before, iterate=not before.frame.converged)

    def paint(self, ids: np.ndarray, label: int) -> None:
        """Label the vertices ``ids`` within the current gesture; the shape stays as it is."""
        state = self._require_state()
        if self._gesture is not None:  # undo may have ended the stroke
            self._replace(replace(state, document=state.document.painted(ids, label)))

    def end_stroke(self, gesture: str) -> None:
        """Grip base and handle where they are now, under the new labels."""
        before, self._gesture = self._gesture, None
        state = self._require_state()
        if before is None:
            return
        if np.array_equal(before.document.labels, state.document.labels):
            self._replace(replace(state, document=before.document))
            return
        self.history.record(gesture, before)
        frame = replace(state.frame, handle_drift=0.0, converged=True)
        self._jump(replace(state, document=state.document.regripped(frame.U), frame=frame), iterate=False)

    # Posing

    def move_handle(self, pose: np.ndarray) -> None:
        """Put the handle at ``pose`` (4, 4), measured from where it was gripped, within a gesture."""
        state = self._require_state()
        self._say(replace(state.document, pose=frozen(np.array(pose))))
        self._ask(iterate=True)

    def end_drag(self, gesture: str) -> None:
        """Finish the drag; the worker goes on until the shape has settled."""
        before, self._gesture = self._gesture, None
        if before is not None and before.document is not self._require_state().document:
            self.history.record(gesture, before)
            self._listener.status_changed()

    def reset_handle(self) -> None:
        """Put the handle back and the mesh in its rest shape; the paint stays."""
        self.cancel_gesture()
        state = self._require_state()
        mesh = state.document.mesh
        if not self.moved:
            return
        self.history.record("Reset handle", state)
        rest = rest_frame(mesh, state.inspection)
        self._jump(replace(state, document=state.document.regripped(mesh.V), frame=rest), iterate=False)

    def set_method(self, method: str) -> None:
        """Deform by another method, from the shape on screen."""
        self._set("Change method", method=method)

    def set_tolerance(self, tolerance: float) -> None:
        """Accept another relative error of the area."""
        self._set("Change tolerance", tolerance=tolerance)

    def _set(self, gesture: str, **what: object) -> None:
        self.cancel_gesture()
        state = self._require_state()
        document = replace(state.document, **what)  # type: ignore[arg-type]
        if all(getattr(state.document, name) == value for name, value in what.items()):
            return
        self.history.record(gesture, state)
        going = self.activity is Activity.REFINING or not np.array_equal(document.pose, IDENTITY)
        if going:
            self._say(document)
        else:
            self._replace(replace(state, document=document))
        self._ask(iterate=going)

    # Going back

    def undo(self) -> None:
        """Take the last gesture back: the very document and shape that were there before it."""
        self._go(self.history.undo)

    def redo(self) -> None:
        """Do again what was undone last."""
        self._go(self.history.redo)

    def _go(self, swap: Callable[[State], State | None]) -> None:
        self.cancel_gesture()
        target = swap(self._require_state())
        if target is not None:
            self._jump(target, iterate=not target.frame.converged)

    # The other threads

    def receive(self) -> None:
        """Take in what the worker and the errands have left; call it when woken."""
        while not self._outcomes.empty():
            self._finish(self._outcomes.get())
        reply = self._worker.take()
        if reply is not None and reply.generation == self._generation:
            self._accept(reply)

    def wait_idle(self, timeout: float) -> bool:
        """Receive until nothing is under way any more; False if that took longer than ``timeout`` seconds."""
        until = time.monotonic() + timeout
        while time.monotonic() < until:
            self.receive()
            if self.errand is None and self.activity is not Activity.REFINING:
                return True
            time.sleep(0.002)
        return False

    def close(self) -> None:
        """Stop the worker; a file that is being written is finished first."""
        self._closed = True
        self._worker.close()
        if self.errand is not None and not self.errand.can_be_cancelled:
            self.errand.join(timeout=10.0)

    def _finish(self, outcome: Outcome) -> None:
        if outcome.errand is not self.errand:
            return  # cancelled
        self.errand = None
        if outcome.failure:
            self._listener.failed(outcome.failure)
        else:
            outcome.errand.done(outcome.value)
        self._listener.status_changed()

    def _accept(self, reply: Reply) -> None:
        state = self._require_state()
        if reply.warning and reply.warning != self._warned:
            self._listener.told(reply.warning)
        self._warned = reply.warning
        if reply.frame is not None:
            self.seconds_per_iteration = reply.seconds
            settled = reply.frame.converged and reply.document is self._asked
            self._replace(replace(state, frame=replace(reply.frame, converged=settled)))
        # A slightly stale frame of this drag is worth showing, but says nothing about its end.
        if reply.finished and reply.document is self._asked:
            settled = reply.frame is not None and reply.frame.converged
            self.activity = Activity.SETTLED if settled else Activity.UNREACHED
        if reply.failure:
            self._listener.failed(reply.failure)
        self._listener.status_changed()

    def _send(
        self, title: str, work: Callable[[], object], done: Callable[..., None], can_be_cancelled: bool = True
    ) -> None:
        if self.errand is not None:
            self._listener.failed(f"{self.errand.title} is not finished; wait for it or cancel it.")
            return
        self.errand = Errand(title, work, done, self._deliver, can_be_cancelled)
        self._listener.status_changed()

    def _deliver(self, outcome: Outcome) -> None:
        self._outcomes.put(outcome)
        if not self._closed:
            self._listener.wake()

    def _opened(self, state: State, name: str) -> None:
        before, self._gesture = self._gesture or self.state, None
        if before is not None:
            document = before.document
            self.history.record(f"Open {name}", before)
            kept = replace(state.document, method=document.method, tolerance=document.tolerance)
            state = replace(state, document=kept)
        self._warned = None
        self._jump(state, iterate=False)
        if state.inspection.findings:
            self._listener.told(" ".join(state.inspection.findings))

    # The one way to change the state

    def _jump(self, state: State, iterate: bool) -> None:
        """Go to ``state``; frames of the time before are no longer wanted."""
        self._generation += 1
        self._replace(state)
        self._ask(iterate)

    def _say(self, document: Document) -> None:
        """Replace the document; what is on screen has not settled for the new one."""
        state = self._require_state()
        self._replace(replace(state, document=document, frame=replace(state.frame, converged=False)))

    def _ask(self, iterate: bool) -> None:
        state = self._require_state()
        iterate = iterate and state.document.problem is None
        self.activity = Activity.REFINING if iterate else Activity.IDLE
        self._asked = state.document
        self._worker.ask(Request(state.document, self._generation, state.frame.U, iterate))
        self._listener.status_changed()

    def _replace(self, state: State) -> None:
        old, self.state = self.state, state
        self._listener.changed(old, state)

    def _require_state(self) -> State:
        if self.state is None:
            raise RuntimeError("no mesh is open")
        return self.state
