"""What is done is in a file soon, and a program that is killed leaves it whole.

    python tests/session/test_autosave.py [kills]

A process does random things and says after each that it is done; it is killed at a random moment. What is
found must open, and hold what was done SOON before that at the latest.
"""

import os
import random
import signal
import stat
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "support"))
from driven_session import BENT, VIEW, Driven, check_equal, pose
from meshes import box

from apd_viewer.errors import InputError
from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.files.storage.lock import acquire_lock
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE
from apd_viewer.session import autosave
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.storage import recovery_file
from apd_viewer.session.storage.recovery_file import age_text, find_recovery_files, lock_path
from apd_viewer.session.storage.session_file import open_session, save_session

ROOT = Path(__file__).parents[2]
SOON = 1.5  # s; usually 0.3, and longer where the disk is busy
SLOW = 10.0  # s; nothing here should come near it


@pytest.fixture
def folder(tmp_path):
    """Where it is kept; not there yet."""
    return tmp_path / "recovery"


@pytest.fixture
def bar(tmp_path):
    """A bar that came from a file."""
    mesh = Mesh(*box(2, 2, 6))
    save_mesh(mesh, mesh.V, tmp_path / "bar.obj")
    return open_mesh(tmp_path / "bar.obj")


@pytest.fixture
def session(folder, bar):
    """A session that keeps what is done, with a painted bar."""
    others = set(threading.enumerate())
    session = Driven()
    session.autosave.start(folder, lambda: VIEW)
    session.show_now(bar)
    session.paint_ends()
    session.settle()
    check_kept(folder, session)  # or what is written now surprises a test
    yield session
    session.close()
    assert set(threading.enumerate()) <= others


def kept(folder: Path) -> Path | None:
    """The one file that is there."""
    paths = [path for path in folder.glob("*.apd") if not path.name.startswith(".")]
    assert len(paths) <= 1
    return paths[0] if paths else None


def check_kept(folder: Path, session: Driven) -> None:
    """That what is on screen is in the file soon."""
    since = time.monotonic()
    while True:
        try:
            found, view = open_session(kept(folder) or folder)
            check_equal(found, session.store.state)
            assert not list(folder.glob(".*.part*")), "it is being written once more"
        except (AssertionError, InputError):
            if time.monotonic() - since > SLOW:
                raise
            time.sleep(0.01)
        else:
            assert view == VIEW
            return


def left_behind(folder: Path, mesh: Mesh, name: str = "1-1", age: float = 0.0) -> Path:
    """What a program has left that is dead."""
    folder.mkdir(exist_ok=True)
    path = folder / f"{name}.apd"
    save_session(path, initial_state(mesh), VIEW)
    written = time.time() - age
    os.utime(path, (written, written))
    return path


# Keeping


def test_autosave_has_every_step_in_the_file_soon(session, folder):
    check_kept(folder, session)
    session.drag(BENT)
    session.settle()
    check_kept(folder, session)
    for step in (
        session.gestures.undo,
        session.gestures.redo,
        lambda: session.gestures.go_to_step(1),
        lambda: session.gestures.go_to_step(3),
    ):
        step()
        session.settle()
        check_kept(folder, session)
    session.parts.rename_handle(0, "neck")
    check_kept(folder, session)
    session.settings.change(method="local")
    session.settle()
    check_kept(folder, session)


def test_autosave_keeps_the_end_of_a_drag_before_its_shape_has_settled(session, folder, monkeypatch):
    written = []
    monkeypatch.setattr(autosave.AutosaveWriter, "put", lambda _, copy, __: written.append(copy.state))
    session.drag(*(pose(k / 50) for k in range(1, 30)))
    assert [state.document for state in written] == [session.store.state.document]
    session.settle()
    assert len(written) == 2, "and once more, not with every frame"
    assert written[1] is session.store.state


def test_autosave_does_not_keep_what_is_not_finished(session, folder):
    check_kept(folder, session)
    before = session.store.state
    session.gestures.begin()
    session.handles.drag(BENT)
    session.listen(0.2)
    found = open_session(kept(folder))[0]
    check_equal(found, before)
    session.gestures.cancel()
    session.settle()
    check_kept(folder, session)


