"""Links in a circle are refused in a sentence, and stay where they are."""

import pytest
from symbolic_links import needs_links

from apd_viewer.__main__ import main
from apd_viewer.errors import InputError
from apd_viewer.files.storage.atomic_file import (
    is_circular_link,
    replacing_file,
    resolved_path,
    staging_folder,
)

pytestmark = needs_links


@pytest.fixture
def circle(tmp_path, monkeypatch):
    """Two links to each other, from which the working folder is relative."""
    monkeypatch.chdir(tmp_path)
    first, second = tmp_path / "first.obj", tmp_path / "second.obj"
    first.symlink_to(second)
    second.symlink_to(first)
    (tmp_path / "mesh.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    yield first
    assert first.is_symlink()
    assert second.is_symlink()


def test_resolved_path_goes_along_links_that_lead_in_no_circle(tmp_path):
    (tmp_path / "link").symlink_to(tmp_path / "to")
    assert resolved_path(tmp_path / "link" / "x") == (tmp_path / "to" / "x").resolve()
    assert not is_circular_link(tmp_path / "link")
    with replacing_file(tmp_path / "link") as scratch:
        scratch.write_text("text")
    assert (tmp_path / "to").read_text() == "text"


def test_replacing_file_replaces_no_circle_by_a_file(circle):
    assert is_circular_link(circle)
    with (
        pytest.raises(InputError, match=r"cannot be written \(Too many levels of symbolic links\)"),
        replacing_file(circle),
    ):
        pytest.fail("what takes long comes after the check")


@pytest.mark.parametrize("below", ["", "folder", "folder/below"])
def test_staging_folder_replaces_no_circle_by_a_folder(circle, below):
    with pytest.raises(InputError, match="Too many levels of symbolic links"), staging_folder(circle / below):
        pytest.fail("what takes long comes after the check")


@pytest.mark.parametrize(
    "words",
    [
        "deform mesh.obj --selection mesh.sel --iterations 1 -o first.obj",
        "deform mesh.obj --selection first.obj --iterations 1 -o out.obj",
        "deform first.obj --selection mesh.sel --iterations 1 -o out.obj",
        "deform mesh.obj --selection mesh.sel --iterations 1 -o out.obj --report first.obj",
        "deform mesh.obj --selection mesh.sel --iterations 1 -o first.obj/out.obj",
        "press mesh.obj --to 0.5 -o first.obj",
        "replay first.obj -o out.obj",
        "deck first.obj -o first.obj",
        "info first.obj",
        "volumes first.obj",
        "study first.obj -o out",
        "study design -o first.obj",
        "thumbnail mesh.obj first.obj",
        "paper -o first.obj",
        "first.obj",
    ],
)
def test_main_says_in_a_sentence_that_links_lead_in_a_circle(circle, words, capsys):
    assert main(words.split()) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.startswith("error: ")
    assert said.err.count("\n") == 1
