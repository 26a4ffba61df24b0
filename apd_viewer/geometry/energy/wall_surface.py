"""Thin elastic wall with held vertices, and its Hessian.

Stretching is that of the material of St. Venant and Kirchhoff in every triangle,

    E = sum_t A_t (lambda/2 (tr e)^2 + mu e : e),        e = (D^T D - I) / 2,  D the deformation gradient

in plane stress: ``lambda = C nu / (1 - nu^2)`` and ``mu = C / (2 (1 + nu))``, with C Young's modulus times
thickness. Turns may be large, stretches not: the wall is meant to be thin. It bends at its hinges, see
:class:`Hinges`. The membrane has Young's modulus times thickness 4 per area, as the cells of Eq. 1, so that
loads of all methods compare; the bending rigidity follows from the thickness.
"""

from dataclasses import replace
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numba import prange

from apd_viewer.geometry.energy.held_surface import HeldSurface
from apd_viewer.geometry.energy.hinges import Hinges, angles_and_gradients
from apd_viewer.geometry.energy.material import Material
from apd_viewer.geometry.energy.solve_mesh import SolveMesh
from apd_viewer.geometry.energy.wall_hessian import wall_blocks
from apd_viewer.geometry.linalg import parallel_ops
from apd_viewer.geometry.linalg.block_cholesky import BlockPattern
from apd_viewer.geometry.linalg.threads import parallel, sum_of_portions
from apd_viewer.geometry.mesh.operators import cotangents, is_well_shaped
from apd_viewer.geometry.mesh.weighted_areas import Patch
from apd_viewer.geometry.pose.constraints import NO_SOFT_CONSTRAINTS, SoftConstraints
from apd_viewer.language import trn

# Stiffness against translation, in bending rigidities over the fourth power of the mesh size.
_SHIFT = 0.1
# Triangles per parallel task.
_PORTION = 512


