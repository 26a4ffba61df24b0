"""Files read in silence, with one sentence for those impossible to read.

All that anyone names is opened here: a pipe would wait for a writer, and a device may never end.
"""

from __future__ import annotations

import errno
import logging
import os
import stat
import warnings
from contextlib import contextmanager
from typing import TYPE_CHECKING, BinaryIO

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.language import tr

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

_LONGEST = 160  # characters of an error message
# Neither waits for a writer of what has taken the place of a file, nor becomes a terminal's process.
_FLAGS = os.O_RDONLY | sum(
    getattr(os, name, 0) for name in ("O_NONBLOCK", "O_NOCTTY", "O_CLOEXEC", "O_BINARY")
)
# What they log goes to handlers of whoever set them up, and is not printed for want of any.
for _library in ("PIL", "trimesh"):
    logging.getLogger(_library).addHandler(logging.NullHandler())


@contextmanager
def without_library_warnings() -> Iterator[None]:
    """Keep warnings of libraries off the terminal; errors are said in sentences."""
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        yield


class NotRegularError(OSError):
    """The error for a pipe, a device or a folder in the place of a file."""

    def __init__(self, path: str | Path) -> None:
        super().__init__(errno.EINVAL, tr("it is no regular file"), str(path))


def check_regular(path: str | Path) -> None:
    """Raise NotRegularError for anything but a regular file, OSError for none."""
    # By itself, and not on what was opened: to open a device may do something already.
    if not stat.S_ISREG(os.stat(path).st_mode):  # noqa: PTH116, Path raises on names that are too long
        raise NotRegularError(path)


def open_regular(path: str | Path, flags: int = 0) -> BinaryIO:
    """Open a regular file for reading, and nothing else; raises OSError.

    Parameters
    ----------
    path : path
    flags : int
        More of those of :func:`os.open`.
    """
    check_regular(path)
    stream = os.fdopen(os.open(path, _FLAGS | flags), "rb")
    if not stat.S_ISREG(os.fstat(stream.fileno()).st_mode):  # replaced meanwhile
        stream.close()
        raise NotRegularError(path)
    return stream


def read_bytes(path: str | Path) -> bytes:
    """Content of a regular file up to its current size; raises OSError."""
    with open_regular(path) as stream:
        # Files of the kernel are regular, 0 bytes long, and may wait or go on for ever.
        return stream.read(os.fstat(stream.fileno()).st_size)


def read_content(path: Path) -> bytes:
    """Content of a file.

    Raises
    ------
    InputError
        If it cannot be read.
    """
    try:
        return read_bytes(path)
    except (FileNotFoundError, ValueError) as error:  # or a name that no file can have
        raise InputError(tr("There is no file {path}; check the name.").format(path=path)) from error
    except NotRegularError as error:
        raise InputError(
            tr("{path} is a folder, a pipe or a device; name a file instead.").format(path=path)
        ) from error
    except OSError as error:
        raise InputError(
            tr("{path} cannot be read ({reason}); check the file.").format(
                path=path, reason=error.strerror or error
            )
        ) from error
    except MemoryError as error:
        raise InputError(
            tr("{name} does not fit into memory; choose another file.").format(name=path.name)
        ) from error


def one_line_message(error: Exception) -> str:
    """Error message without text from a broken file."""
    said = "".join(sign if sign.isprintable() else " " for sign in str(error))
    return said if len(said) <= _LONGEST else said[:_LONGEST] + "…"
