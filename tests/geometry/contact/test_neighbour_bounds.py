"""Neighbour bounds: against the gaps of all pairs of elements, before, during and after steps."""

from itertools import combinations

import numpy as np
import pytest
from meshes import grid, moved, rotation, tube

from apd_viewer.geometry.contact.distances import gaps
from apd_viewer.geometry.contact.neighbour_bounds import NeighbourBounds
from apd_viewer.geometry.contact.patches import Patches

REACH = 0.1


class Surface:
    """Patches of a mesh, and all its pairs of elements by the patches that they belong to."""

    def __init__(self, V, F):
        E = np.unique(np.sort(F[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)), axis=0)
        self.V, self.patches = V, Patches(V, F, E)
        count = len(self.patches.vertices.start) - 1
        self.between = np.column_stack(np.triu_indices(count))
        self.bounds = NeighbourBounds(V, F, E, self.patches, REACH, 1.0)
        of = [self.owners(rows) for rows in (self.patches.vertices, self.patches.edges, self.patches.faces)]
        two = [(a, b) for a, b in combinations(range(len(E)), 2) if not set(E[a]) & set(E[b])]
        one = [(v, f) for v in range(len(V)) for f in range(len(F)) if v not in F[f]]
        two, one = np.array(two), np.array(one)
        self.pairs = np.vstack(
            [np.hstack([E[two[:, 0]], E[two[:, 1]]]), np.hstack([one[:, :1], F[one[:, 1]]])]
        )
        self.edges = np.arange(len(self.pairs)) < len(two)
        i = np.concatenate([of[1][two[:, 0]], of[0][one[:, 0]]])
        j = np.concatenate([of[1][two[:, 1]], of[2][one[:, 1]]])
        key = {pair: k for k, pair in enumerate(map(tuple, self.between.tolist()))}
        self.row = np.array([key[min(a, b), max(a, b)] for a, b in zip(i.tolist(), j.tolist(), strict=True)])
        self.reach = np.minimum(REACH, 0.25 * gaps(V, self.pairs, self.edges))

    def owners(self, rows):
        found = np.empty(len(rows.item), np.int64)
        found[rows.item] = np.repeat(np.arange(len(rows.start) - 1), np.diff(rows.start))
        return found

    def least_excess(self, U):
        """Of the gaps over their range, between each two patches."""
        least = np.full(len(self.between), np.inf)
        np.minimum.at(least, self.row, gaps(np.ascontiguousarray(U), self.pairs, self.edges) - self.reach)
        return least

    def check(self, U, W):
        """Bounds of a step, which no shape on it may be below."""
        found = self.bounds.excess(U, W, self.between)
        for share in np.linspace(0.0, 1.0, 9):
            assert (found <= np.maximum(self.least_excess(U + share * (W - U)), -1.0) + 1e-9).all()
        return found


@pytest.fixture(scope="module")
def sheet():
    return Surface(*grid(9, 9))


def rolled(V, bend):
    """A sheet rolled up about the second axis, by so much a unit of length."""
    return np.column_stack([np.sin(bend * V[:, 0]) / bend, V[:, 1], (1.0 - np.cos(bend * V[:, 0])) / bend])


@pytest.mark.parametrize("size", [0.05, 0.3, 1.0])
@pytest.mark.parametrize("bend", [1e-3, 0.2, 1.0])
def test_neighbour_bounds_are_below_all_gaps_on_a_step(sheet, size, bend):
    rng = np.random.default_rng(5)
    for _ in range(3):
        stretch = np.eye(3) + 0.4 * rng.normal(size=(3, 3))
        U = rolled(sheet.V, bend) @ stretch.T
        waves = np.sin(U @ rng.normal(size=(3, 3)) + rng.normal(size=3))
        sheet.check(U, U + size * (waves + 0.2 * rng.normal(size=U.shape)))


def test_neighbour_bounds_are_below_all_gaps_of_a_tube():
    surface = Surface(*tube(9, 7))
    rng = np.random.default_rng(6)
    U = surface.V + 0.05 * rng.normal(size=surface.V.shape)
    surface.check(U, U + 0.3 * np.sin(U @ rng.normal(size=(3, 3))))


def test_neighbour_bounds_know_that_a_smooth_sheet_does_not_touch(sheet):
    """Stretched, sheared, moved and a little bent: nothing has to be searched."""
    U = rolled(sheet.V, 0.03) @ np.array([[1.2, 0.2, 0.0], [0.0, 0.9, 0.0], [0.0, 0.0, 1.0]]).T
    W = moved(U, rotation([1.0, 2.0, 3.0], 0.1), [7.0, 0.0, 0.0])
    assert sheet.check(np.ascontiguousarray(U), np.ascontiguousarray(W)).min() > 0.0


def test_neighbour_bounds_know_that_half_a_turn_at_once_goes_through_a_line(sheet):
    """Both ends of the straight step are the rest shape, turned; half way all points are on the axis."""
    W = moved(sheet.V, rotation([0.0, 1.0, 0.0], np.pi), [0.0, 0.0, 0.0])
    assert sheet.check(sheet.V, np.ascontiguousarray(W)).max() < 0.0


def test_neighbour_bounds_know_nothing_of_a_fold(sheet):
    """Patches on both sides of a fold lie on each other, though each is as at rest."""
    U = sheet.V.copy()
    middle = 0.5 * (U[:, 0].min() + U[:, 0].max()) + 0.01
    over = U[:, 0] > middle
    U[over] = np.column_stack([2 * middle - U[over, 0], U[over, 1], U[over, 2] + 0.02])
    found, least = sheet.check(U, U), sheet.least_excess(U)
    assert (least < 0.0).any()
    assert (found[least < 0.0] < 0.0).all()
    assert (found > 0.0).any()


def test_neighbour_bounds_are_exact_for_the_rest_shape_of_one_patch():
    """The least gap at rest, whose range is a quarter of it at most."""
    surface = Surface(*grid(3, 3))
    rest = gaps(surface.V, surface.pairs, surface.edges).min()
    found = surface.bounds.excess(surface.V, surface.V, surface.between)
    assert found.min() == pytest.approx(rest - min(REACH, 0.25 * rest), abs=0.02)
