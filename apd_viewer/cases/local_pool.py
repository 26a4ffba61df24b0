"""Engine of worker processes on this machine.

Each process has an executor of its own: the case that killed a process is known, a case far over its time
limit can be ended, and a process is replaced after a number of cases without waiting for the others.
"""

import contextlib
import os
import signal
import threading
import time
from collections.abc import Iterator
from concurrent.futures import BrokenExecutor, Future, ProcessPoolExecutor
from multiprocessing import get_context, parent_process
from threading import Thread

from apd_viewer.cases.case_worker import CaseAnswer, CaseTask, TaskRunner, run_task as work_on_case
from apd_viewer.session.processes.child_boot import set_up_process

# Number of cases before a process is replaced.
RECYCLE_AFTER = 300
# Factor of the time limit, plus seconds, after which a case stuck in native code is killed.
_FAR_TOO_LONG = 1.5, 30.0


def _initialize_worker(parent_pid: int) -> None:
    """Initialise a worker process to exit with its parent process."""
    set_up_process(parent_pid)
    Thread(target=_follow_owner, daemon=True).start()


def _follow_owner() -> None:
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(0)


class _WorkerSlot:
    """One worker process and its current case."""

    def __init__(self) -> None:
        self.executor: ProcessPoolExecutor | None = None
        self.cases = 0
        self.future: Future[CaseAnswer] | None = None
        self.until = float("inf")

    @property
    def is_free(self) -> bool:
        """True if no case is running in the process."""
        return self.future is None or self.future.done()

    def start(self, work: TaskRunner, task: CaseTask, recycle: int) -> Future[CaseAnswer]:
        """Start a case, in a new process if the old one is due for replacement."""
        if self.executor is not None and self.cases >= recycle:
            self.end()
        factor, more = _FAR_TOO_LONG
        self.until = (
            float("inf") if task.time_limit is None else time.monotonic() + factor * task.time_limit + more
        )
        try:
            self.future = self._submit(work, task)
        except BrokenExecutor:  # the process died during its last case or while idle
            self.end()
            self.future = self._submit(work, task)
        self.cases += 1
        return self.future

    def _submit(self, work: TaskRunner, task: CaseTask) -> Future[CaseAnswer]:
        if self.executor is not None:
            return self.executor.submit(work, task)
        self.executor = ProcessPoolExecutor(1, get_context("spawn"), _initialize_worker, (os.getpid(),))
        self.cases = 0
        with worker_start_context():  # the process starts with its first task
            return self.executor.submit(work, task)

    def end(self, at_once: bool = False) -> None:
        """End the process, after its case or at once."""
        if self.executor is not None:
            if at_once:
                self.kill()
            self.executor.shutdown(wait=at_once, cancel_futures=True)
            self.executor = None

    def kill(self) -> None:
        """Kill the process, so that its case fails."""
        for process in list((getattr(self.executor, "_processes", None) or {}).values()):
            process.kill()


def core_count() -> int:
    """Number of cores available to this program."""
    allowed = getattr(os, "sched_getaffinity", None)
    return len(allowed(0)) if allowed else os.cpu_count() or 1


class LocalPool:
    """Pool of spawned worker processes on this machine.

    Parameters
    ----------
    workers : int
        Number of processes.
    work : callable
        Function that runs a task in a worker process.
    recycle : int
        Cases of a process before it is replaced.
    """

    can_blame_case = True

    def __init__(self, workers: int, work: TaskRunner = work_on_case, recycle: int = RECYCLE_AFTER) -> None:
        self._slots = [_WorkerSlot() for _ in range(workers)]
        self._work, self._recycle = work, recycle
        self.overdue: set[Future[CaseAnswer]] = set()

    def free_slot_count(self) -> int:
        """Number of idle processes."""
        return sum(lane.is_free for lane in self._slots)

    def running_count(self) -> int:
        """Number of running cases."""
        return len(self._slots) - self.free_slot_count()

    def start(self, task: CaseTask) -> Future[CaseAnswer]:
        """Start a case in a free process."""
        lane = next(lane for lane in self._slots if lane.is_free)
        return lane.start(self._work, task, self._recycle)

    def supervise_workers(self) -> None:
        """Kill the processes of overdue cases."""
        for lane in self._slots:
            if lane.future is not None and not lane.is_free and time.monotonic() > lane.until:
                self.overdue.add(lane.future)
                lane.kill()

    def close(self, at_once: bool) -> None:
        """End the processes, after their cases or at once."""
        for lane in self._slots:
            lane.end(at_once)


_ONE_CORE = dict.fromkeys(
    ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1"
)


@contextlib.contextmanager
def worker_start_context() -> Iterator[None]:
    """Start processes in this context with one core each and Ctrl+C ignored."""
    before = {name: os.environ.get(name) for name in _ONE_CORE}
    main = threading.current_thread() is threading.main_thread()
    handler = signal.signal(signal.SIGINT, signal.SIG_IGN) if main else None
    os.environ.update(_ONE_CORE)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
        if main:
            signal.signal(signal.SIGINT, handler)
