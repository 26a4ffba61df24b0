"""Elastic surface with held vertices: local step and factored global step.

The energy is a sum of terms, each the squared distance to a projection onto preferred shapes: rotated cells
(Eq. 1), triangles with their rest shape or rest area (:class:`Membrane`), triangles that deform like their
neighbours (:class:`Bending`). For fixed projections, the energy is quadratic in the positions, with a
constant matrix:

    grad E = 4 (K U - b),        K factored once, b from the local step.

With bending, collapsing triangles push back (:class:`AreaPenalty`): this force is part of the gradient, but
not of b, because without a line search a global step would follow it too far.
Springs pull soft vertices to their targets; they add to K and to b, and have no local step.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from scipy.sparse import coo_array, diags_array, hstack

from apd_viewer.geometry.energy import arap_cells, membrane_hessian
from apd_viewer.geometry.energy.held_surface import HeldSurface
from apd_viewer.geometry.energy.material import Material
from apd_viewer.geometry.energy.membrane import Membrane
from apd_viewer.geometry.energy.plastic_bending import PlasticBending
from apd_viewer.geometry.energy.solve_mesh import SolveMesh
from apd_viewer.geometry.linalg import parallel_ops
from apd_viewer.geometry.linalg.block_cholesky import BlockFactor, BlockPattern
from apd_viewer.geometry.linalg.linear_solver import Factorizer, LinearSolver, Matrix, Metric
from apd_viewer.geometry.linalg.rotations import compose_rotations
from apd_viewer.geometry.pose.constraints import NO_SOFT_CONSTRAINTS, SoftConstraints

_MINUS = np.array([-1.0])
_NOTHING = np.empty((0, 3))
_NONE, _NO_FORCES = np.empty(0), np.empty((0, 0, 3))


def _factor_directly(matrix: Callable[[], Matrix], V: np.ndarray) -> LinearSolver:
    return LinearSolver(matrix(), V)


class ElasticSurface(HeldSurface):
    """Elastic surface with held vertices, solved by local and global steps.

    Parameters
    ----------
    rest : SolveMesh
    fixed : (k,) int array
        Held vertices, each once.
    material : Material
    factorizer : callable, optional
        Makes the factor of the matrix that a callable returns, given the positions of its unknowns, too;
        here and now without it.
    soft : SoftConstraints

    Attributes
    ----------
    membrane : Membrane or None
        Term preserving shape and area of every triangle; None if the material has none.
    factor : Factor
        Of :attr:`factored_matrix`.
    metric : Metric
        Metric of :meth:`solve`: ``factor``, or the factor of another positive definite matrix.
    """

    creases: PlasticBending | None = None

    def __init__(
        self,
        rest: SolveMesh,
        fixed: np.ndarray,
        material: Material | None = None,
        factorizer: Factorizer | None = None,
        soft: SoftConstraints = NO_SOFT_CONSTRAINTS,
    ) -> None:
        super().__init__(rest, fixed, soft)
        self.factorizer = factorizer or _factor_directly
        self.material = material = material or Material()
        self.membrane: Membrane | None = None
        if material.shear > 0.0 or material.area > 0.0:
            self.membrane = Membrane(rest.V, rest.all_triangles, material.shear, material.area)
        if material.bending > 0.0 and material.yield_curvature < np.inf:
            ratio = material.rigidity / material.bending
            self.creases = PlasticBending(rest, material.yield_curvature, ratio)
        self._bending = self.creases or (rest.bending if material.bending > 0.0 else None)
        # True if the ARAP cells are the only term of the energy.
        more = self.membrane is not None or self._bending is not None or len(soft.ids) > 0
        self._has_cells_alone = not more and material.rigidity == 1.0
        self.factor = self.factorizer(lambda: self.factored_matrix, rest.V[self.free])
        self.metric: Metric = self.factor
        self._coupling = material.coupling * float(rest.vertex_areas.sum())
        self._targets = np.concatenate([rest.V[fixed], rest.V[soft.ids]]) if len(soft.ids) else _NOTHING
        self._from_held: np.ndarray | None = None
        self._q: np.ndarray | None
        self.restart(rest.V)

    @cached_property
    def _blocks(self) -> tuple[Matrix, Matrix]:
        rest, material = self.rest, self.material
        K = rest.L if material.rigidity == 1.0 else material.rigidity * rest.L
        if self.membrane is not None:
            K = K + self.membrane.K
        if self._bending is not None:
            K = K + material.bending * self._bending.K
        rows = K.tocsr()[self.free]
        K_ff, K_fc = rows[:, self.free].tocsr(), rows[:, self.fixed].tocsr()
        if not len(self.soft.ids):
            return K_ff, K_fc
        place, n = self.place[self.soft.ids], len(self.free)
        springs = diags_array(np.bincount(place, self.spring_constants, minlength=n))
        drawn = coo_array((-self.spring_constants, (place, np.arange(len(place)))), shape=(n, len(place)))
        return (K_ff + springs).tocsr(), hstack([K_fc, drawn]).tocsr()

    @property
    def K_ff(self) -> Matrix:
        """Block of the global matrix for the free vertices, (f, f)."""
        return self._blocks[0]

    @property
    def factored_matrix(self) -> Matrix:
        """Matrix :attr:`K_ff`, made positive definite if no vertices are held.

        A translation is then about as stiff as the softest deformation, though it costs no energy.
        """
        if len(self.fixed):
            return self.K_ff
        size = np.ptp(self.rest.V, axis=0)
        return (self.K_ff + diags_array(self.rest.vertex_areas[self.free] / float(size @ size))).tocsr()

    @cached_property
    def hessian(self) -> ProjectedHessian:
        """Approximate Hessian of a surface with a membrane; undefined without one."""
        assert self.membrane is not None
        others = self.K_ff - self.membrane.K[self.free][:, self.free]
        return ProjectedHessian(self.rest.V, self.free, others, self.membrane)

    @property
    def q(self) -> np.ndarray:
        """Rotations of the cells, (n, 4) unit quaternions."""
        if self._q is None:
            q = self.rest.identity_rotations()
            if self.U is not self.rest.V or self.creases:
                self._turn_cells(self.U, q)
            self._q = q
            self._follow_creases()
        return self._q

    def restart(self, U: np.ndarray) -> None:
        """Continue from the positions ``U`` (n, 3)."""
        self.U = U
        self._q = None  # rotations are computed on demand, often much later
        if self.membrane is not None:
            self.membrane.local_step(U)

    def right_hand_side(
        self, targets: np.ndarray, mult: np.ndarray = _NONE, forces: np.ndarray = _NO_FORCES
    ) -> np.ndarray:
        """Right-hand side of the global step, ``b_f - K_fc targets``, (f, 3) float array.

        Parameters
        ----------
        targets : (k, 3) float array
            Positions of the held vertices.
        mult, forces : (g,) and (g, n, 3) float arrays
            ``mult_i forces_i`` are added to ``b``.
        """
        rest, material, more = self.rest, self.material, _NOTHING
        if self.membrane is not None:
            more = self.membrane.right_hand_side()
        if self._bending is not None:
            pull = self._bending.right_hand_side(self.q, material.bending)
            more = pull if more is _NOTHING else more + pull
        terms = *rest.graph, rest.V, rest.LV, self.q, material.rigidity, more
        return arap_cells.right_hand_side(*terms, mult, forces, self.free, self.held_contribution(targets))

    def held_contribution(self, targets: np.ndarray) -> np.ndarray:
        """Contribution ``K_fc targets`` of held vertices at ``targets`` (k, 3)."""
        if targets is not self._targets or self._from_held is None:
            self._targets, self._from_held = targets, parallel_ops.matrix_product(self._blocks[1], targets)
        return self._from_held

    def residual(self, targets: np.ndarray) -> np.ndarray:
        """A quarter of the gradient on the free vertices, (f, 3) float array."""
        if self._has_cells_alone:
            return arap_cells.quarter_gradient(
                *self.rest.graph, self.rest.V, self.rest.LV, self.U, self.q, self.free
            )
        residual = parallel_ops.matrix_product(self.K_ff, parallel_ops.gathered_rows(self.U, self.free))
        parallel_ops.add_combination(residual, _MINUS, self.right_hand_side(targets)[None])
        if self._bending is not None:
            collapsing = self.rest.area_penalty.gradient(self.U)[self.free]
            residual += 0.25 * self.material.bending * collapsing
        return residual

    def residual_at(self, U: np.ndarray, targets: np.ndarray) -> np.ndarray:
        """Residual at ``U`` (n, 3); the current positions are unchanged."""
        current, q = self.U, self.q.copy()
        self.local_step(U)
        residual = self.residual(targets)
        self.U, self._q = current, q
        if self.membrane is not None:
            self.membrane.local_step(current)
        self._follow_creases()
        return residual

    def solve(self, b_f: np.ndarray) -> np.ndarray:
        """Response to forces ``b_f`` in the current metric, both (f, 3) float arrays."""
        return self.metric.solve(b_f)

    def global_step(
        self, targets: np.ndarray, mult: np.ndarray = _NONE, forces: np.ndarray = _NO_FORCES
    ) -> np.ndarray:
        """Minimiser (n, 3) of the energy for a fixed ``b``, not made current."""
        return self.all_positions(
            self.factor.solve_refined(self.right_hand_side(targets, mult, forces)), targets
        )

    def local_step(self, U: np.ndarray) -> None:
        """Make ``U`` (n, 3) current and compute each term's projection there."""
        q, self.U = self.q, U
        if self.membrane is not None:
            self.membrane.local_step(U)
        self._turn_cells(U, q)
        self._follow_creases()

    def energy_after_local_step(self, U: np.ndarray) -> float:
        """Do a local step at ``U`` (n, 3); return its energy without rotation coupling."""
        q, self.U = self.q, U
        if self.membrane is not None:
            self.membrane.local_step(U)
        energies = np.zeros(arap_cells.portion_count(len(U)))
        self._turn_cells(U, q, energies)
        self._follow_creases()
        return self._energy(energies.sum())

    def commit_creases(self) -> None:
        """Make the plastic flow at the current positions permanent."""
        if self.creases:
            self.creases.commit_flow(self.U, self.q)

    def _follow_creases(self) -> None:
        if self.creases:
            self.creases.update_flow(self.U, self.q)

    def _turn_cells(self, U: np.ndarray, q: np.ndarray, energies: np.ndarray = _NONE) -> None:
        rest, material, S0 = self.rest, self.material, arap_cells.NO_MOMENTS
        if self._bending is not None:
            S0 = self._bending.moments(U, material.bending / material.rigidity)
        if self._coupling > 0.0:
            arap_cells.gauss_seidel_local_step(*rest.graph, rest.V, U, S0, self._coupling, q)
            if len(energies):
                energies[0] = arap_cells.energy(*rest.graph, rest.V, U, q)
        else:
            arap_cells.local_step(*rest.graph, rest.V, U, S0, q, energies)

    def rotate_projections(self, rotations: np.ndarray) -> None:
        """Rotate each term's projection by ``rotations`` (n, 4), unit quaternions."""
        compose_rotations(rotations, self.q)
        if self.membrane is not None:
            self.membrane.rotate_projections(rotations)

    @property
    def energy(self) -> float:
        """Energy of the current positions, without the coupling of rotations."""
        return self._energy(arap_cells.energy(*self.rest.graph, self.rest.V, self.U, self.q))

    def _energy(self, cells: float) -> float:
        """Energy of the current positions, given the energy of the ``cells``."""
        flat = 0.0 if self.membrane is None else self.membrane.energy
        return self._energy_without_membrane(self.U, self.q, cells) + flat

    def energy_at(self, U: np.ndarray) -> float:
        """Energy at ``U`` (n, 3) near the current positions, membrane excluded."""
        q = self.q.copy()
        self._turn_cells(U, q)
        return self._energy_without_membrane(U, q, arap_cells.energy(*self.rest.graph, self.rest.V, U, q))

    def _energy_without_membrane(self, U: np.ndarray, q: np.ndarray, cells: float) -> float:
        """Energy at ``U`` (n, 3) of bending, springs and ``cells``, with rotations ``q``."""
        E = self.material.rigidity * cells
        if self._bending is not None:
            E += self.material.bending * (self._bending.energy(U, q) + self.rest.area_penalty.energy(U))
        if len(self.soft.ids):
            away = U[self.soft.ids] - self._targets[len(self.fixed) :]
            E += 2.0 * parallel_ops.inner_product(self.spring_constants, (away * away).sum(axis=1))
        return float(E)


