"""The thread that iterates: complete requests in, coalesced replies out.

It knows nothing of windows and calls nobody while it holds a lock. Requests and replies are plain
values that can be pickled.
"""

from __future__ import annotations

import threading
import time
import traceback
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.constraints import Constraints
from apd_viewer.geometry.deform import MOST_ITERATIONS
from apd_viewer.geometry.deformation import Deformation, Frame
from apd_viewer.geometry.mesh import Mesh
from apd_viewer.geometry.rest_mesh import RestMesh
from apd_viewer.session.document import Document
from apd_viewer.session.slot import Slot


@dataclass(frozen=True, eq=False)
class Request:
    """What to work on.

    Attributes
    ----------
    document : Document
    generation : int
        Counts jumps of the state. A new one starts from ``U``; the same one goes on from where
        the worker is.
    U : (n, 3) float array
        The shape to start from.
    iterate : bool
        Otherwise only make ready: factor, so that the first drag need not wait.
    """

    document: Document
    generation: int
    U: np.ndarray
    iterate: bool


@dataclass(frozen=True, eq=False)
class Reply:
    """What came of a request: a frame, or a sentence that says why there is none.

    Attributes
    ----------
    finished : bool
        Nothing more comes for this request.
    seconds : float
        Time that the last iteration took.
    warning : str or None
        What the user should know about what is held.
    """

    document: Document
    generation: int
    frame: Frame | None
    finished: bool
    seconds: float = 0.0
    failure: str | None = None
    warning: str | None = None


class Worker:
    """Owns the solver and the thread that drives it.

    Parameters
    ----------
    wake : callable
        Called on the worker's thread when a reply lies in the empty slot; must only pass it on.
    """

    def __init__(self, wake: Callable[[], object]) -> None:
        self._wake = wake
        self._requests: Slot[Request] = Slot()
        self._replies: Slot[Reply] = Slot()
        self._rest: tuple[Mesh, RestMesh] | None = None
        self._solver: Deformation | None = None
        self._key: tuple[object, ...] = ()
        self._goals: tuple[object, ...] = ()
        self._poses: tuple[object, ...] = ()
        self._generation: int | None = None
        self._thread = threading.Thread(target=self._run, name="solver", daemon=True)
        self._thread.start()

    def ask(self, request: Request) -> None:
        """Turn to ``request`` next, and forget any other that still waits."""
        self._requests.put(request)

    def take(self) -> Reply | None:
        """Take the newest reply; None if there is none."""
        return self._replies.take()

    def close(self) -> None:
        """End the thread after the iteration that it is in, and wait for it."""
        self._requests.close()
        self._thread.join()
        self._solver = self._rest = None

    def _run(self) -> None:
        while (request := self._requests.wait()) is not None:
            try:
                self._answer(request)
            except InputError as error:
                self._fail(request, str(error))
            except Exception as error:
                # A defect or a lack of memory must reach the screen, and the next request a thread.
                traceback.print_exc()
                self._fail(
                    request, f"The solver stopped ({str(error) or type(error).__name__}); undo the last step."
                )

    def _answer(self, request: Request) -> None:
        if self._rest is not None and self._rest[0] is not request.document.mesh:
            self._solver = self._rest = None
            self._key = ()
        if request.document.problem:
            return
        solver = self._prepared(request)
        if not request.iterate:
            return
        warning = solver.rest.loose_warning(solver.fixed)
        while True:  # one step at least, or poses that come faster than they are prepared show nothing
            started = time.perf_counter()
            frame = solver.step()
            seconds = time.perf_counter() - started
            finished = frame.settled or frame.iteration >= MOST_ITERATIONS
            self._reply(Reply(request.document, request.generation, frame, finished, seconds, None, warning))
            if finished or self._requests.waiting:
                return

    def _prepared(self, request: Request) -> Deformation:
        """The solver of the request, told what is asked and aimed; factored only where it must be."""
        document = request.document
        held = document.constraints()
        weights = document.stiffness, document.area_stiffness, document.shear_stiffness
        key = (document.mesh, document.labels, document.method, *weights)
        goals = (document.targets, document.hold_area, document.member, document.regions)
        poses = tuple(handle.pose for handle in document.handles)
        fresh = self._solver is None or not _alike(key, self._key)
        if self._solver is None or fresh:
            self._solver = None  # its memory is needed for the next one
            self._solver = self._made(document, held)
        elif not _alike(goals, self._goals):
            self._solver.keep(*document.asked)
        self._solver.tolerance = document.tolerance
        jump = fresh or request.generation != self._generation
        # Aiming anew would take the paper's handle back to where it was put.
        if jump or not _alike(poses, self._poses):
            self._solver.aim(held.targets, request.U if jump else None)
        self._generation, self._key, self._goals, self._poses = request.generation, key, goals, poses
        return self._solver

    def _made(self, document: Document, held: Constraints) -> Deformation:
        rest = self._rest_of(document.mesh)
        return Deformation(
            rest.V,
            rest.F,
            held.fixed,
            method=document.method,
            handle=held.handles,
            stiffness=document.stiffness,
            area_stiffness=document.area_stiffness,
            shear_stiffness=document.shear_stiffness,
            **document.asked._asdict(),
            rest=rest,
        )

    def _rest_of(self, mesh: Mesh) -> RestMesh:
        if self._rest is None or self._rest[0] is not mesh:
            self._rest = (mesh, RestMesh(mesh.V, mesh.F, mesh.weld))
        return self._rest[1]

    def _fail(self, request: Request, message: str) -> None:
        self._solver = None
        self._reply(Reply(request.document, request.generation, None, True, failure=message))

    def _reply(self, reply: Reply) -> None:
        if self._replies.put(reply):
            self._wake()


def _alike(a: tuple[object, ...], b: tuple[object, ...]) -> bool:
    """Whether two tuples are equal; arrays only if they are the very same."""
    return len(a) == len(b) and all(
        x is y or (not isinstance(x, np.ndarray) and x == y) for x, y in zip(a, b, strict=True)
    )