class WallSurface(HeldSurface):
    """Thin elastic wall with some vertices held.

    Parameters
    ----------
    rest : SolveMesh
    fixed : (k,) int array
        Held vertices, each once.
    material : Material
        With a thickness.
    soft : SoftConstraints

    Attributes
    ----------
    stretching : Stretching
    hinges : Hinges
        Of a wall as thick as 1.
    rows : (n,) int array
        Row of every vertex in the Hessian; -1 for those that are not free.
    """

    def __init__(
        self,
        rest: SolveMesh,
        fixed: np.ndarray,
        material: Material,
        soft: SoftConstraints = NO_SOFT_CONSTRAINTS,
    ) -> None:
        super().__init__(rest, fixed, soft)
        self.material, self._thickness = material, material.thickness
        self._found: tuple[float, np.ndarray] | None = None
        self.stretching = Stretching(rest.V, rest.all_triangles, material.tensile_stiffness, material.poisson)
        unit = replace(material, thickness=1.0).plate_rigidity
        clamps = np.asarray(np.isin(rest.F, fixed).all(axis=1))
        self.hinges = Hinges(rest.V, rest.F, unit, material.poisson, clamps)
        self._targets = np.concatenate([rest.V[fixed], rest.V[soft.ids]])
        self.rows = np.where(self.place < len(self.free), np.maximum(self.place, -1), -1)
        size = float(np.linalg.norm(np.ptp(rest.V, axis=0)))
        shift = _SHIFT * material.plate_rigidity / size**4 * rest.vertex_areas[self.free]
        springs = np.bincount(self.place[soft.ids], self.spring_constants, minlength=len(self.free))
        self._diagonal = 4.0 * (shift + springs) if len(soft.ids) else 4.0 * shift
        self.restart(rest.V)

    @property
    def thickness(self) -> float:
        """Current thickness, which decreases in steps towards that of a thin wall."""
        return self._thickness

    @thickness.setter
    def thickness(self, thickness: float) -> None:
        self._thickness, self._found = thickness, None

    @property
    def plate_rigidity(self) -> float:
        """Current bending rigidity, a squared length."""
        return replace(self.material, thickness=self._thickness).plate_rigidity

    def restart(self, U: np.ndarray) -> None:
        """Continue from the positions ``U`` (n, 3)."""
        self.U, self._found = U, None

    def local_step(self, U: np.ndarray) -> None:
        """Make ``U`` (n, 3) current."""
        self.restart(U)

    def energy_after_local_step(self, U: np.ndarray) -> float:
        """Make ``U`` (n, 3) current; return its energy."""
        self.restart(U)
        return self.energy

    @property
    def energy(self) -> float:
        """Energy of the current positions."""
        E = self._energy_and_gradient[0]
        if len(self.soft.ids):
            away = self.U[self.soft.ids] - self._targets[len(self.fixed) :]
            E += 2.0 * parallel_ops.inner_product(self.spring_constants, (away * away).sum(axis=1))
        return E

    @property
    def _energy_and_gradient(self) -> tuple[float, np.ndarray]:
        if self._found is None:
            self._found = self._energy_and_gradient_at(self.U)
        return self._found

    def _energy_and_gradient_at(self, U: np.ndarray) -> tuple[float, np.ndarray]:
        E, g = self.stretching.energy_and_gradient(U)
        angles, J = angles_and_gradients(U, self.hinges.corners)
        bent, moments = self.hinges.moments(angles)
        square = self._thickness**2
        g += self.hinges.gradient(square * moments, J)
        return E + square * bent, g

    @property
    def stretching_fraction(self) -> float:
        """Fraction of the energy of the current positions due to stretching, 0 to 1."""
        E = self._energy_and_gradient[0]
        return self.stretching.energy_and_gradient(self.U)[0] / E if E > 0.0 else 0.0

    def attach_springs(self, targets: np.ndarray) -> None:
        """Attach springs to soft vertices, at ``targets`` (k + s, 3) after the held ones."""
        self._targets = targets

    def residual(self, targets: np.ndarray) -> np.ndarray:
        """A quarter of the gradient on the free vertices, (f, 3)."""
        self.attach_springs(targets)
        return self._quarter_gradient(self.U, self._energy_and_gradient[1], targets)

    def residual_at(self, U: np.ndarray, targets: np.ndarray) -> np.ndarray:
        """Residual at ``U`` (n, 3); the current positions are unchanged."""
        return self._quarter_gradient(U, self._energy_and_gradient_at(U)[1], targets)

    def _quarter_gradient(self, U: np.ndarray, g: np.ndarray, targets: np.ndarray) -> np.ndarray:
        residual = 0.25 * parallel_ops.gathered_rows(g, self.free)
        if len(self.soft.ids):
            away = U[self.soft.ids] - targets[len(self.fixed) :]
            np.add.at(residual, self.place[self.soft.ids], self.spring_constants[:, None] * away)
        return residual

    @cached_property
    def couplings(self) -> sp.csr_array:
        """Nonzero pattern (f, f) of the Hessian."""
        hinges, n = self.hinges, len(self.U)
        count = np.arange(len(hinges.corners))
        at = np.repeat(count, 4), hinges.corners.ravel()
        of_vertices = sp.coo_array((np.ones(len(at[0]), np.float32), at), shape=(len(count), n)).tocsr()
        bent = np.ones(len(hinges.Q.data), np.float32), hinges.Q.indices, hinges.Q.indptr
        coupled = sp.csr_array(bent, shape=hinges.Q.shape)
        F = self.rest.F
        corners = np.repeat(F, 3, axis=1).ravel(), np.tile(F, 3).ravel()
        flat = sp.coo_array((np.ones(len(corners[0]), np.float32), corners), shape=(n, n)).tocsr()
        return (of_vertices.T @ coupled @ of_vertices + flat).tocsr()[self.free][:, self.free]

    def blocks(
        self, pattern: BlockPattern, tensions: np.ndarray, pressure: float, share: float
    ) -> np.ndarray:
        """Blocks (e, 3, 3) of a quarter of the Hessian at the current positions.

        Parameters
        ----------
        pattern : BlockPattern
            Pattern of all coupled vertices.
        tensions : (m,) float array
            Weight of each triangle's area in the Lagrangian.
        pressure : float
            Multiplier of the volume.
        share : float
            Factor of the possibly indefinite terms, 0 to 1.
        """
        flat, hinges, U = self.stretching, self.hinges, self.U
        angles, J = angles_and_gradients(U, hinges.corners)
        square, patch = self._thickness**2, flat.patch
        triangles = patch.F, patch.start, patch.corner, flat.hats, flat.areas, *flat.lame
        bent = hinges.corners, *hinges.at_vertices, hinges.Q.indptr, hinges.Q.indices, square * hinges.Q.data
        rows = self.free, self.rows, pattern.start, pattern.column
        moments = square * hinges.moments(angles)[1]
        blocks = wall_blocks(U, *triangles, tensions, pressure, *bent, J, moments, share, *rows)
        own = pattern.diagonal
        blocks[own] += self._diagonal[:, None, None] * np.eye(3)
        blocks *= 0.25
        return blocks


def joints_sentence(surface: HeldSurface) -> str | None:
    """Sentence on the edges of a wall that resist no bending; None if it has none."""
    count = len(surface.hinges.others) if isinstance(surface, WallSurface) else 0
    if not count:
        return None
    said = trn(
        "At {n:,} edge of more than two triangles the wall bends freely.",
        "At {n:,} edges of more than two triangles the wall bends freely.",
        count,
    )
    return said.format(n=count)


