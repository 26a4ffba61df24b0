"""What Help > Copy diagnostics puts on the clipboard."""

import logging
import os
from pathlib import Path

import pytest
from PySide6.QtGui import QGuiApplication

from apd_viewer import log
from apd_viewer.ui.sharing.report_controller import diagnostics


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("APD_VIEWER_LOGS", str(tmp_path))
    return tmp_path


def test_diagnostics_hold_versions_log_and_last_crash(folder):
    (folder / "apd-viewer-1.crash").write_text("Fatal Python error: older")
    (folder / "apd-viewer-2.crash").write_text("Fatal Python error: Aborted")
    (folder / "apd-viewer-3.crash").touch()
    with log.recording_log():
        for k in range(1000):
            logging.getLogger("apd_viewer.test").info("record %d", k)
        said = diagnostics("Vendor, Renderer, 4.6")
    assert "apd-viewer 0" in said
    assert "OpenGL Vendor, Renderer, 4.6" in said
    assert "record 999" in said
    assert "record 800" not in said
    assert "Aborted" in said
    assert "older" not in said


def test_diagnostics_say_where_there_is_no_log_and_no_crash(folder):
    assert diagnostics("").endswith("Log:\nnone\n\nLast crash:\nnone")


def test_diagnostics_name_no_folder_of_the_user(folder):
    home = Path.home()
    (folder / "apd-viewer-1.crash").write_text(f'  File "{home / "work" / "mine.py"}", line 1 in <module>')
    with log.recording_log():
        logging.getLogger("apd_viewer.test").info("opened %s in %s", home / "secret" / "a.obj", os.sep)
        said = diagnostics("")
    assert "a.obj" in said
    assert str(home) not in said
    assert "secret" not in said


def test_copy_diagnostics_copies_them_and_says_so(window, folder):
    action = next(each for each in window.actions_.help.values() if "diagnostics" in each.text())
    action.trigger()
    assert f"OpenGL {window.canvas.viewport.opengl_info}" in QGuiApplication.clipboard().text()
    assert (
        window.canvas.viewport.opengl_info.count(",") >= 2 or os.environ.get("QT_QPA_PLATFORM") == "offscreen"
    )
    assert "copied" in window.notice.text


def test_notice_fail_logs_what_the_window_says_has_failed(window, folder):
    with log.recording_log():
        window.notice.show_failure("A sentence.")
        assert "A sentence." in diagnostics("")
