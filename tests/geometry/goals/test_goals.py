"""From percentages to goals: what is measured, what is refused, and the words."""

import numpy as np
import pytest
from meshes import box, soup, tube

from apd_viewer.errors import InputError
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.goals.goals import (
    GoalMeasures,
    Region,
    filled_volume_goal,
    goal_at_rest,
    make_goals,
    region_patch,
)
from apd_viewer.geometry.goals.target_values import ball_volume
from apd_viewer.geometry.mesh.operators import face_areas

V, F = box(2, 3, 4)
REST = RestMesh(V, F)
TOP = np.flatnonzero(V[:, 2] == 4)


CALM = np.random.default_rng(1).random((2, len(V)))


def value(goal, U):
    return GoalMeasures((goal,)).values(U)[0]


def test_make_goals_turns_percentages_into_areas_and_a_volume():
    area, region, volume = make_goals(REST, 110, 50.0, [Region("lid", TOP, 90), Region("read only", TOP)])
    assert area.target == pytest.approx(1.1 * 52)
    assert value(area, 2 * V) == pytest.approx(4 * 52)
    assert volume.target == pytest.approx(12)
    assert value(volume, 2 * V) == pytest.approx(8 * 24)
    assert region.target == pytest.approx(0.9 * 6)
    assert value(region, V) == pytest.approx(6)
    assert make_goals(REST, None, None, []) == ()


def test_goal_measures_have_values_and_gradients_that_belong_together():
    goals = make_goals(REST, 110, 50.0, [Region("lid", TOP, 90)], CALM)
    assert len(goals) == 5
    measures = GoalMeasures(goals)
    rng = np.random.default_rng(0)
    U, direction = V + 0.1 * rng.normal(size=V.shape), rng.normal(size=V.shape)
    g = np.zeros((len(goals), *V.shape))
    values = measures.values_and_gradients(U, g)
    np.testing.assert_allclose(values, measures.values(U), rtol=1e-13)
    np.testing.assert_allclose(values, [value(goal, U) for goal in goals], rtol=1e-13)
    quotients = (measures.values(U + 1e-5 * direction) - measures.values(U - 1e-5 * direction)) / 2e-5
    np.testing.assert_allclose(quotients, (g * direction).sum(axis=(1, 2)), rtol=1e-6)
    for goal in goals:
        assert goal.relative_deviation(goal.target) == 0.0
        assert goal.relative_deviation(goal.rest) == pytest.approx(1 - goal.target / goal.rest)


def test_make_goals_asks_a_level_of_calmness_for_what_the_area_is_but_not_in_a_region():
    *_, calm = make_goals(REST, 110, None, [Region("lid", TOP, 90)], CALM[:1])
    weights = np.where(V[:, 2] == 4, 0.0, CALM[0])[F].mean(axis=1)
    assert calm.rest == pytest.approx(face_areas(V, F) @ weights, rel=1e-6)
    assert calm.target == pytest.approx(1.1 * calm.rest)
    assert make_goals(REST, None, None, [], CALM) == ()


def test_region_patch_a_region_is_the_triangles_with_all_corners_in_it():
    patch = region_patch(REST, Region("lid", TOP))
    assert (V[patch.F][:, :, 2] == 4).all()
    assert len(patch.F) == 2 * 6
    assert len(region_patch(REST, Region("a point", TOP[:1])).F) == 0


def test_region_patch_a_region_goes_over_seams():
    """Only one of the copies at each place is named."""
    X, G = soup(V, F)
    rest = RestMesh(X, G)
    named = rest.weld.first[X[rest.weld.first][:, 2] == 4]
    assert len(region_patch(rest, Region("lid", named)).F) == 2 * 6


def test_goal_shortfall_has_words_for_what_is_not_reached():
    (area,) = make_goals(REST, 10, None, [])
    assert area.shortfall_sentence(52 * 0.31234) == "the area is at 31.23 % instead of 10 %"
    assert area.shortfall_sentence(52 * 0.1 * (1 + 2e-7)) == "the area is at 10.000002 % instead of 10 %"


@pytest.mark.parametrize("percent", [0, -5, 1001, np.nan, np.inf, "all", True])
def test_make_goals_refuses_percentages_that_are_none(percent):
    for asked in ((percent, None, []), (None, percent, []), (None, None, [Region("lid", TOP, percent)])):
        with pytest.raises(InputError, match="must be a percentage from 1 to 1000"):
            make_goals(REST, *asked)


def test_make_goals_needs_something_to_measure():
    open_mesh = RestMesh(*tube(8, 4))
    with pytest.raises(InputError, match="There is no volume to keep: the surface is open"):
        make_goals(open_mesh, None, 100, [])
    with pytest.raises(InputError, match="“speck” contains no complete triangle"):
        make_goals(REST, None, None, [Region("speck", TOP[:2], 100)])
    assert make_goals(REST, None, None, [Region("speck", TOP[:2])]) == ()
    for ids in ([-1], [len(V)]):
        with pytest.raises(InputError, match="“lid” has a vertex that does not exist"):
            region_patch(REST, Region("lid", np.array(ids)))


@pytest.mark.parametrize("region", ["lid", ("lid", TOP), Region("", TOP), None])
def test_region_patch_refuses_what_is_no_region(region):
    with pytest.raises(InputError, match="Regions must be a list of Region"):
        region_patch(REST, region)


def test_ball_volume_is_that_of_the_ball_of_an_area():
    assert ball_volume(4.0 * np.pi * 2.0**2) == pytest.approx(4.0 / 3.0 * np.pi * 2.0**3)


def test_filled_volume_goal_asks_for_cubic_mesh_units_whatever_the_rest_shape():
    for U in (V, V * [1.0, 1.0, 1e-6]):
        goal = filled_volume_goal(RestMesh(U, F), 7.5, None)
        assert goal.target == 7.5
        assert value(goal, 2 * V) == pytest.approx(8 * 24)
        assert goal.relative_deviation(15.0) == pytest.approx(1.0)
        assert goal_at_rest(goal, 2 * V) is goal
        assert goal.shortfall_sentence(7.25) == "the volume is at 7.25 instead of 7.5 cubic mesh units"


def test_filled_volume_goal_refuses_more_than_a_ball_of_the_kept_area_holds():
    most = ball_volume(52.0)
    for area, share in ((100, 1.0), ("121%", 1.331)):
        assert filled_volume_goal(REST, 0.999 * share * most, area).target > 0.0
        with pytest.raises(InputError, match=f"at most {share * most:.4g} cubic mesh units"):
            filled_volume_goal(REST, 1.001 * share * most, area)
    assert filled_volume_goal(REST, 2.0 * most, None).target == 2.0 * most
    with pytest.raises(InputError, match="open"):
        filled_volume_goal(RestMesh(*tube(8, 4)), 1.0, None)
