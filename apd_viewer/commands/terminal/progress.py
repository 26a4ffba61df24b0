"""Progress of long work: a bar on a terminal, lines for a parent program or a log."""

import json
import math
import sys
import time

from apd_viewer.commands.terminal.columns import column_count, padded_text, shortened_text

_WIDTH = 24
_INTERVAL = 0.1  # least seconds between two updates


class Progress:
    """Progress display, updated at most ten times a second; silent without a reader.

    Parameters
    ----------
    is_json : bool
        Say it on the standard output, as lines of JSON such as ``{"done": 0.5, "doing": "..."}``.
    log_interval : float
        Seconds between two lines of a log, which is written where there is no terminal; by default none is.
    """

    def __init__(self, is_json: bool = False, log_interval: float = math.inf) -> None:
        self._lines = is_json
        self._bar = not is_json and sys.stderr.isatty()
        self._is_log = not (self._lines or self._bar)
        self._interval = log_interval if self._is_log else _INTERVAL
        self._last = time.monotonic() if self._is_log else -_INTERVAL
        self._shown = ""

    def show(self, done: float, doing: str, **numbers: float | None) -> None:
        """Show the fraction of work done, 0 to 1, and the current step.

        Lines have ``numbers`` numbers as well.
        """
        now = time.monotonic()
        if now - self._last < self._interval and (done < 1.0 or self._is_log):
            return
        self._last = now
        if self._is_log:
            print(doing, file=sys.stderr, flush=True)
            return
        if self._lines:
            print(json.dumps({"done": round(done, 4), "doing": doing, **numbers}), flush=True)
            return
        full = round(_WIDTH * done)
        said = f"{'━' * full}{'╌' * (_WIDTH - full)} {100 * done:3.0f} %  {doing}"
        # A longer text would wrap, and the next update could not overwrite it.
        self._draw(shortened_text(said, 79))

    def end(self) -> None:
        """Remove the progress bar."""
        if self._bar and self._shown:
            self._draw("")
            print("\r", end="", file=sys.stderr, flush=True)

    def _draw(self, text: str) -> None:
        print(f"\r{padded_text(text, column_count(self._shown))}", end="", file=sys.stderr, flush=True)
        self._shown = text
