"""Menu entries and controls of a window that no display shows."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from functools import cache
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[2]


class Entry(NamedTuple):
    """A menu entry."""

    menu: str
    name: str
    title: str
    keys: str
    tip: str


class Control(NamedTuple):
    """A control: its section of the panel, card or dialog, and its own words."""

    section: str
    title: str
    tip: str


def entries() -> list[Entry]:
    """All menu entries."""
    return [Entry(*row) for row in facts()["entries"]]


def controls() -> list[Control]:
    """All controls of the window and its dialogs."""
    return [Control(*row) for row in facts()["controls"]]


@cache
def facts() -> dict[str, list[list[str]]]:
    """Findings of a process of its own."""
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
    found: dict[str, list[list[str]]] = json.loads(done.stdout.splitlines()[-1])
    return found
