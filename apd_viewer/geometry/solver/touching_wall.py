"""Thin elastic wall in contact, stepped by its Hessian.

A wall is many times stiffer in its plane than in bending, so that no constant matrix suits as a metric. Its
Hessian does, including the curvature of the goals, whose tension stiffens the wall, and of the gaps.
"""

import numpy as np
import scipy.sparse as sp

from apd_viewer.geometry.contact.contact import Contact, DirectedSprings
from apd_viewer.geometry.contact.obstacle_pairs import ObstaclePairs
from apd_viewer.geometry.energy.enclosed_gas import EnclosedVolume
from apd_viewer.geometry.energy.wall_surface import WallSurface
from apd_viewer.geometry.goals.goals import Goal
from apd_viewer.geometry.linalg.block_cholesky import BlockFactor, BlockPattern
from apd_viewer.geometry.linalg.linear_solver import Metric
from apd_viewer.geometry.solver.touching_surface import TouchingSurface

# Number of steps per Hessian, whose factorization takes as long as 30 steps.
_RENEWED = 30
# Successive attempts at a definite matrix: factor of the indefinite terms, and addition to the diagonal
# relative to its mean, since needles resist nothing and leave their corners loose.
_ATTEMPTS = (1.0, 0.0), (0.3, 0.0), (0.0, 0.0), (0.0, 1e-9), (0.0, 1e-6), (0.0, 1e-3), (0.0, 1.0)
# Largest gap energy after a motion of held vertices and obstacles, relative to the total energy before and to
# the bending rigidity.
_MOST_RISE, _LEAST_RISE = 4.0, 0.01
# A wall thinner than the first value, in mesh sizes, has too many competing folds: one of the second
# thickness follows handles and obstacles, and is thinned by the third factor at each rest.
_THIN, _EASY, _THINNER = 1e-3, 8e-3, 0.3
# Longest displacement of free vertices, relative to that of held vertices and obstacles.
_FLUNG = 3.0
# Energy due to rounding, relative to the squared mesh size; up to it, nothing has touched the wall yet.
_NO_ENERGY = 1e-16
# Sine of the angle below which plates are parallel.
_PARALLEL = 1e-6
# Trial displacement of held vertices, in mesh sizes.
_MOVED = 1e-6


