"""The solver's process: killed, useless, unable to start, left alone. The user's work survives all of it."""

import gc
import os
import signal
import subprocess
import sys
import textwrap
import time
from contextlib import closing
from pathlib import Path

import forked
import interleavings
import numpy as np
import pytest
from driven_session import BENT, Driven, bar, pose
from meshes import box, ends
from process_tree import tree_of

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, HANDLE
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.processes import solver_process
from apd_viewer.session.processes.child_process import ChildProcess
from apd_viewer.session.processes.request_and_reply import Request
from apd_viewer.session.processes.solver_worker import SolverWorker
from apd_viewer.session.state_store import Activity

pytestmark = pytest.mark.usefixtures("processes")
SIGKILL = getattr(signal, "SIGKILL", signal.SIGTERM)
linux = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="looks into /proc")
ROOT = Path(__file__).parents[3]
BYTES_AN_EVENT = 6_000  # at most; the shape of the bar alone has 1,500
SPARE = 4 << 20  # bytes; at least so many lie free after a drag of 5,000 vertices
RESTART = 10.0  # s; a new solver process takes 1.3 to 2.1 s where nothing else wants the cores


def kill(processes: list[ChildProcess], session: Driven) -> None:
    """Kill the process, and wait until there is another."""
    count = len(processes)
    os.kill(processes[-1].pid, SIGKILL)
    session.until(lambda: len(processes) > count, 3.0)


def gone(pid: int) -> bool:
    """Whether a process has ended, be it that nobody has asked yet how."""
    try:
        return ") Z " in Path(f"/proc/{pid}/stat").read_text()
    except OSError:
        return True


def next_frame(session: Driven, seconds: float) -> None:
    before = session.U
    session.until(lambda: session.U is not before, seconds)


@pytest.fixture
def altered(monkeypatch):
    """Processes that are started from now on do something else first."""

    def alter(code: str) -> None:
        monkeypatch.setattr(solver_process, "ChildProcess", forked.altered(code))

    return alter


# Killed


def test_solver_worker_loses_nothing_when_its_process_is_killed_in_a_drag_five_times(session, processes):
    session.settings.change(method="arap")
    session.gestures.begin()
    for k in range(5):  # more often than a request is given up after
        session.handles.drag(pose(0.1 * k + 0.1))
        next_frame(session, 2 * RESTART)
        session.listen(0.02)
        U, document, killed = session.U, session.store.state.document, time.monotonic()
        kill(processes, session)
        assert session.store.state.document is document
        session.handles.drag(pose(0.1 * k + 0.15))
        next_frame(session, RESTART)
        assert time.monotonic() - killed < RESTART
        assert np.abs(session.U - U).max() < 1.0, "it goes on from where it was"
    document = session.store.state.document
    session.gestures.end("Move handle")
    session.settle()
    assert session.store.state.document is document
    assert session.store.activity is Activity.SETTLED
    held = document.constraints()
    assert np.allclose(session.U[held.fixed], held.targets, rtol=0, atol=1e-12)
    assert session.failed == []
    assert len(session.told) == 1, "five times the same news in ten seconds would be four too many"
    assert "nothing was lost" in session.told[0]


def test_solver_worker_goes_on_from_the_last_shape_without_a_word_from_the_user(empty, altered, processes):
    altered(
        """
        import time
        from apd_viewer.geometry.solver.deformation import Deformation
        real = Deformation.iterate
        Deformation.iterate = lambda self: (time.sleep(0.01), real(self))
        """
    )
    session = empty
    session.show_now(bar())
    session.paint_ends()
    session.settings.change(tolerance=1e-12)  # not to be met
    session.settings.change(method="paper")
    session.drag(BENT)
    session.until(lambda: session.store.state.frame.iteration > 30)
    U = session.U
    changes = len(session.changes)
    kill(processes, session)
    session.until(lambda: session.told)
    next_frame(session, RESTART)
    session.listen(0.1)
    rest = session.store.state.document.mesh.V
    for _, state in session.changes[changes:]:
        assert np.abs(state.frame.U - U).max() < 0.2 * np.abs(U - rest).max()


