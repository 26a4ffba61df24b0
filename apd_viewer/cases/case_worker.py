"""Task of a worker: one case on one core, including the set-up of the process.

A worker thus needs no environment of its own.

A process keeps half a gigabyte after compiling, so workers do not compile. The first worker on a machine
starts another process to compile, which leaves a marker file; the other workers wait for it.
"""

import contextlib
import getpass
import hashlib
import os
import socket
import stat
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Mapping
from functools import cache
from importlib import metadata
from itertools import count
from pathlib import Path
from typing import NamedTuple

from threadpoolctl import threadpool_limits

from apd_viewer.cases.case_file import case_to_bytes
from apd_viewer.cases.run_case import CaseDocuments, MissingInputError, run_case
from apd_viewer.cases.study_case import InputFile, StudyCase
from apd_viewer.files.storage.lock import acquire_lock
from apd_viewer.files.storage.regular_files import read_bytes
from apd_viewer.geometry.analysis.self_intersections import use_one_core_for_search
from apd_viewer.geometry.linalg.threads import use_one_core
from apd_viewer.session.processes.freed_memory import keep_freed_memory, release_freed_memory

# One case at a time: memory is measured per process, and kernels run one at a time anyway.
_ONE_CASE = threading.Lock()
# Number of cases between releases of freed memory, which would get fragmented over hundreds of cases.
_TRIMMED = 5
_ended = count(1)
_sent: dict[str, bytes] = {}


class CaseTask(NamedTuple):
    """One case for a worker, with its time limit and inputs.

    Attributes
    ----------
    time_limit : float or None
        Seconds that it may take.
    sent_inputs : mapping of str to bytes
        Content of its sources by digest, for a worker that has not got them; empty at first.
    """

    case: StudyCase
    time_limit: float | None = None
    sent_inputs: Mapping[str, bytes] = {}


class CaseAnswer(NamedTuple):
    """Reply of a worker: a result, or the digests of missing inputs.

    Attributes
    ----------
    content : bytes
        The result, as its file holds it; empty where sources are missing.
    missing_inputs : tuple of str
        Digests of sources that the worker has not got and cannot see: they are to be sent.
    """

    content: bytes
    missing_inputs: tuple[str, ...] = ()


TaskRunner = Callable[[CaseTask], CaseAnswer]


def run_task(task: CaseTask) -> CaseAnswer:
    """Run a case in this process."""
    with _ONE_CASE:
        _prepare_process()
        use_one_core()
        _sent.update(task.sent_inputs)
        try:
            return CaseAnswer(case_to_bytes(run_case(task.case, _meshes(), task.time_limit)))
        except MissingInputError:
            return CaseAnswer(b"", tuple(source.digest for source in task.case.input_files))
        finally:
            _sent.clear()
            if next(_ended) % _TRIMMED == 0:
                release_freed_memory()


@cache
def _prepare_process() -> None:
    keep_freed_memory()
    threadpool_limits(1, user_api="blas")
    use_one_core_for_search()
    compile_kernels_once()


@cache
def _meshes() -> CaseDocuments:
    return CaseDocuments(_content)


def _content(source: InputFile) -> bytes:
    if source.digest in _sent:
        return _sent[source.digest]
    try:
        return read_bytes(source.path)
    except OSError:
        raise MissingInputError from None


_PACKAGE = Path(__file__).parents[1]
_LONGEST = 600.0  # longest wait in seconds; compiling takes about two minutes
_PAUSE = 0.2  # seconds between attempts to get the lock
_PROGRAM = "from apd_viewer.geometry.warmup import warm_up; warm_up()"


def compile_kernels_once() -> None:
    """Compile the kernels into this machine's cache, once for all its workers."""
    # A failure is harmless: the first case then compiles the kernels itself.
    with contextlib.suppress(Exception):
        mark = _marker_path()
        mark.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        if not _is_private_folder(mark.parent):
            return
        end = time.monotonic() + _LONGEST
        while not mark.exists() and time.monotonic() < end:
            lock = acquire_lock(mark.with_suffix(".lock"))
            if lock is None:
                time.sleep(_PAUSE)
                continue
            try:
                if not mark.exists():
                    _compile()
                    mark.touch()
            finally:
                lock.release()


def _compile() -> None:
    environment = {**os.environ, "NUMBA_NUM_THREADS": "1"}
    # If this process fails, the first case compiles the missing kernels.
    subprocess.run(
        [sys.executable, "-c", _PROGRAM],
        env={**environment, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        timeout=_LONGEST,
        check=False,
    )


def _is_private_folder(folder: Path) -> bool:
    """True if no other user can write to a folder.

    In a shared place, any user may have created it.
    """
    there = folder.lstat()
    if sys.platform == "win32":  # temporary folders are private to the user on Windows
        return True
    return stat.S_ISDIR(there.st_mode) and there.st_uid == os.getuid() and not there.st_mode & 0o022


def _marker_path() -> Path:
    """Path of the marker file for compiled kernels on this machine."""
    told = hashlib.sha256()
    for path in sorted(_PACKAGE.rglob("*.py")):
        there = path.stat()
        told.update(f"{path} {there.st_size} {there.st_mtime_ns}\n".encode())
    for word in (
        sys.version,
        metadata.version("numba"),
        socket.gethostname(),
        os.environ.get("NUMBA_CACHE_DIR", ""),
    ):
        told.update(word.encode())
    return (
        Path(tempfile.gettempdir()) / f"apd-viewer-{getpass.getuser()}" / f"{told.hexdigest()[:24]}.compiled"
    )
