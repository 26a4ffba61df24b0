"""Opening and writing in the background, and closing while something is under way."""

import gc
import threading
import time
import weakref

import numpy as np
import pytest
from driven_session import BENT, LONG, Driven, bar, pose, solver_threads
from living import living
from meshes import box

from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.solver.methods import DEFAULT_METHOD
from apd_viewer.session import file_jobs
from apd_viewer.session.processes.solver_worker import SolverWorker
from apd_viewer.session.state_store import Activity


@pytest.fixture
def session():
    others = set(threading.enumerate())
    session = Driven()
    session.show_now(bar())
    session.paint_ends()
    yield session
    session.close()
    assert set(threading.enumerate()) <= others


@pytest.fixture
def gate(monkeypatch):
    """Opening and writing wait for this event."""
    event = threading.Event()

    def held(real):
        def work(*args):
            assert event.wait(LONG)
            return real(*args)

        return work

    monkeypatch.setattr(file_jobs, "open_mesh", held(open_mesh))
    monkeypatch.setattr(file_jobs, "save_mesh", held(save_mesh))
    yield event
    event.set()


@pytest.fixture
def cube_file(tmp_path):
    path = tmp_path / "cube.obj"
    mesh = Mesh(*box(1, 1, 1))
    save_mesh(mesh, mesh.V, path)
    return path


def finish(session: Driven) -> None:
    session.until(lambda: session.jobs.current is None)


# Opening


def opening(session, path):
    """Open a file, and the thread that opens it; the solver may start threads meanwhile."""
    session.files.open(path)
    (thread,) = (thread for thread in threading.enumerate() if thread.name == session.jobs.current.title)
    return thread


def test_files_open_works_in_the_background_and_can_be_undone(session, cube_file, gate):
    session.settings.change(method="arap")
    before = session.store.state
    session.files.open(cube_file)
    assert session.jobs.current.title == "Opening cube.obj"
    session.listen(0.02)
    assert session.store.state is before
    gate.set()
    finish(session)
    assert len(session.U) == 8
    assert session.U is session.store.state.document.mesh.V
    assert session.store.state.document.settings.method == DEFAULT_METHOD
    assert session.store.activity is Activity.IDLE
    session.gestures.undo()
    assert session.store.state is before


def test_files_open_tells_of_a_file_that_cannot_be_opened_and_changes_nothing(session, tmp_path):
    bad = tmp_path / "bad.obj"
    bad.write_text("v 0 0 0\nf 1 2 3\n")
    for path in (bad, tmp_path / "none.obj", tmp_path):
        before, count = session.store.state, len(session.failed)
        undo, changes = session.gestures.history.next_undo_name, len(session.changes)
        session.files.open(path)
        finish(session)
        assert len(session.failed) == count + 1
        assert session.failed[-1].endswith(".")
        assert session.store.state is before
        assert (session.gestures.history.next_undo_name, len(session.changes)) == (undo, changes)


@pytest.mark.parametrize(
    "error",
    [
        RuntimeError("broken"),
        MemoryError(),
    ],
)
def test_files_open_tells_of_a_defect_and_changes_nothing(session, cube_file, monkeypatch, capfd, error):
    def broken(_):
        raise error

    before = session.store.state
    monkeypatch.setattr(file_jobs, "open_mesh", broken)
    session.files.open(cube_file)
    finish(session)
    assert session.failed == [f"Opening cube.obj failed ({str(error) or 'MemoryError'})."]
    assert session.store.state is before
    assert "Traceback" in capfd.readouterr().err


def test_jobs_cancel_keeps_an_opening_from_ever_arriving(session, cube_file, gate):
    before = session.store.state
    thread = opening(session, cube_file)
    session.jobs.cancel()
    assert session.jobs.current is None
    gate.set()
    thread.join(LONG)
    session.listen(0.02)
    assert session.store.state is before
    session.jobs.cancel()
    session.files.open(cube_file)
    finish(session)
    assert len(session.U) == 8


def test_jobs_cancel_lets_no_opening_arrive_in_place_of_the_next(session, cube_file, gate, tmp_path):
    slab = tmp_path / "slab.obj"
    mesh = Mesh(*box(2, 2, 1))
    save_mesh(mesh, mesh.V, slab)
    session.files.open(cube_file)
    session.jobs.cancel()
    session.files.open(slab)
    gate.set()
    finish(session)
    session.listen(0.05)
    assert len(session.U) == len(mesh.V)


def test_jobs_refuse_a_second_job_and_the_first_arrives(session, cube_file, gate, tmp_path):
    session.files.open(cube_file)
    first = session.jobs.current
    session.files.open_mesh(bar())
    session.files.export(tmp_path / "out.obj")
    assert session.jobs.current is first
    assert len(session.failed) == 2
    assert all("Opening cube.obj" in sentence for sentence in session.failed)
    gate.set()
    finish(session)
    assert len(session.U) == 8
    assert not (tmp_path / "out.obj").exists()