class TouchingWall(TouchingSurface):
    """Thin elastic wall with gap energy.

    Parameters
    ----------
    elastic_surface : WallSurface
    contact : Contact
    gas : EnclosedVolume, optional
    """

    elastic_surface: WallSurface
    longest_step, growth, reach, least_part, follows_at_once = 0.05, 4.0, np.inf, 1e-7, True
    # With 2e-3, or 3e-4, loads of a thick ring can be off by 1 %. A smaller tolerance of the energy instead
    # leaves thin rings the time to tip over, as nothing but friction would keep them upright.
    most_imbalance = 1e-4

    def __init__(
        self, elastic_surface: WallSurface, contact: Contact, gas: EnclosedVolume | None = None
    ) -> None:
        super().__init__(elastic_surface, contact, gas)
        self._pattern: BlockPattern | None = None
        self._springs = contact.directed_springs(elastic_surface.U)
        self._age = _RENEWED
        self._size = float(np.linalg.norm(np.ptp(elastic_surface.rest.V, axis=0)))
        self._tensions, self._pressure = np.zeros(len(elastic_surface.rest.F)), 0.0
        held = len(elastic_surface.fixed) + len(elastic_surface.soft.ids)
        self._is_held, self._may_turn = held > 0, held < 3
        self._factored: Metric | None = None
        self._is_definite: bool | None = None

    def solve(self, b_f: np.ndarray) -> np.ndarray:
        """Response to forces ``b_f``, both (f, 3), without a constraint on rotation."""
        if self._factored is None:
            self._factored = self._factor()
        X = self._factored.solve(b_f)
        return X if self._is_held else _without_sliding(X, self.contact.obstacles)

    def without_drift(self, U: np.ndarray, _: np.ndarray) -> np.ndarray:
        """``U`` (n, 3) without the mean of the last step along all plates.

        Vertices that contact has stopped have held it back there, but nothing does.
        """
        if self._is_held:
            return U
        start = self.contact.start
        step = _without_sliding((U - start)[self.free], self.contact.obstacles)
        return self.positions_along(start, 1.0, step, U[:0])

    def make_thick(self) -> bool:
        """Restart with a wall thick enough to follow; False if it is the same."""
        last, thin = self.elastic_surface.material.thickness, _THIN * self._size
        thickness = _EASY * self._size if last < thin else last
        if thickness == self.elastic_surface.thickness:
            return False
        self.elastic_surface.thickness, self._age = thickness, _RENEWED
        return True

    def make_thinner(self) -> bool:
        """Continue with a thinner wall; False if already at the requested thickness."""
        wall, last = self.elastic_surface, self.elastic_surface.material.thickness
        if wall.thickness <= last:
            return False
        wall.thickness = max(last, _THINNER * wall.thickness)
        self._age = _RENEWED
        return True

    def attach_springs(self, targets: np.ndarray) -> None:
        """Attach springs to soft vertices, at ``targets`` (k + s, 3) after the held ones."""
        self.elastic_surface.attach_springs(targets)

    @property
    def is_definite(self) -> bool | None:
        """True if the last Hessian was positive definite; None if unknown."""
        return self._is_definite

    def has_wide_gaps(self, W: np.ndarray) -> bool:
        """True if the gaps at ``W`` (n, 3) are wide enough to continue from there."""
        allowed = max(_MOST_RISE * abs(self.energy), _LEAST_RISE * self.elastic_surface.plate_rigidity)
        return self.contact.energy_at(W) <= allowed

    def request_new_metric(self) -> bool:
        """Request a new Hessian for the next step; False if none could reduce the energy."""
        was_new = self._age == 0 or abs(self.energy) <= _NO_ENERGY * self._size**2
        if was_new:
            return False
        self._age = _RENEWED
        return True

    def renew_metric(self, goals: tuple[Goal, ...], multipliers: np.ndarray) -> bool:
        """Factor the Hessian if due; False if nothing changed."""
        self._age += 1
        if self._age <= _RENEWED:
            return False
        self._tensions = np.zeros(len(self.elastic_surface.rest.F))
        self._pressure = self.gas.metric_pressure if self.gas else 0.0
        for goal, multiplier in zip(goals, -4.0 * multipliers, strict=True):
            if goal.is_volume:
                self._pressure += multiplier
            else:
                self._tensions += multiplier * goal.triangle_fractions
        self._springs = self.contact.directed_springs(self.U)
        self._factored, self._age = self._factor(), 0
        return True

    def _factor(self) -> Metric:
        pattern = self._pattern_with(self._springs.ids)
        for share, firmer in _ATTEMPTS:
            blocks = self.elastic_surface.blocks(pattern, self._tensions, self._pressure, share)
            _add_springs(self._springs, np.append(self.elastic_surface.rows, -1), pattern, blocks)
            mean = np.trace(blocks[pattern.diagonal].mean(axis=0)) / 3.0
            blocks[pattern.diagonal] += firmer * mean * np.eye(3)
            try:
                factor = BlockFactor(pattern, blocks, np.float64)
            except ValueError:
                continue
            # The curvature of the gaps is not in the matrix, and that of free turns is rounded to either side
            # of 0: then it only proves minima.
            is_known = not (self._may_turn or len(self._springs.ids))
            self._is_definite = (share, firmer) == _ATTEMPTS[0] or (False if is_known else None)
            return factor
        raise ArithmeticError("The Hessian of the wall is not finite.")

    def _pattern_with(self, ids: np.ndarray) -> BlockPattern:
        """Pattern that also couples the vertices ``ids`` (p, 4) of each pair."""
        couplings, f = self.elastic_surface.couplings, len(self.free)
        rows = np.append(self.elastic_surface.rows, -1)[np.minimum(ids, len(self.U))]
        a, b = np.repeat(rows, 4, axis=1).ravel(), np.tile(rows, 4).ravel()
        inside = (a >= 0) & (b >= 0)
        more = sp.coo_array((np.ones(inside.sum(), np.float32), (a[inside], b[inside])), shape=(f, f)).tocsr()
        if self._pattern is not None:
            known = sp.csr_array(
                (np.ones(len(self._pattern.column)), self._pattern.column, self._pattern.start), shape=(f, f)
            )
            if (known.multiply(more)).nnz == more.nnz:
                return self._pattern
        whole = (couplings + more).tocsr()
        whole.sort_indices()
        # Order the unknowns by current positions: touching parts may be far apart in the rest shape.
        X = self.U[self.free]
        self._pattern = BlockPattern(X, whole.indptr.astype(np.int64), whole.indices.astype(np.int64))
        return self._pattern

    def following_positions(self, held: np.ndarray, held_after: np.ndarray) -> np.ndarray:
        """Free positions (f, 3) after a motion of held vertices and obstacles.

        Parameters
        ----------
        held, held_after : (k + s, 3) float arrays
            Held and soft vertices before and after it; obstacles go ahead as they are told.
        """
        start = self.U[self.free]
        way = self.solve(self._pull_of_held(held, held_after) + self._pull_of_obstacles())
        moves = [pairs.points_ahead - pairs.points for pairs in self.contact.obstacles]
        longest = max(float(np.abs(move).max(initial=0.0)) for move in [held_after - held, *moves])
        # Near buckling the response would be far too large.
        return start + min(1.0, _FLUNG * longest / max(float(np.abs(way).max()), 1e-300)) * way

    def _pull_of_held(self, held: np.ndarray, held_after: np.ndarray) -> np.ndarray:
        move = held_after - held
        longest = float(np.abs(move).max(initial=0.0))
        if longest == 0.0:
            return np.zeros((len(self.free), 3))
        wall, small = self.elastic_surface, _MOVED * self._size / longest
        moved = held + small * move
        there = wall.all_positions(self.U[self.free], moved)
        change = wall.residual_at(there, moved) - wall.residual_at(self.U, held)
        return change / -small

    def _pull_of_obstacles(self) -> np.ndarray:
        pull = np.zeros_like(self.U)
        springs, n = self._springs, len(self.U)
        if len(springs.ids) and self.contact.obstacles:
            moves = np.zeros((n + len(self.contact.obstacles), 3))
            for k, pairs in enumerate(self.contact.obstacles):
                moves[n + k] = pairs.points_ahead[0] - pairs.points[0]
            opened = np.einsum("pi,pia,pa->p", springs.weights, moves[springs.ids], springs.directions)
            forces = (springs.constants * opened)[:, None] * springs.directions
            for i in range(4):
                own = springs.ids[:, i] < n
                np.add.at(pull, springs.ids[own, i], -springs.weights[own, i, None] * forces[own])
        return pull[self.free]


