"""The timeline keeps a bounded number of steps."""

from dataclasses import replace

from meshes import box

from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.model import timeline
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.model.timeline import Timeline


def test_timeline_drops_the_first_steps_where_they_are_too_many(monkeypatch):
    state = initial_state(Mesh(*box(1, 1, 1)))
    states = [replace(state, frame=replace(state.frame, U=frozen(state.frame.U + k))) for k in range(6)]
    monkeypatch.setattr(timeline, "MOST_BYTES", 4 * state.frame.U.nbytes)
    found = Timeline()
    for each in states:
        found = found.followed_by(each)
    assert [step.state for step in found.steps] == states[2:]
    assert found.dropped == 2
    assert found.index_of(states[3]) == 1
    assert found.index_of(states[0]) is None
