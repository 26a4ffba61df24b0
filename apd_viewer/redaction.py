"""Redaction of paths in a text."""

from __future__ import annotations

import re
import sys
from pathlib import Path

# Absolute paths, also below the user's home folder: quoted as Python quotes them, or without spaces.
_PATH = re.compile(
    r"""(?P<quote>["'])(?P<quoted>(?:[A-Za-z]:|~)?[\\/][^"'\n]*)(?P=quote)"""
    r"""|(?<![\w.:/\\])(?P<bare>(?:[A-Za-z]:[\\/]|~[\\/]|[\\/](?=[^\s\\/"']+[\\/]))[^\s"']*)"""
)


def redacted_text(text: str) -> str:
    """Shorten paths in a text to file names, and those of modules to import paths."""
    home = str(Path.home())
    if len(home) > len(Path.home().anchor):
        for spelling in (home.replace("\\", "\\\\"), home):
            text = text.replace(spelling, "~")
    roots = sorted({_below_home(root, home) for root in sys.path if Path(root).is_absolute()}, key=len)
    return _PATH.sub(lambda match: _shortened(match, roots[::-1]), text)


def _below_home(path: str, home: str) -> str:
    return path.replace(home, "~", 1) if path.startswith(home) else path


def _shortened(match: re.Match[str], roots: list[str]) -> str:
    quote, path = match["quote"] or "", match["quoted"] or match["bare"]
    name = re.split(r"[\\/]+", path.rstrip("\\/"))[-1]
    if name.endswith(".py"):
        root = next((root for root in roots if path.startswith(root)), path.removesuffix(name))
        name = path[len(root) :].lstrip("\\/")
    return f"{quote}{name}{quote}"
