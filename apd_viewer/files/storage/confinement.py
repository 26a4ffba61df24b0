"""Confinement of a process to a folder, for what its user may read and write.

All files named by users, or in files of theirs, are opened and replaced in one place each, which ask here.
Without :func:`confine_process` everything is allowed.
"""

import os
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

from apd_viewer.errors import InputError
from apd_viewer.language import tr


class _Limits(NamedTuple):
    folder: Path
    also: tuple[Path, ...]
    overwriting: bool


_limits: _Limits | None = None


def confine_process(folder: Path, also: Iterable[Path] = (), overwriting: bool = False) -> None:
    """Allow files of users in a folder, from now on.

    Parameters
    ----------
    folder : Path
        With everything below it.
    also : iterable of Path
        More folders that may be read, and written over: scratch folders, and samples.
    overwriting : bool
        Whether existing files in ``folder`` may be replaced.
    """
    global _limits
    _limits = _Limits(_real(folder), tuple(map(_real, also)), overwriting)


def _real(path: str | Path) -> Path:
    return Path(os.path.realpath(path))


def check_inside(path: str | Path, folder: Path) -> None:
    """Raise InputError if a path, its links resolved, leads out of a folder."""
    try:
        real = _real(folder / path)
    except ValueError:  # a null character
        real = None
    if real is None or not real.is_relative_to(_real(folder)):
        raise InputError(
            tr("{path} is not in the folder {folder}; name a file in it, relative to it.").format(
                path=str(path).replace("\0", "?"), folder=folder
            )
        )


def check_reading(path: str | Path) -> None:
    """Raise InputError if this process may not read a file."""
    if _limits is not None and not _is_below(path, _limits.also):
        check_inside(path, _limits.folder)


def check_writing(path: str | Path) -> None:
    """Raise InputError if this process may not write a file, or not replace it."""
    if _limits is None or _is_below(path, _limits.also):
        return
    check_inside(path, _limits.folder)
    if os.path.lexists(path) and not _limits.overwriting:
        raise InputError(
            tr("{path} exists already, and may not be replaced; choose another name.").format(path=path)
        )


def _is_below(path: str | Path, folders: Iterable[Path]) -> bool:
    return any(_real(path).is_relative_to(folder) for folder in folders)