def test_solver_worker_replaces_a_process_killed_at_rest_and_nothing_moves(session, processes):
    session.drag(BENT)
    session.settle()
    state = session.store.state
    kill(processes, session)
    session.listen(1.0)
    assert session.store.state is state
    assert session.store.activity is Activity.SETTLED
    assert session.failed == []
    assert len(session.told) == 1
    session.drag(pose(0.3))
    session.settle()
    assert session.store.activity is Activity.SETTLED


def test_solver_worker_gives_up_in_a_sentence_a_request_that_kills_every_process(empty, altered, monkeypatch):
    with monkeypatch.context() as patch:
        patch.setattr(solver_process, "ChildProcess", forked.Quick)  # again in the end
        altered(
            """
            import os
            from apd_viewer.geometry.solver.deformation import Deformation
            Deformation.iterate = lambda self: os._exit(139)
            """
        )
        empty.show_now(bar())
        empty.paint_ends()
        state = empty.store.state
        empty.drag(BENT)
        empty.until(lambda: empty.failed)
    assert "3 times" in empty.failed[0]
    assert empty.failed[0].endswith(".")
    assert empty.store.activity is Activity.UNREACHED
    assert empty.U is state.frame.U
    empty.gestures.undo()
    assert empty.store.state is state
    empty.drag(BENT)
    empty.settle()
    assert empty.store.activity is Activity.SETTLED
    assert len(empty.failed) == 1


def test_solver_worker_gets_an_error_in_its_process_into_the_log_of_its_owner(empty, altered, caplog):
    altered(
        """
        from apd_viewer.geometry.solver.deformation import Deformation
        def fails(self):
            raise RuntimeError("out of luck")
        Deformation.iterate = fails
        """
    )
    empty.show_now(bar())
    empty.paint_ends()
    empty.drag(BENT)
    empty.until(lambda: empty.failed)
    assert "RuntimeError: out of luck" in caplog.text
    assert "in fails" in caplog.text, "with where it was"


# Not started


def test_solver_worker_says_that_its_process_ends_at_once(empty, monkeypatch):
    with monkeypatch.context() as patch:
        patch.setattr(
            solver_process, "ChildProcess", lambda title, _: ChildProcess(title, "raise SystemExit(3)")
        )
        empty.show_now(bar())
        empty.until(lambda: empty.failed)
        assert "3 times" in empty.failed[0]
        empty.listen(0.2)
        assert len(empty.failed) == 1
    empty.paint_ends()
    empty.drag(BENT)
    empty.settle()
    assert empty.store.activity is Activity.SETTLED


def test_solver_worker_says_that_its_process_cannot_be_started(empty, monkeypatch):
    with monkeypatch.context() as patch:
        patch.setattr(solver_process, "ChildProcess", ChildProcess)
        patch.setattr(sys, "executable", "/no/such/python")
        empty.show_now(bar())
        empty.until(lambda: empty.failed)
    assert "cannot be started" in empty.failed[0]
    assert empty.store.state is not None
    empty.paint_ends()
    empty.drag(BENT)
    empty.settle()
    assert empty.store.activity is Activity.SETTLED


# Factored elsewhere


@pytest.fixture
def endless(altered):
    """Large meshes take a minute to factor, all the time with the interpreter held."""
    altered(
        """
        from apd_viewer.session.processes import remote_factor, request_solver
        request_solver.REMOTE_FACTOR_ROWS = 1000
        slow = "from apd_viewer.geometry.linalg.linear_solver import LinearSolver; import ctypes\\n"
        slow += "LinearSolver.from_rows = lambda *_: ctypes.PyDLL(None).sleep(60)\\nmain(replies)"
        real = remote_factor.ChildProcess
        remote_factor.ChildProcess = lambda title, script: real(title, script.replace("main(replies)", slow))
        """
    )


