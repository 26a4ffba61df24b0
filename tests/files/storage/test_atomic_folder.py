"""Folders that are filled: all files or none, and no scratch is left."""

import os

import pytest

from apd_viewer.errors import InputError
from apd_viewer.files.storage.atomic_folder import filling


def test_the_files_are_there_at_the_end_and_not_before(tmp_path):
    folder = tmp_path / "a" / "b"
    with filling(folder) as scratch:
        (scratch / "deep").mkdir()
        (scratch / "deep" / "one.txt").write_text("1")
        (scratch / "two.txt").write_text("2")
        assert not (tmp_path / "a").exists()
    assert (folder / "deep" / "one.txt").read_text() == "1"
    assert (folder / "two.txt").read_text() == "2"
    assert [path.name for path in tmp_path.iterdir()] == ["a"]


def test_what_goes_wrong_leaves_all_as_it_was(tmp_path):
    (tmp_path / "two.txt").write_text("old")

    def fill():
        with filling(tmp_path) as scratch:
            (scratch / "two.txt").write_text("new")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fill()
    assert [path.name for path in tmp_path.iterdir()] == ["two.txt"]
    assert (tmp_path / "two.txt").read_text() == "old"


def test_a_file_in_the_way_is_said_before_any_work(tmp_path):
    (tmp_path / "taken").write_text("")
    for folder in (tmp_path / "taken", tmp_path / "taken" / "below"):
        with pytest.raises(InputError, match=r"cannot be written .+choose another location"):
            filling(folder).__enter__()
    assert [path.name for path in tmp_path.iterdir()] == ["taken"]


def test_scratch_of_the_day_before_is_cleared_away(tmp_path):
    old, new = tmp_path / ".apd-viewer-old.part", tmp_path / ".apd-viewer-new.part"
    for folder in (old, new):
        folder.mkdir()
    os.utime(old, (0, 0))
    with filling(tmp_path):
        pass
    assert [path.name for path in tmp_path.iterdir()] == [new.name]
