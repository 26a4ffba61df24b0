"""One-line progress display on a terminal or in a notebook."""

import sys
import time
from typing import Any, Protocol

from apd_viewer.geometry.pose.frame import Frame
from apd_viewer.language import tr

_INTERVAL = 0.1  # seconds between updates, as fast as the eye can read


class _Output(Protocol):
    """Output of a progress line."""

    def show(self, text: str) -> None:
        """Replace the displayed text."""

    def end(self) -> None:
        """Keep the last text; further output starts below it."""


class ProgressLine:
    """Progress line of iterations, up to 10 updates a second; silent without output.

    Parameters
    ----------
    iterations : int or None
        Number of all iterations, if known.
    """

    def __init__(self, iterations: int | None = None) -> None:
        self._iterations = iterations
        self._output = _progress_output()
        self._last = -_INTERVAL
        self._text = self._shown = ""

    def __call__(self, frame: Frame) -> None:
        """Display a frame, at most every 0.1 s."""
        if self._output is None:
            return
        self._text = frame_line(frame, self._iterations)
        now = time.monotonic()
        if now - self._last >= _INTERVAL:
            self._last = now
            self._show(self._output)

    def end(self) -> None:
        """Display the last frame and finish the line."""
        if self._output is not None and self._text:
            self._show(self._output)
            self._output.end()

    def _show(self, output: _Output) -> None:
        if self._text != self._shown:
            self._shown = self._text
            output.show(self._text)


def frame_line(frame: Frame, iterations: int | None = None) -> str:
    """Text of a frame: iteration, total if known, and area error."""
    area = 100 * frame.area_error
    if iterations:
        return tr("iteration {done:,} of {all:,}   area {area:+.3f} %").format(
            done=frame.iteration, all=iterations, area=area
        )
    return tr("iteration {done:,}   area {area:+.3f} %").format(done=frame.iteration, area=area)


class _Terminal:
    """Progress line on standard error."""

    def __init__(self) -> None:
        self._longest = 0

    def show(self, text: str) -> None:
        self._longest = max(self._longest, len(text))
        print(f"\r{text.ljust(self._longest)}", end="", file=sys.stderr, flush=True)  # noqa: T201

    def end(self) -> None:
        print(file=sys.stderr, flush=True)  # noqa: T201


class _Cell:
    """Progress line below a notebook cell, by IPython."""

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


def _progress_output() -> _Output | None:
    """Terminal or notebook cell for the progress line; None elsewhere."""
    if sys.stderr is not None and sys.stderr.isatty():
        return _Terminal()
    # IPython is no dependency, but already imported in any notebook.
    ipython = sys.modules.get("IPython")
    if ipython is None or ipython.get_ipython() is None:
        return None
    return _Cell(ipython.display.display)