def _without_sliding(X: np.ndarray, obstacles: list[ObstaclePairs]) -> np.ndarray:
    """``X`` (f, 3) without its mean along all plates, which costs no energy.

    Nothing holds a wall along all of its plates, so that rounding errors alone would carry it away. With
    obstacles of other kinds it stays as it is.
    """
    normals = np.array([n for each in obstacles if (n := each.obstacle.plate_normal) is not None])
    if not len(normals) or len(normals) < len(obstacles):
        return X
    _, sizes, directions = np.linalg.svd(normals)
    along = directions[np.count_nonzero(sizes > _PARALLEL) :]
    return np.asarray(X - (X.mean(axis=0) @ along.T) @ along)


def _add_springs(
    springs: DirectedSprings, rows: np.ndarray, pattern: BlockPattern, blocks: np.ndarray
) -> None:
    """Add the ``springs`` to ``blocks``; ``rows`` (n + 1,) ends with -1 for obstacles."""
    if not len(springs.ids):
        return
    f, at = len(pattern.start) - 1, rows[np.minimum(springs.ids, len(rows) - 1)]
    keys = np.repeat(np.arange(f), np.diff(pattern.start)) * f + pattern.column
    along = springs.directions[:, :, None] * springs.directions[:, None, :]
    for i in range(4):
        for j in range(4):
            both = (at[:, i] >= 0) & (at[:, j] >= 0)
            slot = np.searchsorted(keys, at[both, i] * f + at[both, j])
            firm = (springs.constants * springs.weights[:, i] * springs.weights[:, j])[both]
            np.add.at(blocks, slot, firm[:, None, None] * along[both])
