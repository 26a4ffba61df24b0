"""A pipe that sees who opens it to read, and lets go of them."""

import os
import subprocess
from pathlib import Path

# A process, as Qt holds the interpreter while it waits. The pipe goes, or it would be opened again and again.
_WATCH = 'exec 3> "$1"; rm "$1"; touch "$1.opened"; exec 3>&-'


class WatchedPipe:
    """A pipe without a writer; whoever waits for one is noted, and goes on with nothing.

    Parameters
    ----------
    path : path
    """

    def __init__(self, path):
        self.path = Path(path)
        os.mkfifo(self.path)
        self._watch = subprocess.Popen(["sh", "-c", _WATCH, "sh", str(self.path)])

    @property
    def opened(self):
        """Whether anybody has waited for a writer."""
        return Path(f"{self.path}.opened").exists()

    def close(self):
        self._watch.kill()
        self._watch.wait()