def test_files_open_lets_verbs_go_on_meanwhile(session, cube_file, gate):
    session.files.open(cube_file)
    session.drag(BENT)
    session.until(lambda: session.store.activity is Activity.SETTLED)
    bent = session.store.state
    gate.set()
    finish(session)
    session.gestures.undo()
    assert session.store.state is bent


def test_files_open_mesh_tells_the_findings_of_the_mesh(session):
    V, F = box(1, 1, 1)
    session.show_now(Mesh(np.vstack([V, [[5.0, 5.0, 5.0]]]), F))
    assert any("loose vertex" in sentence for sentence in session.told)


# Writing


def test_files_export_writes_the_shape_that_was_on_screen(session, tmp_path, gate):
    session.drag(BENT)
    session.settle()
    U, area = session.U, session.store.state.frame.area
    session.files.export(tmp_path / "bent.obj")
    session.drag(pose(-0.5))
    session.until(lambda: session.store.activity is Activity.SETTLED)
    gate.set()
    finish(session)
    written = open_mesh(tmp_path / "bent.obj")
    assert np.allclose(written.V, U, rtol=0, atol=1e-12)
    assert np.array_equal(written.F, session.store.state.document.mesh.F)
    assert f"area {area:.6g}" in session.told[-1]
    assert "bent.obj" in session.told[-1]


@pytest.mark.parametrize("name", ["out.xyz", "no/such/folder/out.obj"])
def test_files_export_tells_of_what_cannot_be_written_and_it_stays_unsaved(session, tmp_path, name):
    session.drag(BENT)
    session.settle()
    before = session.store.state
    session.files.export(tmp_path / name)
    finish(session)
    assert len(session.failed) == 1
    assert session.store.state is before
    assert session.saved_work.is_unsaved


# Closing


def closed_within(session: Driven, seconds: float) -> None:
    started = time.monotonic()
    session.close()
    assert time.monotonic() - started < seconds
    assert solver_threads() == []


def test_session_close_ends_a_run_at_the_next_iteration(session):
    session.settings.change(tolerance=1e-12)  # not to be met
    session.drag(BENT)
    session.until(lambda: session.store.state.frame.iteration > 3)
    closed_within(session, 2.0)


def test_session_close_waits_for_a_file_that_is_written(session, tmp_path, monkeypatch):
    def slowly(*args):
        time.sleep(0.3)
        save_mesh(*args)

    monkeypatch.setattr(file_jobs, "save_mesh", slowly)
    session.files.export(tmp_path / "out.obj")
    closed_within(session, 2.0)
    assert len(open_mesh(tmp_path / "out.obj").V) == len(session.U)


def test_session_close_waits_for_a_file_that_is_written_although_that_was_cancelled(
    session, tmp_path, monkeypatch
):
    def slowly(*args):
        time.sleep(0.3)
        save_mesh(*args)

    monkeypatch.setattr(file_jobs, "save_mesh", slowly)
    session.files.export(tmp_path / "out.obj")
    session.jobs.cancel()
    session.close()
    assert (tmp_path / "out.obj").exists()


def test_session_close_does_not_wait_for_a_file_that_is_opened(session, cube_file, gate):
    thread = opening(session, cube_file)
    closed_within(session, 2.0)
    assert thread.is_alive()
    gate.set()
    thread.join(LONG)


def test_session_wakes_nobody_after_closing(session, cube_file, gate):
    thread = opening(session, cube_file)
    session.jobs.cancel()
    session.close()
    woken = len(session.woken)
    gate.set()
    thread.join(LONG)
    assert len(session.woken) == woken


def test_session_close_works_twice_and_before_anything_is_open():
    session = Driven()
    closed_within(session, 2.0)
    closed_within(session, 2.0)


def test_session_leaves_no_thread_and_no_worker():
    others, sessions = set(threading.enumerate()), []
    workers = living(SolverWorker)
    for k in range(20):
        session = Driven()
        session.show_now(bar())
        if k % 2:
            session.paint_ends()
            session.drag(BENT)
            session.until(lambda s=session, least=k % 5: s.store.state.frame.iteration > least)
        sessions.append(weakref.ref(session))
        session.close()
    del session
    gc.collect()
    assert set(threading.enumerate()) <= others
    assert [ref() for ref in sessions if ref() is not None] == []
    assert living(SolverWorker) == workers


def test_jobs_tell_input_errors_in_sentences_without_a_traceback(session, tmp_path, capfd):
    session.files.open(tmp_path / "none.stl")
    finish(session)
    assert capfd.readouterr().err == ""
