"""Obstacles in a session: clear of the shape where they are put, and one step of undo each."""

from dataclasses import replace

import numpy as np
import pytest
from driven_session import VIEW, bar, pose

from apd_viewer.errors import InputError
from apd_viewer.geometry.contact.mesh_contact import contact_thickness
from apd_viewer.geometry.mesh.arrays import diagonal, frozen
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.model.named_obstacle import MOST_OBSTACLES, NamedObstacle, ObstacleKind
from apd_viewer.session.storage.session_file import open_session, save_session

UP = np.array([0.0, 0.0, 1.0])


def now(session):
    return session.store.state.document


def steps(session):
    """Names of the steps since contact was turned off."""
    return session.gestures.history.undo_names[1:]


def apart(session):
    return contact_thickness(diagonal(now(session).mesh.V), now(session).settings.thickness)


def least_distance(obstacle):
    """Distance of an obstacle, in the plane y = 0.5, from many points of the bent sheet."""
    x = np.linspace(-1.0, 1.0, 2001)
    sheet = np.column_stack([x, np.full(len(x), 0.5), 1.5 * np.abs(x)])
    core = obstacle.centre + np.linspace(-0.5, 0.5, 201)[:, None] * obstacle.length * obstacle.axis
    return np.linalg.norm(core[:, None] - sheet, axis=2).min() - obstacle.radius


@pytest.fixture
def opened(empty):
    """A session with a bar of 2 x 2 x 6, nothing painted and contact off."""
    empty.show_now(bar())
    empty.settings.set_contact(False)
    return empty


@pytest.fixture
def bent(empty):
    """A session with a V-shaped sheet: what touches one side from above is in the way of the other."""
    y, x = np.meshgrid(np.linspace(0.0, 1.0, 5), np.linspace(-1.0, 1.0, 9), indexing="ij")
    V = np.column_stack([x.ravel(), y.ravel(), 1.5 * np.abs(x).ravel()])
    k = np.arange(4 * 9).reshape(4, 9)[:, :-1].ravel()
    F = np.vstack([np.column_stack([k, k + 1, k + 10]), np.column_stack([k, k + 10, k + 9])])
    empty.show_now(Mesh(V, F))
    return empty


def test_add_floor_puts_a_floor_under_the_lowest_point_and_turns_contact_on(opened):
    before = now(opened)
    assert opened.obstacles.add_floor(UP) == 0
    (floor,) = now(opened).obstacles
    assert (floor.name, floor.kind) == ("Floor", ObstacleKind.PLATE)
    np.testing.assert_array_equal(floor.axis, UP)
    low = opened.U[:, 2].min()
    assert floor.place[2] == pytest.approx(low - apart(opened), abs=1e-12)
    assert now(opened).settings.contact
    assert steps(opened) == ["Add floor"]
    opened.gestures.undo()
    assert now(opened) is before  # contact is off again in the same step
    opened.gestures.redo()
    assert now(opened).obstacles == (floor,)


def test_add_plates_lets_two_plates_touch_the_shape_from_both_sides(opened):
    axis = np.array([3.0, 4.0, 0.0])
    opened.obstacles.add_plates(axis)
    one, two = now(opened).obstacles
    assert (one.name, two.name) == ("Plate 1", "Plate 2")
    np.testing.assert_allclose(one.axis, axis / 5.0)
    np.testing.assert_allclose(two.axis, -axis / 5.0)
    for plate in (one, two):
        heights = (opened.U - plate.place) @ plate.axis
        assert heights.min() == pytest.approx(apart(opened), rel=1e-9)
    assert len(steps(opened)) == 1


def test_add_floor_and_put_plates_keep_the_thickness_of_the_walls(opened):
    opened.obstacles.add_floor(UP, thickness=0.05)
    assert now(opened).settings.thickness == 0.05
    assert now(opened).obstacles[0].place[2] == pytest.approx(opened.U[:, 2].min() - 0.05)
    opened.obstacles.add_plates(np.eye(3)[0], thickness=0.02)  # contact is on already
    assert now(opened).settings.thickness == 0.05


@pytest.mark.parametrize("kind", ObstacleKind)
def test_proposed_obstacle_touches_the_point_and_points_into_the_shape(opened, kind):
    point, outwards = np.array([2.0, 1.0, 3.0]), np.array([1.0, 0.0, 0.0])
    obstacle = opened.obstacles.proposed_obstacle(kind, point, outwards)
    np.testing.assert_array_equal(obstacle.axis, -outwards)
    front = obstacle.place + (obstacle.radius + 0.5 * obstacle.length) * obstacle.axis
    np.testing.assert_allclose(front, point + apart(opened) * outwards, atol=1e-12)
    assert opened.obstacles.add(obstacle) == 0
    assert now(opened).obstacles[0].name == f"{kind.value.capitalize()} 1"
    assert steps(opened) == [f"Add {kind.value.capitalize()} 1"]


