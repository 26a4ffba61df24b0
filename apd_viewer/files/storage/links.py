"""Symbolic links, circles among them."""

from __future__ import annotations

import errno
import os
from pathlib import Path


def resolved_path(path: Path) -> Path:
    """Absolute path behind all links; one in a circle stays as it is.

    ``Path.resolve`` raises RuntimeError there, before Python 3.13.
    """
    return Path(os.path.realpath(path))


def is_circular_link(path: Path) -> bool:
    """True for a link to itself, also by way of others."""
    return os.path.islink(os.path.realpath(path))  # noqa: PTH114, Path raises on names that are too long


def check_not_circular(path: Path) -> None:
    """Raise OSError for a link to itself: a file or folder would replace it."""
    if is_circular_link(path):
        raise OSError(errno.ELOOP, os.strerror(errno.ELOOP))