def test_autosave_does_not_keep_a_mesh_that_was_only_opened(folder, bar):
    session = Driven()
    session.autosave.start(folder)
    session.show_now(bar)
    session.listen(0.1)
    assert not folder.exists()
    session.close()
    assert not folder.exists()


def test_autosave_does_not_keep_a_second_mesh_that_was_only_opened(session, folder, bar):
    check_kept(folder, session)
    session.show_now(bar)
    session.until(lambda: kept(folder) is None)
    session.gestures.undo()
    check_kept(folder, session)


@pytest.mark.parametrize("safe", ["saved", "undone"])
def test_autosave_no_longer_keeps_work_that_is_safe(session, folder, tmp_path, safe):
    check_kept(folder, session)
    if safe == "saved":
        session.files.save(tmp_path / "mine.apd", VIEW)
    else:
        session.gestures.go_to_step(0)
    session.until(lambda: kept(folder) is None)
    assert find_recovery_files(folder) == []
    session.parts.rename_handle(0, "neck")
    check_kept(folder, session)


def test_autosave_leaves_nothing_after_a_clean_end(session, folder):
    check_kept(folder, session)
    session.until(lambda: len(list(folder.iterdir())) == 2)  # one more while it is written
    session.close()
    assert list(folder.iterdir()) == []


def test_autosave_keeps_nothing_without_a_folder(tmp_path, bar):
    session = Driven()
    session.show_now(bar)
    session.paint_ends()
    session.close()
    assert [path.name for path in tmp_path.iterdir()] == ["bar.obj"]


def test_set_interval_at_an_interval_keeps_the_newest_and_saved_work_does_not_wait(session, folder, tmp_path):
    check_kept(folder, session)
    session.listen(0.5)  # until the writer waits for the next copy: the interval counts from there
    session.autosave.set_interval(1000.0)
    session.parts.rename_handle(0, "first")
    check_kept(folder, session)
    before = kept(folder).read_bytes()
    for name in ("second", "third"):
        session.parts.rename_handle(0, name)
    session.listen(0.1)
    assert kept(folder).read_bytes() == before
    session.autosave.set_interval(0.0)
    check_kept(folder, session)
    session.autosave.set_interval(1000.0)
    session.parts.rename_handle(0, "fourth")
    session.files.save(tmp_path / "mine.apd", VIEW)
    session.until(lambda: kept(folder) is None)


def test_autosave_keeps_nothing_turned_off_and_all_turned_on_again(session, folder):
    check_kept(folder, session)
    session.autosave.set_interval(None)
    session.parts.rename_handle(0, "neck")
    session.until(lambda: kept(folder) is None)
    session.autosave.set_interval(0.0)
    check_kept(folder, session)


# The disk


def test_autosave_has_a_step_safe_once_it_is_done(session, folder):
    check_kept(folder, session)
    for name in ("Neck", "Shoulder", "Cap"):
        before = kept(folder).read_bytes()
        session.parts.rename_handle(0, name)
        assert kept(folder).read_bytes() != before, "the very next moment may be the last"


def test_autosave_has_a_step_safe_once_done_though_the_shape_before_it_is_being_written(
    session, folder, monkeypatch
):
    check_kept(folder, session)
    begun, write = threading.Event(), save_session

    def unhurried(*copy, **more):
        begun.set()
        time.sleep(0.05)
        return write(*copy, **more)

    session.drag(*(pose(k / 50) for k in range(1, 30)))
    monkeypatch.setattr(autosave, "save_session", unhurried)
    session.settle()
    assert begun.wait(SLOW), "the settled shape"
    session.parts.rename_handle(0, "Neck")
    assert open_session(kept(folder))[0].document.handles[0].name == "Neck"