def begun(session: Driven, processes: list[ChildProcess], mesh: Mesh) -> Driven:
    """The session in the middle of an endless factorization."""
    session.show_now(mesh)
    session.paint_ends()
    session.until(lambda: children_of(processes))
    return session


@pytest.fixture
def factoring(empty, endless, processes):
    """A session in the middle of the factorization of a small mesh."""
    return begun(empty, processes, Mesh(*box(10, 10, 30)))


def children_of(processes: list[ChildProcess]) -> list[int]:
    """The processes that the session's process has started."""
    pid = processes[-1].pid if processes else None
    return tree_of(pid)[1:] if pid else []


@linux
def test_remote_factor_is_ended_when_it_has_become_useless(factoring, processes):
    (useless,) = children_of(processes)
    factoring.show_now(bar())
    factoring.paint_ends()
    factoring.drag(BENT)
    factoring.settle()
    assert factoring.store.activity is Activity.SETTLED
    assert len(processes) == 1, "what else it knows is not lost with it"
    assert gone(useless)
    assert children_of(processes) == []
    assert factoring.failed == factoring.told == [], "that is nobody's business"


@linux
def test_remote_factor_that_is_needed_goes_on_whatever_the_pose(factoring, processes):
    before = children_of(processes)
    factoring.drag(pose(0.1), pose(0.2))
    factoring.listen(0.3)
    assert children_of(processes) == before


@linux
@pytest.mark.parametrize(
    "method", ["exact", *(pytest.param(name, marks=pytest.mark.night) for name in ("local", "arap"))]
)
def test_request_solver_lets_the_shape_follow_the_hand_while_it_is_factored(
    empty, endless, processes, method
):
    factoring = begun(empty, processes, Mesh(*box(20, 20, 40)))  # which has a coarse surface
    factoring.settings.change(method=method)
    factoring.gestures.begin()
    for k in range(10):
        factoring.handles.drag(pose(0.05 * k + 0.05))
        next_frame(factoring, 20.0)
        frame = factoring.store.state.frame
        assert not frame.settled
        if method == "exact":
            assert abs(frame.area_error) <= 1e-9
    factoring.gestures.end("Move handle")
    # A preview that crosses itself contact takes none of, so the last part of a long way may wait.
    factoring.until(lambda: factoring.store.state.frame.share_reached > 0.5, 20.0)
    assert factoring.store.activity is Activity.REFINING, "the shape of the fine surface is still to come"
    assert factoring.failed == []


@linux
def test_session_close_ends_a_factorization_at_once(factoring, processes):
    before = [processes[-1].pid, *children_of(processes)]
    started = time.monotonic()
    factoring.close()
    assert time.monotonic() - started < 1.0
    end = time.monotonic() + 1.0
    while not all(gone(pid) for pid in before):
        assert time.monotonic() < end
        time.sleep(0.01)


@linux
def test_remote_factor_goes_along_with_a_killed_process(factoring, processes):
    (before,) = children_of(processes)
    kill(processes, factoring)
    factoring.until(lambda: gone(before), 5.0)  # it may not have loaded yet what lets it notice
    factoring.until(lambda: children_of(processes))


@linux
def test_remote_factor_that_dies_is_begun_again(factoring, processes):
    factoring.drag(pose(0.1))
    (before,) = children_of(processes)
    os.kill(before, SIGKILL)
    factoring.until(lambda: children_of(processes) not in ([], [before]))
    assert factoring.failed == factoring.told == []


def test_solver_worker_ask_never_waits(endless):
    mesh = Mesh(*box(20, 20, 40))
    base, top = ends(mesh.V)
    document = initial_state(mesh).document.with_label(base, BASE).with_label(top, HANDLE)
    slowest = 0.0
    with closing(SolverWorker(lambda: None)) as worker:
        for k in range(200):
            request = Request(document.with_pose(0, pose(0.01 * k)), 99, mesh.V, iterate=True)
            started = time.perf_counter()
            worker.put_request(request)
            slowest = max(slowest, time.perf_counter() - started)
            time.sleep(0.0005)
    assert slowest < 0.05


