"""Atomic file writes: whole or not at all."""

from __future__ import annotations

import contextlib
import os
import tempfile
import time
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from apd_viewer.errors import InputError
from apd_viewer.files.storage.links import followed, refuse_circle
from apd_viewer.language import tr

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

_PART = ".part"
_MOST_OF_A_NAME = 40  # a scratch file's name must not be too long where its target's is not
_LONG_AGO = 3600.0  # s


@contextmanager
def replacing(
    path: Path, at_once: bool = False, finish: Callable[[Path], object] = lambda _: None
) -> Iterator[Path]:
    """Scratch file beside ``path``, moved over it once it is whole.

    Whatever goes wrong on the way, the file that was at ``path`` before stays as it was. With ``at_once``
    that holds for whatever becomes of this program, but not where power fails before :func:`flush_to_disk`.
    ``finish(scratch)`` is called last, with the whole file; where it raises, nothing is moved.

    Raises
    ------
    InputError
        If the operating system refuses; the message says what to do.
    """
    scratch: Path | None = None
    path = followed(path)  # a link stays a link
    try:
        refuse_circle(path)
        _clear_away(path)
        # The suffix is kept: writers choose the format by it.
        suffix = _PART + path.suffix
        handle, name = tempfile.mkstemp(prefix=_prefix(path), suffix=suffix, dir=path.parent)
        scratch = Path(name)
        os.close(handle)
        yield scratch
        if not at_once:
            flush_to_disk(scratch)
        scratch.chmod(_usual_mode(path))
        finish(scratch)
        scratch.replace(path)
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(
            tr("{path} cannot be written ({reason}); choose another location. Nothing was changed.").format(
                path=path, reason=reason
            )
        ) from error
    finally:
        if scratch is not None:
            scratch.unlink(missing_ok=True)


def _prefix(path: Path) -> str:
    return f".{path.name[:_MOST_OF_A_NAME]}-"


def _clear_away(path: Path) -> None:
    """Remove scratch files of writers killed long ago."""
    prefix, suffix = _prefix(path), _PART + path.suffix
    with os.scandir(path.parent) as found:
        left = [each for each in found if each.name.startswith(prefix) and each.name.endswith(suffix)]
    for each in left:
        with contextlib.suppress(OSError):
            if time.time() - each.stat().st_mtime > _LONG_AGO:
                os.unlink(each)  # noqa: PTH108


def flush_to_disk(path: Path) -> None:
    """Return when the content of a file is on the disk; raises OSError."""
    with path.open("rb+") as stream:
        os.fsync(stream.fileno())


def _usual_mode(path: Path) -> int:
    """Permissions of the replaced file, or of a new one."""
    if path.exists():
        return path.stat().st_mode & 0o777
    umask = os.umask(0)
    os.umask(umask)
    return 0o666 & ~umask
