"""A session replaces its file only where that holds what was read or written last."""

import pytest
from driven_session import BENT, VIEW, Driven, bar, check_equal, pose

from apd_viewer.errors import InputError
from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.session import file_jobs
from apd_viewer.session.storage import session_file
from apd_viewer.session.storage.session_file import open_session, open_session_file, save_session


def wait(session):
    session.until(lambda: session.jobs.current is None)


def save(session, path, **more):
    told, failed = len(session.told), len(session.failed)
    session.files.save(path, VIEW, **more)
    wait(session)
    return session.told[told:], session.failed[failed:]


@pytest.fixture
def path(session, tmp_path):
    """The file of the session."""
    save(session, tmp_path / "a.apd")
    return tmp_path / "a.apd"


@pytest.fixture
def other(path):
    """Another one on the same file."""
    other = Driven()
    other.files.open(path)
    wait(other)
    yield other
    other.close()


def test_save_over_does_not_replace_what_another_session_has_saved(session, other, path):
    session.drag(BENT)
    assert save(session, path) == (["Saved a.apd, including a copy of the mesh."], [])
    saved = path.read_bytes()
    other.drag(pose(0.3))
    told, failed = save(other, path)
    assert told == []
    assert len(failed) == 1
    assert failed[0].startswith("a.apd was not saved: it has been changed elsewhere")
    assert path.read_bytes() == saved
    assert [each.name for each in path.parent.iterdir()] == ["a.apd"]
    assert other.saved_work.is_unsaved


def test_save_over_does_not_replace_what_comes_while_it_is_written(session, path, monkeypatch):
    def slow(*args, **more):
        path.write_bytes(b"somebody else's")
        return save_session(*args, **more)

    session.drag(BENT)
    monkeypatch.setattr(session_file, "save_session", slow)
    _, failed = save(session, path)
    assert len(failed) == 1
    assert path.read_bytes() == b"somebody else's"
    assert [each.name for each in path.parent.iterdir()] == ["a.apd"]


def test_save_over_does_not_replace_what_comes_while_it_is_opened(session, path, monkeypatch):
    other, now = Driven(), path.read_bytes()
    session.drag(BENT)
    save(session, path)
    newer = path.read_bytes()
    path.write_bytes(now)

    def slow(path):
        found = open_session_file(path)
        path.write_bytes(newer)
        return found

    monkeypatch.setattr(file_jobs, "open_session_file", slow)
    other.files.open(path)
    wait(other)
    other.drag(pose(0.3))
    _, failed = save(other, path)
    other.close()
    assert len(failed) == 1
    assert path.read_bytes() == newer


def test_save_over_replaces_what_was_seen_and_nothing_newer_when_agreed(session, other, path):
    found = []
    session.drag(BENT)
    save(session, path)
    other.drag(pose(0.3))
    assert save(other, path, on_file_changed=found.append) == ([], [])
    path.write_bytes(b"a third one")
    assert save(other, path, on_file_changed=found.append, replaceable=found[0]) == ([], [])
    assert path.read_bytes() == b"a third one"
    assert len(found) == 2
    other.settle()
    save(other, path, replaceable=found[1])
    check_equal(open_session(path)[0], other.store.state)
    assert not other.saved_work.is_unsaved


def test_files_save_replaces_a_file_chosen_anew(session, path, tmp_path):
    (tmp_path / "b.apd").write_bytes(b"somebody else's")
    assert save(session, tmp_path / "b.apd")[1] == []
    check_equal(open_session(tmp_path / "b.apd")[0], session.store.state)


def test_files_save_takes_its_own_file_by_another_name_for_no_other(session, path, monkeypatch):
    monkeypatch.chdir(path.parent)
    session.files.open("a.apd")
    wait(session)
    path.write_bytes(b"somebody else's")
    assert len(save(session, path)[1]) == 1


def test_saved_work_does_not_forget_in_undo_across_files_what_each_held(session, path):
    """Another mesh is saved over the file of the first, and undone up to that."""
    session.show_now(bar())
    save(session, path)
    newer = path.read_bytes()
    session.gestures.undo()
    assert session.saved_work.path == path
    session.drag(BENT)
    assert len(save(session, path)[1]) == 1
    assert path.read_bytes() == newer


# What becomes of a saved file, and of the mesh in another


def look(session):
    session.saved_work.check_file_now()
    session.receive_results()
    return session.saved_work.is_unsaved


def test_saved_work_is_unsaved_when_its_file_has_gone_until_it_is_back(session, path):
    assert not look(session)
    path.rename(path.with_name("b.apd"))
    told = len(session.told)
    assert look(session)
    assert session.told[told:] == [
        "a.apd has been moved or deleted. The changes shown here are in no file until you save them."
    ]
    assert look(session)
    assert len(session.told) == told + 1, "and said once"
    path.with_name("b.apd").rename(path)
    assert not look(session)
    path.unlink()
    assert save(session, path)[1] == []
    assert not look(session)
    check_equal(open_session(path)[0], session.store.state)


def test_saved_work_is_unsaved_when_somebody_else_has_overwritten_its_file(session, other, path):
    other.drag(BENT)
    save(other, path)
    assert look(session)
    assert "has been changed by another window or program" in session.told[-1]
    assert not look(other)


def test_saved_work_takes_a_file_written_again_with_the_same_content_for_no_change(session, path):
    content = path.read_bytes()
    path.unlink()
    path.write_bytes(content)
    assert not look(session)
    session.drag(BENT)
    assert save(session, path)[1] == []


def test_saved_work_look_during_its_own_save_is_no_news(session, path):
    told = len(session.told)
    for k in range(20):
        session.drag(pose(0.01 * k))
        session.files.save(path, VIEW)
        while session.jobs.current is not None:
            session.saved_work.check_file()
            session.receive_results()
    session.saved_work.close()
    session.receive_results()
    assert session.told[told:] == ["Saved a.apd, including a copy of the mesh."] * 20
    assert not session.saved_work.is_unsaved


def remove(mesh):
    mesh.unlink()


def change(mesh):
    mesh.write_text(mesh.read_text().replace("v 0", "v 1", 1))


def move_beside(mesh):
    mesh.rename(mesh.parent.parent / mesh.name)


def rewrite(mesh):
    content = mesh.read_bytes() + b"# looked at"
    mesh.unlink()
    mesh.write_bytes(content)


@pytest.mark.parametrize("embeds", [False, True])
@pytest.mark.parametrize("opens", [False, True], ids=["saved", "opened"])
@pytest.mark.parametrize("act", [remove, change, move_beside, rewrite])
def test_saved_work_is_safe_as_long_as_the_session_opens(session, tmp_path, act, opens, embeds):
    """Its mesh is in a file of its own, or in the session, or nowhere any more."""
    mesh = tmp_path / "meshes" / "bar.obj"
    mesh.parent.mkdir()
    save_mesh(bar(), bar().V, mesh)
    session.files.open(mesh)
    wait(session)
    session.paint_ends()
    path = tmp_path / "a.apd"
    save(session, path, embed=embeds)
    if opens:
        session.files.open(path)
        wait(session)
    assert not look(session)
    act(mesh)
    unsaved = look(session)
    try:
        open_session(path)
        opened = True
    except InputError:
        opened = False
    assert unsaved != opened
    assert opened == (embeds or act in (move_beside, rewrite))
    if unsaved:
        assert session.told[-1].startswith("The mesh of a.apd has been moved, changed or deleted.")
        assert save(session, path)[1] == []
        assert not look(session)
        check_equal(open_session(path)[0], session.store.state)
