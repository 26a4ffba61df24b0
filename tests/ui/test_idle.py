"""A window that is left alone does nothing: in all its states, hidden, minimised and after much use."""

import gc
import sys
import weakref
from itertools import islice
from pathlib import Path

import meshes
import numpy as np
import pytest
from driving import idle, settle
from PySide6.QtWidgets import QApplication
from resting import Watch, drawn, gesture, iconify, states

from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.posing.motion import MOTIONS

GESTURES = 5


@pytest.fixture
def bottle(new_bottle):
    """A window of each test's own: it is hidden."""
    return new_bottle


@pytest.mark.parametrize(("most", "each"), [(21, 3), pytest.param(None, 1, marks=pytest.mark.night)])
def test_workbench_rests_in_every_state(sample, painted_bottle, tmp_path, most, each):
    """No paint, a handful of timers and hardly any processor time, whatever is open; by day in a few."""
    watch, taken = Watch(), enumerate(states(sample, tmp_path, GESTURES, painted_bottle))
    found = {name: watch.restless() for k, name in islice(taken, most) if k % each == 0}
    assert len(found) >= (most or 46) // each, "the test is blind"
    assert {name: said for name, said in found.items() if said} == {}


def test_text_entry_card_text_cursor_does_not_have_the_window_composed_anew(qtbot, bottle):
    """In software: for each of its blinks the whole window would be composed."""
    bottle.shell.activateWindow()
    bottle.edits.text_entries.open_entry(bottle.edits.text_entries.vertices)
    qtbot.waitUntil(bottle.edits.text_entries.vertices.text.hasFocus)
    assert Watch().restless(1.2) == ""


@pytest.mark.parametrize("away", ["minimised", pytest.param("hidden", marks=pytest.mark.night)])
def test_viewport_draws_nothing_while_not_seen_though_the_shape_changes(qtbot, bottle, away):
    window, view = bottle, bottle.canvas.viewport
    window.docks["plots"].show()
    window.canvas.frame_mesh()
    drawn(window)
    settle(qtbot, view)
    iconify(window.shell, True) if away == "minimised" else window.shell.hide()
    qtbot.waitUntil(lambda: not window.shell.windowHandle().isExposed())
    draws, before, watch = view.draw_count, window.session.store.state, Watch()
    window.session.handles.move_by(MOTIONS["TWIST"], "60deg", 0)
    window.actions_.display.switches["turntable"].setChecked(True)
    counts = watch.count(0.6)
    idle(qtbot, window)
    assert window.session.store.state.frame is not before.frame
    assert view.draw_count == draws
    assert [who for who, kind in counts if kind == "Paint"] == []
    window.actions_.display.switches["turntable"].setChecked(False)
    iconify(window.shell, False) if away == "minimised" else window.shell.show()
    qtbot.waitUntil(lambda: view.draw_count > draws)


@pytest.fixture
def files(tmp_path):
    """Meshes of several kinds in several formats."""
    found = []
    for k, suffix in enumerate((".obj", ".off", ".ply", ".stl", ".glb")):
        V, F = (meshes.sphere(3), meshes.tube(24, 16))[k % 2]
        save_mesh(Mesh(V, F), V, tmp_path / f"{k}{suffix}")
        found.append(tmp_path / f"{k}{suffix}")
    return found


def test_workbench_keeps_nothing_of_meshes_that_undo_no_longer_reaches(window, files):
    """Neither by the window nor by the solver nor by what was noted as saved."""
    history, first = window.session.gestures.history, []
    for k, path in enumerate([*files, *files]):
        window.files.open_path(path)
        drawn(window)
        window.session.gestures.begin()
        window.session.painting.paint(np.arange(40), 0)
        window.session.painting.end_stroke("Paint")
        drawn(window)
        if k == 2:
            state, before = window.session.store.state, things(window)
            first = [
                weakref.ref(each)
                for each in (state, state.document, state.document.mesh, state.surface_index)
            ]
            del state
    assert things(window) == before
    assert all(each() is not None for each in first), "undo leads there"
    history.limit_memory(1)
    gesture(window, 0)
    drawn(window)
    gc.collect()
    assert [each() for each in first] == [None] * len(first)


def things(window):
    """How many widgets and actors there are, and handles of the process."""
    gc.collect()
    props = window.canvas.viewport.renderer.GetViewProps().GetNumberOfItems()
    handles = len(list(Path("/proc/self/fd").iterdir())) if sys.platform == "linux" else 0
    return len(QApplication.allWidgets()), props, handles