@linux
@pytest.mark.night
def test_request_solver_ends_with_a_large_mesh_where_it_would_with_a_small_one(empty, altered, processes):
    altered(
        "from apd_viewer.session.processes import request_solver; request_solver.REMOTE_FACTOR_ROWS = 2500\n"
    )
    empty.show_now(Mesh(*box(16, 16, 36)))
    empty.paint_ends()
    empty.drag(pose(0.2), pose(0.4))
    empty.settle()
    assert children_of(processes)
    U, document = empty.U, empty.store.state.document
    held = document.constraints()
    near = Deformation(document.mesh.V, document.mesh.F, held.fixed, handle=held.handles, area=100.0)
    near.aim(held.targets)
    while not (frame := near.step()).settled:
        pass
    energies = [near.rest.energy(shape) for shape in (U, frame.U)]
    assert energies[0] == pytest.approx(energies[1], rel=1e-3)
    assert empty.store.state.frame.converged


def test_solver_worker_keeps_what_is_known_of_a_mesh_beyond_its_process(empty, altered, processes, capfd):
    altered(
        """
        import sys
        from apd_viewer.geometry.energy import solve_mesh
        from apd_viewer.session.processes import request_solver
        request_solver.REMOTE_FACTOR_ROWS = 2500
        real = solve_mesh.decimated_mesh
        def thinned(V, F, count):
            print(f"thinned {len(V)}", file=sys.stderr, flush=True)
            return real(V, F, count)
        solve_mesh.decimated_mesh = thinned

        import time
        from apd_viewer.session.processes.mailbox import Mailbox
        take = Mailbox.wait
        def late(self):
            while not self.is_ready:
                time.sleep(0.001)
            time.sleep(0.3)  # so the first order of the second process is never looked at
            return take(self)
        Mailbox.wait = late
        """
    )
    empty.show_now(Mesh(*box(20, 20, 40)))
    empty.paint_ends()
    empty.drag(pose(0.1))
    next_frame(empty, 20.0)
    kill(processes, empty)
    empty.drag(pose(0.2))
    next_frame(empty, 20.0)
    assert capfd.readouterr().err.split("\n").count(f"thinned {len(empty.U)}") == 1


# Left alone

ORPHAN = """
    import sys, time
    sys.path[:0] = {paths!r}
    from driven_session import Driven, BENT
    from meshes import box
    from apd_viewer.geometry.mesh.mesh import Mesh
    print("begun", flush=True)
    session = Driven()
    session.show_now(Mesh(*box({size})))
    session.paint_ends()
    session.settings.change(tolerance=1e-12)
    session.settings.change(method="paper")
    session.drag(BENT)
    session.until(lambda: session.store.state.frame.iteration)
    print("iterating", flush=True)
    if {wait}:
        time.sleep(60)
    session.close()
"""


def script(tmp_path, wait: bool) -> list[str]:
    """A user's script, without a guard, and a folder to start it in with a trap in it."""
    paths, size = [str(ROOT), str(ROOT / "tests" / "support")], "20, 20, 40" if wait else "2, 2, 6"
    (tmp_path / "numpy.py").write_text("raise SystemExit('not this one')")
    (tmp_path / "scripts").mkdir()
    path = tmp_path / "scripts" / "script.py"
    path.write_text(textwrap.dedent(ORPHAN.format(paths=paths, wait=wait, size=size)))
    return [sys.executable, "-W", "error", str(path)]


