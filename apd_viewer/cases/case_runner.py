"""Runs each case of a study once, retrying after the death of a worker process.

An engine starts cases and reports their ends, with processes on this machine or with workers elsewhere;
the runner is independent of the kind.
"""

import contextlib
import queue
import time
from collections import deque
from collections.abc import Callable, Mapping
from concurrent.futures import BrokenExecutor, CancelledError, Future
from typing import Protocol

from apd_viewer.cases.case_file import case_to_bytes
from apd_viewer.cases.case_worker import CaseAnswer, CaseTask
from apd_viewer.cases.run_case import failed_result
from apd_viewer.cases.study_case import StudyCase
from apd_viewer.errors import InputError
from apd_viewer.files.storage.regular_files import read_bytes
from apd_viewer.language import tr

# The system may kill a process, for example to free memory: a case is retried before it is blamed.
MOST_DEATHS = 3
_TICK = 0.5  # seconds between two checks of the running cases


class Engine(Protocol):
    """Interface of the worker pools for cases.

    Attributes
    ----------
    can_blame_case : bool
        Whether the case of a dead worker is its likely cause.
    overdue : set of Future
        Cases that were ended with their process as they took far too long.
    """

    can_blame_case: bool
    overdue: set[Future[CaseAnswer]]

    def free_slot_count(self) -> int:
        """Number of cases the engine can accept now."""

    def running_count(self) -> int:
        """Number of running cases."""

    def start(self, task: CaseTask) -> Future[CaseAnswer]:
        """Start a case."""

    def supervise_workers(self) -> None:
        """Stop overdue cases; raises InputError if all workers are lost."""

    def close(self, at_once: bool) -> None:
        """End local worker processes, or release shared workers."""


class CaseRunner:
    """Runs cases on an engine until all are finished or a stop is requested.

    Parameters
    ----------
    cases : mapping of str to StudyCase
        By their keys.
    on_result : callable
        Called with the bytes of each result, on the thread of :meth:`run`.
    limit : float or None
        Seconds that a case may take.
    on_tick : callable
        Called twice a second, and after every case.
    """

    def __init__(
        self,
        cases: Mapping[str, StudyCase],
        engine: Engine,
        on_result: Callable[[bytes], object],
        limit: float | None = None,
        on_tick: Callable[[int], object] = lambda _: None,
    ) -> None:
        self._cases, self._engine, self._finished = cases, engine, on_result
        self._limit, self._tick = limit, on_tick
        self._waiting = deque(cases)
        self._suspects: deque[str] = deque()
        self._deaths: dict[str, int] = {}
        # Keys of cases on workers without access to the input files: these are sent with the task.
        self._sent: set[str] = set()
        self._running: dict[Future[CaseAnswer], str] = {}
        self._ended: queue.SimpleQueue[Future[CaseAnswer]] = queue.SimpleQueue()
        self._stopping = False

    def stop(self) -> None:
        """Start no more cases, but finish the running ones; safe in a signal handler."""
        self._stopping = True

    def run(self) -> None:
        """Run the cases; raises InputError if the workers are lost."""
        looked = time.monotonic()
        while True:
            self._fill()
            if not self._running and (self._stopping or not (self._waiting or self._suspects)):
                return
            with contextlib.suppress(queue.Empty):
                future = self._ended.get(timeout=_TICK)
                key = self._running.pop(future)
                self._fill()  # keeps the worker busy while the result is written
                self._finish(key, future)
            self._tick(self._engine.running_count())
            if time.monotonic() - looked > _TICK:
                self._engine.supervise_workers()
                looked = time.monotonic()

    def _fill(self) -> None:
        """Start waiting cases on free workers unless stopping; suspect cases run alone."""
        if self._stopping:
            return
        while self._waiting and self._engine.free_slot_count() > 0:
            self._start(self._waiting.popleft())
        if self._suspects and not self._running and self._engine.free_slot_count() > 0:
            self._start(self._suspects.popleft())

    def _start(self, key: str) -> None:
        sources = self._cases[key].input_files if key in self._sent else ()
        sent = {source.digest: read_bytes(source.path) for source in sources}
        future = self._engine.start(CaseTask(self._cases[key], self._limit, sent))
        self._running[future] = key
        future.add_done_callback(self._ended.put)

    def _finish(self, key: str, future: Future[CaseAnswer]) -> None:
        try:
            answer = future.result()
        except BrokenExecutor:
            if future in self._engine.overdue:
                self._fail(key, tr("It took longer than {limit:g} s.").format(limit=self._limit))
            else:
                self._handle_worker_death(key)
        except CancelledError:
            self._waiting.appendleft(key)
        except ImportError as error:
            raise InputError(
                tr("The workers or their scheduler cannot load {name}; install apd-viewer there.").format(
                    name=error.name or error
                )
            ) from error
        except Exception as error:
            if type(error).__name__ != "KilledWorker":
                raise
            self._handle_worker_death(key)
        else:
            if answer.missing_inputs:
                self._sent.add(key)
                self._waiting.appendleft(key)
            else:
                self._finished(answer.content)

    def _handle_worker_death(self, key: str) -> None:
        """Requeue or fail a case after the death of its worker process."""
        self._deaths[key] = deaths = self._deaths.get(key, 0) + 1
        if self._engine.can_blame_case and deaths < MOST_DEATHS:
            self._waiting.append(key)
        elif not self._engine.can_blame_case and deaths == 1:
            self._suspects.append(key)
        else:
            self._fail(key, tr("Its process died at every attempt."))

    def _fail(self, key: str, sentence: str) -> None:
        self._finished(case_to_bytes(failed_result(self._cases[key], sentence)))
