"""Atomic writes of files and folders: whole or not at all.

A file beside each scratch folder is locked while the folder is being filled. Folders left behind by a killed
program are thus recognised independently of the clock.
"""

import contextlib
import errno
import os
import shutil
import stat
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from apd_viewer.errors import InputError
from apd_viewer.files.storage.confinement import check_writing
from apd_viewer.files.storage.lock import FileLock, acquire_lock
from apd_viewer.geometry.signals.deferred_signals import DEFERRED_SIGNALS
from apd_viewer.language import tr

_PART = ".part"
_MOST_OF_A_NAME = 40  # characters of a file's name used in its scratch name, to limit its length
_LONG_AGO = 3600.0  # seconds after which a scratch file is stale


@contextmanager
def replacing_file(
    path: Path, at_once: bool = False, finish: Callable[[Path], object] = lambda _: None
) -> Iterator[Path]:
    """Context of a scratch file beside ``path``, moved to ``path`` on success.

    After any error, the previous file at ``path`` is unchanged. With ``at_once`` this includes the death of
    this program, but not a power failure before :func:`flush_to_disk`.
    ``finish(scratch)`` is called last, with the whole file; if it raises, nothing is moved.

    Only regular files are replaced: a pipe with a reader, a character device such as /dev/null and this
    program's own output receive the whole content at once, and anything else is refused.

    Raises
    ------
    InputError
        If the operating system refuses; the message says what to do.
    """
    scratch: Path | None = None
    try:
        check_not_circular(path)
        check_writing(path)
        streams = is_stream(path)
        if not streams:
            path = resolved_path(path)  # replace the file behind a link, not the link
            _remove_stale_files(path)
        # The suffix is kept: writers choose the format by it.
        suffix, folder = _PART + path.suffix, None if streams else path.parent
        with DEFERRED_SIGNALS:
            handle, made = tempfile.mkstemp(prefix=_prefix(path), suffix=suffix, dir=folder)
            scratch = Path(made)
        os.close(handle)
        yield scratch
        if streams:
            finish(scratch)
            _write_through(scratch, path)
            return
        if not at_once:
            flush_to_disk(scratch)
        scratch.chmod(_usual_mode(path))
        finish(scratch)
        scratch.replace(path)
    except OSError as error:
        raise file_write_error(path, error) from error
    finally:
        if scratch is not None and scratch.exists():
            with contextlib.suppress(OSError):
                scratch.chmod(0o600)  # Windows removes no file that may not be written
            scratch.unlink(missing_ok=True)


def file_write_error(path: Path, error: OSError) -> InputError:
    """InputError for a failed write to a path."""
    reason = error.strerror or str(error)
    return InputError(
        tr("{path} cannot be written ({reason}); choose another location. Nothing was changed.").format(
            path=path, reason=reason
        )
    )


def is_stream(path: Path) -> bool:
    """True for a pipe or character device; raises OSError for a socket or the like."""
    try:
        mode = path.stat().st_mode
    except FileNotFoundError:
        return False
    if _own_output(path) is not None or stat.S_ISFIFO(mode) or stat.S_ISCHR(mode):
        return True
    if stat.S_ISREG(mode) or stat.S_ISDIR(mode):
        return False
    raise OSError(errno.EINVAL, tr("it is not a regular file"))


def _own_output(path: Path) -> int | None:
    """Descriptor of standard output or error if ``path`` refers to it; else None."""
    for descriptor in (1, 2):
        with contextlib.suppress(OSError):
            if os.path.samestat(os.fstat(descriptor), path.stat()):
                return descriptor
    return None


def _write_through(scratch: Path, path: Path) -> None:
    """Copy the content of a file to a stream; raises OSError."""
    own = _own_output(path)
    try:
        # Opened without waiting for a reader of a pipe, since there may never be one.
        stream = os.open(path, os.O_WRONLY | getattr(os, "O_NONBLOCK", 0)) if own is None else os.dup(own)
    except OSError as error:
        if error.errno == errno.ENXIO:
            error.strerror = tr("no program reads from it")
        raise
    with (
        contextlib.suppress(BrokenPipeError),  # a reader such as head may close early
        os.fdopen(stream, "wb") as sink,
        scratch.open("rb") as source,
    ):
        if own is None and hasattr(os, "O_NONBLOCK"):
            os.set_blocking(stream, True)
        shutil.copyfileobj(source, sink)


def _prefix(path: Path) -> str:
    return f".{path.name[:_MOST_OF_A_NAME]}-"


