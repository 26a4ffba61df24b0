"""Checks of the newest shape in a process, ended as soon as the shape moves."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from apd_viewer.geometry.analysis.shape_check import Examination
from apd_viewer.session.jobs.mailbox import Mailbox
from apd_viewer.session.processes.child_process import START, ChildProcess
from apd_viewer.session.processes.shape_check_main import NOBODY_LOOKED

_START = START.format(module="processes.shape_check_main")
# A settled shape is often moved again at once, and a program just starting has more urgent work.
_CALM, _AT_FIRST = 0.3, 2.0  # s
# Result if the process died or cannot be started.
UNKNOWN = Examination(None, (math.nan, math.nan, math.nan), math.nan)


@dataclass(frozen=True, eq=False)
class Shape:
    """A shape to check: positions ``U`` (n, 3), welded triangles ``F`` (m, 3)."""

    U: np.ndarray
    F: np.ndarray


class Examiner:
    """Examines one shape at a time; the newest wins.

    Parameters
    ----------
    wake : callable
        Called on a thread when there is an examination to take.
    """

    def __init__(self, wake: Callable[[], object]) -> None:
        self._wake = wake
        self._shapes: Mailbox[Shape] = Mailbox()
        self._found: Mailbox[tuple[Shape, Examination]] = Mailbox()
        self._wanted: Shape | None = None
        self._process = ChildProcess("shape check", _START)
        self._busy = False
        self._lock = threading.Lock()
        self._closed = threading.Event()
        self._thread = threading.Thread(target=self._run, name="examiner", daemon=True)
        self._thread.start()

    def ask(self, shape: Shape) -> None:
        """Examine ``shape`` soon instead of any other. Never blocks."""
        self.forget()
        self._wanted = shape
        self._shapes.put(shape)

    def forget(self) -> None:
        """Examine nothing; end an examination in progress."""
        self._wanted = None
        self._shapes.take()
        with self._lock:
            if self._busy:
                self._process.kill()

    def take(self) -> tuple[Shape, Examination] | None:
        """Take the result for the shape asked for last; None if there is none yet."""
        found = self._found.take()
        return found if found is not None and found[0] is self._wanted else None

    def close(self) -> None:
        """End the process and the thread."""
        self.forget()
        self._closed.set()
        self._shapes.close()
        self._thread.join()

    # The thread "examiner"

    def _run(self) -> None:
        begun = False
        while self._shapes.comes_within(threading.TIMEOUT_MAX):
            self._closed.wait(_CALM if begun else _AT_FIRST)
            begun = True
            shape = self._shapes.wait()
            if shape is None:
                break
            found = self._examined(shape)
            if shape is self._wanted:
                self._found.put((shape, found))
                self._wake()
        self._process.end()

    def _examined(self, shape: Shape) -> Examination:
        try:
            with self._lock:
                if shape is not self._wanted:
                    return UNKNOWN
                if self._process.pid is None:
                    self._process.start()
                self._busy = True
            found = self._answer(shape)
        except OSError:  # there can be no process
            found = None
        with self._lock:
            self._busy = False
        if found is None:
            self._process.end()
        return UNKNOWN if found is None else found

    def _answer(self, shape: Shape) -> Examination | None:
        """Return the examination of a shape; None if the process has died."""
        process = self._process
        if not process.send(np.ascontiguousarray(shape.F, np.int32), np.ascontiguousarray(shape.U)):
            return None
        crossing, boxes = process.receive(), process.receive()
        if crossing is None or boxes is None:
            return None
        ids = None if crossing == NOBODY_LOOKED else np.frombuffer(crossing, dtype=np.int64)
        dx, dy, dz, packed = np.frombuffer(boxes).tolist()
        return Examination(ids, (dx, dy, dz), packed)
