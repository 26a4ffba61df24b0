"""Solver on a thread of its own, one shape ahead of whoever asks for the newest."""

import logging
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import NamedTuple

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.pose.frame import Frame
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.path_iteration import PathIteration, PathStop
from apd_viewer.language import tr

_LAST_WAIT = 5.0  # seconds for the thread's last iteration

_log = logging.getLogger(__name__)


class _Motion(NamedTuple):
    """Targets (k, 3), and for new held vertices their solver and first shape."""

    targets: np.ndarray
    make: Callable[[], Deformation] | None = None
    U: np.ndarray | None = None


class LiveShape(NamedTuple):
    """Newest shape of a solver.

    Attributes
    ----------
    number : int
        Of the iteration; larger for newer ones.
    frame : Frame or None
        None before the first iteration.
    is_at_work : bool
        True if a newer one follows.
    problem : str
        Sentence on what stopped the solver; else empty.
    """

    number: int = 0
    frame: Frame | None = None
    is_at_work: bool = False
    problem: str = ""


class LiveSolver:
    """Iterations towards the newest targets, on a thread until :meth:`close`."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._motion: _Motion | None = None
        self._shape = LiveShape()
        self._is_iterating = self._is_held = self._is_busy = self._has_ended = False
        self._thread: threading.Thread | None = None

    @property
    def shape(self) -> LiveShape:
        """The newest shape."""
        return self._shape

    def open(self, make: Callable[[], Deformation], targets: np.ndarray, U: np.ndarray | None) -> None:
        """Go on with the solver from ``make``, to ``targets`` (k, 3) from ``U``."""
        self._begin(_Motion(targets, make, U))

    def aim(self, targets: np.ndarray) -> None:
        """Replace the targets (k, 3) of the solver that was opened last."""
        self._begin(_Motion(targets))

    def stop(self) -> None:
        """Forget targets and solver; the last shape stays."""
        with self._changed:
            self._motion, self._is_iterating = None, False
            self._shape = self._shape._replace(is_at_work=False, problem="")

    def newer_shape(self, number: int, seconds: float) -> LiveShape:
        """The newest shape, after waiting up to ``seconds`` for one after ``number``."""
        with self._changed:
            self._changed.wait_for(lambda: self._shape.number > number or not self._shape.is_at_work, seconds)
            return self._shape

    @contextmanager
    def held(self) -> Iterator[None]:
        """Context without iterations: two solvers at a time would slow each other."""
        try:
            with self._changed:
                self._is_held = True
                self._changed.wait_for(lambda: not self._is_busy)
            yield
        finally:
            with self._changed:
                self._is_held = False
                self._changed.notify_all()

    def close(self) -> None:
        """End the thread after its iteration."""
        with self._changed:
            self._has_ended = True
            self._changed.notify_all()
        if self._thread not in (None, threading.current_thread()):
            self._thread.join(_LAST_WAIT)

    def _begin(self, motion: _Motion) -> None:
        with self._changed:
            if self._motion is not None and motion.make is None:  # not begun yet
                motion = self._motion._replace(targets=motion.targets)
            self._motion = motion
            self._shape = self._shape._replace(is_at_work=True, problem="")
            if self._thread is None:
                self._thread = threading.Thread(target=self._run, name="live", daemon=True)
                self._thread.start()
            self._changed.notify_all()

    def _run(self) -> None:
        solver: Deformation | None = None
        walk: PathIteration | None = None
        count, refused = 0, ""
        while (motion := self._next_motion()) is not None:
            try:
                if isinstance(motion, _Motion):
                    if motion.make:
                        solver = walk = None
                        solver = motion.make()
                    if solver is None:
                        raise InputError(refused)
                    walk, count = PathIteration(solver, [PathStop(motion.targets)], motion.U), 0
                if walk is None or solver is None:
                    continue
                walk.iterate()
                count += not walk.is_on_its_way
                may_go_on = count < solver.convergence.most_iterations and not walk.settled
                self._publish(walk.frame(), may_go_on)
            except (InputError, MemoryError) as error:
                refused = str(error) or tr("Not enough memory for this mesh.")
                self._end(refused)
            except Exception as error:
                _log.exception("The solver stopped")
                said = tr("The solver stopped ({said}); the log says more.")
                self._end(said.format(said=str(error) or type(error).__name__))

    def _next_motion(self) -> _Motion | bool | None:
        """A new motion, or True to go on with the last; None at the end."""
        with self._changed:
            self._is_busy = False
            self._changed.notify_all()
            self._changed.wait_for(
                lambda: self._has_ended or (not self._is_held and (self._motion or self._is_iterating))
            )
            if self._has_ended:
                return None
            taken, self._motion = self._motion, None
            self._is_busy = self._is_iterating = True
            return taken or True

    def _publish(self, frame: Frame, may_go_on: bool) -> None:
        with self._changed:
            self._is_iterating = self._is_iterating and may_go_on
            is_at_work = self._is_iterating or self._motion is not None
            self._shape = LiveShape(self._shape.number + 1, frame, is_at_work)
            self._changed.notify_all()

    def _end(self, problem: str) -> None:
        with self._changed:
            self._is_iterating = False
            self._shape = self._shape._replace(is_at_work=self._motion is not None, problem=problem)
            self._changed.notify_all()