def test_autosave_lets_a_key_that_is_held_down_wait_for_no_file(session, folder, monkeypatch):
    check_kept(folder, session)
    awaited, put = [], autosave.AutosaveWriter.put

    def noted(backup, copy, patience):
        awaited.append(patience > 0.0)
        put(backup, copy, patience)

    monkeypatch.setattr(autosave.AutosaveWriter, "put", noted)
    for k in range(1, 6):
        session.handles.set_pose(pose(k / 50), 0, "Nudge handle", is_repeat=True)
    assert awaited[0]
    assert not any(awaited[1:])
    check_kept(folder, session)
    session.gestures.undo()
    assert awaited[-1]


def test_autosave_keeps_nobody_waiting_for_a_slow_disk_and_writes_the_newest(session, folder, monkeypatch):
    check_kept(folder, session)
    entered, go_on, written = threading.Event(), threading.Event(), []

    def slow(path, state, view, is_urgent, finish):
        entered.set()
        assert go_on.wait(SLOW)
        written.append(state.document.handles[0].name)
        return save_session(path, state, view, is_urgent=is_urgent, finish=finish)

    monkeypatch.setattr(autosave, "save_session", slow)
    session.parts.rename_handle(0, "first")
    assert entered.wait(SLOW)
    since = time.monotonic()
    for k in range(100):
        session.parts.rename_handle(0, f"name {k}")
    assert time.monotonic() - since < 1.0
    go_on.set()
    check_kept(folder, session)
    # What was kept before may still be written once more: its shape at rest came as a frame of its own.
    assert written[-1] == "name 99"
    assert set(written) <= {"Handle 1", "first", "name 99"}


def test_autosave_says_a_full_disk_once_and_tries_again_with_the_next_step(session, folder, monkeypatch):
    check_kept(folder, session)
    safe = kept(folder).read_bytes()
    full, write = True, Path.replace

    def replace(path, target):
        if full:
            raise OSError(28, "No space left on device")
        return write(path, target)

    monkeypatch.setattr(Path, "replace", replace)
    told = len(session.told)
    for name in ("a", "b", "c"):
        session.parts.rename_handle(0, name)
        session.listen(0.15)
    assert len(session.told) == told + 1
    assert "No space left on device" in session.told[-1]
    assert session.failed == []
    assert kept(folder).read_bytes() == safe
    full = False
    session.parts.rename_handle(0, "d")
    check_kept(folder, session)
    full = True
    session.parts.rename_handle(0, "e")
    session.until(lambda: len(session.told) == told + 2)


def test_autosave_says_that_a_disk_does_not_keep_what_it_took(session, folder, monkeypatch):
    check_kept(folder, session)

    def fsync(descriptor):
        raise OSError(5, "Input/output error")

    monkeypatch.setattr(os, "fsync", fsync)
    session.parts.rename_handle(0, "neck")
    session.until(lambda: session.told)
    assert "Input/output error" in session.told[-1]


def test_autosave_says_once_that_a_folder_cannot_be_made(tmp_path, bar):
    (tmp_path / "file").write_text("in the way")
    session = Driven()
    session.autosave.start(tmp_path / "file" / "recovery")
    session.show_now(bar)
    session.paint_ends()
    session.until(lambda: session.told)
    session.parts.rename_handle(0, "neck")
    session.listen(0.1)
    session.close()
    assert len(session.told) == 1
    assert session.told[0].startswith("Autosave failed (")


def test_autosave_says_that_a_disk_has_no_locks(session, folder, tmp_path, monkeypatch):
    def refused(*_):
        raise OSError(95, "Operation not supported")

    monkeypatch.setattr(pytest.importorskip("fcntl"), "flock", refused)
    session.autosave.close()
    session.autosave.start(tmp_path / "elsewhere")
    session.parts.rename_handle(0, "neck")
    session.until(lambda: session.told)
    assert "Operation not supported" in session.told[-1]
    assert find_recovery_files(tmp_path / "elsewhere") == []


def test_autosave_fills_a_cleared_folder_again(session, folder):
    check_kept(folder, session)
    folder.rename(folder.with_name("cleared"))  # in one act, as it may be written just now
    session.parts.rename_handle(0, "neck")
    check_kept(folder, session)
    assert find_recovery_files(folder) == []


# What is left


