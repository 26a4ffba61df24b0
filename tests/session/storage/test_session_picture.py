"""The small picture in a session: in it and taken out again, and no matter to who opens it."""

import zipfile

import numpy as np
import pytest
from driven_session import VIEW, check_equal
from meshes import box

from apd_viewer.errors import InputError
from apd_viewer.files.picture_files import png_content
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.storage.session_file import open_session, save_session
from apd_viewer.session.storage.session_picture import session_picture

PICTURE = png_content(np.full((4, 8, 4), 99, dtype=np.uint8))


@pytest.fixture
def state():
    return initial_state(Mesh(*box(1, 1, 2)))


def test_session_picture_takes_the_picture_out_as_it_was_put_in(state, tmp_path):
    path = tmp_path / "a.apd"
    save_session(path, state, VIEW, picture=PICTURE)
    assert session_picture(path) == PICTURE
    found, view = open_session(path)
    check_equal(found, state)
    assert view == VIEW


def test_save_session_gives_the_same_file_for_the_same_session_and_picture(state, tmp_path):
    for name in ("a.apd", "b.apd"):
        save_session(tmp_path / name, state, VIEW, picture=PICTURE)
    assert (tmp_path / "a.apd").read_bytes() == (tmp_path / "b.apd").read_bytes()


def test_save_session_without_a_picture_writes_the_same_rest(state, tmp_path):
    save_session(tmp_path / "a.apd", state, VIEW, picture=PICTURE)
    save_session(tmp_path / "b.apd", state, VIEW)
    assert session_picture(tmp_path / "b.apd") is None
    with zipfile.ZipFile(tmp_path / "a.apd") as first, zipfile.ZipFile(tmp_path / "b.apd") as second:
        rest = {name: first.read(name) for name in first.namelist() if name != "picture.png"}
        assert rest == {name: second.read(name) for name in second.namelist()}


def test_save_session_writes_first_bytes_that_tell_a_session(state, tmp_path):
    """As the file type says, for systems that look into files."""
    save_session(tmp_path / "a.apd", state, VIEW, picture=PICTURE)
    assert (tmp_path / "a.apd").read_bytes().startswith(b"PK\x03\x04")
    assert (tmp_path / "a.apd").read_bytes()[30:42] == b"session.json"


def test_session_picture_refuses_what_is_no_session(tmp_path):
    (tmp_path / "a.apd").write_text("nonsense")
    for name in ("a.apd", "gone.apd"):
        with pytest.raises(InputError, match=f"^{name} is not a valid session"):
            session_picture(tmp_path / name)


def test_session_picture_says_in_a_sentence_that_a_picture_is_too_large(state, tmp_path, monkeypatch):
    def full(*_):
        raise MemoryError

    save_session(tmp_path / "a.apd", state, VIEW, picture=PICTURE)
    monkeypatch.setattr("apd_viewer.files.storage.archive.Archive.content", full)
    with pytest.raises(InputError, match=r"a\.apd does not fit into memory"):
        session_picture(tmp_path / "a.apd")
