"""Elastic surface with held vertices, independent of its energy."""

from abc import ABC, abstractmethod

import numpy as np

from apd_viewer.geometry.energy.material import Material
from apd_viewer.geometry.energy.plastic_bending import PlasticBending
from apd_viewer.geometry.energy.plastic_hinges import PlasticHinges
from apd_viewer.geometry.energy.solve_mesh import SolveMesh
from apd_viewer.geometry.linalg import parallel_ops
from apd_viewer.geometry.pose.constraints import NO_SOFT_CONSTRAINTS, SoftConstraints


class HeldSurface(ABC):
    """Elastic surface with some vertices held.

    Parameters
    ----------
    rest : SolveMesh
    fixed : (k,) int array
        Held vertices, each once.
    soft : SoftConstraints
        Free vertices pulled by springs. Their targets follow those of ``fixed`` in all ``targets``.

    Attributes
    ----------
    U : (n, 3) float array
        Current positions. Replaced, never written into.
    free : (f,) int array
        Vertices to solve for. If any are held, components without a held vertex are excluded: their position
        is undetermined, so they stay at rest (see :class:`LooseComponents`).
    is_held, is_free : (n,) bool arrays
        Masks of ``fixed`` and ``free``.
    place : (n,) int array
        Rows of the free vertices; from -1 downwards, rows of the held ones; f for vertices at rest.
    spring_constants : (s,) float array
        Of the springs of ``soft``.
    material : Material
    creases : PlasticBending or PlasticHinges or None
        Plastic creases; None for a material that does not yield.
    """

    material: Material
    creases: PlasticBending | PlasticHinges | None = None

    def __init__(
        self, rest: SolveMesh, fixed: np.ndarray, soft: SoftConstraints = NO_SOFT_CONSTRAINTS
    ) -> None:
        self.rest, self.fixed, self.soft, self.U = rest, fixed, soft, rest.V
        self.spring_constants = soft.density * rest.vertex_areas[soft.ids] if len(soft.ids) else soft.density
        self.is_held = np.zeros(len(rest.V), dtype=bool)
        self.is_held[fixed] = True
        self.is_free = rest.is_connected_to(fixed) & ~self.is_held
        self.free = np.flatnonzero(self.is_free)
        self.place = np.full(len(rest.V), len(rest.V))
        self.place[self.free] = np.arange(len(self.free))
        self.place[fixed] = -1 - np.arange(len(fixed))

    def all_positions(self, X: np.ndarray, targets: np.ndarray) -> np.ndarray:
        """Positions (n, 3), with free vertices at ``X`` and held ones at ``targets``."""
        return parallel_ops.scattered_rows(self.U, self.place, X, targets)

    def positions_along(
        self, U: np.ndarray, fraction: float, direction: np.ndarray, targets: np.ndarray
    ) -> np.ndarray:
        """``U`` (n, 3) plus a fraction of ``direction`` (f, 3); held ones at ``targets``."""
        return parallel_ops.displaced_rows(U, self.place, fraction, direction, targets)

    @abstractmethod
    def restart(self, U: np.ndarray) -> None:
        """Continue from the positions ``U`` (n, 3)."""

    @abstractmethod
    def local_step(self, U: np.ndarray) -> None:
        """Make ``U`` (n, 3) current, and prepare its energy."""

    @property
    @abstractmethod
    def energy(self) -> float:
        """Energy of the current positions."""

    @abstractmethod
    def energy_after_local_step(self, U: np.ndarray) -> float:
        """Make ``U`` (n, 3) current; return its energy."""

    @abstractmethod
    def residual(self, targets: np.ndarray) -> np.ndarray:
        """A quarter of the gradient on the free vertices, (f, 3)."""

    @abstractmethod
    def residual_at(self, U: np.ndarray, targets: np.ndarray) -> np.ndarray:
        """Residual at ``U`` (n, 3); the current positions are unchanged."""

    def commit_creases(self) -> None:  # noqa: B027 (optional)
        """Make the plastic flow at the current positions permanent, if any."""
