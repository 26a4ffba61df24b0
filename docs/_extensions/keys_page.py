"""Menu entries with their keys, taken from the window's own actions."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

from plain_markdown import escaped, marked, slug, table

ROOT = Path(__file__).parents[2]
# The offscreen platform has the keys of Windows; these are those of Linux, as the pages name them.
_LINUX = {"redo": "Ctrl+Shift+Z", "quit": "Ctrl+Q"}


class Entry(NamedTuple):
    """A menu entry."""

    menu: str
    name: str
    title: str
    keys: str
    tip: str


def anchor(name: str) -> str:
    """Anchor of the action ``name``."""
    return f"action-{slug(name)}"


def entries() -> list[Entry]:
    """All menu entries of a window that no display shows, made in a process of its own."""
    environment = os.environ | {"QT_QPA_PLATFORM": "offscreen", "APD_VIEWER_LANGUAGE": "en"}
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run(
            [sys.executable, str(Path(__file__).with_name("window_entries.py")), folder],
            env=environment | {"PYTHONPATH": str(ROOT), "APD_VIEWER_LOGS": folder},
            cwd=folder,
            check=True,
            capture_output=True,
            text=True,
        )
    return [Entry(*row) for row in json.loads(done.stdout.splitlines()[-1])]


def keys_page() -> str:
    """Markdown with a table for each menu."""
    found = entries()
    parts = []
    for menu in dict.fromkeys(entry.menu for entry in found):
        rows = [_row(entry) for entry in found if entry.menu == menu]
        parts.append(f"## {menu}\n\n" + table(("entry", "keys", "what it does"), rows))
    return "\n".join(parts)


def _row(entry: Entry) -> tuple[str, ...]:
    keys = _LINUX.get(entry.name, entry.keys).split("; ")
    shown = " or ".join(f"`{key}`" for key in keys if key)
    return marked(escaped(entry.title), anchor(entry.name)), shown, escaped(entry.tip)
