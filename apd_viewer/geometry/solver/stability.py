"""Stability of a shape at rest, and the way down from a saddle of the energy.

At rest the slope of the energy vanishes, but that holds at saddles, too: a flat sheet that is pushed in its
own plane rests flat, however hard. Whether a shape is stable, its curvature tells. The Lanczos process
[Lanczos 1950] finds the lowest one from differences of gradients, relative to the metric of the descent:
that of K is 1 in every direction, and below 0 the energy falls. All is looked at within the goals.
"""

import numpy as np
from scipy.linalg import eigh_tridiagonal

from apd_viewer.geometry.solver.convergence import DEFAULT_CONVERGENCE
from apd_viewer.geometry.solver.iterative_solver import IterativeSolver
from apd_viewer.geometry.solver.quasi_newton import Equilibrium

# Size of the displacement from which a difference of gradients is taken, in mesh sizes.
_DIFFERENCE = 1e-7
# Most directions looked at: 40 of a small surface; of a large one, whose rest is seldom a saddle since its
# coarse levels are not symmetric, 6, which take 1 to 5 % of the time to settle with 13,000 vertices.
_MOST_DIRECTIONS, _LEAST_DIRECTIONS, _VERTICES_IN_ALL = 40, 6, 80_000
# The search ends once the error of the lowest curvature, relative to it, is below the first where the energy
# falls, and below the second elsewhere.
_KNOWN_FALLING, _KNOWN_RISING = 0.3, 0.1
# Curvatures from here on, relative to K, are told from rounding and from the last part of the descent.
_FALLING = -1e-5
# Most free vertices of a flat sheet that is looked at after so many iterations: larger ones have coarse
# levels, which are not symmetric. Points of a flat one are so near to a plane, in mesh sizes.
_MOST_OF_FLAT, _FIRST_ITERATIONS, _FLAT = 5_000, 2, 1e-9
# Times that a displacement along a falling direction is doubled while the energy falls.
_DOUBLINGS = 12
# Saddles left until a shape counts as not stable; most often there is one.
_MOST_ESCAPES = 10
# Energy of a shape at rest up to rounding, relative to the size of the mesh; strains of 1e-8.
_NO_ENERGY = 1e-16


