"""Background task on a separate thread; only the latest request counts."""

import threading
from collections.abc import Callable
from contextlib import suppress

from PySide6.QtCore import QObject, Qt, Signal

# Task; its argument is a function returning True once the result is no longer wanted.
Work = Callable[[Callable[[], bool]], object]


class BackgroundTask(QObject):
    """Runs one task at a time, and emits the result on the GUI thread.

    Attributes
    ----------
    done : Signal(object)
        The result of what was asked for last, None where there was no memory for it.
    """

    done = Signal(object)
    _ended = Signal(object, object)

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self._wanted: Work | None = None
        self._thread: threading.Thread | None = None
        self._ended.connect(self._end, Qt.ConnectionType.QueuedConnection)

    @property
    def is_busy(self) -> bool:
        """True while a result is pending."""
        return self._wanted is not None

    def begin(self, work: Work) -> None:
        """Run ``work`` as soon as the previous task has stopped."""
        self._wanted = work
        if self._thread is None:
            self._start(work)

    def cancel(self) -> None:
        """Discard the pending task, and the result of the running one."""
        self._wanted = None

    def close(self) -> None:
        """Wait for the thread: work during interpreter exit would crash it."""
        self.cancel()
        if self._thread is not None:
            self._thread.join()
            self._thread = None

    def _start(self, work: Work) -> None:
        self._thread = threading.Thread(target=self._run, args=(work,), name="measuring", daemon=True)
        self._thread.start()

    def _run(self, work: Work) -> None:
        result = None
        with suppress(MemoryError):
            result = work(lambda: self._wanted is not work)
        self._ended.emit(work, result)

    def _end(self, work: Work, result: object) -> None:
        if self._thread is None:
            return  # the task was closed in the meantime
        self._thread.join()
        self._thread = None
        if self._wanted is work:
            self._wanted = None
            self.done.emit(result)
        elif self._wanted is not None:
            self._start(self._wanted)
