"""How much of a surface has grown and shrunk, against sorting all its triangles."""

import numpy as np
import pytest
from meshes import box, rotation, sphere

from apd_viewer.geometry.analysis.area_change import local_change
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.mesh.operators import face_areas

V, F = sphere(4)
REST = face_areas(V, F)


def stretched(strength, seed=0):
    """The sphere, drawn out and wrinkled."""
    noise = np.random.default_rng(seed).normal(size=V.shape)
    return V * [1.0, 1.0 + strength, 1.0 - 0.3 * strength] + 0.01 * strength * noise


def sorted_changes(U, F=F, rest=REST):
    """Changes of all triangles, ascending, and the share of the surface up to each."""
    change = np.abs(face_areas(U, F) / rest - 1.0)
    order = np.argsort(change)
    return change[order], np.cumsum(rest[order]) / rest.sum()


@pytest.mark.parametrize("strength", [1e-6, 1e-3, 0.1, 2.0])
def test_local_change_has_mean_percentile_and_largest_of_the_sorted_triangles(strength):
    U = stretched(strength)
    found, (change, share) = local_change(U, F, REST), sorted_changes(U)
    assert found.mean == pytest.approx((change * np.diff(share, prepend=0.0)).sum(), rel=1e-9, abs=1e-16)
    assert found.largest == change[-1] == pytest.approx(RestMesh(V, F).measure(U)[2], rel=1e-12)
    # A bin is 1/64 of its distance from zero wide at most.
    assert found.p99 == pytest.approx(change[np.searchsorted(share, 0.99)], rel=1 / 64)
    assert found.mean <= found.p99 <= found.largest


@pytest.mark.parametrize("strength", [1e-3, 0.1, 2.0])
def test_local_change_shares_are_those_of_a_histogram_weighted_by_the_area_at_rest(strength):
    U = stretched(strength)
    ratio = np.log2(face_areas(U, F) / REST)
    reach = 1.1 * np.abs(ratio).max()
    edges = np.linspace(-reach, reach, 12)
    expected = np.histogram(ratio, edges, weights=REST)[0] / REST.sum()
    shares = local_change(U, F, REST).surface_fractions(edges)
    np.testing.assert_allclose(shares, expected, atol=0.01)
    assert shares.sum() == pytest.approx(1.0, abs=1e-12)


def test_local_change_of_what_is_only_turned_is_none_but_for_rounding():
    found = local_change(V @ rotation([1, 2, 3], 0.7).T + [5.0, 0.0, 1.0], F, REST)
    assert found.largest < 1e-12
    assert found.surface_fractions(np.array([-1e-9, 1e-9]))[0] == pytest.approx(1.0, abs=1e-12)
    still = local_change(V, F, REST)
    assert (still.mean, still.p99, still.largest) == (0.0, 0.0, 0.0)
    assert still.surface_fractions(np.array([-1e-9, 1e-9]))[0] == pytest.approx(1.0, abs=1e-12)


def test_local_change_puts_halved_and_doubled_equally_far_from_unchanged():
    edges = np.linspace(-2.55, 2.55, 52)  # none of them at one
    doubled = local_change(np.sqrt(2.0) * V, F, REST).surface_fractions(edges)
    halved = local_change(np.sqrt(0.5) * V, F, REST).surface_fractions(edges)
    np.testing.assert_allclose(doubled, halved[::-1], atol=1e-9)
    assert doubled[np.searchsorted(edges, 1.0) - 1] == pytest.approx(1.0)


def test_local_change_shares_are_of_the_area_at_rest_and_of_nothing_else():
    """A third of a plane, of few large triangles, doubled, the rest, of many small ones, as it was."""
    X = np.array(
        [[0, 0, 0], [1, 0, 0], [0, 2, 0], [1, 2, 0]] + [[k, y, 5] for k in range(5) for y in (0, 1.0)]
    )
    faces = [[0, 1, 2], [1, 3, 2]] + [
        t for k in range(4, 12, 2) for t in ([k, k + 2, k + 1], [k + 1, k + 2, k + 3])
    ]
    faces, U = np.array(faces), X.copy()
    U[:4] *= np.sqrt(2.0)
    found = local_change(U, faces, face_areas(X, faces))
    edges = np.array([-3.0, -0.5, 0.5, 3.0])
    np.testing.assert_allclose(found.surface_fractions(edges), [0.0, 2 / 3, 1 / 3], atol=1e-12)
    assert found.mean == pytest.approx(1 / 3)
    assert found.largest == pytest.approx(1.0)
    assert found.p99 == pytest.approx(1.0, rel=1 / 64)


def test_local_change_counts_collapsed_and_huge_triangles_and_no_slivers():
    V, F = box(1, 1, 1)
    flat = local_change(V * [0.0, 1.0, 1.0], F, face_areas(V, F))
    assert flat.largest == 1.0
    assert flat.p99 == pytest.approx(1.0, rel=2e-3)
    assert flat.mean == pytest.approx(2 / 3)
    huge = local_change(1e9 * V, F, face_areas(V, F))
    assert huge.largest == pytest.approx(1e18)
    assert huge.surface_fractions(np.array([0.0, np.inf]))[0] == pytest.approx(1.0)
    needle = np.vstack([F, [[0, 0, 1]]])
    moved = V @ rotation((3, -1, 2), 2.0).T
    assert local_change(moved, needle, face_areas(V, needle)).largest < 1e-12
