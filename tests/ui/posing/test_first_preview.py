"""A drag while kernels are compiled: where the handle is to be, and no claim about the area."""

import numpy as np
import pytest
from driving import document, drag, idle, ring_grip
from in_thread import Compiler, InThread

from apd_viewer.geometry.pose.constraints import HANDLE, transform
from apd_viewer.presentation.readings import NO_VALUE, area_percent
from apd_viewer.session.processes import solver_process


@pytest.fixture
def compiler(qtbot, bottle, monkeypatch):
    """What compiles in the solver of the window on the bottle; 30 % are there."""
    compiler = Compiler()
    monkeypatch.setattr(solver_process, "start_solver_process", lambda: InThread(compiler))
    bottle.session.store.restart_solver()
    compiler.tell(0.3)
    qtbot.waitUntil(bottle.status.compiling.isVisible)
    yield compiler
    compiler.tell(1.0)


def twist(qtbot, window):
    drag(qtbot, window, ring_grip(window, 1), (60.0, 10.0))


def asked_places(window):
    """Where the handle's vertices were asked to be."""
    asked = document(window)
    return transform(asked.handles[0].pose, asked.initial_positions[asked.labels == HANDLE])


def check_nothing_is_previewed(window):
    assert not len(window.motion_preview.requested_ghost.patches.vertices)
    assert window.panel.area.percent.text() == area_percent(window.session.store.state)
    assert window.panel.volume.volume.text() != NO_VALUE
    assert "Preview" not in window.invitation.text()


def test_motion_preview_stands_for_a_drag_until_its_kernels_are_compiled(qtbot, bottle, compiler):
    rest, area, shown = (
        bottle.session.store.state,
        bottle.panel.area,
        bottle.motion_preview.requested_ghost.patches,
    )
    check = np.testing.assert_allclose
    twist(qtbot, bottle)
    assert document(bottle).is_posed
    assert bottle.session.store.state.frame.U is rest.frame.U
    check(shown.vertices, asked_places(bottle), rtol=0, atol=1e-9)
    strain = bottle.panel.strain
    changes = strain.local_change, strain.largest_strain, strain.mean_strain
    claims = area.percent, *changes, bottle.panel.volume.volume
    assert [label.text() for label in claims] == [NO_VALUE] * 5
    assert "no area is kept" in area.verdict.text()
    bottle.session.parts.rename_handle(0, "Cap")
    assert [label.text() for label in claims] == [NO_VALUE] * 5
    for share, percent in ((0.3, "30 %"), (0.555, "55 %"), (0.999, "99 %")):
        compiler.tell(share)
        qtbot.waitUntil(lambda percent=percent: percent in area.area.text())
        assert percent in bottle.invitation.text()
        assert "Preview" in bottle.invitation.text()
    twist(qtbot, bottle)
    check(shown.vertices, asked_places(bottle), rtol=0, atol=1e-9)
    compiler.tell(1.0)
    idle(qtbot, bottle)
    state = bottle.session.store.state
    check(state.frame.U[state.document.labels == HANDLE], asked_places(bottle), rtol=0, atol=1e-9)
    check_nothing_is_previewed(bottle)
    assert not bottle.status.compiling.isVisible()


def test_motion_preview_shows_nothing_of_what_has_its_kernels(qtbot, bottle, compiler):
    check_nothing_is_previewed(bottle)
    compiler.tell(1.0)
    qtbot.waitUntil(bottle.status.compiling.isHidden)
    twist(qtbot, bottle)
    check_nothing_is_previewed(bottle)
    idle(qtbot, bottle)


def test_motion_preview_can_be_undone(qtbot, bottle, compiler):
    rest = bottle.session.store.state
    twist(qtbot, bottle)
    assert len(bottle.motion_preview.requested_ghost.patches.vertices)
    bottle.session.gestures.undo()
    assert bottle.session.store.state is rest
    assert not len(bottle.motion_preview.requested_ghost.patches.vertices)
    assert bottle.panel.area.percent.text() == area_percent(rest)
