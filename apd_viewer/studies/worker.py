"""The task of a worker: one case, by one core, with its set-up in the task itself.

So a worker needs no environment of its own, whoever started it.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from functools import cache
from itertools import count
from typing import TYPE_CHECKING, NamedTuple

from threadpoolctl import threadpool_limits

from apd_viewer.files.storage.reading import bytes_of
from apd_viewer.geometry.analysis.self_intersections import search_by_one_core
from apd_viewer.geometry.linalg.threads import use_one_core
from apd_viewer.session.jobs.freed_memory import give_back_freed_memory, keep_freed_memory
from apd_viewer.studies.case_document import MissingSourceError, OpenedMeshes
from apd_viewer.studies.case_file import packed
from apd_viewer.studies.kernels import compile_once
from apd_viewer.studies.run_case import run_case

if TYPE_CHECKING:
    from apd_viewer.studies.plans.case import Source, StudyCase

# A process runs one case at a time: memory is measured by it, and kernels run one at a time anyway.
_ONE_CASE = threading.Lock()
# Cases after which freed memory is given back: kept in pieces, it grows for hundreds of cases.
_TRIMMED = 5
_ended = count(1)
_sent: dict[str, bytes] = {}


class Task(NamedTuple):
    """A case for a worker.

    Attributes
    ----------
    case : StudyCase
    limit : float or None
        Seconds that it may take.
    sent : mapping of str to bytes
        Content of its sources by digest, for a worker that has not got them; empty at first.
    """

    case: StudyCase
    limit: float | None = None
    sent: Mapping[str, bytes] = {}


class CaseAnswer(NamedTuple):
    """Reply of a worker.

    Attributes
    ----------
    content : bytes
        The result, as its file holds it; empty where sources are missing.
    missing : tuple of str
        Digests of sources that the worker has not got and cannot see: they are to be sent.
    """

    content: bytes
    missing: tuple[str, ...] = ()


Work = Callable[[Task], CaseAnswer]


def work(task: Task) -> CaseAnswer:
    """Run a case in this process."""
    with _ONE_CASE:
        _prepare_process()
        use_one_core()
        _sent.update(task.sent)
        try:
            return CaseAnswer(packed(run_case(task.case, _meshes(), task.limit)))
        except MissingSourceError:
            return CaseAnswer(b"", tuple(source.digest for source in task.case.sources))
        finally:
            _sent.clear()
            if next(_ended) % _TRIMMED == 0:
                give_back_freed_memory()


@cache
def _prepare_process() -> None:
    keep_freed_memory()
    threadpool_limits(1, user_api="blas")
    search_by_one_core()
    compile_once()


@cache
def _meshes() -> OpenedMeshes:
    return OpenedMeshes(_content)


def _content(source: Source) -> bytes:
    if source.digest in _sent:
        return _sent[source.digest]
    try:
        return bytes_of(source.path)
    except OSError:
        raise MissingSourceError from None