@pytest.mark.parametrize("kind", [ObstacleKind.SPHERE, ObstacleKind.CYLINDER])
def test_proposed_obstacle_moves_back_until_it_is_clear_what_another_part_is_in_the_way_of(bent, kind):
    outwards = np.array([-1.5, 0.0, 1.0]) / np.hypot(1.5, 1.0)
    point = np.array([0.1, 0.5, 0.15])
    first = bent.obstacles.proposed_obstacle(kind, point, outwards, is_preview=True)
    assert least_distance(first) < 0.0
    clear = bent.obstacles.proposed_obstacle(kind, point, outwards)
    assert least_distance(clear) == pytest.approx(apart(bent), rel=0.05)
    back = clear.place - first.place
    assert np.cross(back, outwards) == pytest.approx(0.0, abs=1e-12)
    assert back @ outwards > 0.0
    halfway = replace(clear, place=clear.place - 0.02 * outwards)
    assert least_distance(halfway) < apart(bent)  # it was not moved farther than necessary


def test_proposed_obstacle_moves_a_plate_back_behind_all_of_the_shape_even_at_once(bent):
    outwards = np.array([0.0, 0.0, -1.0])
    plate = bent.obstacles.proposed_obstacle(
        ObstacleKind.PLATE, np.array([0.5, 0.5, 0.75]), outwards, is_preview=True
    )
    assert plate.place[2] == pytest.approx(-apart(bent))


def test_obstacles_move_is_one_step_with_the_distance_in_the_title(opened):
    opened.obstacles.add_floor(UP)
    opened.obstacles.move(0, 0.25 * UP)
    np.testing.assert_allclose(now(opened).obstacles[0].shift, 0.25 * UP)
    opened.obstacles.move(0, -0.5 * UP)
    opened.obstacles.move(0, np.array([3.0, 4.0, 0.0]))
    opened.obstacles.move(0, np.zeros(3))
    assert steps(opened)[1:] == ["Move Floor by 0.25", "Move Floor by −0.5", "Move Floor by 5"]
    opened.obstacles.reset(0)
    assert not now(opened).obstacles[0].shift.any()
    opened.obstacles.reset(0)
    assert steps(opened)[4:] == ["Reset Floor"]


def test_obstacles_drag_is_one_step_and_can_be_given_up(opened):
    opened.obstacles.add_floor(UP)
    before = now(opened)
    opened.gestures.begin()
    for share in (0.1, 0.2, 0.3):
        opened.obstacles.drag(0, share * UP)
    np.testing.assert_allclose(now(opened).obstacles[0].shift, 0.3 * UP)
    opened.obstacles.end_drag(0)
    assert steps(opened) == ["Add floor", "Move Floor by 0.3"]
    opened.gestures.undo()
    assert now(opened) is before
    opened.gestures.begin()
    opened.obstacles.drag(0, UP)
    opened.gestures.cancel()
    assert now(opened) is before
    opened.obstacles.drag(0, UP)  # the drag was ended by something else
    assert now(opened) is before


def test_obstacles_replace_places_an_obstacle_anew_by_typed_numbers(opened):
    opened.obstacles.add_floor(UP)
    opened.obstacles.move(0, 0.1 * UP)
    floor = now(opened).obstacles[0]
    lower = replace(floor, place=frozen(floor.place - UP), axis=frozen(np.array([0.0, 1.0, 5.0])))
    opened.obstacles.replace(0, lower)
    again = now(opened).obstacles[0]
    np.testing.assert_array_equal(again.place, lower.place)
    assert not again.shift.any()
    assert steps(opened)[-1] == "Place Floor"
    assert not opened.told


def test_obstacles_replace_moves_back_a_plate_that_would_cut_the_shape_and_says_so(opened):
    opened.obstacles.add_floor(UP)
    floor = now(opened).obstacles[0]
    opened.obstacles.replace(0, replace(floor, place=frozen(floor.place + 3.0 * UP)))
    np.testing.assert_allclose(now(opened).obstacles[0].place, floor.place, atol=1e-9)
    assert "moved back" in opened.told[-1]


def test_obstacles_replace_refuses_a_sphere_in_the_shape_with_a_place_that_is_taken(opened):
    point, outwards = np.array([2.0, 1.0, 3.0]), np.array([1.0, 0.0, 0.0])
    opened.obstacles.add(opened.obstacles.proposed_obstacle(ObstacleKind.SPHERE, point, outwards))
    before, sphere = now(opened), now(opened).obstacles[0]
    inside = replace(sphere, place=frozen(sphere.place - 0.3 * outwards))
    with pytest.raises(InputError, match="would intersect the shape"):
        opened.obstacles.replace(0, inside)
    with pytest.raises(InputError, match="radius"):
        opened.obstacles.replace(0, replace(sphere, radius=0.0))
    with pytest.raises(InputError, match="direction"):
        opened.obstacles.replace(0, replace(sphere, kind=ObstacleKind.PLATE, axis=frozen(np.zeros(3))))
    assert now(opened) is before


