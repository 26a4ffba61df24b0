"""The timeline keeps a bounded number of steps, and a result of the method Wall at each."""

from dataclasses import replace

from meshes import box

from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.model import timeline
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.model.timeline import Timeline

WALL = {"method": "wall", "wall_thickness": 0.01}


def shapes(count):
    """States of a box with another shape each."""
    state = initial_state(Mesh(*box(1, 1, 1)))
    return [replace(state, frame=replace(state.frame, U=frozen(state.frame.U + k))) for k in range(count)]


def test_timeline_drops_the_first_steps_where_they_are_too_many(monkeypatch):
    states = shapes(6)
    monkeypatch.setattr(timeline, "MOST_BYTES", 4 * states[0].frame.U.nbytes)
    found = Timeline()
    for each in states:
        found = found.with_state(each)
    assert [step.state for step in found.steps] == states[2:]
    assert found.dropped == 2
    assert found.index_of(states[3]) == 1
    assert found.index_of(states[0]) is None


def test_timeline_counts_answers_of_the_wall_as_shapes(monkeypatch):
    states = shapes(3)
    own = states[1].updated(states[1].document.with_settings(**WALL))
    answer = replace(own, frame=replace(own.frame, U=frozen(own.frame.U + 0.5)))
    found = Timeline().with_run_from(states[0])
    for each in states[1:]:
        found = found.with_state(each)
    assert found.steps_without_wall_result(2, WALL) == [0, 1, 2]
    found = found.with_wall_result(1, answer)
    assert found.steps_without_wall_result(2, WALL) == [0, 2]
    assert found.steps_without_wall_result(2, WALL | {"poisson": 0.1}) == [0, 1, 2]
    assert (found.index_of(answer), found.index_of(states[1])) == (1, 1)
    assert found.state_at(1, states[0].document, of_wall=True) is answer
    assert found.state_at(2, states[0].document, of_wall=True) is states[2]
    again = found.with_run_from(states[1])
    assert (again.run_of(1), again.run_of(3)) == (range(3), range(3, 4))
    assert again.steps[3].wall_result is answer, "what is known of a shape goes with it"
    monkeypatch.setattr(timeline, "MOST_BYTES", 4 * states[0].frame.U.nbytes)
    bounded = found.with_state(states[0])
    assert [step.state for step in bounded.steps] == [states[1], states[2], states[0]]
