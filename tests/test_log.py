"""The log: what reaches it, what must not, and that it never stands in the way."""

import logging
import os
import subprocess
import sys
import textwrap
import threading
import warnings
from pathlib import Path

import pytest

from apd_viewer import log
from apd_viewer.__main__ import main
from apd_viewer.log import redacted_text

ROOT = Path(__file__).parents[1]
LOGGER = logging.getLogger("apd_viewer.test")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Where the log of a test goes."""
    monkeypatch.setenv("APD_VIEWER_LOGS", str(tmp_path / "logs"))
    return tmp_path / "logs"


def text(folder, pattern="*.log"):
    return "".join(path.read_text(encoding="utf-8") for path in sorted(folder.glob(pattern)))


def python(script, **environment):
    return subprocess.run(
        [sys.executable, "-c", textwrap.dedent(script)],
        cwd=ROOT,
        env=os.environ | environment,
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )


def test_log_is_not_written_by_the_library(folder):
    done = python("import apd_viewer, apd_viewer.__main__; apd_viewer.Mesh")
    assert done.returncode == 0, done.stderr
    assert not folder.exists()


def test_log_has_no_file_after_a_command_without_trouble(folder):
    assert main(["info", str(ROOT / "resources" / "bottle.obj")]) == 0
    assert list(folder.iterdir()) == []


def test_log_begins_with_the_versions(folder):
    with log.recording_log():
        LOGGER.info("hello")
    lines = text(folder).splitlines()
    assert lines[0].startswith("Python 3.")
    assert {line.split()[0] for line in lines[:-1]} >= {"apd-viewer", "PySide6_Essentials", "vtk", "numba"}
    assert lines[-1].endswith("INFO apd_viewer.test: hello")


def test_recording_log_ends_with_its_block(folder):
    hooks = sys.excepthook, threading.excepthook, warnings.showwarning
    with log.recording_log(), log.recording_log("debug"):
        assert len(logging.getLogger("apd_viewer").handlers) == 1
    assert (sys.excepthook, threading.excepthook, warnings.showwarning) == hooks
    assert logging.getLogger("apd_viewer").handlers == []
    assert log.current_file() is None


def test_recording_log_records_and_prints_a_level(folder, capsys):
    with log.recording_log("warning"):
        LOGGER.info("small")
        LOGGER.warning("great")
    for said in (text(folder), capsys.readouterr().err):
        assert "great" in said
        assert "small" not in said


def test_recording_log_without_a_level_prints_nothing(folder, capsys):
    with log.recording_log():
        LOGGER.debug("smallest")
        LOGGER.error("great")
    assert capsys.readouterr().err == ""
    assert "smallest" not in text(folder)


def test_main_takes_a_level_of_the_log_for_each_command(folder, capsys):
    assert main(["info", "--log-level", "debug", str(ROOT / "resources" / "bottle.obj")]) == 0
    with pytest.raises(SystemExit):
        main(["info", "--log-level", "loud", "x.obj"])
    assert "debug" in capsys.readouterr().err


def test_log_that_is_long_is_rotated(folder, monkeypatch):
    monkeypatch.setattr(log, "MOST_BYTES", 10_000)
    with log.recording_log():
        for k in range(1000):
            LOGGER.info("record %d", k)
    files = sorted(folder.iterdir())
    assert [path.suffix for path in files] == [".log", ".1"]
    assert all(path.stat().st_size <= 10_000 for path in files)
    assert all(path.read_text(encoding="utf-8").startswith("Python 3.") for path in files)
    assert "record 999" in files[0].read_text(encoding="utf-8")


def test_recording_log_removes_old_files_and_no_others(folder):
    folder.mkdir()
    (folder / "notes.txt").touch()
    for k in range(50):
        old = folder / f"apd-viewer-{k}.log"
        old.touch()
        os.utime(old, (k, k))
    with log.recording_log():
        LOGGER.info("hello")
    left = {path.name for path in folder.glob("apd-viewer-?*.log")}
    assert len(left) == 21
    assert {"apd-viewer-49.log", "apd-viewer-30.log"} <= left
    assert (folder / "notes.txt").exists()


def test_log_is_one_for_each_of_two_processes(folder):
    script = """
        import logging
        from apd_viewer import log
        with log.recording_log():
            logging.getLogger("apd_viewer").info("hello")
            {}
    """
    inner = "import subprocess, sys; subprocess.run([sys.executable, '-c', sys.argv[1]], check=True)"
    done = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(script).format(inner), textwrap.dedent(script).format("pass")],
        cwd=ROOT,
        check=False,
        timeout=60,
    )
    assert done.returncode == 0
    assert [path.read_text(encoding="utf-8").count("hello") for path in folder.glob("*.log")] == [1, 1]


def test_recording_log_is_not_stopped_by_a_folder_that_cannot_be_written(tmp_path, monkeypatch, capsys):
    (tmp_path / "file").touch()
    monkeypatch.setenv("APD_VIEWER_LOGS", str(tmp_path / "file" / "logs"))
    with log.recording_log():
        LOGGER.error("lost")
    assert capsys.readouterr().err == ""


def test_log_has_an_exception_in_a_thread(folder):
    done = python(
        """
        import threading
        from apd_viewer import log
        with log.recording_log():
            thread = threading.Thread(target=lambda: 1 / 0)
            thread.start()
            thread.join()
        """
    )
    assert done.returncode == 0
    assert "ZeroDivisionError" in text(folder)
    assert "ZeroDivisionError" in done.stderr


def test_log_has_an_exception_in_a_callback(folder, monkeypatch):
    monkeypatch.setattr(sys, "excepthook", lambda *_: None)
    with log.recording_log():
        sys.excepthook(ValueError, ValueError("from Qt"), None)
    assert "from Qt" in text(folder)


def test_log_has_an_exception_that_ends_the_program(folder):
    with pytest.raises(ZeroDivisionError), log.recording_log():
        raise ZeroDivisionError
    assert "ZeroDivisionError" in text(folder)
    assert "test_log.py" in text(folder)


def test_log_takes_what_the_user_can_act_on_for_no_failure(folder):
    assert main(["info", "gone.obj"]) == 2
    assert list(folder.iterdir()) == []


def test_recording_log_lets_a_warning_reach_the_log_and_the_terminal(folder):
    with pytest.warns(UserWarning, match="odd"), log.recording_log():
        warnings.warn("odd", UserWarning, stacklevel=1)
    assert "odd" in text(folder)


def test_recording_log_leaves_a_file_after_a_crash(folder):
    done = python(
        """
        import ctypes
        from apd_viewer import log
        with log.recording_log():
            ctypes.string_at(0)
        """
    )
    assert done.returncode != 0
    assert "most recent call first" in text(folder, "*.crash")


def test_recording_log_leaves_no_file_after_a_run_without_a_crash(folder):
    assert python("from apd_viewer import log\nwith log.recording_log(): pass").returncode == 0
    assert list(folder.iterdir()) == []


HOME = Path.home()


@pytest.mark.parametrize(
    ("said", "kept"),
    [
        ("[Errno 2] No such file: '/data/My Meshes/a.obj'", "[Errno 2] No such file: 'a.obj'"),
        (f"see {HOME / 'meshes' / 'bunny.obj'} (x)", "see bunny.obj (x)"),
        (f"see {HOME}", "see ~"),
        (r"C:\Users\anna\b.ply", "b.ply"),
        (r"'C:\\Users\\anna b\\c.stl'", "'c.stl'"),
        (f'File "{os.__file__}", line 3', 'File "os.py", line 3'),
        (f'File "{log.__file__}", line 3', f'File "{Path("apd_viewer", "log.py")}", line 3'),
        ("('/a/b.obj', '/c/d.obj')", "('b.obj', 'd.obj')"),
        ("3 / 4, n/a, +3 %/mm, https://a.org/x/y", "3 / 4, n/a, +3 %/mm, https://a.org/x/y"),
    ],
)
def test_redacted_text_reduces_a_path_to_its_name(said, kept):
    assert redacted_text(said) == kept


def test_log_names_no_folder(folder, tmp_path):
    with log.recording_log():
        try:
            (tmp_path / "secret" / "a.obj").read_bytes()
        except OSError:
            LOGGER.exception("Opening a.obj failed")
    assert "a.obj" in text(folder)
    assert "secret" not in text(folder).replace('"secret"', "")
