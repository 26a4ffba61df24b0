"""Folders that are filled: all files or none, and no scratch is left."""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from apd_viewer.errors import InputError
from apd_viewer.files.storage.atomic_file import staging_folder


def test_staging_folder_has_the_files_there_at_the_end_and_not_before(tmp_path):
    folder = tmp_path / "a" / "b"
    with staging_folder(folder) as scratch:
        (scratch / "deep").mkdir()
        (scratch / "deep" / "one.txt").write_text("1")
        (scratch / "two.txt").write_text("2")
        assert not (tmp_path / "a").exists()
    assert (folder / "deep" / "one.txt").read_text() == "1"
    assert (folder / "two.txt").read_text() == "2"
    assert [path.name for path in tmp_path.iterdir()] == ["a"]


def test_staging_folder_leaves_all_as_it_was_when_something_goes_wrong(tmp_path):
    (tmp_path / "two.txt").write_text("old")

    def fill():
        with staging_folder(tmp_path) as scratch:
            (scratch / "two.txt").write_text("new")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fill()
    assert [path.name for path in tmp_path.iterdir()] == ["two.txt"]
    assert (tmp_path / "two.txt").read_text() == "old"


def test_staging_folder_says_before_any_work_that_a_file_is_in_the_way(tmp_path):
    (tmp_path / "taken").write_text("")
    for folder in (tmp_path / "taken", tmp_path / "taken" / "below"):
        with pytest.raises(InputError, match=r"cannot be written .+choose another location"):
            staging_folder(folder).__enter__()
    assert [path.name for path in tmp_path.iterdir()] == ["taken"]


KILLED = """
import os, sys
from pathlib import Path
from apd_viewer.files.storage.atomic_file import staging_folder
with staging_folder(Path(sys.argv[1])) as scratch:
    (scratch / "half.txt").write_text("half")
    print(scratch, flush=True)
    sys.stdin.read()
"""


@pytest.mark.parametrize("age", [-1e8, 0.0, 1e8], ids=["of the future", "of now", "of 3 years ago"])
def test_staging_folder_clears_away_only_the_scratch_of_the_dead_whatever_its_age(tmp_path, age):
    command = [sys.executable, "-c", KILLED, str(tmp_path / "out")]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as other:
        theirs = Path(other.stdout.readline().strip())
        os.utime(theirs, (time.time() - age,) * 2)
        with staging_folder(tmp_path):
            assert (theirs / "half.txt").read_text() == "half", "it is being filled"
        other.kill()
        other.wait()
        assert theirs.exists()
        os.utime(theirs, (time.time() - age,) * 2)
        with staging_folder(tmp_path):
            pass
    assert list(tmp_path.iterdir()) == []


def test_staging_folder_writes_to_a_disk_without_locks(tmp_path, monkeypatch):
    def refused(*_):
        raise OSError(95, "Operation not supported")

    monkeypatch.setattr(pytest.importorskip("fcntl"), "flock", refused)
    with staging_folder(tmp_path / "out") as scratch:
        (scratch / "one.txt").write_text("1")
    assert (tmp_path / "out" / "one.txt").read_text() == "1"
