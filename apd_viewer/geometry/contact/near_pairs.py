"""List of near pairs, kept complete while a surface moves.

All pairs that may touch are listed; for all others, every pair of near patches keeps a lower bound of the
excess of their gaps over their range. Two patches are searched again only if a step could exhaust it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from apd_viewer.geometry.contact.collision_times import detect_collisions
from apd_viewer.geometry.contact.gap_energy import gap_gradient, gap_springs
from apd_viewer.geometry.contact.neighbour_bounds import NeighbourBounds
from apd_viewer.geometry.contact.pair_search import PairSearch
from apd_viewer.geometry.contact.patches import Patches, pair_keys, rows_among
from apd_viewer.geometry.linalg.parallel_ops import largest_difference, largest_displacement
from apd_viewer.geometry.mesh.edges_and_components import undirected_edges

# In mean edge lengths: largest distance of patches with a bound, look-ahead of a search, and largest approach
# of two patches in one step. Larger values mean more pairs, smaller ones more searches.
_PATCHES_WITHIN = 3.0
_LOOK_AHEAD = 0.4
_FARTHEST = 1.0
# Longest step in mean edge lengths; longer ones are split, so that all patches that may meet are listed. The
# largest coordinate measures it: cut by their length itself, which allows longer steps, filled pillows of
# cloth come to rest with loads that differ by up to 0.25 % instead of 0.14 %.
_LONGEST = 1.5
_CORNER = 3.0**0.5  # largest ratio of a vector's length to its largest coordinate
# Margin above the range, in mean edge lengths, within which exact gaps replace lower bounds.
_MARGIN = 0.1
# Fraction of the look-ahead: a search starts early once a bound falls below it.
_SOON = 0.1
# Smallest gap after a step: the least of these fractions of the range, the pair's range and its listed gap.
_FLOOR, _FLOOR_OF_RANGE, _FLOOR_OF_GAP = 5e-3, 0.1, 0.5


class _ListedPairs(NamedTuple):
    """Columns of the listed pairs; see :class:`FoundPairs`.

    ``low`` bounds the gaps from below; ``reach`` is the range of their energy, ``floor`` the least gap.
    """

    pairs: np.ndarray
    edges: np.ndarray
    owner: np.ndarray
    low: np.ndarray
    reach: np.ndarray
    floor: np.ndarray

    @classmethod
    def empty(cls) -> _ListedPairs:
        no = np.zeros(0)
        return cls(np.zeros((0, 4), np.int32), np.zeros(0, bool), np.zeros(0, np.int32), no, no, no)

    def subset(self, kept: np.ndarray) -> _ListedPairs:
        """Rows selected by the mask ``kept``."""
        rows = np.flatnonzero(kept)
        return _ListedPairs(*(column.take(rows, axis=0) for column in self))

    def joined_with(self, more: _ListedPairs) -> _ListedPairs:
        """Rows of this list, followed by those of ``more``."""
        return _ListedPairs(*(np.concatenate(columns) for columns in zip(self, more, strict=True)))


class NearPairs:
    """Near pairs of a moving surface, with their gap energy.

    Parameters
    ----------
    V : (n, 3) float array
        Rest positions.
    F : (m, 3) int array
    exempt_groups : (z, n) int array
        See :class:`PairSearch`.
    reach : float
        Range of the gap energy, mesh units.

    Attributes
    ----------
    touching_at_rest : int array
        Vertices of the pairs found that touch at rest, as where a vertex hangs on an edge.
    """

    def __init__(self, V: np.ndarray, F: np.ndarray, exempt_groups: np.ndarray, reach: float) -> None:
        self._reach = reach
        E = undirected_edges(F, len(V))
        self.edges = E
        lengths = np.linalg.norm(V[E[:, 0]] - V[E[:, 1]], axis=1)
        self._edge = float(lengths.mean())
        self._usual = _PATCHES_WITHIN * self._edge
        self._patches = Patches(V, F, E)
        start, edges = self._patches.edges
        self._edges_of = np.add.reduceat(np.append(lengths[edges], 0.0), start[:-1])
        self._edges_of /= np.maximum(np.diff(start), 1)
        self._search = PairSearch(V, F, E, self._patches, exempt_groups, reach)
        self._neighbours = NeighbourBounds(V, F, E, self._patches, reach, self._edge)
        self.touching_at_rest = np.zeros(0, np.int32)
        self.rebuild_at(V)

    def rebuild_at(self, U: np.ndarray) -> None:
        """Rebuild the list of pairs at ``U`` (n, 3)."""
        self._between, self._bound = np.zeros((0, 2), np.int64), np.zeros(0)
        self._listed = _ListedPairs.empty()
        self._paid_at, self._clearance = U, 0.0
        self._find_near_patches(U, self._usual)
        self.find_collision_free_fractions(U, U)
        self.accept_step()

    def find_collision_free_fractions(self, U: np.ndarray, W: np.ndarray) -> np.ndarray | None:
        """Collision-free fractions (n,) of steps from ``U`` to ``W``; None if all are 1.

        ``U`` is the shape of the last :meth:`rebuild_at` or :meth:`accept_step`.
        """
        self._within = 2.0 * largest_displacement(W, self._paid_at) < self._clearance
        if self._within:
            self._energy_after = 0.0
            return None
        far = self._list_within_reach(U, W)
        if far is not None:
            return np.full(len(U), far)
        listed, self._ahead = self._listed, W
        self._low_after, fraction = np.empty(len(listed.low)), np.empty(len(listed.low))
        pairs, bounds = (listed.pairs, listed.edges), (listed.low, listed.reach, listed.floor)
        motions, after = (self._approach, listed.owner), (self._low_after, fraction)
        margin = _MARGIN * self._edge
        self._energy_after, blocked = detect_collisions(U, W, margin, *pairs, *bounds, *motions, *after, 0.0)
        if not blocked:
            return None
        fractions, short = np.ones(len(U)), fraction < 1.0
        np.minimum.at(fractions, listed.pairs[short].ravel(), np.repeat(fraction[short], 4))
        return fractions

    @property
    def energy_ahead(self) -> float:
        """Energy per stiffness at the end of the last collision-free step found."""
        return self._energy_after

    def accept_step(self) -> None:
        """Accept the last collision-free step found."""
        if self._within:
            return
        self._paid_at = self._ahead
        listed = self._listed = self._listed._replace(low=self._low_after)
        self._bound = self._bound - self._spent
        apart = float((listed.low - listed.reach).min(initial=np.inf)), float(self._bound.min(initial=np.inf))
        self._clearance = min(*apart, self._unseen - self._moved_after)

    def gradient(self, U: np.ndarray) -> tuple[np.ndarray, int, float]:
        """Gradient (n, 3) per stiffness, number of touching pairs, and smallest gap."""
        listed = self._listed
        return gap_gradient(U, listed.pairs, listed.edges, listed.low, listed.reach, 0.0)

    @property
    def may_touch(self) -> bool:
        """True if some gap may be within the range of the gap energy."""
        return bool((self._listed.low < self._listed.reach).any())

    def springs(self, U: np.ndarray, most: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Springs of touching pairs: vertices (p, 4), constants (p,), weights (p, 4)."""
        touching = self._listed.subset(self._listed.low < self._listed.reach)
        k, w = gap_springs(U, touching.pairs, touching.edges, touching.reach, most, 0.0)
        return touching.pairs, k, w

    def _reduce_bounds(self, U: np.ndarray) -> None:
        """Reduce all bounds by the approach during steps within the clearance."""
        if U is not self._paid_at:
            approach = self._patches.approach_bounds(self._paid_at, U, self._between)
            self._listed = self._listed._replace(low=self._listed.low - approach[self._listed.owner])
            self._bound = self._bound - approach
            self._paid_at, self._clearance = U, 0.0

    def _list_within_reach(self, U: np.ndarray, W: np.ndarray) -> float | None:
        """List all pairs within reach of a step; return the possible fraction if too long."""
        self._reduce_bounds(U)
        if (longest := _CORNER * largest_difference(W, U)) > _LONGEST * self._edge:
            return 0.9 * _LONGEST * self._edge / longest
        step, moved = largest_displacement(W, U), largest_displacement(U, self._listed_at)
        needed = max(self._usual, 4.0 * step)
        if 2.0 * (moved + step) > self._unseen or self._unseen > 2.0 * needed:
            self._find_near_patches(U, needed)
            moved = 0.0
        self._moved_after = 2.0 * (moved + step)
        self._approach = approach = self._patches.approach_bounds(U, W, self._between)
        self._spent = approach
        left = self._bound - approach
        kept = self._keep_neighbours(U, W, left)
        left[kept] = np.inf
        most = float(approach[left < 0.0].max(initial=0.0))
        if most > _FARTHEST * self._edge:
            return 0.9 * _FARTHEST * self._edge / most
        if (left < 0.0).any():
            self._renew_listed_pairs(U, left < _SOON * self._look_ahead)
        return None

    def _keep_neighbours(self, U: np.ndarray, W: np.ndarray, left: np.ndarray) -> np.ndarray:
        """Rows of patch pairs whose bounds, ``left`` after a step, the rest shape raises."""
        if not (left < 0.0).any():
            return np.zeros(0, np.int64)
        rows = np.flatnonzero(left < _SOON * self._look_ahead)
        excess = self._neighbours.excess(U, W, self._between[rows])
        better = excess > np.maximum(left[rows], 0.0)
        rows = rows[better]
        # These bounds hold before, during and after the step: nothing of them is spent.
        self._bound[rows], self._spent = excess[better], self._approach.copy()
        self._spent[rows] = 0.0
        return rows

    def _renew_listed_pairs(self, U: np.ndarray, short: np.ndarray) -> None:
        """Renew the listed pairs between the patch pairs in the mask ``short``."""
        rows = np.flatnonzero(short)
        approach, ahead = self._approach[rows], self._look_ahead[rows]
        beyond = approach + np.maximum(ahead, np.minimum(approach, 1.2 * ahead))
        found, self._bound[rows] = self._search.near_pairs(U, self._between[rows], beyond)
        apart = found.reach > 0.0
        if not apart.all():
            self.touching_at_rest = np.union1d(self.touching_at_rest, found.pairs[~apart])
            found = found.subset(apart)
        floor = np.minimum(_FLOOR * self._reach, _FLOOR_OF_RANGE * found.reach)
        floor = np.minimum(floor, _FLOOR_OF_GAP * found.gap)
        owner = rows[found.owner].astype(np.int32)
        new = _ListedPairs(found.pairs, found.is_edge_pair, owner, found.gap, found.reach, floor)
        self._listed = self._listed.subset(~short[self._listed.owner]).joined_with(new)

    def _find_near_patches(self, U: np.ndarray, beyond: float) -> None:
        """Find the near patch pairs, keeping known bounds and listed pairs."""
        self._unseen = beyond
        between, bound = self._patches.near_pairs(self._patches.boxes(U), self._reach + beyond)
        bound -= self._reach
        row = rows_among(pair_keys(self._between), pair_keys(between))
        there = np.flatnonzero(row >= 0)
        bound[row[there]] = np.maximum(bound[row[there]], self._bound[there])
        owner = row[self._listed.owner]
        self._listed = self._listed._replace(owner=owner).subset(owner >= 0)
        self._between, self._bound, self._listed_at = between, bound, U
        self._look_ahead = _LOOK_AHEAD * np.minimum(*self._edges_of[between.T])


class NoPairs:
    """Empty set of near pairs, for a surface without self-contact.

    Parameters
    ----------
    n : int
        Number of the vertices.
    """

    energy_ahead, may_touch = 0.0, False
    edges = np.zeros((0, 2), np.int64)
    touching_at_rest = np.zeros(0, np.int32)

    def __init__(self, n: int) -> None:
        self._n = n

    def rebuild_at(self, _: np.ndarray) -> None:
        """Do nothing."""

    def find_collision_free_fractions(self, _: np.ndarray, _W: np.ndarray) -> None:
        """None: every step is collision-free."""

    def accept_step(self) -> None:
        """Do nothing."""

    def gradient(self, _: np.ndarray) -> tuple[np.ndarray, int, float]:
        """No gradient (n, 3), no touching pairs, and an infinite gap."""
        return np.zeros((self._n, 3)), 0, np.inf

    def springs(self, _: np.ndarray, _most: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """No springs; see :meth:`NearPairs.springs`."""
        return np.zeros((0, 4), np.int64), np.zeros(0), np.zeros((0, 4))
