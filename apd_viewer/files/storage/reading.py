"""Whole files read, with one sentence for those impossible to read."""

from __future__ import annotations

from typing import TYPE_CHECKING

from apd_viewer.errors import InputError
from apd_viewer.language import tr

if TYPE_CHECKING:
    from pathlib import Path

_LONGEST = 160  # characters of an error message


def content_of(path: Path) -> bytes:
    """Content of a file.

    Raises
    ------
    InputError
        If it cannot be read.
    """
    try:
        return path.read_bytes()
    except FileNotFoundError as error:
        raise InputError(tr("There is no file {path}; check the name.").format(path=path)) from error
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


def in_one_line(error: Exception) -> str:
    """Error message without text from a broken file."""
    said = "".join(sign if sign.isprintable() else " " for sign in str(error))
    return said if len(said) <= _LONGEST else said[:_LONGEST] + "…"
