"""The ``desktop`` command: register or unregister the program with the desktop.

Also the parsers of both commands for desktops, by name.
"""

import argparse
import contextlib
import os
import re
import shutil
import subprocess
import sys
import sysconfig
from collections.abc import Callable, Sequence
from pathlib import Path

from apd_viewer.commands.desktop.thumbnail_command import thumbnail_parser
from apd_viewer.commands.terminal.command_output import CommandOutput
from apd_viewer.commands.terminal.parser import Parser, add_option
from apd_viewer.errors import InputError
from apd_viewer.files.samples import resource_path
from apd_viewer.files.storage.atomic_file import replacing_file
from apd_viewer.installation import is_packaged
from apd_viewer.language import tr

_ENDING = ".exe" if sys.platform == "win32" else ""


def desktop_parser() -> Parser:
    """Argument parser for the ``desktop`` command."""
    parser = Parser(
        prog="apd-viewer desktop",
        description=tr("Add the program to the menu, and open files with it (Linux)."),
    )
    what = parser.add_mutually_exclusive_group(required=True)
    add_option(what, "--install", tr("add menu entry, icon, file types and thumbnails"))
    add_option(what, "--remove", tr("remove them again"))
    parser.set_defaults(run=_desktop)
    return parser


DESKTOP_PARSERS: dict[str, Callable[[], Parser]] = {"desktop": desktop_parser, "thumbnail": thumbnail_parser}


def own_command() -> list[str]:
    """Command line, as a list of words, to start this program from any folder."""
    started = Path(sys.argv[0])
    beside = Path(sysconfig.get_path("scripts")) / f"apd-viewer{_ENDING}"
    for script in (started, beside):
        if script.stem == "apd-viewer" and script.is_file():
            return [str(script.absolute())]  # links are not resolved: they may later lead to a newer version
    return [sys.executable, "-m", "apd_viewer"]


def _desktop(options: argparse.Namespace) -> CommandOutput:
    _check_system()
    folder, missing = data_folder(), list[str]()
    if options.install:
        missing = install_files(folder, own_command())
        lines = [tr("Added menu entry, icon, file types and thumbnails to {folder}.")]
        lines += (
            [tr("Files cannot be opened by a click yet: install {programs} and repeat this command.")]
            if missing
            else []
        )
    elif remove_files(folder):
        lines = [tr("Removed menu entry, icon, file types and thumbnails from {folder}.")]
    else:
        lines = [tr("There was nothing to remove in {folder}.")]
    lines = [line.format(folder=folder, programs=tr(" and ").join(missing)) for line in lines]
    return CommandOutput(lines, lambda: {"folder": str(folder), "missing_programs": missing})


def _check_system() -> None:
    """Raise InputError, with advice, except on Linux outside a packaged program."""
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


_NAME = "apd-viewer"
# Destination of each resource, relative to the user's data folder.
_PLACES = {
    f"desktop/{_NAME}.desktop": f"applications/{_NAME}.desktop",
    f"desktop/{_NAME}.xml": f"mime/packages/{_NAME}.xml",
    f"desktop/{_NAME}.thumbnailer": f"thumbnailers/{_NAME}.thumbnailer",
    f"icons/{_NAME}.svg": f"icons/hicolor/scalable/apps/{_NAME}.svg",
}
# Tools for updating the desktop databases, their folders, and the files they index.
_COLLECTORS = (
    ("update-mime-database", "mime", "packages/*.xml"),
    ("update-desktop-database", "applications", "*.desktop"),
)
_COLLECTED = {
    "mime": (
        *("XMLnamespaces", "aliases", "generic-icons", "globs", "globs2", "icons", "magic", "mime.cache"),
        *("subclasses", "treemagic", "types", "version"),
    ),
    "applications": ("mimeinfo.cache",),
}
_PATIENCE = 60.0  # time limit of a tool, seconds


def data_folder() -> Path:
    """Folder of the user's data, ``$XDG_DATA_HOME`` or its default."""
    named = Path(os.environ.get("XDG_DATA_HOME", ""))
    return named if named.is_absolute() else Path.home() / ".local" / "share"  # XDG specification


def install_files(folder: Path, command: Sequence[str]) -> list[str]:
    """Write all desktop files; return the database tools missing or not finishing.

    Parameters
    ----------
    folder : Path
        Data folder, created if missing.
    command : sequence of str
        The words that start this program, beginning with a path.

    Raises
    ------
    InputError
        If a file cannot be written.
    """
    for source, place in _PLACES.items():
        path = folder / place
        with contextlib.suppress(OSError):  # replacing_file reports the error
            path.parent.mkdir(parents=True, exist_ok=True)
        with replacing_file(path) as scratch:
            scratch.write_bytes(_with_start_command(command, resource_path(source).read_bytes()))
    return [program for program, part, _ in _COLLECTORS if not _run_collector(program, folder / part)]


def remove_files(folder: Path) -> bool:
    """Remove all desktop files and emptied folders; False if there were no files.

    Raises
    ------
    OSError
        If one cannot be removed.
    """
    found = [path for place in _PLACES.values() if (path := folder / place).exists()]
    for path in found:
        path.unlink()
    for program, part, others in _COLLECTORS:
        if found and (folder / part).is_dir():
            _run_collector(program, folder / part)
            if not any((folder / part).glob(others)):
                _remove_collected(folder / part, _COLLECTED[part])
    for place in _PLACES.values():
        _remove_empty((folder / place).parent, folder)
    return bool(found)


def _run_collector(program: str, folder: Path) -> bool:
    """Run a database tool on a folder; False if it is missing or does not finish."""
    found = shutil.which(program)
    if found is None:
        return False
    try:
        subprocess.run([found, str(folder)], capture_output=True, check=False, timeout=_PATIENCE)
    except (OSError, subprocess.TimeoutExpired):
        return False
    return True


def _remove_collected(folder: Path, names: Sequence[str]) -> None:
    """Remove the files written by a database tool, and its empty folders."""
    for name in names:
        (folder / name).unlink(missing_ok=True)
    for inner in folder.iterdir():
        with contextlib.suppress(OSError):  # no folder, or one with files of other programs
            inner.rmdir()


def _remove_empty(folder: Path, top: Path) -> None:
    """Remove a folder below ``top``, and its parents, as far as they are empty."""
    while folder != top:
        with contextlib.suppress(OSError):  # folder with files of other programs
            folder.rmdir()
        folder = folder.parent


def _with_start_command(command: Sequence[str], content: bytes) -> bytes:
    """Content of a desktop file, with its start command replaced."""
    words = " ".join(map(_exec_word, command)).encode()
    content = re.sub(rb"(?m)^Exec=apd-viewer\b", lambda _: b"Exec=" + words, content)
    tried = _escaped_value(command[0]).encode()
    return re.sub(rb"(?m)^TryExec=.*$", lambda _: b"TryExec=" + tried, content)


def _exec_word(word: str) -> str:
    """Word for the key Exec of a desktop file: quoted, then escaped."""
    quoted = re.sub(r'(["`$\\])', r"\\\1", word.replace("%", "%%"))
    return _escaped_value(f'"{quoted}"' if re.search(r"[^\w@%+=:,./-]", word) else quoted)


def _escaped_value(text: str) -> str:
    return text.replace("\\", "\\\\").replace("\n", "\\n").replace("\t", "\\t")
