"""Patches: their bounds against the motion of all pairs, their neighbours against brute force."""

import numpy as np
import pytest
from meshes import grid, moved, rabbit, rotation, tube

from apd_viewer.geometry.contact.patches import Patches

MESHES = {"sheet": grid(8, 8), "tube": tube(9, 7), "rabbit": rabbit(2)}


def edges_of(F):
    return np.unique(np.sort(F[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)), axis=0)


def members(rows, p):
    return rows.item[rows.start[p] : rows.start[p + 1]]


def all_pairs(count):
    return np.column_stack(np.triu_indices(count))


@pytest.fixture(params=MESHES)
def surface(request):
    V, F = MESHES[request.param]
    return V, F, Patches(V, F, edges_of(F))


def test_patches_have_every_vertex_edge_and_triangle_in_one(surface):
    V, F, patches = surface
    E, count = edges_of(F), len(patches.vertices.start) - 1
    for rows, n in ((patches.vertices, len(V)), (patches.edges, len(E)), (patches.faces, len(F))):
        assert np.array_equal(np.sort(rows.item), np.arange(n))
    for p in range(count):
        mine = [members(patches.vertices, p), E[members(patches.edges, p)], F[members(patches.faces, p)]]
        reached = np.unique(np.concatenate([x.ravel() for x in mine]))
        assert np.array_equal(np.sort(members(patches.covered_vertices, p)), reached)


@pytest.mark.parametrize("size", [1e-3, 0.1, 1.0])
def test_patches_let_no_two_points_come_nearer_than_is_said(surface, size):
    V, _, patches = surface
    rng = np.random.default_rng(1)
    count = len(patches.vertices.start) - 1
    pairs = all_pairs(count)
    for _ in range(3):
        U = V + 0.1 * rng.normal(size=V.shape)
        smooth = np.sin(U @ rng.normal(size=(3, 3)) + rng.normal(size=3))
        W = U + size * (smooth + 0.2 * rng.normal(size=V.shape))
        bounds = patches.approach_bounds(U, W, pairs)
        for (i, j), bound in zip(pairs, bounds, strict=True):
            # Points of the patches, and any between them.
            a, b = (rng.dirichlet(np.ones(3), 8) for _ in range(2))
            x, y = (rng.choice(members(patches.covered_vertices, p), (8, 3)) for p in (i, j))
            before = np.einsum("sk,skc->sc", a, U[x]) - np.einsum("sk,skc->sc", b, U[y])
            after = np.einsum("sk,skc->sc", a, W[x]) - np.einsum("sk,skc->sc", b, W[y])
            for share in (0.3, 1.0):
                there = before + share * (after - before)
                nearer = np.linalg.norm(before, axis=1) - np.linalg.norm(there, axis=1)
                assert nearer.max() <= share * bound + 1e-12


def test_patches_come_no_nearer_by_a_common_rigid_motion(surface):
    V, _, patches = surface
    count = len(patches.vertices.start) - 1
    spin = np.array([0.3, -1.0, 0.7])
    W = V + np.cross(spin, V) + [5.0, 0.0, -2.0]
    # The fit is kept from being singular, which costs a millionth.
    assert patches.approach_bounds(V, W, all_pairs(count)).max() <= 2e-4
    turned = moved(V, rotation(spin, 1e-3), [0.0, 1.0, 0.0])
    assert patches.approach_bounds(V, turned, all_pairs(count)).max() <= 1e-5


def test_patches_tell_each_of_two_that_meet_by_how_much():
    V, F = grid(4, 4)
    both = np.vstack([V, V + [0.0, 0.0, 30.0]])
    G = np.vstack([F, F + len(V)])
    patches = Patches(both, G, edges_of(G))
    upper = np.array(
        [members(patches.vertices, p)[0] >= len(V) for p in range(len(patches.vertices.start) - 1)]
    )
    pairs = all_pairs(len(upper))
    W = both - (np.arange(len(both)) >= len(V))[:, None] * [0.0, 0.0, 0.5]
    apart = upper[pairs[:, 0]] != upper[pairs[:, 1]]
    found = patches.approach_bounds(both, W, pairs)
    assert np.allclose(found[apart], 0.5, atol=1e-5)
    assert np.allclose(found[~apart], 0.0, atol=1e-5)


@pytest.mark.parametrize("gap", [0.0, 0.3, 2.0, 10.0])
@pytest.mark.parametrize("large", [False, True], ids=["alike", "a few large ones"])
def test_patches_near_are_those_of_brute_force(surface, gap, large):
    V, _, patches = surface
    U = V + 0.1 * np.random.default_rng(2).normal(size=V.shape)
    if large:
        U[members(patches.vertices, 0)] *= 4.0
        U[members(patches.vertices, 3)] += [6.0, 0.0, 0.0]
    boxes = patches.boxes(U)
    for p in range(len(boxes)):
        mine = U[members(patches.covered_vertices, p)]
        assert np.array_equal(boxes[p], np.concatenate([mine.min(axis=0), mine.max(axis=0)]))
    i, j = np.triu_indices(len(boxes))
    between = np.maximum(boxes[j, :3] - boxes[i, 3:], boxes[i, :3] - boxes[j, 3:])
    apart = np.linalg.norm(np.maximum(between, 0.0), axis=1)
    near = apart <= gap
    pairs, distances = patches.near_pairs(boxes, gap)
    assert np.array_equal(pairs, np.column_stack([i, j])[near])
    assert np.allclose(distances, apart[near], atol=1e-14)
