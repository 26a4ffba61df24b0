"""Only regular files are opened, whatever is named."""

import os
import re
import threading
from pathlib import Path

import pytest
from watched_pipe import WatchedPipe

import apd_viewer
from apd_viewer.errors import InputError
from apd_viewer.files.known_file import fingerprint
from apd_viewer.files.storage.lock import acquire_lock
from apd_viewer.files.storage.regular_files import (
    NotRegularFileError,
    open_regular_file,
    read_bytes,
    read_content,
)


@pytest.fixture
def pipe(tmp_path):
    pipe = WatchedPipe(tmp_path / "pipe")
    yield pipe
    pipe.close()


@pytest.fixture
def others(pipe, tmp_path):
    """Names of what is no regular file."""
    (tmp_path / "link").symlink_to(pipe.path)
    (tmp_path / "zero").symlink_to("/dev/zero")
    return [pipe.path, tmp_path / "link", tmp_path / "zero", "/dev/zero", "/dev/null", tmp_path]


def test_regular_files_of_a_pipe_is_seen_by_the_pipe(pipe):
    assert pipe.path.read_bytes() == b""
    assert pipe.opened


def test_regular_files_does_not_open_what_is_no_regular_file(pipe, others):
    for path in others:
        for read in (open_regular_file, read_bytes):
            with pytest.raises(NotRegularFileError, match="not a regular file"):
                read(path)
        with pytest.raises(InputError, match=r"name a file instead\.$"):
            read_content(path)
    assert fingerprint(pipe.path).size is None
    with pytest.raises(OSError, match="not a regular file"):
        acquire_lock(pipe.path)
    assert not pipe.opened


def test_open_regular_does_not_wait_for_a_pipe_that_takes_the_place_of_a_file(tmp_path, monkeypatch):
    path = tmp_path / "file"
    path.write_bytes(b"1")
    real = os.open

    def swapped(name, *flags):
        path.unlink()
        os.mkfifo(path)
        return real(name, *flags)

    monkeypatch.setattr(os, "open", swapped)
    guard = threading.Timer(5.0, lambda: real(path, os.O_RDWR))  # lets go of who waits
    guard.start()
    with pytest.raises(NotRegularFileError):
        open_regular_file(path)
    assert guard.is_alive()
    guard.cancel()


def test_read_bytes_reads_a_file_whole_also_through_a_link_and_by_a_descriptor(tmp_path):
    content = os.urandom(3_000_000)
    (tmp_path / "file").write_bytes(content)
    (tmp_path / "link").symlink_to("file")
    assert read_bytes(tmp_path / "file") == read_content(tmp_path / "link") == content
    with (tmp_path / "file").open("rb") as stream:  # as the shell does for /dev/stdin
        assert read_bytes(f"/proc/self/fd/{stream.fileno()}") == content


def test_read_content_says_names_of_no_file(tmp_path):
    for name in ("gone", "a\0b"):
        with pytest.raises(InputError, match=r"^There is no file .*; check the name\.$"):
            read_content(tmp_path / name)
    (tmp_path / "loop").symlink_to("loop")
    with pytest.raises(InputError, match="cannot be read"):
        read_content(tmp_path / "loop")


def test_read_bytes_takes_files_of_the_kernel_that_wait_or_never_end_to_be_as_long_as_they_say():
    assert read_bytes("/proc/self/mem") == b""


# These read what the program itself has: its resources, its settings and what it has just written.
OF_THEIR_OWN = {
    "commands/deform_command.py",
    "commands/desktop/desktop_command.py",
    "commands/mcp_command.py",
    "figures/drawing.py",
    "figures/rendered_pictures.py",
    "files/storage/atomic_file.py",
    "geometry/linalg/kernels.py",
    "geometry/warmup.py",
    "language.py",
    "presentation/live_view.py",
    "presentation/report_view.py",
    "ui/sharing/report_controller.py",
    "ui/widgets/theme.py",
    "verification/verification_run.py",
}
READS = re.compile(r"""\.read_(bytes|text)\(|\bopen\((["']r|\))|\bQ(Pixmap|Image|File)\(str\(""")


def test_regular_files_alone_opens_what_is_named():
    package = Path(apd_viewer.__file__).parent
    found = {
        path.relative_to(package).as_posix()
        for path in package.rglob("*.py")
        for line in path.read_text(encoding="utf-8").splitlines()
        if READS.search(line) and not re.search(r"\b(self|box|sheet|search)\.open\(\)|def open", line)
    }
    assert found == OF_THEIR_OWN