class StabilitySearch:
    """Search for a direction in which the energy of a shape at rest falls.

    It begins with the response to random forces, in which soft directions prevail.

    Parameters
    ----------
    at : Equilibrium
        As before after each step, to the bit.
    size : float
        Of the mesh, mesh units.

    Attributes
    ----------
    at : Equilibrium
    lowest : float
        Lowest curvature found, relative to that of K.
    has_ended : bool
    """

    def __init__(self, at: Equilibrium, size: float) -> None:
        self.at, self._difference = at, _DIFFERENCE * size
        free = at.surface.free
        self._most = int(np.clip(_VERTICES_IN_ALL // len(free), _LEAST_DIRECTIONS, _MOST_DIRECTIONS))
        self._goal_values = at.projection.values.copy()
        self._slope = at.slope(at.surface.U)
        self._g = at.projection.g[:, free].copy()
        self._y = np.array([at.solve(g) for g in self._g]).reshape(self._g.shape)
        self._inverse = np.linalg.pinv(np.einsum("ija,kja->ik", self._g, self._y))
        self._directions: list[np.ndarray] = []
        self._before = np.zeros((len(free), 3))
        self._diagonal: list[float] = []
        self._beside: list[float] = []
        self._forces = self._within_goals(np.random.default_rng(0).normal(size=(len(free), 3)))
        self._response = at.solve(self._forces)
        self._norm = _norm(self._response, self._forces)
        self.lowest, self.has_ended = np.inf, self._norm == 0.0 or at.is_definite is True
        self._values, self._vectors = np.zeros(0), np.zeros((0, 0))

    def _within_goals(self, forces: np.ndarray) -> np.ndarray:
        """Forces (f, 3) without those whose response changes a goal."""
        along = np.einsum("ija,ja->i", self._y, forces)
        return forces - np.einsum("i,ija->ja", self._inverse @ along, self._g)

    def step(self) -> None:
        """Look at one more direction."""
        direction, dual = self._response / self._norm, self._forces / self._norm
        forces = self._curved(direction)
        self._directions.append(direction.astype(np.float32))
        self._diagonal.append(float(np.einsum("ij,ij->", direction, forces)))
        # The recurrence of three terms; `dual` is K times the direction.
        forces = forces - self._diagonal[-1] * dual - self._norm_before * self._before
        self._before, self._forces = dual, forces
        self._response = self.at.solve(forces)
        self._norm = _norm(self._response, forces)
        self._values, self._vectors = eigh_tridiagonal(self._diagonal, self._beside)
        self._beside.append(self._norm)
        self.lowest = float(self._values[0])
        error = self._norm * abs(float(self._vectors[-1, 0]))
        known = _KNOWN_FALLING if self.lowest < 0.0 else _KNOWN_RISING
        found = error <= known * abs(self.lowest) and (self.lowest < 0.0 or self.at.is_definite is None)
        self.has_ended = found or len(self._directions) >= self._most

    @property
    def _norm_before(self) -> float:
        return self._beside[-1] if self._beside else 0.0

    def _curved(self, direction: np.ndarray) -> np.ndarray:
        """Hessian of the Lagrangian times ``direction`` (f, 3), within the goals."""
        at, small = self.at, self._difference / max(float(np.abs(direction).max()), 1e-300)
        change = (at.slope(at.along(small * direction)) - self._slope) / small
        at.projection.evaluate(at.surface.U)
        at.projection.values = self._goal_values.copy()
        return self._within_goals(change)

    def falling_direction(self, seed: int) -> np.ndarray | None:
        """Direction (f, 3) in which the energy falls, at most 1 long; None if none.

        The lowest for seed 0; for any other a random mixture of all that fall.
        """
        falling = np.flatnonzero(self._values < _FALLING)
        if not len(falling):
            return None
        random = np.random.default_rng(seed)
        shares = random.normal(size=len(falling)) if seed else np.eye(len(falling))[0]
        way = np.zeros(self._before.shape)
        for part, direction in zip(self._vectors[:, falling] @ shares, self._directions, strict=True):
            way += part * direction
        return way / np.abs(way).max()


def _norm(response: np.ndarray, forces: np.ndarray) -> float:
    """Length of a response (f, 3) to forces (f, 3) in the metric."""
    return float(np.sqrt(max(np.einsum("ij,ij->", response, forces), 0.0)))


def lower_shape(at: Equilibrium, way: np.ndarray) -> np.ndarray | None:
    """Shape (n, 3) of lower energy along ``way`` (f, 3), or against it; None if none.

    The displacement is doubled for as long as the energy falls. The surface stays at rest.
    """
    surface, projection, start = at.surface, at.projection, at.surface.U
    best, lowest = None, surface.energy
    for sign in (1.0, -1.0):
        for doubling in range(_DOUBLINGS):
            U, _ = projection.project(at.along(sign * 2.0**doubling * way))
            energy = surface.energy_after_local_step(U)
            met = projection.has_met_goals
            surface.local_step(start)
            if not met or not energy < lowest:
                break
            best, lowest = U, energy
        if best is not None:
            break
    projection.evaluate(start)
    return best


class Stability:
    """Stability of the shapes that a solver comes to rest at.

    A saddle is left for a lower shape nearby, from which the solver goes on.

    Parameters
    ----------
    solver : IterativeSolver
    size : float
        Of the mesh, mesh units.

    Attributes
    ----------
    imperfection, seed : float, int
        How saddles are left, as :class:`Convergence` has it.
    saddle_escapes : int
        Number of saddles left.
    """

    def __init__(self, solver: IterativeSolver, size: float) -> None:
        self._solver, self._size = solver, size
        self.imperfection, self.seed = DEFAULT_CONVERGENCE.imperfection, DEFAULT_CONVERGENCE.seed
        self._no_energy = _NO_ENERGY * size**2
        self.reset()

    def reset(self) -> None:
        """Begin anew, since targets or goals are others."""
        self._search: StabilitySearch | None = None
        self._begins_flat: bool | None = None
        self._is_stable: bool | None = None
        self.saddle_escapes = 0

    @property
    def _lies_flat(self) -> bool:
        """True if the shape is a small flat sheet."""
        U, free = self._solver.elastic.U, self._solver.elastic.free
        if len(free) > _MOST_OF_FLAT:
            return False
        X = U - U.mean(axis=0)
        normal = np.linalg.eigh(np.einsum("ij,ik->jk", X, X))[1][:, 0]
        return bool(np.abs(X @ normal).max() <= _FLAT * self._size)

    @property
    def is_stable(self) -> bool | None:
        """True if the energy falls in no direction looked at; None while not known."""
        if self._is_stable is None and self._is_descent and (self._solver.energy or 0.0) <= self._no_energy:
            return True
        return self._is_stable

    @property
    def is_open(self) -> bool:
        """True if stability can be found out, and has not been."""
        return self._is_descent and self.is_stable is None

    @property
    def _is_descent(self) -> bool:
        return self._solver.progress.converged is not None

    def is_due(self, at_rest: bool, iteration: int) -> bool:
        """True if a step is due: at rest, and at the beginning of a flat sheet's descent.

        A sheet that is pushed in its plane, and not along the axes, would leave it by rounding errors, for
        any fold.
        """
        if self._begins_flat is None and iteration == _FIRST_ITERATIONS:
            self._begins_flat = self._lies_flat
        return (at_rest or bool(self._begins_flat)) and self.is_open

    def step(self, at_rest: bool) -> bool:
        """Look at one more direction; return True if the shape is left for a lower one."""
        if self._search is None:
            at = self._solver.equilibrium
            assert at is not None
            self._search = StabilitySearch(at, self._size)
        if not self._search.has_ended:
            self._search.step()
            return False
        search, self._search = self._search, None
        at, way = search.at, search.falling_direction(self.seed)
        self._begins_flat = False
        may_leave = self.imperfection > 0.0 and self.saddle_escapes < _MOST_ESCAPES
        lower = None
        if way is not None and may_leave:
            lower = lower_shape(at, self.imperfection * self._size * way)
        if lower is None:
            if at_rest:
                # It holds where no displacement of that size leads lower, or contact leaves no way.
                known_to_fall = at.is_definite is False and not len(at.multipliers)
                self._is_stable = may_leave if way is not None else not known_to_fall
            return False
        self.saddle_escapes += 1
        self._solver.restart(lower)
        return True
