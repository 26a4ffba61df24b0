"""Write completions of the command line for bash, zsh and fish.

    python resources/installer/completions.py [FOLDER]

leaves them in FOLDER, or in build/completions, where hatch_build.py and debian.py find them. They are made
in advance: parsers take long to import, and users would wait for that at every Tab.
"""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

import shtab

os.environ["APD_VIEWER_LANGUAGE"] = "en"

from apd_viewer.commands.desktop.desktop_command import DESKTOP_PARSERS
from apd_viewer.commands.parsers import PARSERS

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "build" / "completions"
# Names of values that are files or folders, besides those with a suffix or of the type Path.
_FILES = {"MESH", "SESSION", "FILE", "OTHER", "REST", "OUT", "SEL"}
_FOLDERS = {"DIR", "FOLDER"}
SHELLS = "bash", "zsh", "fish"


def whole_parser() -> argparse.ArgumentParser:
    """Parser of the command line with all commands, for shtab."""
    parser = argparse.ArgumentParser(prog="apd-viewer")
    parser.add_argument("--version", action="version", help="show the version and exit")
    parsers = {name: make() for name, make in (PARSERS | DESKTOP_PARSERS).items()}
    for name, own in parsers.items():
        for action in own._actions:
            _complete(action)
        command, _, part = name.partition(" ")
        if part:
            nested = parsers[command].add_subparsers(dest="part", parser_class=argparse.ArgumentParser)
            nested.add_parser(part, help=own.description, add_help=False, parents=[own])
    commands = parser.add_subparsers(dest="command")
    for name, own in parsers.items():
        if " " not in name:
            commands.add_parser(name, help=own.description, add_help=False, parents=[own])
    return parser


def _complete(action: argparse.Action) -> None:
    """Let files and folders be completed where a value is one."""
    name = action.metavar if isinstance(action.metavar, str) else ""
    if name in _FOLDERS:
        action.complete = shtab.DIRECTORY  # type: ignore[attr-defined]
    elif action.type is Path or name in _FILES or "." in name:
        action.complete = shtab.FILE  # type: ignore[attr-defined]


def main(folder: Path = FOLDER) -> None:
    """Write the three files."""
    parser = whole_parser()
    folder.mkdir(parents=True, exist_ok=True)
    for shell in SHELLS:
        (folder / shell).write_text(shtab.complete(parser, shell), encoding="utf-8")
    print(f"{folder}: {', '.join(SHELLS)}")


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
