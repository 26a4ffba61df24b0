"""A drag while kernels are compiled: where the handle is to be, and no claim about the area."""

import numpy as np
import pytest
from driving import document, drag, idle, ring_grip
from in_thread import Compiler, InThread

from apd_viewer.geometry.pose.constraints import HANDLE, transform
from apd_viewer.presentation.readings import NOTHING, area_percent
from apd_viewer.session.processes import process_client


@pytest.fixture
def compiler(qtbot, bottle, monkeypatch):
    """What compiles in the solver of the window on the bottle; 30 % are there."""
    compiler = Compiler()
    monkeypatch.setattr(process_client, "start_process", lambda: InThread(compiler))
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
    return transform(asked.handles[0].pose, asked.grip[asked.labels == HANDLE])


def check_nothing_is_previewed(window):
    assert not len(window.preview.asked.patches.shown)
    assert window.panel.area.percent.text() == area_percent(window.session.store.state)
    assert window.panel.volume.volume.text() != NOTHING
    assert "Preview" not in window.invitation.text()


def test_motion_preview_stands_for_a_drag_until_its_kernels_are_compiled(qtbot, bottle, compiler):
    rest, area, shown = bottle.session.store.state, bottle.panel.area, bottle.preview.asked.patches
    check = np.testing.assert_allclose
    twist(qtbot, bottle)
    assert document(bottle).posed
    assert bottle.session.store.state.frame.U is rest.frame.U
    check(shown.shown, asked_places(bottle), rtol=0, atol=1e-9)
    claims = area.percent, area.local_change, bottle.panel.volume.volume
    assert [label.text() for label in claims] == [NOTHING] * 3
    assert "no area is kept" in area.verdict.text()
    bottle.session.parts.rename_handle(0, "Cap")
    assert [label.text() for label in claims] == [NOTHING] * 3
    for share, percent in ((0.3, "30 %"), (0.555, "55 %"), (0.999, "99 %")):
        compiler.tell(share)
        qtbot.waitUntil(lambda percent=percent: percent in area.area.text())
        assert percent in bottle.invitation.text()
        assert "Preview" in bottle.invitation.text()
    twist(qtbot, bottle)
    check(shown.shown, asked_places(bottle), rtol=0, atol=1e-9)
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
    assert len(bottle.preview.asked.patches.shown)
    bottle.session.gestures.undo()
    assert bottle.session.store.state is rest
    assert not len(bottle.preview.asked.patches.shown)
    assert bottle.panel.area.percent.text() == area_percent(rest)
