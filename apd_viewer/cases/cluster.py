"""Engine of Dask workers behind a running scheduler.

Tasks are sent as pickles, which can run any code: use only a trusted scheduler.
"""

import time
from concurrent.futures import Future
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

from apd_viewer.cases.case_worker import CaseAnswer, CaseTask, TaskRunner, run_task as work_on_case
from apd_viewer.errors import InputError
from apd_viewer.installation import is_packaged
from apd_viewer.language import tr

ANSWER_SECONDS = 20  # seconds the scheduler may take to answer
_GONE = 30.0  # seconds without a scheduler before it counts as lost
_LOOK = 2.0  # seconds between two counts of the workers
_PROFILE_CALLBACKS = ("profile", "profile-cycle")


class Cluster:
    """Dask workers as an engine for cases.

    Parameters
    ----------
    client : distributed.Client
    work : callable
        Function that runs a task on a worker.
    """

    # Dask also blames prefetched cases for the death of their worker.
    can_blame_case = False

    def __init__(self, client: Any, work: TaskRunner = work_on_case) -> None:
        self._client, self._work = client, work
        self._executor = client.get_executor(pure=False, retries=2)
        self._futures: set[Future[CaseAnswer]] = set()
        self.overdue: set[Future[CaseAnswer]] = set()
        self._threads, self._looked = 0, -_LOOK
        self._gone_since: float | None = None

    def free_slot_count(self) -> int:
        """Number of cases to submit now, with one queued per running case."""
        now = time.monotonic()
        if now - self._looked > _LOOK:
            self._looked = now
            self._threads = self._thread_count()
        return 2 * self._threads - len(self._futures)

    def _thread_count(self) -> int:
        """Total number of worker threads; 0 without a scheduler."""
        try:
            return sum(self._client.nthreads().values()) if self._is_alive else 0
        except OSError:
            return 0

    @property
    def _is_alive(self) -> bool:
        return self._client.status == "running"

    def running_count(self) -> int:
        """Number of running cases."""
        return min(self._threads, len(self._futures))

    def start(self, task: CaseTask) -> Future[CaseAnswer]:
        """Submit a case to the scheduler."""
        future: Future[CaseAnswer] = self._executor.submit(_run_unprofiled, self._work, task)
        self._futures.add(future)
        # Results are released on arrival: Dask would recompute retained ones after the death of a worker.
        future.add_done_callback(self._futures.discard)
        return future

    def supervise_workers(self) -> None:
        """Raise InputError once the scheduler has been unreachable for too long."""
        now = time.monotonic()
        self._gone_since = None if self._is_alive else self._gone_since or now
        if self._gone_since is not None and now - self._gone_since > _GONE:
            raise InputError(
                tr("The scheduler is gone. Finished cases are kept; repeat the command to continue.")
            )

    def close(self, at_once: bool) -> None:
        """Withdraw the cases not yet started, and disconnect from the scheduler."""
        if self._is_alive:
            self._executor.shutdown(wait=False)
        # Dask raises OSError if closing takes too long; its threads then end with this process.
        with suppress(OSError):
            self._client.close(timeout=1 if at_once else ANSWER_SECONDS)


def _run_unprofiled(work: TaskRunner, task: CaseTask) -> CaseAnswer:
    """Run a task in a worker without Dask's profiler."""
    _end_profile()
    return work(task)


@cache
def _end_profile() -> None:
    """Stop Dask's profiler in this process.

    It interrupts the case every 10 ms, and grows by a quarter of a mebibyte per second.
    """
    try:
        worker = _import_distributed().get_worker()
    except ValueError:  # not in a Dask worker, for example in a test
        return
    for name in _PROFILE_CALLBACKS:
        if callback := worker.periodic_callbacks.get(name):
            worker.loop.add_callback(callback.stop)


def connect_cluster(
    address: str | None, scheduler_file: Path | None, work: TaskRunner = work_on_case
) -> Cluster:
    """Connect to the Dask workers of a scheduler.

    Parameters
    ----------
    address : str or None
        Such as ``tcp://host:8786`` or ``tls://host:8786``; None with a file.
    scheduler_file : Path or None
        File written by the scheduler, with its address.

    Raises
    ------
    InputError
        Without Dask, or if there is no such scheduler.
    """
    where = {"scheduler_file": str(scheduler_file)} if scheduler_file else {"address": address}
    if scheduler_file and not scheduler_file.is_file():
        raise InputError(tr("There is no file {path}; check the name.").format(path=scheduler_file))
    distributed = _import_distributed()
    try:
        return Cluster(distributed.Client(**where, timeout=ANSWER_SECONDS), work)
    except (OSError, ValueError, TypeError) as error:
        raise InputError(
            tr("No scheduler answers at {where} ({reason}); check the address.").format(
                where=scheduler_file or address, reason=error or type(error).__name__
            )
        ) from error


def _import_distributed() -> Any:
    try:
        # Imported here: Dask is an optional dependency and takes half a second to load.
        import distributed
    except ImportError as error:
        if is_packaged():
            said = tr("Dask is missing here; install apd-viewer[cluster] with pip, or omit the scheduler.")
        else:
            said = tr("Dask is not installed; install apd-viewer[cluster], or omit the scheduler.")
        raise InputError(said) from error
    return distributed
