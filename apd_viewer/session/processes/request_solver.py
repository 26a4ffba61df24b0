"""Solver of the newest request: preparation, iterations and readings.

An iteration is cheap compared with its readings. Until the last frame has been displayed, further iterations
are therefore not measured; the last iteration of a request always is.
"""

import contextlib
import logging
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.goals.calm_parts import LARGE
from apd_viewer.geometry.linalg.linear_solver import Factor, Matrix
from apd_viewer.geometry.linalg.threads import cores_for
from apd_viewer.geometry.mesh.decimation import Decimation
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import Constraints
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.multilevel import compute_decimations
from apd_viewer.geometry.solver.path_iteration import PathIteration
from apd_viewer.geometry.solver.restarts import prepare_previews
from apd_viewer.geometry.warmup import warm_up
from apd_viewer.language import tr
from apd_viewer.session.model.document_parts import obstacle_shifts, targets_of
from apd_viewer.session.processes import request_and_reply
from apd_viewer.session.processes.document_deformation import deformation_of, document_iteration
from apd_viewer.session.processes.freed_memory import release_freed_memory
from apd_viewer.session.processes.mailbox import Mailbox
from apd_viewer.session.processes.remote_factor import RemoteFactor
from apd_viewer.session.processes.request_and_reply import Cost, Reply, Request, RequestProgress, RequestStage
from apd_viewer.session.processes.shared_memory import SharedShapeBuffer

_log = logging.getLogger(__name__)
_NOTHING = np.zeros((0, 3))
_MOMENT = 0.0005  # polling interval in seconds
_SOON = 1.0  # seconds without a request before idle work
# Keeping freed memory saves a third of the time of each frame in a drag, but it becomes more fragmented
# with every gesture: 165 MiB after 2,000 gestures.
PAUSE = 2.0  # seconds without a request before freed memory is released
_NO_ROOM = tr("Not enough memory for this mesh; close other programs and try again.")
# Matrices with this many rows take over half a second to factor, in another process.
REMOTE_FACTOR_ROWS = 100_000


