"""Comparison of methods: one document solved by each in turn.

All methods start from the rest shape, as :func:`apd_viewer.deform` does, independent of earlier shapes. Only
a shape that solves the document already is taken as it is. They share one process, which ends after the last
method: memory may not suffice for two large ones.

All methods of the class are called on one thread.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum

from apd_viewer.geometry.pose.frame import Frame
from apd_viewer.session.model.document import Document
from apd_viewer.session.processes.request_and_reply import Cost, Reply, Request
from apd_viewer.session.processes.solver_worker import SolverWorker


class OutcomeOrigin(Enum):
    """Origin of an outcome: a comparison, or the displayed shape.

    Of the latter, its path is either from the rest shape, as in a comparison, or another one.
    """

    COMPARISON = "comparison"
    DISPLAYED = "displayed"
    OTHER_PATH = "other path"

    @property
    def has_same_path(self) -> bool:
        """True if the path starts at rest, as in a comparison."""
        return self is not OutcomeOrigin.OTHER_PATH


@dataclass(frozen=True, eq=False)
class MethodOutcome:
    """Progress and result of one method.

    Attributes
    ----------
    frame : Frame or None
        The latest shape, and its readings.
    is_finished : bool
        True if no further shape follows.
    cost : Cost or None
        Cost of the result, known at the end.
    failure : str or None
        Sentence on the reason for a missing or unfinished shape.
    origin : OutcomeOrigin
    """

    frame: Frame | None = None
    is_finished: bool = False
    cost: Cost | None = None
    failure: str | None = None
    origin: OutcomeOrigin = OutcomeOrigin.COMPARISON


class Comparison:
    """Solves a document by several methods, one after another.

    Parameters
    ----------
    document : Document
        Document to solve; its own method is ignored.
    wake : callable
        Called on another thread when there is something to :meth:`receive`; must only pass it on.
    known : MethodOutcome or None
        Outcome of the document's own method, where it is known already.

    Attributes
    ----------
    outcomes : dict of str to MethodOutcome
        Outcomes by method; methods not yet started are missing.
    current_method : str or None
        The method that is being solved.
    news : str
        Sentence on an event of the solver; mostly empty.
    """

    def __init__(
        self, document: Document, wake: Callable[[], object], known: MethodOutcome | None = None
    ) -> None:
        self.document = document
        self.outcomes = {} if known is None else {document.settings.method: known}
        self.current_method: str | None = None
        self.news = ""
        self._wake = wake
        self._wanted: tuple[str, ...] = ()
        self._worker: SolverWorker | None = None
        self._asked: Document | None = None
        self._generation = 0

    def set_methods(self, methods: Sequence[str]) -> None:
        """Compare exactly these methods, in this order; finished results are kept."""
        self._wanted = tuple(methods)
        if self.current_method is not None and self.current_method not in self._wanted:
            del self.outcomes[self.current_method]
            self.current_method = None
        self._start_next()

    @property
    def queued_methods(self) -> tuple[str, ...]:
        """Names of the methods not yet started."""
        return tuple(method for method in self._wanted if method not in self.outcomes)

    def method_before(self, method: str) -> str | None:
        """Method that a queued one waits for; None if it does not wait."""
        order = [each for each in (self.current_method, *self.queued_methods) if each is not None]
        k = order.index(method) if method in order else 0
        return order[k - 1] if k else None

    def receive_reply(self) -> bool:
        """Process the next solver reply; return True if there was one."""
        reply = self._worker.take_reply() if self._worker is not None else None
        if reply is None:
            return False
        self.news = reply.news or self.news
        if reply.request.document is self._asked and self.current_method is not None:
            self._receive_reply(self.current_method, reply)
        return True

    def _receive_reply(self, method: str, reply: Reply) -> None:
        frame = reply.frame or self.outcomes[method].frame
        self.outcomes[method] = MethodOutcome(frame, reply.finished, reply.cost, reply.failure)
        if reply.finished:
            self.current_method = None
            self._start_next()

    def _start_next(self) -> None:
        """Start the next method, or end the process after the last one."""
        if self.current_method is not None:
            return
        if not self.queued_methods:
            self._end()
            return
        self.current_method = self.queued_methods[0]
        self.outcomes[self.current_method] = MethodOutcome()
        self._asked = self.document.relative_to_rest.with_settings(method=self.current_method)
        self._generation += 1
        if self._worker is None:
            self._worker = SolverWorker(self._wake)
        self._worker.put_request(
            Request(self._asked, self._generation, self.document.mesh.V, True, is_timed=True)
        )

    def stop(self) -> None:
        """End the solver process; unfinished methods keep their latest shape."""
        self._wanted = tuple(method for method in self._wanted if method in self.outcomes)
        self.current_method = None
        self._end()

    def _end(self) -> None:
        self._asked = None
        worker, self._worker = self._worker, None
        if worker is not None:
            worker.close()