def test_start_process_runs_a_script_without_a_guard_once(tmp_path):
    done = subprocess.run(
        script(tmp_path, False), cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("begun") == 1
    assert done.stderr == ""


def blocks_of(pid: int) -> set[str]:
    """The blocks of shared memory of a process."""
    return {block.name for block in Path("/dev/shm").glob(f"apd-{pid}-*")}


@linux
def test_solver_main_ends_and_leaves_no_memory_when_its_owner_is_killed(tmp_path):
    owner = subprocess.Popen(
        script(tmp_path, True), cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    )
    with owner:
        assert [owner.stdout.readline() for _ in range(2)] == ["begun\n", "iterating\n"]
        _, *below = tree_of(owner.pid)
        assert below
        assert blocks_of(owner.pid), "the test is blind"
        owner.kill()
    end = time.monotonic() + 10.0
    while not all(map(gone, below)) or blocks_of(owner.pid):
        assert time.monotonic() < end
        time.sleep(0.02)


@linux
def test_session_leaves_no_process_no_memory_and_no_open_file():
    def left():
        return len(os.listdir("/proc/self/fd")), blocks_of(os.getpid())  # noqa: PTH208

    for k in range(2):
        session = Driven()
        session.show_now(Mesh(*box(16, 16, 30)))
        session.paint_ends()
        session.drag(BENT)
        session.until(lambda s=session: s.store.state.frame.iteration)
        assert blocks_of(os.getpid()), "the test is blind"
        session.close()
        del session
        if k == 0:
            before = left()
    assert left() == before


# Any order, and for long


@pytest.mark.parametrize("times", [8, pytest.param(40, marks=pytest.mark.night)])
def test_session_shows_only_what_was_asked_for_in_whatever_order_a_user_acts(times):
    assert interleavings.play(times) > 10 * times


def resident(pid: int | str) -> int:
    """Bytes of a process in memory."""
    return int(Path(f"/proc/{pid}/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


@linux
@pytest.mark.parametrize("events", [600, pytest.param(3000, marks=pytest.mark.night)])
def test_session_takes_no_more_memory_with_the_events_of_a_drag(session, processes, events):
    session.settings.change(method="arap")
    session.drag(pose(0.1))
    session.settle()
    assert session.store.activity is Activity.SETTLED
    session.gestures.begin()
    sizes = []
    for k in range(events):
        session.handles.drag(pose(0.5 * np.sin(0.01 * k)))
        session.receive_results()
        session.changes.clear()  # what the test itself keeps
        time.sleep(0.0005)
        if k + 1 in (events // 3, events):
            gc.collect()  # which is seldom done by itself where much is alive, as after many tests
            sizes.append((resident("self"), resident(processes[-1].pid)))
    session.gestures.end("Move handle")
    for before, after in zip(*sizes, strict=True):
        assert after - before < BYTES_AN_EVENT * events


@linux
@pytest.mark.night
def test_request_solver_gives_the_memory_of_a_drag_back_in_a_pause(empty, processes, monkeypatch):
    monkeypatch.setattr(solver_process, "ChildProcess", ChildProcess)  # only such a one keeps freed memory
    empty.show_now(Mesh(*box(30, 30, 30)))
    empty.paint_ends()
    empty.drag(pose(0.1))
    empty.until(lambda: empty.store.compiled_fraction == 1.0, 60.0)
    empty.drag(pose(0.2))
    empty.settle()
    before = resident(processes[-1].pid)
    empty.until(lambda: before - resident(processes[-1].pid) > SPARE, 10.0)


def test_request_solver_factors_the_last_painted_labels(session):
    """Strokes follow each other faster than they are made ready."""
    z = session.store.state.document.mesh.V[:, 2]
    for k in range(1, 5):
        session.stroke(np.flatnonzero(z == k), BASE if k < 3 else HANDLE)
    session.drag(pose(0.2, (0.2, 0.0, 0.0)))
    session.settle()
    held = session.store.state.document.constraints()
    assert np.allclose(session.U[held.fixed], held.targets, rtol=0, atol=1e-9)
    assert initial_state(session.store.state.document.mesh).document.paint_problem