class ProjectedHessian:
    """Hessian of an energy, positive semi-definite per triangle, divided by four.

    A matrix of 3 x 3 blocks, a quarter as all gradients here. Triangles give their own Hessians; all other
    terms give the constant matrix of the global step, their Hessian while the rotations are held.

    Parameters
    ----------
    V : (n, 3) float array
        Rest positions.
    free : (f,) int array
        Vertices that are solved for.
    constant : (f, f) csr_array
        Matrix of all terms but the membrane.
    membrane : Membrane

    Attributes
    ----------
    start, column : (f + 1,), (e,) int arrays
        The blocks' columns, in compressed sparse rows.
    """

    def __init__(self, V: np.ndarray, free: np.ndarray, constant: Matrix, membrane: Membrane) -> None:
        self._free, self._membrane = free, membrane
        f, F = len(free), membrane.patch.F
        place = np.full(len(V), -1)
        place[free] = np.arange(f)
        # Block rows and columns for all pairs of corners of the triangles.
        c, d = np.repeat(place[F], 3, axis=1).ravel(), np.tile(place[F], 3).ravel()
        inside = (c >= 0) & (d >= 0)
        entries = constant.tocoo()
        rows, columns = np.concatenate([entries.row, c[inside]]), np.concatenate([entries.col, d[inside]])
        pattern = sp.csr_array((np.ones(len(rows), dtype=np.int8), (rows, columns)), shape=(f, f))
        pattern.sum_duplicates()
        self.start, self.column = pattern.indptr, pattern.indices
        keys = np.repeat(np.arange(f), np.diff(self.start)) * f + self.column
        slot = np.full(len(c), -1)
        slot[inside] = np.searchsorted(keys, c[inside] * f + d[inside])
        self._slot = slot.reshape(-1, 3, 3)
        self._constant = np.zeros(len(keys))
        self._constant[np.searchsorted(keys, entries.row * np.int64(f) + entries.col)] = entries.data
        self._elimination = BlockPattern(V[free], self.start, self.column)

    def blocks_at(self, U: np.ndarray, least: float = 0.0) -> np.ndarray:
        """Blocks of the matrix at ``U`` (n, 3), (e, 3, 3) float array.

        Parameters
        ----------
        least : float
            Lower bound of the eigenvalues of each triangle's Hessian; -inf for none.
        """
        membrane = self._membrane
        patch, rest = membrane.patch, membrane.rest
        modes = membrane_hessian.modes(patch.F, rest, U, membrane.shear, membrane.area, least)
        blocks = self._constant[:, None, None] * np.eye(3)
        corners = patch.start, patch.corner
        membrane_hessian.add_blocks(self._free, *corners, self._slot, rest, modes, blocks)
        return blocks

    def factor_at(self, U: np.ndarray) -> BlockFactor:
        """Factor of the positive definite matrix at ``U`` (n, 3)."""
        return self._elimination.factor(self.blocks_at(U))
