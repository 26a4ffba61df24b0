"""Identity of a file: name, place, size and digest."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import NamedTuple

from apd_viewer.files.samples import resource_path
from apd_viewer.files.storage.regular_files import open_regular

_PORTION = 1 << 20  # bytes


class Fingerprint(NamedTuple):
    """A file as it is now.

    Attributes
    ----------
    place : str
        Where it is, for people: what is in the home folder begins with ``~``, which tells nobody's name.
    size : int or None
        In bytes; None if it cannot be read any more.
    sha256 : str
        In hexadecimal; empty if it cannot be read any more.
    """

    place: str
    size: int | None
    sha256: str


def fingerprint(path: Path) -> Fingerprint:
    """Read a file once, for its fingerprint."""
    digest, size = hashlib.sha256(), 0
    try:
        with open_regular(path) as stream:
            while portion := stream.read(_PORTION):
                digest.update(portion)
                size += len(portion)
    except OSError:
        return Fingerprint(display_path(path), None, "")
    return Fingerprint(display_path(path), size, digest.hexdigest())


def display_path(path: Path) -> str:
    """Place of a file relative to the home folder or the program."""
    if resource_path("") in path.parents:
        return path.name
    try:
        return (Path("~") / path.absolute().relative_to(Path.home())).as_posix()
    except (ValueError, RuntimeError):  # elsewhere, or there is no home
        return str(path.absolute())
