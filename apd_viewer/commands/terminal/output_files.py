"""Checks of the output files of a command."""

from collections.abc import Iterable
from pathlib import Path

from apd_viewer.errors import InputError
from apd_viewer.files.mesh_writing import check_writable
from apd_viewer.files.storage.atomic_file import resolved_path
from apd_viewer.language import tr


def check_files(paths: Iterable[Path | None]) -> None:
    """Raise InputError unless all files are distinct and writable; skip None."""
    asked = [path for path in paths if path is not None]
    check_distinct(asked)
    for path in asked:
        check_writable(path)


def check_distinct(paths: Iterable[Path]) -> None:
    """Raise InputError if two of the files are the same."""
    seen = set()
    for path in paths:
        place = resolved_path(path)
        if place in seen:
            raise InputError(
                tr("{name} would be written twice; give each file a name of its own.").format(name=path.name)
            )
        seen.add(place)