def test_find_recovery_files_does_not_offer_what_a_living_program_keeps(session, folder):
    check_kept(folder, session)
    assert find_recovery_files(folder) == []
    assert kept(folder) is not None


def test_find_recovery_files_does_not_offer_elsewhere_what_is_offered_here(folder, bar):
    left_behind(folder, bar)
    (left,) = find_recovery_files(folder)
    assert find_recovery_files(folder) == []
    left.release()
    (left,) = find_recovery_files(folder)
    left.discard()
    assert list(folder.iterdir()) == []


def test_find_recovery_files_has_the_newest_first_and_none_is_too_old(folder, bar):
    for name, age in (
        ("1-1", 60.0),
        ("2-1", 0.0),
        ("3-1", 4000 * 86400.0),
        ("4-1", -1e9),
        ("6-1", time.time()),
    ):
        left_behind(folder, bar, name, age)
    (folder / "5-1.lock").touch()
    (folder / ".1-1.apd-killed.part.apd").touch()
    (folder / "mine.apd").write_bytes((folder / "3-1.apd").read_bytes())
    found = find_recovery_files(folder)
    assert [left.path.stem for left in found] == ["4-1", "2-1", "1-1", "3-1", "6-1"]
    assert {left.name for left in found} == {"bar.obj"}
    for left in found:
        left.discard()
    assert [path.name for path in folder.iterdir()] == ["mine.apd"], "which is none of the program's"


def test_find_recovery_files_lets_stay_what_cannot_be_read_now_or_is_not_its_own(folder, bar, monkeypatch):
    path = left_behind(folder, bar)
    (folder / "2-1.apd").mkdir()
    (folder / "3-1.apd").symlink_to(path)
    os.mkfifo(folder / "4-1.apd")
    read = os.open

    def broken(path, *args, **more):
        if str(path).endswith(".apd"):
            raise OSError(5, "Input/output error")
        return read(path, *args, **more)

    with monkeypatch.context() as patch:
        patch.setattr(os, "open", broken)
        (left,) = find_recovery_files(folder)
        assert left.name == "a damaged session"
        left.release()
    (left,) = find_recovery_files(folder)
    assert left.name == "bar.obj"
    left.release()
    assert {each.name for each in folder.glob("*.apd")} == {"1-1.apd", "2-1.apd", "3-1.apd", "4-1.apd"}


@pytest.mark.skipif(sys.platform == "win32", reason="whose folders of users are private")
def test_keep_private_lets_nobody_else_read_what_is_kept_or_left(session, folder, bar, tmp_path):
    check_kept(folder, session)
    assert mode(folder) == 0o700
    assert modes_of_kept(folder) == {0o600}
    session.parts.rename_handle(0, "neck")
    check_kept(folder, session)
    assert modes_of_kept(folder) == {0o600}
    older = tmp_path / "older"
    path = left_behind(older, bar)
    older.chmod(0o755)
    path.chmod(0o644)
    (left,) = find_recovery_files(older)
    left.release()
    assert (mode(older), mode(path)) == (0o700, 0o600)
    session.files.save(tmp_path / "mine.apd", VIEW)
    session.until(lambda: session.jobs.current is None)
    assert mode(tmp_path / "mine.apd") == mode(bar.path), "which others may read where the user lets them"


@pytest.mark.skipif(sys.platform == "win32", reason="whose folders of users are private")
def test_keep_private_closes_a_folder_of_an_older_version_before_anything_is_written(folder, bar):
    folder.mkdir(mode=0o755)
    folder.chmod(0o755)
    again = Driven()
    again.autosave.start(folder)
    again.show_now(bar)
    again.paint_ends()
    again.until(lambda: kept(folder))
    again.close()
    assert mode(folder) == 0o700


def mode(path):
    return stat.S_IMODE(path.stat().st_mode)


def modes_of_kept(folder):
    """Modes of the files that are kept, but those that are being written."""
    return {mode(path) for path in folder.glob("[!.]*.apd")}


def test_find_recovery_files_finds_none_without_a_folder(folder):
    assert find_recovery_files(folder) == []


