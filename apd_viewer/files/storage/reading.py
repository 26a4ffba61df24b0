"""Files read in silence, with one sentence for those impossible to read."""

from __future__ import annotations

import logging
import warnings
from contextlib import contextmanager
from typing import TYPE_CHECKING

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.language import tr

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

_LONGEST = 160  # characters of an error message
# What they log goes to handlers of whoever set them up, and is not printed for want of any.
for _library in ("PIL", "trimesh"):
    logging.getLogger(_library).addHandler(logging.NullHandler())


@contextmanager
def quietly() -> Iterator[None]:
    """Keep warnings of libraries off the terminal; errors are said in sentences."""
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        yield


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