class Stretching:
    """Stretching energy of all triangles.

    Parameters
    ----------
    V : (n, 3) float array
        Rest positions.
    patch : Patch
        Needles do not count.
    firmness : float
        Young's modulus times thickness, energy per area.
    poisson : float

    Attributes
    ----------
    hats : (m, 3, 2) float array
        Gradients of the hat functions in each triangle's plane; zero for those that do not count.
    areas : (m,) float array
    lame : tuple of float
        lambda and mu.
    """

    def __init__(self, V: np.ndarray, patch: Patch, firmness: float, poisson: float) -> None:
        self.patch = patch
        self.hats, self.areas = _plane_hats(V, patch.F, is_well_shaped(cotangents(V, patch.F)))
        self.lame = firmness * poisson / (1.0 - poisson**2), firmness / (2.0 * (1.0 + poisson))

    def energy_and_gradient(self, U: np.ndarray) -> tuple[float, np.ndarray]:
        """Energy at ``U`` (n, 3), and its gradient (n, 3)."""
        patch = self.patch
        energy, forces = _stresses(U, patch.F, self.hats, self.areas, *self.lame)
        return energy, _corner_sums(patch.start, patch.corner, self.hats, forces)


def _plane_hats(V: np.ndarray, F: np.ndarray, sound: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    X = V[F]
    e, f = X[:, 1] - X[:, 0], X[:, 2] - X[:, 0]
    normal = np.cross(e, f)
    double, length = np.linalg.norm(normal, axis=1), np.linalg.norm(e, axis=1)
    sound = sound & (double > 0.0)
    double, length = np.where(sound, double, 1.0), np.where(sound, length, 1.0)
    x1, x2, y2 = length, np.einsum("ti,ti->t", e, f) / length, double / length
    hats = np.zeros((len(F), 3, 2))
    hats[:, 1, 0], hats[:, 1, 1] = 1.0 / x1, -x2 / (x1 * y2)
    hats[:, 2, 1] = 1.0 / y2
    hats[:, 0] = -hats[:, 1] - hats[:, 2]
    hats[~sound] = 0.0
    return hats, np.where(sound, 0.5 * double, 0.0)


@parallel()
def _stresses(
    U: np.ndarray, F: np.ndarray, hats: np.ndarray, areas: np.ndarray, lame: float, mu: float
) -> tuple[float, np.ndarray]:
    """Energy, and area times ``D S`` of every triangle, S the stress, (m, 3, 2)."""
    count = (len(F) + _PORTION - 1) // _PORTION
    energies, forces = np.zeros(count), np.empty((len(F), 3, 2))
    for portion in prange(count):
        own = 0.0
        for t in range(portion * _PORTION, min(len(F), (portion + 1) * _PORTION)):
            i, j, k = F[t, 0], F[t, 1], F[t, 2]
            D = forces[t]
            for a in range(3):
                x, y = U[j, a] - U[i, a], U[k, a] - U[i, a]
                D[a, 0] = x * hats[t, 1, 0] + y * hats[t, 2, 0]
                D[a, 1] = x * hats[t, 1, 1] + y * hats[t, 2, 1]
            area = areas[t]
            if area == 0.0:
                continue
            e00 = 0.5 * (D[0, 0] * D[0, 0] + D[1, 0] * D[1, 0] + D[2, 0] * D[2, 0] - 1.0)
            e11 = 0.5 * (D[0, 1] * D[0, 1] + D[1, 1] * D[1, 1] + D[2, 1] * D[2, 1] - 1.0)
            e01 = 0.5 * (D[0, 0] * D[0, 1] + D[1, 0] * D[1, 1] + D[2, 0] * D[2, 1])
            trace = e00 + e11
            own += area * (0.5 * lame * trace * trace + mu * (e00 * e00 + e11 * e11 + 2.0 * e01 * e01))
            s00, s11, s01 = lame * trace + 2.0 * mu * e00, lame * trace + 2.0 * mu * e11, 2.0 * mu * e01
            for a in range(3):
                x, y = D[a, 0], D[a, 1]
                D[a, 0], D[a, 1] = area * (x * s00 + y * s01), area * (x * s01 + y * s11)
        energies[portion] = own
    return sum_of_portions(energies), forces


@parallel()
def _corner_sums(start: np.ndarray, corner: np.ndarray, hats: np.ndarray, forces: np.ndarray) -> np.ndarray:
    """Sums (n, 3) over the corners at each vertex of forces times hat gradients."""
    out = np.empty((len(start) - 1, 3))
    for i in prange(len(out)):
        x = y = z = 0.0
        for e in range(start[i], start[i + 1]):
            t, c = corner[e] // 3, corner[e] % 3
            g, h = hats[t, c, 0], hats[t, c, 1]
            x += forces[t, 0, 0] * g + forces[t, 0, 1] * h
            y += forces[t, 1, 0] * g + forces[t, 1, 1] * h
            z += forces[t, 2, 0] * g + forces[t, 2, 1] * h
        out[i, 0], out[i, 1], out[i, 2] = x, y, z
    return out
