"""Reading of regular files only, with one-sentence errors and no library output.

All files named by users are opened here: a pipe would wait for a writer, and a device may never end.

A mesh may be untrusted, but the files named in it are read without asking. Their names are therefore resolved
first, including links, and only files in the folder of the mesh or below it are opened.
"""

import errno
import logging
import os
import re
import stat
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

import numpy as np

from apd_viewer.errors import InputError, printable_text
from apd_viewer.files.storage.confinement import check_reading
from apd_viewer.language import tr

_LONGEST = 160  # maximum number of characters of an error message
# Flags against blocking on a pipe and against acquiring a controlling terminal.
_FLAGS = os.O_RDONLY | sum(
    getattr(os, name, 0) for name in ("O_NONBLOCK", "O_NOCTTY", "O_CLOEXEC", "O_BINARY")
)
# Library logs go to handlers of the application; without handlers nothing is printed.
for _library in ("PIL", "trimesh"):
    logging.getLogger(_library).addHandler(logging.NullHandler())


@contextmanager
def without_library_warnings() -> Iterator[None]:
    """Suppress warnings of libraries in a context; errors become sentences."""
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        yield


class NotRegularFileError(OSError):
    """Error for a pipe, device or folder in place of a regular file."""

    def __init__(self, path: str | Path) -> None:
        super().__init__(errno.EINVAL, tr("it is not a regular file"), str(path))


def check_regular_file(path: str | Path) -> None:
    """Raise NotRegularFileError unless ``path`` is a regular file, OSError if missing."""
    # Checked before opening, since opening a device may already have an effect.
    if not stat.S_ISREG(os.stat(path).st_mode):  # noqa: PTH116, Path raises on names that are too long
        raise NotRegularFileError(path)


def open_regular_file(path: str | Path, flags: int = 0) -> BinaryIO:
    """Open a regular file for reading; raises OSError for anything else.

    Parameters
    ----------
    flags : int
        More of those of :func:`os.open`.
    """
    check_reading(path)
    check_regular_file(path)
    stream = os.fdopen(os.open(path, _FLAGS | flags), "rb")
    if not stat.S_ISREG(os.fstat(stream.fileno()).st_mode):  # the file was replaced after the check
        stream.close()
        raise NotRegularFileError(path)
    return stream


def read_bytes(path: str | Path) -> bytes:
    """Content of a regular file up to its current size; raises OSError."""
    with open_regular_file(path) as stream:
        # Kernel files such as those in /proc are regular with size 0, and may block or be endless.
        return stream.read(os.fstat(stream.fileno()).st_size)


STANDARD_INPUT = Path("-")


def read_standard_input() -> bytes:
    """Content of the standard input, up to its end; raises InputError if it is empty."""
    content = b"" if sys.stdin is None else sys.stdin.buffer.read()
    if not content:
        raise InputError(tr("The standard input is empty; pipe a file into it."))
    return content


def read_content(path: Path) -> bytes:
    """Content of a regular file.

    Raises
    ------
    InputError
        If it cannot be read.
    """
    try:
        return read_bytes(path)
    except (FileNotFoundError, ValueError) as error:  # missing, or an impossible file name
        raise InputError(tr("There is no file {path}; check the name.").format(path=path)) from error
    except NotRegularFileError as error:
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
    """Error message on one line, shortened and without unprintable characters."""
    return _shortened_line(str(error), _LONGEST)


def _shortened_line(text: str, most: int) -> str:
    """Text on one line, cut to at most ``most`` characters."""
    line = printable_text(text)
    return line if len(line) <= most else line[:most] + "…"


# Bytes: 44 million vertices with normals in single precision, far more than can be deformed. A small file
# may still name or contain huge data (sparse files, decompression bombs).
LARGEST_FILE = 1 << 30
_LONGEST_NAME = 80  # maximum number of characters quoted from a file
# Absolute paths, URL schemes and drives; a neighbouring file needs no colon.
_ELSEWHERE = re.compile(r"[/\\]|[^/\\]*:")
# Refuses links created after the name was resolved.
_NO_LINKS = getattr(os, "O_NOFOLLOW", 0)


def sibling_content(name: str, mesh: Path | None, most: int | None = None) -> bytes | None:
    """Content of a file named in a mesh file; None if it does not exist.

    Parameters
    ----------
    name : str
        Name as written in the mesh, relative to its folder; backslashes are slashes.
    mesh : path or None
        Path of the mesh; without one there are no neighbouring files.
    most : int or None
        Bytes read at most; None is all of them.

    Raises
    ------
    InputError
        If the name leads out of the folder of the mesh, or there is more than :data:`LARGEST_FILE`.
    OSError
        If the file cannot be read.
    """
    place = _resolved_path(name, mesh)
    # os.path: Path raises on names that are too long.
    if place is None or not os.path.isfile(place):  # noqa: PTH113
        return None
    with open_regular_file(place, _NO_LINKS) as stream:
        size = os.fstat(stream.fileno()).st_size
        wanted = size if most is None else min(most, size)
        if wanted > LARGEST_FILE:
            raise too_large_error(name)
        return stream.read(wanted)


def too_large_error(name: str) -> InputError:
    """Error for a neighbouring file or embedded data beyond :data:`LARGEST_FILE`."""
    return InputError(
        tr(
            "The file contains or refers to more than {limit:.0f} GiB ({named}); reduce the mesh first."
        ).format(limit=LARGEST_FILE / 2**30, named=_shortened_line(name, _LONGEST_NAME))
    )


def _resolved_path(name: str, mesh: Path | None) -> str | None:
    """Real path of a named file, None if invalid; raises InputError if outside."""
    if mesh is None or not name or "\0" in name:
        return None
    slashed = name.replace("\\", "/")
    # Checked without disk access: on Windows, probing a network path already reveals the user.
    if _ELSEWHERE.match(slashed) or Path(os.path.normpath(slashed)).parts[:1] == (os.pardir,):
        raise _outside_error(name, mesh)
    folder = os.path.realpath(mesh.parent)
    place = os.path.realpath(os.path.join(folder, slashed))  # noqa: PTH118
    if not Path(place).is_relative_to(folder):
        raise _outside_error(name, mesh)
    return place


def _outside_error(name: str, mesh: Path) -> InputError:
    return InputError(
        tr(
            "{mesh} refers to a file outside its folder ({named}), which is not read; copy it into the "
            "folder and correct its name in the mesh."
        ).format(mesh=mesh.name, named=_shortened_line(name, _LONGEST_NAME))
    )