def test_acquire_lock_gives_no_lock_of_a_file_that_is_gone(tmp_path, monkeypatch):
    fcntl = pytest.importorskip("fcntl")
    lock = fcntl.flock

    def late(*how):
        lock(*how)
        (tmp_path / "a.lock").unlink()

    monkeypatch.setattr(fcntl, "flock", late)
    assert acquire_lock(tmp_path / "a.lock") is None
    monkeypatch.setattr(recovery_file, "acquire_lock", lambda _: None)
    with pytest.raises(OSError, match="locked"):
        recovery_file.claim_path(tmp_path)


def test_age_text_says_in_words_how_long_ago():
    now = time.time()
    said = [age_text(now - seconds) for seconds in (-5, 0, 59, 61, 125, 3598, 3601, 86398, 2 * 86401)]
    minutes = ["1 minute ago", "2 minutes ago", "59 minutes ago"]
    assert said == ["just now"] * 3 + minutes + ["1 hour ago", "23 hours ago", "2 days ago"]
    assert {age_text(time) for time in (0.0, 86400.0, now + 1e9)} == {"at an unknown time"}


def test_autosave_restore_is_one_step_and_is_kept_again_before_the_file_goes(session, folder, bar):
    session.drag(BENT)
    session.settle()
    before = session.store.state
    path = left_behind(folder, bar)
    (left,) = find_recovery_files(folder)
    saved = open_session(path)[0]
    session.autosave.restore(left)
    session.until(lambda: session.jobs.current is None)
    assert left.is_restored
    check_equal(session.store.state, saved)
    assert session.gestures.history.next_undo_name == "Open bar.obj"
    session.until(lambda: not path.exists() and not lock_path(path).exists())
    check_kept(folder, session)
    session.gestures.undo()
    assert session.store.state is before
    assert session.failed == []


def test_autosave_restore_gives_work_that_counts_as_unsaved(session, folder, bar):
    session.drag(BENT)
    session.settle()
    check_kept(folder, session)
    path = folder / "1-1.apd"
    save_session(path, session.store.state, VIEW)
    (left,) = find_recovery_files(folder)
    again = Driven()
    again.autosave.restore(left)
    again.until(lambda: again.jobs.current is None)
    assert again.saved_work.is_unsaved
    assert path.exists(), "as long as it is not kept anywhere else"
    again.close()
    left.release()