def _remove_stale_files(path: Path) -> None:
    """Remove scratch files left by writers killed over an hour ago."""
    prefix, suffix = _prefix(path), _PART + path.suffix
    with os.scandir(path.parent) as found:
        left = [each for each in found if each.name.startswith(prefix) and each.name.endswith(suffix)]
    for each in left:
        with contextlib.suppress(OSError):
            if time.time() - each.stat().st_mtime > _LONG_AGO:
                os.unlink(each)  # noqa: PTH108


def flush_to_disk(path: Path) -> None:
    """Block until the content of a file is on disk; raises OSError."""
    with path.open("rb+") as stream:
        os.fsync(stream.fileno())


def _usual_mode(path: Path) -> int:
    """Permissions of the file to replace, or the default of a new file."""
    if path.exists():
        return path.stat().st_mode & 0o777
    umask = os.umask(0)
    os.umask(umask)
    return 0o666 & ~umask


def resolved_path(path: Path) -> Path:
    """Absolute path with links resolved; a circular link stays unresolved.

    ``Path.resolve`` raises RuntimeError there, before Python 3.13.
    """
    return Path(os.path.realpath(path))


def is_circular_link(path: Path) -> bool:
    """True for a link to itself, directly or through other links."""
    return os.path.islink(os.path.realpath(path))  # noqa: PTH114, Path raises on names that are too long


def check_not_circular(path: Path) -> None:
    """Raise OSError for a circular link, since a write would replace it."""
    if is_circular_link(path):
        raise OSError(errno.ELOOP, os.strerror(errno.ELOOP))


_PREFIX, _LOCK = ".apd-viewer-", ".lock"


@contextmanager
def staging_folder(folder: Path) -> Iterator[Path]:
    """Scratch folder as a context; its files move to ``folder`` on exit.

    Until then ``folder`` is unchanged, or missing. Files in it that are not replaced are kept.

    Raises
    ------
    InputError
        If the operating system refuses; the message says what to do.
    """
    folder = resolved_path(folder)
    scratch: Path | None = None
    lock: FileLock | None = None
    try:
        beside = _nearest_folder(folder)
        _remove_stale_folders(beside)
        with DEFERRED_SIGNALS:
            scratch = beside / f"{_PREFIX}{os.getpid()}-{time.time_ns()}{_PART}"
            lock = _lock_scratch(scratch)
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
    """InputError for a failed write to a folder."""
    return InputError(
        tr("The folder {folder} cannot be written ({reason}); choose another location.").format(
            folder=folder, reason=error.strerror or error
        )
    )


def make_folder(folder: Path) -> None:
    """Create a folder and its parents; raises InputError."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise folder_write_error(folder, error) from error


def move_files(scratch: Path, folder: Path) -> None:
    """Move all files below ``scratch`` to ``folder``; raises OSError."""
    files = sorted(path for path in scratch.rglob("*") if path.is_file())
    for path in files:
        target = folder / path.relative_to(scratch)
        check_writing(target)
        target.parent.mkdir(parents=True, exist_ok=True)
        if target.exists() and not target.is_file():
            raise FileExistsError(None, tr("{name} in it is not a regular file").format(name=target.name))
        try:
            path.replace(target)  # as a whole, also over an existing file on Windows
        except OSError as error:
            if error.errno != errno.EXDEV:  # on another disk
                raise
            shutil.move(path, target)


def _nearest_folder(folder: Path) -> Path:
    """Nearest existing ancestor of a folder, or the folder itself."""
    while not folder.exists() and folder != folder.parent:
        check_not_circular(folder)
        folder = folder.parent
    if not folder.is_dir():
        raise NotADirectoryError(None, f"{folder.name} is not a folder")
    return folder


def _lock_scratch(scratch: Path) -> FileLock | None:
    """Acquire the lock beside a scratch folder; None if locked or unsupported."""
    with contextlib.suppress(OSError):
        return acquire_lock(scratch.with_suffix(_LOCK))
    return None


def _remove_stale_folders(folder: Path, process: str = "*") -> None:
    """Remove scratch folders of killed programs."""
    for path in folder.glob(f"{_PREFIX}{process}-*{_LOCK}"):
        if (lock := _lock_scratch(path)) is not None:
            shutil.rmtree(path.with_suffix(_PART), ignore_errors=True)
            lock.remove()


def remove_scratch_of(process: int, folder: Path) -> None:
    """Remove the scratch folders of a killed process in ``folder``."""
    _remove_stale_folders(folder, str(process))


def unused_folder(folder: Path, name: str) -> Path:
    """Unused path of a folder ``name``, with a number appended if it exists."""
    number, path = 1, folder / name
    while path.exists():
        number += 1
        path = folder / f"{name}-{number}"
    return path
