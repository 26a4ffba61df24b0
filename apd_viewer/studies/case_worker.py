"""The task of a worker: one case, by one core, with its set-up in the task itself.

So a worker needs no environment of its own, whoever started it.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from functools import cache
from itertools import count
from typing import NamedTuple

from threadpoolctl import threadpool_limits

from apd_viewer.files.storage.regular_files import read_bytes
from apd_viewer.geometry.analysis.self_intersections import use_one_core_for_search
from apd_viewer.geometry.linalg.threads import use_one_core
from apd_viewer.session.jobs.freed_memory import give_back_freed_memory, keep_freed_memory
from apd_viewer.studies.case_document import CaseDocuments, MissingInputError
from apd_viewer.studies.case_file import case_to_bytes
from apd_viewer.studies.kernel_compilation import compile_kernels_once
from apd_viewer.studies.plans.case import InputFile, StudyCase
from apd_viewer.studies.run_case import run_case

# A process runs one case at a time: memory is measured by it, and kernels run one at a time anyway.
_ONE_CASE = threading.Lock()
# Cases after which freed memory is given back: kept in pieces, it grows for hundreds of cases.
_TRIMMED = 5
_ended = count(1)
_sent: dict[str, bytes] = {}


class CaseTask(NamedTuple):
    """A case for a worker.

    Attributes
    ----------
    case : StudyCase
    time_limit : float or None
        Seconds that it may take.
    sent_inputs : mapping of str to bytes
        Content of its sources by digest, for a worker that has not got them; empty at first.
    """

    case: StudyCase
    time_limit: float | None = None
    sent_inputs: Mapping[str, bytes] = {}


class CaseAnswer(NamedTuple):
    """Reply of a worker.

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
                give_back_freed_memory()


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
