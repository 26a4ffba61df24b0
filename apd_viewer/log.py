"""The program's log: a rotating file in the user's log folder.

Only the program writes it, that is the window and the command line; importing the package writes nothing.
Each process writes its own file, since processes cannot share a rotating file; the oldest files are removed.
Only the file name of a mesh is logged.
"""

import faulthandler
import logging
import os
import platform
import re
import sys
import threading
import warnings
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from datetime import datetime
from importlib.metadata import PackageNotFoundError, version
from logging.handlers import RotatingFileHandler
from pathlib import Path
from typing import Any, TextIO

import platformdirs

from apd_viewer.errors import InputError

_LOGGER = logging.getLogger("apd_viewer")
_FORMAT = "%(asctime)s %(levelname)s %(name)s: %(message)s"
MOST_BYTES = 1 << 20  # maximum size of a log file before it is rotated
_MOST_FILES = 20  # maximum number of log files of all runs together
_LIBRARIES = (
    "apd-viewer",
    "PySide6_Essentials",
    "vtk",
    "pyvista",
    "pyvistaqt",
    "numpy",
    "scipy",
    "numba",
    "cholespy",
)


@contextmanager
def recording_log(level: str | None = None) -> Iterator[None]:
    """Record the log during the block; no effect inside another such block.

    Uncaught exceptions of all threads, Python's warnings and crashes are recorded too. Without a writable
    folder nothing is recorded.

    Parameters
    ----------
    level : str or None
        "debug", "info", "warning" or "error": the least that is recorded, which is then printed to the
        standard error as well. None records from "info" on and prints nothing.
    """
    if current_file() is not None:
        yield
        return
    with ExitStack() as undo:
        run = _make_room()
        _add_handlers(undo, f"{run}.log", level)
        _enable_faulthandler(undo, f"{run}.crash")
        _add_hooks(undo)
        try:
            yield
        except InputError:  # reported to the user; not a failure of the program
            raise
        except Exception:
            _LOGGER.critical("Uncaught exception", exc_info=True)
            raise


def log_folder() -> Path:
    """Log folder; the environment variable APD_VIEWER_LOGS overrides it."""
    return Path(os.environ.get("APD_VIEWER_LOGS") or platformdirs.user_log_dir("apd-viewer", appauthor=False))


def current_file() -> Path | None:
    """Log file of this process, created with its first record; None without a log."""
    return next((Path(each.baseFilename) for each in _LOGGER.handlers if isinstance(each, LogFile)), None)


def version_lines() -> list[str]:
    """Versions of the program, its libraries and the system, one per line."""
    lines = [f"Python {platform.python_version()}", platform.platform()]
    for name in _LIBRARIES:
        with suppress(PackageNotFoundError):
            lines.append(f"{name} {version(name)}")
    return lines


class _RedactingFormatter(logging.Formatter):
    """Log formatter removing the names of the user's folders."""

    def format(self, record: logging.LogRecord) -> str:
        """Format the record with its traceback, and redact the paths in it."""
        return redacted_text(super().format(record))


class LogFile(RotatingFileHandler):
    """Rotating log file, created by its first record and headed by the versions."""

    def _open(self) -> Any:
        stream = super()._open()
        if not stream.tell():
            stream.writelines(f"{line}\n" for line in version_lines())
        return stream

    def handleError(self, record: logging.LogRecord) -> None:
        """Drop the record: the disk is full, or the folder is not writable."""


def _make_room() -> Path:
    """Remove old log files; return the path of this run's files without suffix."""
    run = log_folder() / f"apd-viewer-{datetime.now():%Y%m%d-%H%M%S}-{os.getpid()}"
    with suppress(OSError):
        run.parent.mkdir(parents=True, exist_ok=True)
        for path in sorted(run.parent.glob("apd-viewer-*"), key=_age)[_MOST_FILES:]:
            path.unlink(missing_ok=True)
    return run


def _age(path: Path) -> float:
    """Negative modification time; 0 if another process has removed the file."""
    try:
        return -path.stat().st_mtime
    except OSError:
        return 0.0


def _add_handlers(undo: ExitStack, file: str, level: str | None) -> None:
    handlers: list[logging.Handler] = [
        LogFile(file, maxBytes=MOST_BYTES, backupCount=1, encoding="utf-8", delay=True)
    ]
    if level is not None:
        handlers.append(logging.StreamHandler())
    for handler in handlers:
        handler.setFormatter(_RedactingFormatter(_FORMAT))
        _LOGGER.addHandler(handler)
        undo.callback(handler.close)
        undo.callback(_LOGGER.removeHandler, handler)
    undo.callback(_LOGGER.setLevel, _LOGGER.level)
    _LOGGER.setLevel((level or "info").upper())


def _enable_faulthandler(undo: ExitStack, file: str) -> None:
    """Write crashes to a file beside the log, unless faulthandler is in use."""
    if faulthandler.is_enabled():
        return
    with suppress(OSError):
        stream = Path(file).open("w", encoding="utf-8")  # noqa: SIM115, stays open as long as the log
        undo.callback(_close_crash_file, stream)
        faulthandler.enable(stream)
        undo.callback(faulthandler.disable)


def _close_crash_file(stream: TextIO) -> None:
    path = Path(stream.name)
    stream.close()
    with suppress(OSError):
        if not path.stat().st_size:
            path.unlink()


def _add_hooks(undo: ExitStack) -> None:
    def uncaught(kind: type[BaseException], error: BaseException, traceback: Any) -> None:
        if issubclass(kind, Exception):
            _LOGGER.critical("Uncaught exception", exc_info=(kind, error, traceback))

    def uncaught_in_thread(said: threading.ExceptHookArgs) -> None:
        if issubclass(said.exc_type, Exception) and said.exc_value is not None:
            exception = said.exc_type, said.exc_value, said.exc_traceback
            _LOGGER.critical("Uncaught exception in a thread", exc_info=exception)

    def warned(message: Warning | str, kind: type[Warning], file: str, line: int, *_: object) -> None:
        _LOGGER.warning("%s", warnings.formatwarning(message, kind, file, line).rstrip())

    _hook(undo, sys, "excepthook", uncaught)
    _hook(undo, threading, "excepthook", uncaught_in_thread)
    _hook(undo, warnings, "showwarning", warned)


def _hook(undo: ExitStack, owner: object, name: str, listener: Callable[..., None]) -> None:
    """Install a listener called before the owner's original hook."""
    before = getattr(owner, name)

    def both(*arguments: Any) -> None:
        listener(*arguments)
        before(*arguments)

    setattr(owner, name, both)
    undo.callback(setattr, owner, name, before)


# Absolute paths, also those starting with ~: either quoted as in Python messages, or free of spaces.
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
    roots = sorted({_home_shortened(root, home) for root in sys.path if Path(root).is_absolute()}, key=len)
    return _PATH.sub(lambda match: _shortened_path(match, roots[::-1]), text)


def _home_shortened(path: str, home: str) -> str:
    return path.replace(home, "~", 1) if path.startswith(home) else path


def _shortened_path(match: re.Match[str], roots: list[str]) -> str:
    quote, path = match["quote"] or "", match["quoted"] or match["bare"]
    name = re.split(r"[\\/]+", path.rstrip("\\/"))[-1]
    if name.endswith(".py"):
        root = next((root for root in roots if path.startswith(root)), path.removesuffix(name))
        name = path[len(root) :].lstrip("\\/")
    return f"{quote}{name}{quote}"