def test_obstacles_have_names_of_their_own_and_can_be_removed(opened):
    opened.obstacles.add_plates(UP)
    opened.obstacles.rename(0, "Plate 2")
    assert [each.name for each in now(opened).obstacles] == ["Plate 2 2", "Plate 2"]
    opened.obstacles.rename(0, "Press")
    opened.obstacles.rename(0, " ")
    opened.obstacles.remove(1)
    assert [each.name for each in now(opened).obstacles] == ["Press"]
    assert steps(opened)[1:] == ["Rename", "Rename", "Remove Plate 2"]
    opened.obstacles.add_floor(UP)
    opened.obstacles.add_floor(UP)
    assert [each.name for each in now(opened).obstacles] == ["Press", "Floor", "Floor 2"]


def test_obstacles_are_refused_with_a_method_without_contact_and_when_too_many(opened):
    opened.settings.change(method="paper")
    before = now(opened)
    assert opened.obstacles.add_floor(UP) is None
    assert "contact" in opened.failed[-1]
    assert now(opened) is before
    opened.settings.change(method="exact")
    ball = NamedObstacle("", ObstacleKind.SPHERE, frozen(np.array([9.0, 9.0, 9.0])), radius=1.0)
    for k in range(MOST_OBSTACLES):
        assert opened.obstacles.add(ball) == k
    assert opened.obstacles.add(ball) is None
    assert str(MOST_OBSTACLES) in opened.failed[-1]
    assert len(now(opened).obstacles) == MOST_OBSTACLES


def test_shape_editor_restore_brings_obstacles_back_clear_of_the_rest_shape(session):
    session.obstacles.add_floor(UP)
    session.obstacles.add_plates(np.eye(3)[0])
    floor = now(session).obstacles[0]
    assert session.store.state.is_at_rest
    session.obstacles.move(0, -2.0 * UP)
    assert not session.store.state.is_at_rest
    session.settings.set_contact(False)
    session.drag(pose(0.6, (0.5, 0.0, -4.0)))  # the upper end goes down below the floor
    session.settle()
    session.obstacles.add_floor(np.array([0.0, 0.0, -1.0]))
    lid = now(session).obstacles[3]
    session.shapes.restore()
    assert not any(each.shift.any() for each in now(session).obstacles)
    np.testing.assert_allclose(now(session).obstacles[0].place, floor.place, atol=1e-12)
    moved = now(session).obstacles[3]
    assert moved.place[2] > lid.place[2]
    assert ((session.U - moved.place) @ moved.axis).min() == pytest.approx(apart(session))
    session.gestures.undo()
    assert now(session).obstacles[3] is lid


def test_bake_keeps_obstacles_where_they_are(session):
    session.settings.set_contact(False)
    session.drag(pose(0.6, (0.5, 0.0, 0.2)))
    session.settle()
    session.obstacles.add_floor(UP)
    session.obstacles.move(0, -0.5 * UP)
    session.settle()
    where = now(session).obstacles[0].centre
    session.shapes.bake()
    session.settle()
    (floor,) = now(session).obstacles
    np.testing.assert_allclose(floor.place, where, atol=1e-12)
    assert not floor.shift.any()


def test_save_session_keeps_an_obstacle_that_was_just_added(opened, tmp_path):
    opened.obstacles.add_floor(UP)
    save_session(tmp_path / "a.apd", opened.store.state, VIEW)
    found, _ = open_session(tmp_path / "a.apd")
    (floor,) = found.document.obstacles
    np.testing.assert_array_equal(floor.place, now(opened).obstacles[0].place)


def test_set_contact_moves_out_what_stands_in_the_shape_once_contact_is_on(opened):
    opened.obstacles.add_floor(UP)
    opened.settle()
    opened.settings.set_contact(False)
    within = replace(now(opened).obstacles[0], place=frozen(np.array([0.0, 0.0, 0.3])))
    opened.store.set_document(replace(now(opened), obstacles=(within,)))  # as of another shape
    before = now(opened)
    opened.settings.set_contact(True)
    opened.settle()
    (floor,) = now(opened).obstacles
    assert floor.centre[2] == pytest.approx(opened.U[:, 2].min() - apart(opened), abs=1e-9)
    assert opened.told[-1] == "Moved back out of the shape: Floor."
    assert not opened.failed
    opened.gestures.undo()
    assert now(opened) is before
