"""File locks, released by the system when the program ends."""

import contextlib
import errno
import os
import sys
from pathlib import Path
from typing import IO

from apd_viewer.files.storage.regular_files import check_regular_file

if sys.platform == "win32":
    import msvcrt
else:
    import fcntl

_TAKEN = {errno.EACCES, errno.EAGAIN, errno.EDEADLK}


class FileLock:
    """Lock held on a file; see :func:`acquire_lock`."""

    def __init__(self, path: Path, stream: IO[bytes]) -> None:
        self.path = path
        self._stream = stream

    @property
    def is_in_place(self) -> bool:
        """True if the locked file still exists at its path."""
        with contextlib.suppress(FileNotFoundError):
            return os.path.samestat(os.fstat(self._stream.fileno()), self.path.stat())
        return False

    def release(self) -> None:
        """Release the lock and keep its file."""
        self._stream.close()

    def remove(self) -> None:
        """Release the lock and remove its file."""
        if sys.platform == "win32":  # Windows cannot remove an open file
            self._stream.close()
        with contextlib.suppress(OSError):
            self.path.unlink()
        self._stream.close()


def acquire_lock(path: Path) -> FileLock | None:
    """Lock the file at ``path``, created if missing; None if already locked.

    Raises
    ------
    OSError
        If there can be no such file, or no locks on its disk.
    """
    with contextlib.suppress(FileNotFoundError):
        check_regular_file(path)
    stream = path.open("ab")
    try:
        _lock(stream.fileno())
    except OSError as error:
        stream.close()
        if error.errno not in _TAKEN:
            raise
        return None
    lock = FileLock(path, stream)
    if lock.is_in_place:
        return lock
    lock.release()  # the previous holder has removed the file
    return None


def _lock(descriptor: int) -> None:
    # Not fcntl.lockf: its locks are lost when the program closes any descriptor of the file.
    if sys.platform == "win32":
        msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
    else:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
