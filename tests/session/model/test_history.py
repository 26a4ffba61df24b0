import gc
import tracemalloc
import weakref
from dataclasses import replace

import numpy as np
from meshes import box

from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.model.history import History, array_bytes
from apd_viewer.session.model.state import State, initial_state

REST = initial_state(Mesh(*box(1, 1, 2)))


def _states(count: int) -> list[State]:
    """States that share a mesh but no positions."""
    return [replace(REST, frame=replace(REST.frame, U=frozen(REST.frame.U + k))) for k in range(count)]


def _undone(history: History) -> list[State]:
    """All that can be undone, newest first."""
    return list(iter(lambda: history.undo(REST), None))


def test_undo_and_redo_give_back_the_very_states():
    history, (a, b, c) = History(), _states(3)
    history.record("first", a)
    history.record("second", b)
    assert history.undo(c) is b
    assert history.undo(b) is a
    assert history.undo(a) is None
    assert history.redo(a) is b
    assert history.redo(b) is c
    assert history.redo(c) is None


def test_history_limit_drops_the_oldest_at_once_under_a_smaller_budget():
    states = _states(3)
    history = History()
    for state in states:
        history.record("step", state)
    history.limit_memory(1)
    assert _undone(history) == states[-1:], "one always stays"


def test_history_tells_of_what_is_dropped_once_nothing_keeps_it():
    history, alive = History(), []
    for state in _states(3):
        history.record("step", state)
    first = weakref.ref(history.undo_states[0])
    del state
    history.entries_dropped = lambda: alive.append(first() is not None)
    history.limit_memory(1)
    assert alive == [False]


def test_next_undo_name_and_next_redo_name_are_what_would_be_undone_and_redone():
    history, (a, b, c) = History(), _states(3)
    assert (history.next_undo_name, history.next_redo_name) == (None, None)
    history.record("first", a)
    history.record("second", b)
    assert (history.next_undo_name, history.next_redo_name) == ("second", None)
    history.undo(c)
    assert (history.next_undo_name, history.next_redo_name) == ("first", "second")
    history.undo(b)
    assert (history.next_undo_name, history.next_redo_name) == (None, "first")


def test_history_record_forgets_what_could_be_redone():
    history, (a, b, c) = History(), _states(3)
    history.record("first", a)
    history.undo(b)
    history.record("other", c)
    assert (history.next_undo_name, history.next_redo_name) == ("other", None)


def test_history_drops_the_oldest_entries_when_the_budget_is_spent():
    states = _states(6)
    rest, U = sum(array_bytes(states[0]).values()), states[0].frame.U
    history = History(most_bytes=rest + 3 * U.nbytes)
    for k, state in enumerate(states):
        history.record(str(k), state)
    kept = _undone(history)
    assert len(kept) == 4
    assert all(a is b for a, b in zip(kept, reversed(states), strict=False))


def test_history_keeps_one_entry_whatever_it_costs():
    history, (a, b) = History(most_bytes=0), _states(2)
    history.record("first", a)
    history.record("second", b)
    assert history.undo(a) is b
    assert history.undo(a) is None


def test_history_counts_the_meshes_that_entries_keep():
    states = [initial_state(Mesh(*box(2, 2, 6))) for _ in range(20)]
    mesh = states[0].document.mesh
    history = History(most_bytes=5 * (mesh.V.nbytes + mesh.F.nbytes))
    for k, state in enumerate(states):
        history.record(str(k), state)
    assert 1 <= len(_undone(history)) <= 5


def test_history_forgets_no_entries_for_a_mesh_that_they_share():
    states = _states(6)
    mesh, U = states[0].document.mesh, states[0].frame.U
    history = History(most_bytes=mesh.V.nbytes + mesh.F.nbytes + 20 * U.nbytes)
    for k, state in enumerate(states):
        history.record(str(k), state)
    assert len(_undone(history)) == 6


def test_history_counts_the_regions_that_entries_keep():
    n = len(REST.document.mesh.V)
    members = [frozen(np.full(n, k, dtype=np.uint8)) for k in range(20)]
    states = [replace(REST, document=replace(REST.document, member=member)) for member in members]
    history = History(most_bytes=sum(array_bytes(states[0]).values()) + 4 * n)
    for k, state in enumerate(states):
        history.record(str(k), state)
    assert len(_undone(history)) == 5


def test_array_bytes_counts_all_that_a_mesh_keeps_of_its_file(tmp_path):
    """What a state makes the process hand out is what it counts, whatever its mesh came from."""
    V, F = box(16, 16, 16)
    for suffix in (".obj", ".off", ".ply", ".stl", ".glb"):
        path = tmp_path / f"box{suffix}"
        save_mesh(Mesh(V, F), V, path)
        kept = [initial_state(open_mesh(path))]  # what is loaded once is there
        tracemalloc.start()
        kept.append(initial_state(open_mesh(path)))
        gc.collect()
        taken, _ = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        assert 0.75 * taken < sum(array_bytes(kept[1]).values()) < 1.1 * taken, suffix


def test_history_counts_what_is_undone_no_more_and_what_is_redone_again():
    history, states = History(), _states(3)
    for k, state in enumerate(states[:2]):
        history.record(str(k), state)
    both = history.undo_bytes
    history.undo(states[2])
    assert history.undo_bytes == both - states[1].frame.U.nbytes
    history.undo(states[1])
    assert history.undo_bytes == 0
    history.redo(states[0])
    history.redo(states[1])
    assert history.undo_bytes == both
