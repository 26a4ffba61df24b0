"""Commands whose streams are closed, narrow or unread, and that are ended by signals."""

import os
import signal
import subprocess
import sys

import numpy as np
import pytest
from meshes import box

from apd_viewer import Mesh, save_mesh

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="streams and signals of Unix")

OTHERS = ("SIGHUP", 129), ("SIGINT", 130)
PROGRAM = "import sys; from apd_viewer.__main__ import main; sys.exit(main())"


@pytest.fixture
def mesh(tmp_path):
    path = tmp_path / "bar.obj"
    save_mesh(Mesh(*box()), box()[0], path)
    return path


def shell(line, **environment):
    """Status and output of a line of a shell, where $APD is the program."""
    set_up = {**os.environ, "PYTHON": sys.executable, "PROGRAM": PROGRAM, **environment}
    line = f'apd() {{ "$PYTHON" -c "$PROGRAM" "$@"; }}\n{line}'
    done = subprocess.run(["bash", "-c", line], env=set_up, check=False, capture_output=True, timeout=120)
    return done.returncode, done.stdout, done.stderr


@pytest.mark.parametrize("closed", [pytest.param(">&-", marks=pytest.mark.night), "<&- >&- 2>&-"])
def test_use_streams_lets_closed_streams_fail_no_job(closed, mesh, tmp_path):
    out = tmp_path / "out.json"
    status, said, wrong = shell(f"apd volumes {mesh} --json {out} {closed}")
    assert (status, wrong) == (0, b"")
    assert said == b""
    assert out.read_text().startswith("{")  # and not with what was said


def test_main_has_status_2_for_an_error_whatever_is_closed(tmp_path):
    assert shell(f"apd info {tmp_path}/none.obj >&- 2>/dev/full")[0] == 2


@pytest.mark.parametrize("words", [pytest.param("info {mesh}", marks=pytest.mark.night), "--help"])
def test_main_is_not_failed_by_a_reader_that_has_seen_enough(words, mesh):
    line = f"apd {words.format(mesh=mesh)} | true; exit ${{PIPESTATUS[0]}}"
    assert shell(line)[::2] == (0, b"")


def test_use_streams_replaces_what_the_output_cannot_encode():
    narrow = {"PYTHONIOENCODING": "ascii", "APD_VIEWER_LANGUAGE": "zh_CN"}
    status, said, wrong = shell("apd --help", **narrow)
    assert (status, wrong) == (0, b"")
    assert b"apd-viewer" in said
    assert b"?" in said
    assert said.isascii()


@pytest.mark.parametrize(
    ("name", "status"),
    [("SIGTERM", 143), *(pytest.param(*each, marks=pytest.mark.night) for each in OTHERS)],
)
def test_exit_on_signals_leaves_no_scratch(name, status, mesh, tmp_path):
    labels = np.where(box()[0][:, 2] > 5.0, 2, np.where(box()[0][:, 2] < 1.0, 1, 0))
    np.savetxt(tmp_path / "bar.sel", labels, fmt="%d")
    there, own = tmp_path / "there", tmp_path / "tmp"
    there.mkdir()
    own.mkdir()
    words = "sweep", mesh, "--selection", tmp_path / "bar.sel", "--twist", "90deg", "--steps", "900"
    process = subprocess.Popen(
        [sys.executable, "-c", PROGRAM, *map(str, words), "-o", str(there / "out"), "--progress-lines"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env={**os.environ, "TMPDIR": str(own)},
        # In the background a shell has some ignored.
        preexec_fn=lambda: signal.signal(getattr(signal, name), signal.SIG_DFL),
    )
    with process:
        assert process.stdout.readline()
        assert list(there.iterdir())
        process.send_signal(getattr(signal, name))
        process.communicate(timeout=60)
    assert process.returncode == status
    assert list(there.iterdir()) == list(own.iterdir()) == []


@pytest.mark.night
def test_exit_on_signals_respects_nohup(mesh):
    program = "import signal; signal.signal(signal.SIGHUP, signal.SIG_IGN)\n" + PROGRAM.replace(
        "main())", "[main(), print(signal.getsignal(signal.SIGHUP) is signal.SIG_IGN)][0])"
    )
    done = subprocess.run([sys.executable, "-c", program, "info", mesh], check=True, capture_output=True)
    assert done.stdout.endswith(b"True\n")
