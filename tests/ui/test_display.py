"""Displays that cannot be used end in one sentence, and never in Qt's abort."""

import os
import re
import subprocess
import sys

import pytest

from apd_viewer.ui.display import display_connection

pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="others always have a display")

NAMES = "DISPLAY", "WAYLAND_DISPLAY", "XDG_SESSION_TYPE", "QT_QPA_PLATFORM", "XDG_RUNTIME_DIR"
NOT_REACHED = ", where no display can be reached; correct it"
NOT_OPENED = ", which cannot open a window here; unset it"
WITHOUT = ", or deform without a window: apd-viewer deform --help."


def run(*words, **variables):
    """Exit status, output and errors of Python, where no other display is named."""
    kept = {name: value for name, value in os.environ.items() if name not in NAMES}
    done = subprocess.run([sys.executable, *words], env=kept | variables, capture_output=True, text=True)
    return done.returncode, done.stdout, done.stderr


@pytest.mark.parametrize(
    ("variables", "sentence"),
    [
        ({"DISPLAY": ":999"}, "DISPLAY is “:999”" + NOT_REACHED),
        ({"DISPLAY": "nonsense"}, "DISPLAY is “nonsense”" + NOT_REACHED),
        ({"WAYLAND_DISPLAY": "gone"}, "WAYLAND_DISPLAY is “gone”" + NOT_REACHED),
        ({"QT_QPA_PLATFORM": "wayland;xcb"}, "WAYLAND_DISPLAY is “”" + NOT_REACHED),
        ({"QT_QPA_PLATFORM": "nonsense"}, "QT_QPA_PLATFORM is “nonsense”" + NOT_OPENED),
    ],
)
def test_display_connection_tells_an_unreachable_display_in_a_sentence(variables, sentence):
    assert run("-m", "apd_viewer", **variables) == (2, "", f"error: {sentence}{WITHOUT}\n")


def test_display_connection_tells_of_an_x_server_that_refuses_in_a_sentence(tmp_path):
    """With the address of a server, and without the cookie that it asks for."""
    read, write = os.pipe()
    cookies = tmp_path / "server"
    # An entry: any family, address, number, name, data; each with its length before, in two bytes.
    parts = b"", b"", b"MIT-MAGIC-COOKIE-1", bytes(range(16))
    cookies.write_bytes(b"\xff\xff" + b"".join(len(part).to_bytes(2, "big") + part for part in parts))
    server = subprocess.Popen(
        ["Xvfb", "-auth", cookies, "-displayfd", str(write)], pass_fds=[write], stderr=subprocess.DEVNULL
    )
    try:
        os.close(write)
        with os.fdopen(read) as told:
            name = f":{int(told.readline())}"
        (tmp_path / "user").touch()
        status, out, err = run("-m", "apd_viewer", DISPLAY=name, XAUTHORITY=str(tmp_path / "user"))
        assert (status, out) == (2, "")
        assert re.fullmatch(f"error: DISPLAY is “{name}”, where no display can be reached; .+\n", err)
        starts = "from apd_viewer.ui.display import display_connection\n"
        starts += "with display_connection(): print('reached')"
        assert run("-c", starts, DISPLAY=name, XAUTHORITY=str(cookies)) == (0, "reached\n", "")
    finally:
        server.terminate()
        server.wait()


def test_display_connection_names_a_library_that_is_missing(tmp_path):
    (tmp_path / "libxcb-cursor.so.0").touch()  # found first, and no library
    status, out, err = run("-m", "apd_viewer", DISPLAY=os.environ["DISPLAY"], LD_LIBRARY_PATH=str(tmp_path))
    assert (status, out) == (2, "")
    assert re.fullmatch(
        r"error: A library that the window needs is missing \(.*libxcb-cursor.+README\.\n", err
    )


def test_display_connection_keeps_qt_s_own_choice_of_another_display():
    code = (
        "from PySide6.QtWidgets import QApplication\n"
        "from apd_viewer.ui.display import display_connection\n"
        "with display_connection(): application = QApplication([])\n"
        "print(application.platformName())"
    )
    status, out, _ = run("-c", code, WAYLAND_DISPLAY="gone", DISPLAY=os.environ["DISPLAY"])
    assert (status, out) == (0, "xcb\n")


def test_display_connection_is_not_hindered_by_a_closed_standard_error(monkeypatch):
    kept = os.dup(2)
    os.close(2)
    try:
        with display_connection():
            pass
    finally:
        os.dup2(kept, 2)
        os.close(kept)
