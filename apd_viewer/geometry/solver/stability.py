"""Stability of a shape in equilibrium, and descent from a saddle of the energy.

The gradient also vanishes at saddles: a flat sheet compressed in its plane stays flat under any load. The
Lanczos process [Lanczos 1950] finds the lowest curvature of the energy from differences of gradients,
relative to the metric of the descent, in which K has curvature 1 in every direction. Along a direction of
negative curvature the energy falls. All directions are tangent to the goals.
"""

import numpy as np
from scipy.linalg import eigh_tridiagonal

from apd_viewer.geometry.solver.convergence import DEFAULT_CONVERGENCE
from apd_viewer.geometry.solver.iterative_solver import IterativeSolver
from apd_viewer.geometry.solver.quasi_newton_descent import Equilibrium

# Displacement for a difference of gradients, in mesh sizes.
_DIFFERENCE = 1e-7
# Largest number of directions for a small and for a large surface. A large one seldom rests at a saddle, as
# its coarse levels are not symmetric; 6 directions take 1 to 5 % of the time for 13,000 vertices.
_MOST_DIRECTIONS, _LEAST_DIRECTIONS, _VERTICES_IN_ALL = 40, 6, 80_000
# The search ends once the relative error of the lowest curvature is below the first value if negative, below
# the second if positive.
_KNOWN_FALLING, _KNOWN_RISING = 0.3, 0.1
# Smallest negative curvature, relative to K, distinct from rounding errors and incomplete convergence.
_FALLING = -1e-5
# Largest number of free vertices of a flat sheet examined already after these iterations, and largest
# distance of its points from a plane, in mesh sizes. Larger meshes have unsymmetric coarse levels.
_MOST_OF_FLAT, _FIRST_ITERATIONS, _FLAT = 5_000, 2, 1e-9
# Largest number of doublings of a displacement along which the energy falls.
_DOUBLINGS = 12
# Number of saddles left before a shape counts as unstable; most often there is one.
_MOST_ESCAPES = 10
# Energy due to rounding, relative to the squared mesh size; strains of 1e-8.
_NO_ENERGY = 1e-16


