"""A file is replaced as a whole or not at all."""

import errno
import os
import time
from pathlib import Path

import pytest
from symbolic_links import needs_links

from apd_viewer.errors import InputError
from apd_viewer.files.storage.atomic_file import replacing_file


@pytest.fixture
def path(tmp_path):
    return tmp_path / "a file.txt"


def test_replacing_file_puts_the_new_file_in_its_place_only_at_the_end(path):
    path.write_text("old")
    with replacing_file(path) as scratch:
        scratch.write_text("new")
        assert path.read_text() == "old"
    assert path.read_text() == "new"
    assert list(path.parent.iterdir()) == [path]


def test_replacing_file_makes_a_file_that_was_not_there(path):
    with replacing_file(path) as scratch:
        scratch.write_text("new")
        assert not path.exists()
    assert path.read_text() == "new"


def test_replacing_file_clears_away_what_a_killed_writer_left_long_ago(path):
    def left(name, age):
        scratch = path.with_name(name)
        scratch.write_text("half")
        os.utime(scratch, times=(time.time() - age,) * 2)
        return scratch

    left(".a file.txt-abcd.part.txt", 7200.0)
    kept = [left(".a file.txt-abce.part.txt", 60.0), left(".another.txt-abcd.part.txt", 7200.0)]
    kept += [left("a file.txt.part.txt", 7200.0), left(".a file.txt-abcd.part.png", 7200.0)]
    with replacing_file(path) as scratch:
        scratch.write_text("new")
    assert sorted(path.parent.iterdir()) == sorted([path, *kept])


@pytest.mark.parametrize("name", ["ü" * 120 + ".txt", "[a]*?.txt", "-.txt"])
def test_replacing_file_works_with_names_that_need_care(tmp_path, name):
    for said in ("old", "new"):
        with replacing_file(tmp_path / name) as scratch:
            scratch.write_text(said)
    assert (tmp_path / name).read_text() == "new"
    assert len(list(tmp_path.iterdir())) == 1


def test_replacing_file_has_its_scratch_file_beside_the_file_and_of_its_kind(path):
    with replacing_file(path) as scratch:
        # Another folder could be another disk, from which nothing can be renamed.
        assert scratch.parent == path.parent
        assert scratch.suffix == path.suffix
        assert scratch != path
        assert scratch.name.startswith(".")  # hidden from listings while it grows


@pytest.mark.parametrize("error", [RuntimeError, KeyboardInterrupt, SystemExit, InputError])
@pytest.mark.parametrize("old", ["old", None])
def test_replacing_file_changes_nothing_on_an_error_on_the_way_and_passes_it_on(error, old, path):
    if old:
        path.write_text(old)
    with pytest.raises(error, match="broken off"), replacing_file(path) as scratch:  # noqa: PT012
        scratch.write_text("half")
        raise error("broken off")
    assert [p.read_text() for p in path.parent.iterdir()] == ([old] if old else [])


@pytest.mark.parametrize("code", [errno.ENOSPC, errno.EACCES, errno.EROFS, errno.EDQUOT, errno.EIO])
def test_replacing_file_says_in_a_sentence_what_the_system_refuses(code, path):
    path.write_text("old")
    with pytest.raises(InputError) as caught, replacing_file(path) as scratch:  # noqa: PT012
        scratch.write_text("half")
        raise OSError(code, os.strerror(code))
    assert str(path) in str(caught.value)
    assert os.strerror(code) in str(caught.value)
    assert "Nothing was changed" in str(caught.value)
    assert isinstance(caught.value.__cause__, OSError)
    assert [p.read_text() for p in path.parent.iterdir()] == ["old"]


@pytest.mark.parametrize("step", ["fsync", "chmod", "replace"])
def test_replacing_file_changes_nothing_on_a_refusal_at_any_later_step_either(step, path, monkeypatch):
    def refuse(*args, **kwargs):
        raise OSError(errno.EIO, "Input/output error")

    path.write_text("old")
    with monkeypatch.context() as patched:
        patched.setattr(*((os, "fsync") if step == "fsync" else (Path, step)), refuse)
        with pytest.raises(InputError, match="Input/output error"), replacing_file(path) as scratch:
            scratch.write_text("new")
    assert [p.read_text() for p in path.parent.iterdir()] == ["old"]


def test_replacing_file_has_the_file_on_the_disk_before_it_takes_the_place(path, monkeypatch):
    """Or a power cut between the two leaves an empty file under the name."""
    order = []
    fsync, replace = os.fsync, Path.replace

    def flush(descriptor):
        order.append(("flushed", os.fstat(descriptor).st_ino, os.fstat(descriptor).st_size))
        fsync(descriptor)

    def take_place(self, other):
        order.append(("took the place", self.stat().st_ino))
        return replace(self, other)

    monkeypatch.setattr(os, "fsync", flush)
    monkeypatch.setattr(Path, "replace", take_place)
    with replacing_file(path) as scratch:
        scratch.write_text("whole")
    inode = path.stat().st_ino
    assert order == [("flushed", inode, 5), ("took the place", inode)]


def test_replacing_file_says_in_a_sentence_that_a_folder_is_missing(tmp_path):
    with pytest.raises(InputError, match="cannot be written"), replacing_file(tmp_path / "gone" / "a.txt"):
        pytest.fail("there is nothing to write to")
    assert list(tmp_path.iterdir()) == []


def test_replacing_file_refuses_a_name_that_is_longer_than_names_can_be(tmp_path):
    path = tmp_path / ("x" * 300 + ".txt")
    with pytest.raises(InputError, match="cannot be written"), replacing_file(path) as scratch:
        scratch.write_text("new")
    assert list(tmp_path.iterdir()) == []


def test_replacing_file_does_not_mix_two_writers_at_once(path):
    with replacing_file(path) as first:
        first.write_text("first")
        with replacing_file(path) as second:
            assert second != first
            second.write_text("second")
        assert path.read_text() == "second"
    assert path.read_text() == "first"
    assert list(path.parent.iterdir()) == [path]


@needs_links
def test_replacing_file_lets_a_link_stay_a_link_and_replaces_its_file(tmp_path):
    (tmp_path / "folder").mkdir()
    real, link = tmp_path / "folder" / "real.txt", tmp_path / "link.txt"
    real.write_text("old")
    link.symlink_to(real)
    with replacing_file(link) as scratch:
        scratch.write_text("new")
    assert link.is_symlink()
    assert real.read_text() == "new"
