"""Recovery files of crashed programs, found at the next start.

A lock file beside every file is locked while the writing program is running, or another one offers the file.
Process ids would not do, as the system reuses them, nor times, as clocks may be wrong: a file of any age is
kept until it is restored or discarded.
"""

import contextlib
import os
import re
import stat
import time
from pathlib import Path, PurePath

from apd_viewer.errors import InputError
from apd_viewer.files.storage.archive import Archive
from apd_viewer.files.storage.json_fields import JsonFields
from apd_viewer.files.storage.lock import FileLock, acquire_lock
from apd_viewer.files.storage.regular_files import open_regular_file
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.language import tr, trn
from apd_viewer.session.model.state import State
from apd_viewer.session.model.view import SESSION_SUFFIX, View
from apd_viewer.session.storage.session_file import JSON_MEMBER, open_session

_NAME = re.compile(r"\d+-\d+")
_DAY, _HOUR, _MINUTE = 86400.0, 3600.0, 60.0  # seconds
_MOST_TRIES = 5
_FIRST = 1577836800.0  # start of 2020; an earlier time means an unset clock


class RecoveryFile:
    """Recovery file of a crashed program, locked by this program.

    Attributes
    ----------
    name : str
        Of the mesh, for people.
    time : float
        Time of writing by the clock of that time, in seconds of :func:`time.time`.
    mesh : Mesh or None
        Mesh of the session, once read.
    is_restored : bool
        True once restored, and kept safe by this program.
    """

    def __init__(self, path: Path, lock: FileLock, time: float) -> None:
        self.path = path
        self.name = _name_of_mesh(path)
        self.time = time
        self.mesh: Mesh | None = None
        self.is_restored = False
        self._lock = lock

    def read(self) -> tuple[State, View]:
        """Read the session; raises InputError if damaged or without its mesh."""
        try:
            found = open_session(self.path)
        except InputError as error:
            why = str(error.__cause__ or error).rstrip(".")
            raise InputError(
                tr("The unsaved work on {name} cannot be restored: {why}.").format(name=self.name, why=why)
            ) from error
        self.mesh = found[0].document.mesh
        return found

    def discard(self) -> None:
        """Delete the file and its lock."""
        remove_and_unlock(self.path, self._lock)

    def release(self) -> None:
        """Release the file for the next start."""
        self._lock.release()


def find_recovery_files(folder: Path) -> list[RecoveryFile]:
    """Recovery files in a folder, newest first."""
    make_private(folder, 0o700)
    try:
        stems = {path.stem for path in folder.iterdir() if _NAME.fullmatch(path.stem)}
    except OSError:
        return []
    found = (_claim(folder / f"{stem}{SESSION_SUFFIX}") for stem in stems)
    return sorted(filter(None, found), key=lambda left: -left.time)


def _claim(path: Path) -> RecoveryFile | None:
    """Recovery file at ``path``; None if its program runs, or it is claimed or gone."""
    try:
        lock = acquire_lock(lock_path(path))
    except OSError:
        return None
    if lock is None:
        return None
    try:
        found = path.lstat()
        if stat.S_ISREG(found.st_mode):
            make_private(path)
            return RecoveryFile(path, lock, found.st_mtime)
        lock.release()  # file of another program
    except FileNotFoundError:
        remove_and_unlock(path, lock)
    except OSError:
        lock.release()
    return None


def claim_path(folder: Path) -> tuple[Path, FileLock]:
    """Unused path in ``folder``, and its lock; raises OSError."""
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    make_private(folder, 0o700)
    for _ in range(_MOST_TRIES):  # another instance that is starting may be testing the lock
        path = folder / f"{os.getpid()}-{time.time_ns()}{SESSION_SUFFIX}"
        if (lock := acquire_lock(lock_path(path))) is not None:
            return path, lock
    raise OSError(tr("files in it cannot be locked"))


def lock_path(path: Path) -> Path:
    """Path of the lock file beside ``path``, locked while its program runs."""
    return path.with_suffix(".lock")


def remove_and_unlock(path: Path, lock: FileLock) -> None:
    """Remove a file, its temporary files and, finally, its lock."""
    for each in (path, *path.parent.glob(f".{path.name}-*")):
        with contextlib.suppress(OSError):
            each.unlink()
    lock.remove()


def make_private(path: Path, mode: int = 0o600) -> None:
    """Restrict access to the owner, if supported by the file system."""
    with contextlib.suppress(OSError):
        if stat.S_IMODE(path.stat().st_mode) & ~mode:
            path.chmod(mode)


def age_text(written_at: float) -> str:
    """Text of the age of a file from its time of writing."""
    seconds = time.time() - written_at
    if written_at < _FIRST or seconds < -_MINUTE:
        return tr("at an unknown time")
    days, hours, minutes = (int(max(seconds, 0.0) // size) for size in (_DAY, _HOUR, _MINUTE))
    if days:
        return trn("{n} day ago", "{n} days ago", days).format(n=days)
    if hours:
        return trn("{n} hour ago", "{n} hours ago", hours).format(n=hours)
    if minutes:
        return trn("{n} minute ago", "{n} minutes ago", minutes).format(n=minutes)
    return tr("just now")


def _name_of_mesh(path: Path) -> str:
    """Name of the mesh in a session file."""
    try:
        with open_regular_file(path) as stream:  # read lazily, as the file may be large
            said = JsonFields.parse(Archive(stream).content(JSON_MEMBER), path.name)
        return PurePath(said.nested_fields("mesh").text("name")).name
    except (OSError, ValueError):
        return tr("a damaged session")