class RequestSolver:
    """Solver answering requests in turn, with cached preparations.

    Parameters
    ----------
    requests : Mailbox of Request
        Mailbox of the newest request; closing it ends :meth:`run`.
    send : callable
        Called with every message.
    """

    def __init__(self, requests: Mailbox[Request], send: Callable[[Reply | RequestProgress], None]) -> None:
        self._requests = requests
        self._tell = send
        self._tray: SharedShapeBuffer | None = None
        self._rest: tuple[Mesh, RestMesh] | None = None
        self._solver: Deformation | None = None
        self._factors: list[RemoteFactor] = []
        self._warning: str | None = None
        self._key: tuple[object, ...] = ()
        self._goals: tuple[object, ...] = ()
        self._poses: tuple[object, ...] = ()
        self._placed: tuple[object, ...] = ()
        self._walk: PathIteration | None = None
        self._generation: int | None = None
        self._warm = False

    def run(self, when_idle: Callable[[Callable[[], bool]], object] = lambda _: None) -> None:
        """Answer requests until the mailbox is closed.

        Between requests, ``when_idle(called)`` is called until it has finished: it should return soon once
        ``called()`` is True.
        """
        done = not self._requests.wait_for_value(_SOON) and self._run_idle_work(when_idle)
        while (request := self._requests.wait()) is not None:
            self._tell(RequestProgress(RequestStage.TURNED_TO, request))
            try:
                self.answer(request)
            except InputError as error:
                self._fail(request, str(error))
            except Exception as error:
                # Bugs and memory errors must be reported without ending the solver for later requests.
                _log.exception("The solver stopped")
                said = str(error) or type(error).__name__
                stopped = tr("The solver stopped ({said}); undo the last step.").format(said=said)
                self._fail(request, _NO_ROOM if isinstance(error, MemoryError) else stopped)
            self._tell(RequestProgress(RequestStage.ANSWERED, request))
            if not done and not self._requests.is_ready:
                done = self._run_idle_work(when_idle)
            if not self._requests.wait_for_value(PAUSE):
                release_freed_memory()
        self._discard_deformation()

    def answer(self, request: Request) -> None:
        """Answer a request, or prepare for the next one."""
        self.discard_other_mesh(request.document.mesh)
        if request.document.paint_problem:
            # Requests without complete paint are sent during painting, only to prepare for a later one.
            if request.is_timed:  # sent by a comparison of methods, which waits for an answer
                document = request.document
                without = document.settings.traits.obstacle_problem if document.obstacles else ""
                raise InputError(without or document.paint_problem)
            with contextlib.suppress(InputError):
                _prepare_mesh(self._rest_of(request))
            return
        if request.is_timed and not self._warm:
            warm_up()  # otherwise the first method's time would include compilation
            self._warm = True
        self._rest_of(request)
        started = time.perf_counter()
        solver = self._prepared_solver(request)
        if request.iterate:
            self._iterate(request, solver, started)
        else:
            self._prepare_first_shape(solver)
            self._begin_factorizations()

    def discard_other_mesh(self, mesh: Mesh) -> None:
        """Discard the preparations for another mesh, if there are any."""
        if self._rest is not None and self._rest[0] is not mesh:
            self._discard_deformation()
            self._rest = self._tray = None

    @property
    def is_factoring(self) -> bool:
        """True while a matrix is being factorized in another process."""
        return any(factor.is_factoring for factor in self._factors)

    def _run_idle_work(self, when_idle: Callable[[Callable[[], bool]], object]) -> bool:
        """Call ``when_idle``; return False if a request has arrived meanwhile."""
        when_idle(lambda: self._requests.is_ready)
        return not self._requests.is_ready

    def _discard_deformation(self) -> None:
        """Discard the deformation, and end its factorizations."""
        self._solver = self._walk = None
        for factor in self._factors:
            factor.close()
        self._factors = []

    def _fail(self, request: Request, message: str) -> None:
        self._discard_deformation()
        self._tell(Reply(request, finished=True, failure=message))

    def _iterate(self, request: Request, solver: Deformation, started: float) -> None:
        tray, cost, walk = self._shape_buffer_of(request), None, self._walk
        assert walk is not None
        iterations, since, last = 0, time.perf_counter(), 0
        while True:  # at least one iteration, or a fast sequence of poses would show nothing
            while not solver.ready:
                if self._requests.is_ready:
                    return
                time.sleep(_MOMENT)
            walk.iterate()
            iterations += 1
            if walk.is_iterate_hidden:
                if self._requests.is_ready:
                    return
                continue
            most = solver.convergence.most_iterations
            finished = walk.has_arrived and (solver.settled or iterations >= most)
            if finished:
                took = time.perf_counter() - started
                while tray is not None and not tray.is_free and not self._requests.is_ready:
                    time.sleep(_MOMENT)
            may_wait = not finished and last > 0
            is_early = may_wait and time.perf_counter() - since < request.frame_pause
            is_taken = tray is None or (tray.is_free and (finished or tray.is_displayed))
            if is_taken and not is_early:
                seconds = (time.perf_counter() - since) / (iterations - last)
                frame = walk.frame()
                shape_number = None
                if finished:
                    cost = Cost(solver.rest.energy(frame.U), took)
                if tray is not None:
                    shape_number, frame = tray.write_shape(frame.U), replace(frame, U=_NOTHING)
                self._tell(
                    Reply(
                        request,
                        frame,
                        finished,
                        seconds,
                        warning=self._warning,
                        cost=cost,
                        shape_number=shape_number,
                    )
                )
                since, last = time.perf_counter(), iterations
                self._begin_factorizations()
            if finished or self._requests.is_ready:
                return

    def _shape_buffer_of(self, request: Request) -> SharedShapeBuffer | None:
        if request.shape_buffer is None:
            return None
        if self._tray is None or self._tray.name != request.shape_buffer:
            self._tray = SharedShapeBuffer(len(request.document.mesh.V), request.shape_buffer)
        return self._tray

    def _prepared_solver(self, request: Request) -> Deformation:
        """Return the solver with the goals and poses of the request; factor if needed."""
        document = request.document
        held = document.constraints()
        key = request_and_reply.factor_key(document)
        goals, poses = request_and_reply.goal_key(document), request_and_reply.pose_key(document)
        around = request_and_reply.obstacle_key(document)
        fresh = self._solver is None or not request_and_reply.are_same_keys(key, self._key)
        if self._solver is None or fresh:
            self._discard_deformation()  # frees memory before the next solver is made
            self._solver = self._new_deformation(request, held)
        else:
            if not request_and_reply.are_same_keys(goals, self._goals):
                self._solver.keep(*targets_of(document), document.settings.calm)
            if not request_and_reply.are_same_keys(around, self._placed):
                self._solver.replace_obstacles(document.active_obstacles)
        self._solver.tolerance, self._solver.convergence = (
            document.settings.tolerance,
            document.settings.convergence,
        )
        self._solver.loose.set_loose_motion(document.immobile_components)
        self._warning = self._solver.loose.warning
        jumps = request.generation != self._generation
        elsewhere = jumps or not request_and_reply.are_same_keys(around, self._placed)
        # Only after a change: equal targets would reset the handle of the "paper" method to its target.
        if fresh or elsewhere or not request_and_reply.are_same_keys(poses, self._poses):
            U = request.U if fresh or elsewhere else None
            walks = request.iterate and (jumps or (fresh and _must_start_at_rest(self._solver, request)))
            self._walk = document_iteration(self._solver, document, U, walks, request.shifts)
        self._generation, self._key, self._goals, self._poses = request.generation, key, goals, poses
        self._placed = around
        return self._solver

    def _new_deformation(self, request: Request, held: Constraints) -> Deformation:
        rest, document = self._rest_of(request), request.document
        return deformation_of(document, held, rest, self._remote_factor if _is_large(rest) else None)

    def _remote_factor(self, matrix: Callable[[], Matrix], V: np.ndarray) -> Factor:
        self._factors.append(RemoteFactor(matrix, V))
        return self._factors[-1]

    def _begin_factorizations(self) -> None:
        """Begin the factorizations, after the more urgent first shape."""
        for factor in self._factors:
            factor.begin()

    def _prepare_first_shape(self, solver: Deformation) -> None:
        """Compute what the first shape of a drag would wait for."""
        if not self._requests.is_ready:  # else it is asked for already
            solver.frame()
        if not self._requests.is_ready:
            prepare_previews(solver.solver)

    def _rest_of(self, request: Request) -> RestMesh:
        mesh = request.document.mesh
        if self._rest is None or self._rest[0] is not mesh:
            rest = RestMesh(mesh.V, mesh.F, mesh.weld, request.decimations)
            self._rest = mesh, rest
            if _is_large(rest):
                decimations = _prepare_mesh(rest)
                if not request.decimations:
                    self._tell(Reply(request, decimations=decimations))
        return self._rest[1]


def _prepare_mesh(rest: RestMesh) -> tuple[Decimation, ...]:
    """Compute what every deformation of a mesh would wait for, on two threads."""
    shape = rest.solve_mesh

    def prepare_readings() -> None:
        with cores_for(len(shape.V)):
            rest.measure(shape.V)
        _ = shape.L

    with ThreadPoolExecutor(1, "readings") as pool:
        readings = pool.submit(prepare_readings)
        decimations = compute_decimations(rest)
        readings.result()
    if len(shape.V) > LARGE:
        _ = shape.coarse_laplacian
    if decimations and _is_large(rest):
        _ = shape.prolongation
    return decimations


def _must_start_at_rest(solver: Deformation, request: Request) -> bool:
    """True if contact cannot start at the shape because of intersections."""
    contact, shifts = solver.contact, request.shifts
    if contact is None:
        return False
    if len(shifts) != len(contact.shifts):
        shifts = obstacle_shifts(request.document)
    return not contact.contact.can_start_at(solver.rest.to_local(request.U[solver.rest.weld.first]), shifts)


def _is_large(rest: RestMesh) -> bool:
    return len(rest.solve_mesh.V) >= REMOTE_FACTOR_ROWS
