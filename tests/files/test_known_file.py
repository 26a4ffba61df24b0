"""A known file is the same as long as its content is, whatever clocks and tools say."""

import os
import shutil
import threading
import time

import pytest

from apd_viewer.files.known_file import FileState, KnownFile

OLD, OTHER = b"what was saved", b"what is others"
assert len(OLD) == len(OTHER)


def touch(path):
    path.touch()


def set_back(path):
    os.utime(path, (0, 0))


def set_forward(path):
    os.utime(path, (time.time() + 1e9,) * 2)


def sync(path):
    """What a tool does that brings the same file again."""
    other = path.with_name("downloaded")
    other.write_bytes(path.read_bytes())
    other.replace(path)


def write_again(path):
    path.write_bytes(path.read_bytes())


def move_away_and_back(path):
    path.rename(path.with_name("elsewhere")).rename(path)


def write_in_place(path):
    """Another content of the same size and time in the same file."""
    before = path.stat()
    path.write_bytes(OTHER)
    os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))


def replace(path):
    """Another file of the same size and time."""
    before = path.stat()
    path.with_name("other").write_bytes(OTHER)
    os.utime(path.with_name("other"), ns=(before.st_atime_ns, before.st_mtime_ns))
    path.with_name("other").replace(path)


def truncate(path):
    path.write_bytes(b"")


def append(path):
    path.write_bytes(OLD + b".")


def remove_folder(path):
    shutil.rmtree(path.parent)


def rename(path):
    path.rename(path.with_name("elsewhere"))


def put_folder(path):
    path.unlink()
    path.mkdir()


def put_pipe(path):
    path.unlink()
    os.mkfifo(path)


ACTS = {
    FileState.SAME: (touch, set_back, set_forward, sync, write_again, move_away_and_back),
    FileState.CHANGED: (write_in_place, replace, truncate, append),
    FileState.GONE: (remove_folder, rename, put_folder) + ((put_pipe,) if hasattr(os, "mkfifo") else ()),
}


@pytest.fixture
def path(tmp_path):
    (tmp_path / "folder").mkdir()
    path = tmp_path / "folder" / "file"
    path.write_bytes(OLD)
    return path


@pytest.mark.parametrize("written", [False, True], ids=["read", "written"])
@pytest.mark.parametrize(("found", "act"), [(found, act) for found, acts in ACTS.items() for act in acts])
def test_known_file_takes_only_another_content_for_a_change(path, written, found, act):
    if written:
        scratch = path.with_name("scratch")
        scratch.write_bytes(OLD)
        path.unlink()
        known = KnownFile(path, scratch)
        scratch.replace(path)
    else:
        known = KnownFile(path)
    assert known.state is FileState.SAME
    assert [known.check_content(), known.check_content()] == [FileState.SAME] * 2
    act(path)
    assert [known.check_content(), known.check_content(), known.state] == [found] * 3


def test_known_file_is_the_same_again_when_its_content_comes_back(path):
    known = KnownFile(path)
    path.unlink()
    assert known.check_content() is FileState.GONE
    path.write_bytes(OTHER)
    assert known.check_content() is FileState.CHANGED
    path.write_bytes(OLD)
    assert known.check_content() is FileState.SAME


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs named pipes")
def test_known_file_does_not_wait_for_a_pipe(path):
    put_pipe(path)
    done = threading.Event()
    threading.Thread(target=lambda: (KnownFile(path).check_content(), done.set()), daemon=True).start()
    assert done.wait(5.0)
