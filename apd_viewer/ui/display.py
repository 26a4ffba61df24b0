"""Check for a display before Qt starts: without one, Qt aborts the process."""

import ctypes
import os
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

from PySide6.QtCore import QLibraryInfo, QPluginLoader

from apd_viewer.errors import InputError
from apd_viewer.language import tr

_NAMES = "DISPLAY", "WAYLAND_DISPLAY", "QT_QPA_PLATFORM"
_WITHOUT_SCREEN = "offscreen", "minimal"
_LONGEST = 60.0  # s; Qt starts in 0.2 s on an idle machine
# Without a handler, Qt's fatal message would leave a core dump.
_TRIAL = """
import os
from PySide6.QtCore import QtMsgType, qInstallMessageHandler
from PySide6.QtGui import QGuiApplication
qInstallMessageHandler(lambda kind, *_: os._exit(1) if kind == QtMsgType.QtFatalMsg else None)
raise SystemExit(QGuiApplication([]).primaryScreen() is None)
"""


def has_display() -> bool:
    """True if an environment variable names a display; always outside Linux."""
    return any(os.environ.get(name) for name in _NAMES) or not sys.platform.startswith("linux")


@contextmanager
def display_connection() -> Iterator[None]:
    """Context manager keeping a display available until Qt connects to it.

    The platform that Qt tries first is tested here, in milliseconds. Only if that fails, Qt itself is started
    in another process: it may find another platform.

    Raises
    ------
    InputError
        Without a display.
    ImportError
        Without a library to use it.
    """
    if not has_display():
        raise InputError(
            tr(
                "No display is available for the window; log in with one, or deform without a window: "
                "apd-viewer deform --help."
            )
        )
    if not sys.platform.startswith("linux"):
        yield
        return
    # Kept open, since an X server may reset when its only client leaves, and refuse the next one meanwhile.
    with _x_server() as answers:
        trouble = _start_problem(answers)
        if trouble is not None and not _qt_starts():
            raise trouble
        yield


def _start_problem(x_answers: bool) -> Exception | None:
    """Exception to raise if Qt cannot start; None if it can."""
    fallback = "wayland" if os.environ.get("WAYLAND_DISPLAY") else "xcb"
    platform = (os.environ.get("QT_QPA_PLATFORM") or fallback).split(";")[0].split(":")[0]
    if platform in _WITHOUT_SCREEN:
        return None
    if platform not in ("xcb", "wayland"):
        return InputError(
            tr(
                "QT_QPA_PLATFORM is “{name}”, which cannot open a window here; unset it, or deform without "
                "a window: apd-viewer deform --help."
            ).format(name=platform)
        )
    if not (x_answers if platform == "xcb" else _wayland_answers()):
        variable = "DISPLAY" if platform == "xcb" else "WAYLAND_DISPLAY"
        return InputError(
            tr(
                "{variable} is “{name}”, where no display can be reached; correct it, or deform without a "
                "window: apd-viewer deform --help."
            ).format(variable=variable, name=os.environ.get(variable, ""))
        )
    plugins = Path(QLibraryInfo.path(QLibraryInfo.LibraryPath.PluginsPath))
    plugin = QPluginLoader(str(plugins / "platforms" / f"libq{platform}.so"))
    return None if plugin.load() else ImportError(plugin.errorString())


def _wayland_answers() -> bool:
    """True if the Wayland compositor accepts a connection, or one is inherited."""
    if os.environ.get("WAYLAND_SOCKET"):
        return True
    path = Path(os.environ.get("XDG_RUNTIME_DIR", ""), os.environ.get("WAYLAND_DISPLAY") or "wayland-0")
    with closing(socket.socket(socket.AF_UNIX)) as tried:
        try:
            tried.connect(str(path))
        except OSError:
            return False
    return True


@contextmanager
def _x_server() -> Iterator[bool]:
    """Hold a connection to the X server of DISPLAY; False if it cannot be reached."""
    try:
        xcb = ctypes.CDLL("libxcb.so.1")
    except OSError:  # Qt's plugin will report the missing library
        yield True
        return
    xcb.xcb_connect.restype = ctypes.c_void_p
    with _silence():
        connection = ctypes.c_void_p(xcb.xcb_connect(None, None))
    try:
        yield not xcb.xcb_connection_has_error(connection)
    finally:
        xcb.xcb_disconnect(connection)


def _qt_starts() -> bool:
    """True if a trial process can start Qt."""
    try:
        tried = subprocess.run([sys.executable, "-c", _TRIAL], capture_output=True, timeout=_LONGEST)
    except subprocess.TimeoutExpired:
        return False
    return tried.returncode == 0


@contextmanager
def _silence() -> Iterator[None]:
    """Suppress the library's messages on standard error."""
    try:
        error = os.dup(2)
    except OSError:  # standard error is already closed
        yield
        return
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 2)
    try:
        yield
    finally:
        os.dup2(error, 2)
        os.close(error)
        os.close(nowhere)
