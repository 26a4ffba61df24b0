"""Answers of a process to the newest question; the process is killed on cancel."""

import contextlib
import threading
from collections.abc import Callable
from typing import Generic, TypeVar

from apd_viewer.session.processes.child_process import ChildProcess
from apd_viewer.session.processes.mailbox import Mailbox

Question = TypeVar("Question")
Answer = TypeVar("Answer")


def wait_for_answer(
    process: ChildProcess,
    exchange: Callable[[ChildProcess, Question], Answer | None],
    fallback: Answer,
    question: Question,
) -> Answer:
    """Wait for the answer of a process to one question; see :class:`NewestAnswer`."""
    answer = None
    with contextlib.suppress(OSError):  # the process cannot be started
        process.start()
        answer = exchange(process, question)
    process.end()
    return fallback if answer is None else answer


class NewestAnswer(Generic[Question, Answer]):
    """Asynchronous answers of a process; a new question replaces the pending one.

    Parameters
    ----------
    wake : callable
        Called on a thread when there is an answer to take.
    exchange : callable
        ``exchange(process, question)``: the answer, or None if the process has died.
    fallback : object
        The answer where the process died, or cannot be started.
    pause : callable
        ``pause(first)``: seconds to wait before a question, the first one or another, as a newer may follow.
    """

    def __init__(
        self,
        wake: Callable[[], object],
        process: ChildProcess,
        exchange: Callable[[ChildProcess, Question], Answer | None],
        fallback: Answer,
        pause: Callable[[bool], float],
    ) -> None:
        self._wake, self._exchange, self._unknown, self._pause = wake, exchange, fallback, pause
        self._questions: Mailbox[Question] = Mailbox()
        self._answers: Mailbox[tuple[Question, Answer]] = Mailbox()
        self._wanted: Question | None = None
        self._process = process
        self._busy = False
        self._lock = threading.Lock()
        self._closed = threading.Event()
        self._thread = threading.Thread(target=self._run, name=process.title, daemon=True)
        self._thread.start()

    def ask(self, question: Question) -> None:
        """Ask ``question`` in place of any other, without blocking."""
        self.cancel()
        self._wanted = question
        self._questions.put(question)

    def cancel(self) -> None:
        """Cancel the pending question, and kill its process."""
        self._wanted = None
        self._questions.take()
        with self._lock:
            if self._busy:
                self._process.kill()

    def take(self) -> tuple[Question, Answer] | None:
        """Take the answer to the last question; None if not yet available."""
        answer = self._answers.take()
        return answer if answer is not None and answer[0] is self._wanted else None

    def close(self) -> None:
        """End the process and the thread."""
        self.cancel()
        self._closed.set()
        self._questions.close()
        self._thread.join()

    # Methods of the thread

    def _run(self) -> None:
        first = True
        while self._questions.wait_for_value(threading.TIMEOUT_MAX):
            self._closed.wait(self._pause(first))
            first = False
            question = self._questions.wait()
            if question is None:
                break
            answer = self._answer(question)
            if question is self._wanted:
                self._answers.put((question, answer))
                self._wake()
        self._process.end()

    def _answer(self, question: Question) -> Answer:
        try:
            with self._lock:
                if question is not self._wanted:
                    return self._unknown
                if self._process.pid is None:
                    self._process.start()
                self._busy = True
            answer = self._exchange(self._process, question)
        except OSError:  # the process cannot be started
            answer = None
        with self._lock:
            self._busy = False
            # The process may have been killed after its answer was received, for a newer question.
            ended = answer is None or self._process.is_killed
        if ended:
            self._process.end()
        return self._unknown if answer is None else answer
