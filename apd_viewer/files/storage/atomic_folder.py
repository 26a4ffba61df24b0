"""Atomic writes of several files: all or none.

Beside each scratch folder lies a file, which is locked while the folder is being filled. So it is known which
ones were left by a killed program, whatever the clock says.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from apd_viewer.errors import InputError
from apd_viewer.files.storage.atomic_file import check_not_circular, resolved_path
from apd_viewer.files.storage.lock import FileLock, acquire_lock
from apd_viewer.geometry.signals.deferred_signals import DEFERRED_SIGNALS
from apd_viewer.language import tr

_PREFIX, _PART, _LOCK = ".apd-viewer-", ".part", ".lock"


@contextmanager
def staging_folder(folder: Path) -> Iterator[Path]:
    """Scratch folder as a context; its files move to ``folder`` on exit.

    Until then ``folder`` stays as it is, or is not there. Files in it that are not written anew are kept.

    Raises
    ------
    InputError
        If the operating system refuses; the message says what to do.
    """
    folder = resolved_path(folder)
    scratch: Path | None = None
    lock: FileLock | None = None
    try:
        beside = _nearest(folder)
        _clear_away(beside)
        with DEFERRED_SIGNALS:
            scratch = beside / f"{_PREFIX}{os.getpid()}-{time.time_ns()}{_PART}"
            lock = _locked(scratch)
            scratch.mkdir(mode=0o700)
        yield scratch
        with DEFERRED_SIGNALS:
            move_files(scratch, folder)
    except OSError as error:
        raise folder_write_error(folder, error) from error
    finally:
        if scratch is not None:
            with DEFERRED_SIGNALS:
                shutil.rmtree(scratch, ignore_errors=True)
                if lock is not None:
                    lock.remove()


def folder_write_error(folder: Path, error: OSError) -> InputError:
    """Sentence on a folder and the error of writing it."""
    return InputError(
        tr("The folder {folder} cannot be written ({reason}); choose another location.").format(
            folder=folder, reason=error.strerror or error
        )
    )


def make_folder(folder: Path) -> None:
    """Make a folder and all above it; raises InputError."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise folder_write_error(folder, error) from error


def move_files(scratch: Path, folder: Path) -> None:
    """Move all files below ``scratch`` to ``folder``; raises OSError."""
    files = sorted(path for path in scratch.rglob("*") if path.is_file())
    for path in files:
        target = folder / path.relative_to(scratch)
        target.parent.mkdir(parents=True, exist_ok=True)
        if target.exists() and not target.is_file():
            raise FileExistsError(None, tr("{name} in it is no regular file").format(name=target.name))
        shutil.move(path, target)


def _nearest(folder: Path) -> Path:
    """Nearest existing folder at or above the given one."""
    while not folder.exists() and folder != folder.parent:
        check_not_circular(folder)
        folder = folder.parent
    if not folder.is_dir():
        raise NotADirectoryError(None, f"{folder.name} is not a folder")
    return folder


def _locked(scratch: Path) -> FileLock | None:
    """The lock beside a scratch folder; None on a disk without locks."""
    with contextlib.suppress(OSError):
        return acquire_lock(scratch.with_suffix(_LOCK))
    return None


def _clear_away(folder: Path, process: str = "*") -> None:
    """Remove scratch folders of killed programs."""
    for path in folder.glob(f"{_PREFIX}{process}-*{_LOCK}"):
        if (lock := _locked(path)) is not None:
            shutil.rmtree(path.with_suffix(_PART), ignore_errors=True)
            lock.remove()


def remove_scratch_of(process: int, folder: Path) -> None:
    """Remove what a process of this number, since killed, was filling in ``folder``."""
    _clear_away(folder, str(process))


def unused_folder(folder: Path, name: str) -> Path:
    """A path of this name, with a number appended where it exists."""
    number, path = 1, folder / name
    while path.exists():
        number += 1
        path = folder / f"{name}-{number}"
    return path