@pytest.mark.parametrize("damage", ["nonsense", "half", "no mesh"])
def test_autosave_restore_refuses_in_a_sentence_what_is_damaged_and_it_stays(session, folder, bar, damage):
    check_kept(folder, session)
    path = left_behind(folder, bar)
    if damage == "no mesh":
        bar.path.unlink()
    else:
        content = path.read_bytes()
        path.write_bytes(b"nonsense" if damage == "nonsense" else content[: len(content) // 2])
    (left,) = find_recovery_files(folder)
    state = session.store.state
    session.autosave.restore(left)
    session.until(lambda: session.failed)
    name = "bar.obj" if damage == "no mesh" else "a damaged session"
    assert session.failed[0].startswith(f"The unsaved work on {name} cannot be restored: ")
    assert session.store.state is state
    assert not left.is_restored
    session.close()
    assert path.exists()
    left.discard()
    assert not path.exists()


# Kills


NURSERY = """
import os, sys
from pathlib import Path
sys.path[:0] = sys.argv[2:]
import test_autosave
for _ in sys.stdin:
    child = os.fork()
    if not child:
        test_autosave.play(Path(sys.argv[1]))
    print(child, flush=True)
    os.waitpid(child, 0)
    print("dead", flush=True)
"""


def play(folder: Path) -> None:
    """Do random things without an end, in a session that keeps them; log the number and the time of each."""
    import in_thread

    from apd_viewer.session.processes import solver_process

    solver_process.start_solver_process = in_thread.InThread
    chance = random.Random()
    session = Driven()
    session.autosave.start(folder / "recovery", lambda: VIEW)
    session.show_now(open_mesh(folder / "bar.obj"))
    session.paint_ends()
    n = len(session.store.state.document.mesh.V)
    things = [
        lambda: session.stroke(np.array(chance.sample(range(n), 3)), chance.randrange(3)),
        lambda: session.drag(*(pose(chance.uniform(-1.0, 1.0)) for _ in range(5))),
        lambda: session.settings.change(tolerance=chance.uniform(0.001, 0.1)),
        lambda: session.settings.change(method=chance.choice(["local", "exact", "arap"])),
        session.gestures.undo,
        session.gestures.redo,
        session.shapes.restore,
    ]
    with (folder / "log").open("w") as log:
        for number in range(1_000_000):
            chance.choice(things)()
            session.parts.rename_handle(0, f"step {number}")
            print(number, time.monotonic(), file=log, flush=True)
            session.listen(chance.uniform(0.0, 0.03))


def killed_programs(kills: int, folder: Path, seed: int = 0) -> list[float]:
    """Kill so many; return how much older than the kill the oldest step was that was lost, in seconds."""
    chance, ages = random.Random(seed), []
    mesh = Mesh(*box(2, 2, 6))
    save_mesh(mesh, mesh.V, folder / "bar.obj")
    paths = [str(ROOT), str(ROOT / "tests" / "support"), str(ROOT / "tests" / "session")]
    with subprocess.Popen(
        [sys.executable, "-c", NURSERY, str(folder), *paths],
        env={**os.environ, "PYTHONWARNINGS": "ignore::UserWarning"},  # of shared memory that nobody returned
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    ) as nursery:
        for kill in range(kills):
            nursery.stdin.write("play\n")
            nursery.stdin.flush()
            player = int(nursery.stdout.readline())
            _wait_for_first_step(folder)
            time.sleep(chance.uniform(0.0, 1.0))
            assert find_recovery_files(folder / "recovery") == [], "it lives"
            killed = time.monotonic()
            os.kill(player, signal.SIGKILL)
            assert nursery.stdout.readline() == "dead\n"
            ages.append(_lost(folder, killed, kill))
        nursery.stdin.close()
    return ages


def _wait_for_first_step(folder: Path) -> None:
    end = time.monotonic() + SLOW
    while not ((folder / "log").exists() and (folder / "log").read_text().endswith("\n")):
        assert time.monotonic() < end
        time.sleep(0.005)


def _lost(folder: Path, killed: float, kill: int) -> float:
    """Open what is left, and remove it; how long before the kill the oldest step was that is not in it."""
    lines = [line.split() for line in (folder / "log").read_text().splitlines()]
    done = {int(line[0]): float(line[1]) for line in lines if len(line) == 2}
    (folder / "log").unlink()
    last, found = -1, find_recovery_files(folder / "recovery")
    if found:
        (left,) = found
        state, view = left.read()
        assert view == VIEW
        assert np.count_nonzero(state.document.labels == BASE) < len(state.document.labels)
        # It may be between the step and its name, or one of those before the first.
        name = state.document.handles[0].name.split()
        last = int(name[1]) if name[0] == "step" else -1
        left.discard()
    assert list((folder / "recovery").glob("*")) == []
    lost = [killed - time for number, time in done.items() if number > last]
    assert max(lost, default=0.0) < SOON, f"kill {kill}: {len(done)} steps, only {last} in the file"
    return max(lost, default=0.0)


@pytest.mark.skipif(sys.platform != "linux", reason="kills forks of a process")
@pytest.mark.parametrize("kills", [1, pytest.param(8, marks=pytest.mark.night)])
def test_autosave_leaves_of_a_killed_program_what_was_done_soon_before(compiled, tmp_path, kills):
    killed_programs(kills, tmp_path)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as scratch:
        lost = sorted(killed_programs(int(sys.argv[1]) if sys.argv[1:] else 50, Path(scratch), seed=1))
    middle, worst = 1e3 * lost[len(lost) // 2], 1e3 * lost[-1]
    said = f"{len(lost)} kills; the oldest step lost: median {middle:.0f} ms before, at worst {worst:.0f} ms"
    print(said)  # noqa: T201
