"""A pipe that sees who opens it to read, and lets go of them."""

import os
import threading
from pathlib import Path


class WatchedPipe:
    """A pipe without a writer; whoever waits for one is noted, and goes on with nothing.

    Parameters
    ----------
    path : path

    Attributes
    ----------
    opened : bool
        Whether anybody has waited for a writer.
    """

    def __init__(self, path):
        self.path, self.opened = Path(path), False
        os.mkfifo(self.path)
        self._ends = threading.Event()
        self._watch = threading.Thread(target=self._look, daemon=True)
        self._watch.start()

    def _look(self):
        while not self._ends.wait(0.005):
            try:
                writer = os.open(self.path, os.O_WRONLY | os.O_NONBLOCK)
            except OSError:  # nobody reads
                continue
            self.opened = True
            os.close(writer)

    def close(self):
        self._ends.set()
        self._watch.join()
