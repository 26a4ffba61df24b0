"""Names of the files that one command writes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from apd_viewer.errors import InputError
from apd_viewer.language import tr

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path


def check_names(paths: Iterable[Path | None]) -> None:
    """Raise InputError if one of the files to be written would replace another; None is no file."""
    seen = set()
    for path in paths:
        if path is None:
            continue
        place = path.resolve()
        if place in seen:
            raise InputError(
                tr("{name} would be written twice; give each file a name of its own.").format(name=path.name)
            )
        seen.add(place)
