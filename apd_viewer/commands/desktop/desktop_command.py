"""The command desktop: make the program known to the desktop, or unknown."""

from __future__ import annotations

import argparse
import sys
import sysconfig
from pathlib import Path

from apd_viewer.commands.desktop.desktop_files import data_folder, install_files, remove_files
from apd_viewer.commands.terminal.parser import Parser
from apd_viewer.errors import InputError
from apd_viewer.installation import is_packaged
from apd_viewer.language import tr

_ENDING = ".exe" if sys.platform == "win32" else ""


def desktop_parser() -> Parser:
    """Parser of the command desktop."""
    parser = Parser(
        prog="apd-viewer desktop",
        description=tr("Put the program into the menu, and let files be opened with it (Linux)."),
    )
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument(
        "--install", action="store_true", help=tr("add menu entry, icon, file types and thumbnails")
    )
    what.add_argument("--remove", action="store_true", help=tr("remove them again"))
    parser.set_defaults(run=_desktop)
    return parser


def own_command() -> list[str]:
    """Words to start this program from anywhere."""
    started = Path(sys.argv[0])
    beside = Path(sysconfig.get_path("scripts")) / f"apd-viewer{_ENDING}"
    for script in (started, beside):
        if script.stem == "apd-viewer" and script.is_file():
            return [str(script.absolute())]  # a link stays one: it may lead to the next version
    return [sys.executable, "-m", "apd_viewer"]


def _desktop(options: argparse.Namespace) -> None:
    _check_system()
    folder = data_folder()
    if options.install:
        missing = install_files(folder, own_command())
        print(tr("Added menu entry, icon, file types and thumbnails to {folder}.").format(folder=folder))
        if missing:
            said = tr("Files cannot be opened by a click yet: install {programs} and repeat this command.")
            print(said.format(programs=tr(" and ").join(missing)))
    elif remove_files(folder):
        print(tr("Removed menu entry, icon, file types and thumbnails from {folder}.").format(folder=folder))
    else:
        print(tr("There was nothing to remove in {folder}.").format(folder=folder))


def _check_system() -> None:
    """Raise InputError on other systems and in a package, with their own way."""
    if sys.platform == "win32":
        raise InputError(
            tr(
                "This command is for Linux; on Windows, right-click a file, choose Open with, and select "
                "{program}."
            ).format(program=own_command()[0])
        )
    if sys.platform == "darwin":
        raise InputError(
            tr(
                "This command is for Linux; on macOS, start the program in Terminal with a file, such as "
                "apd-viewer bottle.obj."
            )
        )
    if is_packaged():
        raise InputError(
            tr(
                "The package of the program has added menu entry, icon, file types and thumbnails for all "
                "users; it removes them with the program."
            )
        )
