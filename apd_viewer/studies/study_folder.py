"""Folder of a study, perhaps packed by a stranger."""

from __future__ import annotations

import os
from pathlib import Path

from apd_viewer.errors import InputError
from apd_viewer.language import tr

# All that is written there, but for the files of cases, which take the place of links.
_WRITTEN = (
    ".lock",
    "study.sqlite*",
    "results.*",
    "curves.csv",
    "cases",
    "cases/*",
    "inputs",
    "inputs/*",
    "inputs/*/*",
)


def check_links(folder: Path) -> None:
    """Raise InputError for a link out of the folder."""
    inside = os.path.realpath(folder)
    for path in (path for pattern in _WRITTEN for path in folder.glob(pattern)):
        if path.is_symlink() and not Path(os.path.realpath(path)).is_relative_to(inside):
            raise InputError(tr("{path} is a link that leads out of the study; remove it.").format(path=path))
