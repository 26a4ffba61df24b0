"""Compile the kernels once a machine, in a process thrown away.

A process that compiles keeps half a gigabyte, so no worker does. The first worker on a machine starts another
process for it and leaves a mark; the others wait for that.
"""

from __future__ import annotations

import contextlib
import getpass
import hashlib
import os
import socket
import stat
import subprocess
import sys
import tempfile
import time
from importlib import metadata
from pathlib import Path

from apd_viewer.files.storage.lock import acquire_lock

_PACKAGE = Path(__file__).parents[1]
_LONGEST = 600.0  # s; compiling takes about two minutes
_PAUSE = 0.2  # s
_PROGRAM = "from apd_viewer.geometry.warmup import warm_up; warm_up()"


def compile_kernels_once() -> None:
    """Return when the kernels are in this machine's cache, or cannot be."""
    # Whatever is in the way of it: the first case then compiles for itself.
    with contextlib.suppress(Exception):
        mark = _mark()
        mark.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        if not _is_own(mark.parent):
            return
        end = time.monotonic() + _LONGEST
        while not mark.exists() and time.monotonic() < end:
            lock = acquire_lock(mark.with_suffix(".lock"))
            if lock is None:
                time.sleep(_PAUSE)
                continue
            try:
                if not mark.exists():
                    _compile()
                    mark.touch()
            finally:
                lock.release()


def _compile() -> None:
    environment = {**os.environ, "NUMBA_NUM_THREADS": "1"}
    # Where it fails the first case compiles what is missing.
    subprocess.run(
        [sys.executable, "-c", _PROGRAM],
        env={**environment, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        timeout=_LONGEST,
        check=False,
    )


def _is_own(folder: Path) -> bool:
    """True if nobody else can write to a folder.

    Anybody may have made it in a place for all.
    """
    there = folder.lstat()
    if sys.platform == "win32":  # whose temporary folders are the user's
        return True
    return stat.S_ISDIR(there.st_mode) and there.st_uid == os.getuid() and not there.st_mode & 0o022


def _mark() -> Path:
    """File left on a machine with compiled kernels."""
    told = hashlib.sha256()
    for path in sorted(_PACKAGE.rglob("*.py")):
        there = path.stat()
        told.update(f"{path} {there.st_size} {there.st_mtime_ns}\n".encode())
    for word in (
        sys.version,
        metadata.version("numba"),
        socket.gethostname(),
        os.environ.get("NUMBA_CACHE_DIR", ""),
    ):
        told.update(word.encode())
    return (
        Path(tempfile.gettempdir()) / f"apd-viewer-{getpass.getuser()}" / f"{told.hexdigest()[:24]}.compiled"
    )
