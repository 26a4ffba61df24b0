"""One line of progress: on a terminal, or in the output of a notebook's cell."""

from __future__ import annotations

import sys
import time
from typing import Any, Protocol

from apd_viewer.geometry.pose.frame import Frame
from apd_viewer.language import tr

_INTERVAL = 0.1  # s; the eye reads no faster


class _Place(Protocol):
    """Place of the line."""

    def show(self, text: str) -> None:
        """Replace the line."""

    def end(self) -> None:
        """Leave the line as it is; what follows comes below it."""


class ProgressLine:
    """Progress of iterations, a few times a second; silent without a reader.

    Parameters
    ----------
    iterations : int or None
        How many there will be, where that is known.
    """

    def __init__(self, iterations: int | None = None) -> None:
        self._iterations = iterations
        self._place = _place()
        self._last = -_INTERVAL
        self._text = self._shown = ""

    def __call__(self, frame: Frame) -> None:
        """Show a frame, unless the last one was shown only just."""
        if self._place is None:
            return
        self._text = frame_line(frame, self._iterations)
        now = time.monotonic()
        if now - self._last >= _INTERVAL:
            self._last = now
            self._show(self._place)

    def end(self) -> None:
        """Show the last frame, and leave it there."""
        if self._place is not None and self._text:
            self._show(self._place)
            self._place.end()

    def _show(self, place: _Place) -> None:
        if self._text != self._shown:
            self._shown = self._text
            place.show(self._text)


def frame_line(frame: Frame, iterations: int | None = None) -> str:
    """Iteration, of so many if that is known, and area of a frame."""
    area = 100 * frame.area_error
    if iterations:
        return tr("iteration {done:,} of {all:,}   area {area:+.3f} %").format(
            done=frame.iteration, all=iterations, area=area
        )
    return tr("iteration {done:,}   area {area:+.3f} %").format(done=frame.iteration, area=area)


class _Terminal:
    """Line on the standard error."""

    def __init__(self) -> None:
        self._longest = 0

    def show(self, text: str) -> None:
        self._longest = max(self._longest, len(text))
        print(f"\r{text.ljust(self._longest)}", end="", file=sys.stderr, flush=True)  # noqa: T201

    def end(self) -> None:
        print(file=sys.stderr, flush=True)  # noqa: T201


class _Cell:
    """Line below the cell of a notebook, by IPython."""

    def __init__(self, display: Any) -> None:
        self._display = display
        self._handle: Any = None

    def show(self, text: str) -> None:
        content = {"text/plain": text}
        if self._handle is None:
            self._handle = self._display(content, raw=True, display_id=True)
        else:
            self._handle.update(content, raw=True)

    def end(self) -> None:
        pass


def _place() -> _Place | None:
    """Place with a reader: a terminal, a notebook, or none."""
    if sys.stderr is not None and sys.stderr.isatty():
        return _Terminal()
    # Whoever works in a notebook has loaded it; it is no dependency.
    ipython = sys.modules.get("IPython")
    if ipython is None or ipython.get_ipython() is None:
        return None
    return _Cell(ipython.display.display)