class StabilitySearch:
    """Search for a direction in which the energy of an equilibrium shape falls.

    It starts from the response to random forces, dominated by soft directions.

    Parameters
    ----------
    equilibrium : Equilibrium
        Restored bit for bit after each step.
    size : float
        Of the mesh, mesh units.

    Attributes
    ----------
    equilibrium : Equilibrium
    lowest : float
        Lowest curvature found, relative to that of K.
    has_ended : bool
    """

    def __init__(self, equilibrium: Equilibrium, size: float) -> None:
        at = self.equilibrium = equilibrium
        self._difference = _DIFFERENCE * size
        free = at.surface.free
        self._most = int(np.clip(_VERTICES_IN_ALL // len(free), _LEAST_DIRECTIONS, _MOST_DIRECTIONS))
        self._goal_values = at.projection.values.copy()
        self._slope = at.quarter_gradient(at.surface.U)
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
        """Examine one more direction."""
        direction, dual = self._response / self._norm, self._forces / self._norm
        forces = self._hessian_product(direction)
        self._directions.append(direction.astype(np.float32))
        self._diagonal.append(float(np.einsum("ij,ij->", direction, forces)))
        # Three-term recurrence; `dual` is K times the direction.
        forces = forces - self._diagonal[-1] * dual - self._norm_before * self._before
        self._before, self._forces = dual, forces
        self._response = self.equilibrium.solve(forces)
        self._norm = _norm(self._response, forces)
        self._values, self._vectors = eigh_tridiagonal(self._diagonal, self._beside)
        self._beside.append(self._norm)
        self.lowest = float(self._values[0])
        error = self._norm * abs(float(self._vectors[-1, 0]))
        known = _KNOWN_FALLING if self.lowest < 0.0 else _KNOWN_RISING
        found = error <= known * abs(self.lowest) and (
            self.lowest < 0.0 or self.equilibrium.is_definite is None
        )
        self.has_ended = found or len(self._directions) >= self._most

    @property
    def _norm_before(self) -> float:
        return self._beside[-1] if self._beside else 0.0

    def _hessian_product(self, direction: np.ndarray) -> np.ndarray:
        """Hessian of the Lagrangian times ``direction`` (f, 3), within the goals."""
        at, small = self.equilibrium, self._difference / max(float(np.abs(direction).max()), 1e-300)
        change = (at.quarter_gradient(at.moved_along(small * direction)) - self._slope) / small
        at.projection.evaluate(at.surface.U)
        at.projection.values = self._goal_values.copy()
        return self._within_goals(change)

    def descent_direction(self, seed: int) -> np.ndarray | None:
        """Direction (f, 3) in which the energy falls, at most 1 long; None if none.

        The lowest one for seed 0, else a random combination of all falling ones.
        """
        falling = np.flatnonzero(self._values < _FALLING)
        if not len(falling):
            return None
        random = np.random.default_rng(seed)
        weights = random.normal(size=len(falling)) if seed else np.eye(len(falling))[0]
        found = np.zeros(self._before.shape)
        for part, direction in zip(self._vectors[:, falling] @ weights, self._directions, strict=True):
            found += part * direction
        return found / np.abs(found).max()


def _norm(response: np.ndarray, forces: np.ndarray) -> float:
    """Length of a response (f, 3) to forces (f, 3) in the metric."""
    return float(np.sqrt(max(np.einsum("ij,ij->", response, forces), 0.0)))


def lower_energy_shape(at: Equilibrium, direction: np.ndarray) -> np.ndarray | None:
    """Shape (n, 3) of lower energy along plus or minus ``direction`` (f, 3), or None.

    The displacement is doubled for as long as the energy falls. The surface keeps its current positions.
    """
    surface, projection, start = at.surface, at.projection, at.surface.U
    best, lowest = None, surface.energy
    for sign in (1.0, -1.0):
        for doubling in range(_DOUBLINGS):
            U, _ = projection.project(at.moved_along(sign * 2.0**doubling * direction))
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
    """Stability of the shapes at which a solver comes to rest.

    At a saddle, the solver restarts from a lower shape nearby.

    Parameters
    ----------
    solver : IterativeSolver
    size : float
        Of the mesh, mesh units.

    Attributes
    ----------
    imperfection, seed : float, int
        Size and random seed of the displacement off a saddle; see :class:`Convergence`.
    saddle_escapes : int
        Number of saddles left.
    """

    def __init__(self, solver: IterativeSolver, size: float) -> None:
        self._solver, self._size = solver, size
        self.imperfection, self.seed = DEFAULT_CONVERGENCE.imperfection, DEFAULT_CONVERGENCE.seed
        self._no_energy = _NO_ENERGY * size**2
        self.reset()

    def reset(self) -> None:
        """Discard all results after a change of targets or goals."""
        self._search: StabilitySearch | None = None
        self._begins_flat: bool | None = None
        self._is_stable: bool | None = None
        self.saddle_escapes = 0

    @property
    def _lies_flat(self) -> bool:
        """True if the shape is a small flat sheet."""
        U, free = self._solver.surface.U, self._solver.surface.free
        if len(free) > _MOST_OF_FLAT:
            return False
        X = U - U.mean(axis=0)
        normal = np.linalg.eigh(np.einsum("ij,ik->jk", X, X))[1][:, 0]
        return bool(np.abs(X @ normal).max() <= _FLAT * self._size)

    @property
    def is_stable(self) -> bool | None:
        """True if the energy falls in no examined direction; None while unknown."""
        if self._is_stable is None and self._is_descent and (self._solver.energy or 0.0) <= self._no_energy:
            return True
        return self._is_stable

    @property
    def is_pending(self) -> bool:
        """True if stability can be determined, but is still unknown."""
        return self._is_descent and self.is_stable is None

    @property
    def _is_descent(self) -> bool:
        return self._solver.progress.converged is not None

    def is_due(self, in_equilibrium: bool, iteration: int) -> bool:
        """True if a step is due: in equilibrium, or early in a flat sheet's descent.

        A sheet compressed in its plane, not along the axes, would buckle into an arbitrary fold by rounding
        errors.
        """
        if self._begins_flat is None and iteration == _FIRST_ITERATIONS:
            self._begins_flat = self._lies_flat
        return (in_equilibrium or bool(self._begins_flat)) and self.is_pending

    def step(self, in_equilibrium: bool) -> bool:
        """Examine one more direction; return True after a step to lower energy."""
        if self._search is None:
            at = self._solver.equilibrium
            assert at is not None
            self._search = StabilitySearch(at, self._size)
        if not self._search.has_ended:
            self._search.step()
            return False
        search, self._search = self._search, None
        at, direction = search.equilibrium, search.descent_direction(self.seed)
        self._begins_flat = False
        may_leave = self.imperfection > 0.0 and self.saddle_escapes < _MOST_ESCAPES
        lower = None
        if direction is not None and may_leave:
            lower = lower_energy_shape(at, self.imperfection * self._size * direction)
        if lower is None:
            if in_equilibrium:
                # Stable if no displacement of that size lowers the energy, or contact blocks it.
                known_to_fall = at.is_definite is False and not len(at.multipliers)
                self._is_stable = may_leave if direction is not None else not known_to_fall
            return False
        self.saddle_escapes += 1
        self._solver.restart(lower)
        return True
