"""A mesh far from the origin is deformed and measured as one that is near: by shifts without rounding."""

import meshes
import numpy as np
import pytest

import apd_viewer
from apd_viewer.geometry.analysis.inspection import inspect
from apd_viewer.geometry.analysis.shape_check import check_shape
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.mesh.arrays import local_origin
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.solver.methods import METHODS

# About 8.4 million, in sizes of the mesh about a million; a last bit there is 2e-9.
FAR = 2.0**23 * np.array([1.0, 0.5, -1.0])
LAST_BIT = 2.0**-29


def on_the_grid(V):
    """Positions whose sums with FAR are exact."""
    return np.round(V * 2.0**26) / 2.0**26


V, F = meshes.tube(12, 12)
V = on_the_grid(V)
LOW, HIGH = meshes.ends(V)
FIXED = np.r_[LOW, HIGH]
TARGETS = np.vstack([V[LOW], on_the_grid(V[HIGH] @ meshes.rotation([0, 0, 1], 1.1).T + [0.2, 0.0, 0.1])])


def both(G=F, **more):
    """The same deformation near and far."""
    near = apd_viewer.deform(V, G, FIXED, TARGETS, handle=HIGH, **more)
    far = apd_viewer.deform(V + FAR, G, FIXED, TARGETS + FAR, handle=HIGH, **more)
    return near, far


@pytest.mark.parametrize("method", METHODS)
def test_deform_far_from_the_origin_shifts_the_shape_and_keeps_all_else_the_same(method):
    near, far = both(method=method)
    assert near.iterations == far.iterations
    assert np.abs(far.U - FAR - near.U).max() <= LAST_BIT
    for name in ("area", "area_error", "volume_capped", "handle_drift", "local_change", "converged"):
        assert getattr(far, name) == getattr(near, name), name
    assert far.energy == pytest.approx(near.energy, rel=1e-9)


@pytest.mark.parametrize(
    "more",
    [{"stiffness": 0.02}, {"contact": True}, {"method": "arap", "iterations": 15}, {"volume": 95.0}],
    ids=["stiff", "in contact", "plain", "volume"],
)
def test_deform_far_from_the_origin_is_the_same_with_bending_contact_and_targets(more):
    near, far = both(np.vstack([F, *_lids()]), **more)
    assert near.iterations == far.iterations
    assert np.abs(far.U - FAR - near.U).max() <= LAST_BIT
    assert far.least_gap == near.least_gap


def _lids():
    """Triangles over both ends of the tube."""
    for ends, sign in ((LOW, -1), (HIGH, 1)):
        ring = ends[np.argsort(np.arctan2(V[ends, 1], V[ends, 0]))]
        yield np.column_stack([np.full(len(ring) - 2, ring[0]), ring[1:-1], ring[2:]])[:, ::sign]


def test_deform_far_from_the_origin_lets_what_rests_stay_to_the_bit():
    U = apd_viewer.deform(V + FAR, F, FIXED, V[FIXED] + FAR, handle=HIGH, iterations=1).U
    assert np.abs(U - FAR - V).max() <= LAST_BIT
    assert np.array_equal(U[FIXED], V[FIXED] + FAR)


def test_deformation_far_from_the_origin_is_pushed_the_same_by_obstacles():
    results = []
    for place in (0.0, FAR):
        ball = apd_viewer.sphere(np.array([3.0, 0.0, 2.0]) + place, 0.5)
        solver = apd_viewer.Deformation(V + place, F, FIXED, handle=HIGH, contact=True, obstacles=[ball])
        solver.replace_obstacles([ball])
        solver.aim(V[FIXED] + place, U=V + place, shifts=np.array([[-1.8, 0.0, 0.0]]), begin=np.zeros((1, 3)))
        while np.abs((frame := solver.step()).loads).max() <= 0.1:
            assert not frame.settled
        results.append(frame)
    near, far = results
    assert np.array_equal(far.loads, near.loads)
    assert np.abs(far.U - FAR - near.U).max() <= LAST_BIT


@pytest.mark.night
def test_press_far_from_the_origin_takes_the_same_load():
    B, G = meshes.sphere(2)
    B = on_the_grid(B)
    args = {"axis": (0, 0, 1), "to": 1.7, "steps": 1, "stiffness": 0.01}
    near, far = apd_viewer.press(B, G, **args), apd_viewer.press(B + FAR, G, **args)
    for a, b in zip(near.steps, far.steps, strict=True):
        assert (a.distance, a.load_low, a.load_high, a.volume) == (
            b.distance,
            b.load_low,
            b.load_high,
            b.volume,
        )
        assert np.abs(b.U - FAR - a.U).max() <= LAST_BIT


@pytest.mark.parametrize("make", [meshes.tube, meshes.cup, meshes.rabbit], ids=["tube", "cup", "rabbit"])
def test_inspect_and_check_shape_read_the_same_far_from_the_origin(make):
    W, G = make()
    W = on_the_grid(W)
    near, far = Mesh(W, G), Mesh(W + FAR, G)
    a, b = inspect(near), inspect(far)
    for name in ("area", "volume", "volume_capped", "size", "double_wall"):
        assert getattr(a, name) == getattr(b, name), name
    assert [each.kind for each in b.findings] == [*(each.kind for each in a.findings), "far away"]
    p, q = check_shape(W, near.joined_F), check_shape(W + FAR, far.joined_F)
    for mine, other in (
        (q.packed_box, p.packed_box),
        (q.hull.width, p.hull.width),
        (q.hull.volume, p.hull.volume),
    ):
        assert mine == pytest.approx(other, rel=1e-12)
    assert q.hull.sides == pytest.approx(p.hull.sides, rel=1e-12)


def test_local_origin_leaves_what_is_about_the_origin_as_it_is():
    for X in (V, V + [2.0, -3.0, 1.0], 1e6 * V, 1e-9 * V):
        assert not local_origin(X).any()
        assert RestMesh(X, F).V is X
    assert not local_origin(np.zeros((3, 3))).any()


@pytest.mark.parametrize("place", [1e5, 1e6, 3.3e7, 1e12])
def test_local_origin_rounds_at_most_the_last_bit(place):
    X = V + place * np.array([1.0, -0.7, 0.013])
    centre = local_origin(X)
    assert np.abs(X - centre).max() < 9.0 * np.linalg.norm(np.ptp(X, axis=0))
    assert np.abs((X - centre) + centre - X).max() <= np.spacing(np.abs(X).max())


def test_press_far_from_the_origin_holds_what_is_fixed():
    ball, G = meshes.sphere(2)
    ball, low = on_the_grid(ball), np.flatnonzero(ball[:, 2] < -0.8)
    found = apd_viewer.press(ball + FAR, G, (0, 0, 1), "90%", 2, fixed=low)
    np.testing.assert_array_equal(found.U[low], ball[low] + FAR)
