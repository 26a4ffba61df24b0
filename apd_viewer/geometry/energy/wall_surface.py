"""Thin elastic wall with held vertices, and its Hessian.

Stretching is that of the material of St. Venant and Kirchhoff in every triangle,

    E = sum_t A_t (lambda/2 (tr e)^2 + mu e : e),        e = (D^T D - I) / 2,  D the deformation gradient

in plane stress: ``lambda = C nu / (1 - nu^2)`` and ``mu = C / (2 (1 + nu))``, with C Young's modulus times
thickness. Turns may be large, stretches not: the wall is meant to be thin. It bends at its hinges, see
:class:`Hinges`. The membrane has Young's modulus times thickness 4 per area, as the cells of Eq. 1, so that
loads of all methods compare; the bending rigidity follows from the thickness. Of a wall map these are
the weights of its mean: a triangle f times as thick stretches by f times its weight, bends by f^3 times it
and yields at 1/f of the yield curvature, unless the map has yield radii. Its modulus over the mean is a
factor of both.

Over an arc of length l and curvature k the chord is shorter than the arc, ``l (1 - k^2 l^2 / 24)``. If all
edges were alike, the flat triangles of a wall that bends would shrink evenly. Uneven edges shrink unevenly,
for which triangles would have to stretch. So to the squared length of an edge that is longer than its
neighbours is added by how much more it shrinks,

    c l_0^4 k^2 / 12,        c = (1 - m^2 / l_0^2) / (1 + (l_0 / 60 t)^4),

less the same at rest: l_0 is its length there, t the thickness, and m^2 the mean of the squared edges of its
triangles and 3 % more. The curvature k along the edge follows from the angles of five hinges as slopes do.
Where edges are long against the thickness a wall folds at single edges, and chords are right.

A wall of film or cloth may have the relaxed membrane of :mod:`tension_field` instead, without arcs.
"""

from dataclasses import replace
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numba import prange

from apd_viewer.geometry.energy.held_surface import HeldSurface
from apd_viewer.geometry.energy.hinges import Hinges, angles_and_gradients
from apd_viewer.geometry.energy.material import Material
from apd_viewer.geometry.energy.plastic_hinges import PlasticHinges
from apd_viewer.geometry.energy.solve_mesh import SolveMesh
from apd_viewer.geometry.energy.tension_field import relaxed_stress
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
# Squared length of an edge, in mean squares of the edges of its triangles, from which it counts as long.
_EVEN = 1.03
# Length of edges, in thicknesses, from which a wall folds at single ones.
_FOLDS = 60.0
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
    creases : PlasticHinges or None
        The hinges, if they yield.
    rows : (n,) int array
        Row of every vertex in the Hessian; -1 for those that are not free.
    """

    creases: PlasticHinges | None = None

    def __init__(
        self,
        rest: SolveMesh,
        fixed: np.ndarray,
        material: Material,
        soft: SoftConstraints = NO_SOFT_CONSTRAINTS,
    ) -> None:
        super().__init__(rest, fixed, soft)
        self.material, self._thickness = material, material.thickness
        self._found: tuple[float, float, np.ndarray] | None = None
        factors = material.thickness_factors
        unit = replace(material, thickness=1.0).plate_rigidity * factors**3 * material.young_factors
        clamps = np.asarray(np.isin(rest.F, fixed).all(axis=1))
        shape = rest.V, rest.F, unit, material.poisson, clamps
        self.hinges: Hinges = Hinges(*shape)
        if material.yield_curvature < np.inf:
            self.hinges = self.creases = PlasticHinges(*shape, material.yield_curvatures, material.hardening)
        self.stretching = Stretching(rest.V, rest.all_triangles, self.hinges, material)
        # A triangle that vanishes takes the tensile stiffness times its area, of the mean triangle.
        self._collapse_weight = 0.5 * material.tensile_stiffness / max(len(rest.F), 1)
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

    def commit_creases(self) -> None:
        """Make the plastic flow at the current positions permanent."""
        if self.creases:
            self.creases.commit_flow(angles_and_gradients(self.U, self.hinges.corners)[0])
            self._found = None

    @property
    def energy(self) -> float:
        """Energy of the current positions."""
        stretched, bent, _ = self._energies_and_gradient
        E = stretched + bent
        if len(self.soft.ids):
            away = self.U[self.soft.ids] - self._targets[len(self.fixed) :]
            E += 2.0 * parallel_ops.inner_product(self.spring_constants, (away * away).sum(axis=1))
        return E

    @property
    def _energies_and_gradient(self) -> tuple[float, float, np.ndarray]:
        if self._found is None:
            self._found = self._energies_and_gradient_at(self.U)
        return self._found

    def _energies_and_gradient_at(self, U: np.ndarray) -> tuple[float, float, np.ndarray]:
        """Energies of stretching and of bending, and the gradient (n, 3) of both."""
        angles, J = angles_and_gradients(U, self.hinges.corners)
        angles = self.hinges.nearest_to_rest(angles)
        stretched, g, stretching_moments = self.stretching.energy_and_gradient(U, angles)
        stretched += self._collapse_weight * self.rest.area_penalty.energy(U)
        g += self._collapse_weight * self.rest.area_penalty.gradient(U)
        bent, moments = self.hinges.moments(angles)
        square = self._thickness**2
        g += self.hinges.gradient(square * moments + stretching_moments, J)
        return stretched, square * bent, g

    @property
    def stretching_fraction(self) -> float:
        """Fraction of the energy of the current positions due to stretching, 0 to 1."""
        stretched, bent, _ = self._energies_and_gradient
        return stretched / (stretched + bent) if stretched + bent > 0.0 else 0.0

    def attach_springs(self, targets: np.ndarray) -> None:
        """Attach springs to soft vertices, at ``targets`` (k + s, 3) after the held ones."""
        self._targets = targets

    def residual(self, targets: np.ndarray) -> np.ndarray:
        """A quarter of the gradient on the free vertices, (f, 3)."""
        self.attach_springs(targets)
        return self._quarter_gradient(self.U, self._energies_and_gradient[2], targets)

    def residual_at(self, U: np.ndarray, targets: np.ndarray) -> np.ndarray:
        """Residual at ``U`` (n, 3); the current positions are unchanged."""
        return self._quarter_gradient(U, self._energies_and_gradient_at(U)[2], targets)

    def _quarter_gradient(self, U: np.ndarray, g: np.ndarray, targets: np.ndarray) -> np.ndarray:
        residual = 0.25 * parallel_ops.gathered_rows(g, self.free)
        if len(self.soft.ids):
            away = U[self.soft.ids] - targets[len(self.fixed) :]
            np.add.at(residual, self.place[self.soft.ids], self.spring_constants[:, None] * away)
        return residual

    @cached_property
    def couplings(self) -> sp.csr_array:
        """Nonzero pattern (f, f) of the Hessian."""
        hinges, flat, n = self.hinges, self.stretching, len(self.U)
        bent = np.ones(len(hinges.Q.data), np.float32), hinges.Q.indices, hinges.Q.indptr
        coupled = sp.csr_array(bent, shape=hinges.Q.shape)
        of_hinges = _incidence(hinges.corners, n)
        of_arcs = (flat.arcs != 0.0).astype(np.float32) @ of_hinges
        of_triangles = _incidence(self.rest.F, n) + _incidence(hinges.edge_of, len(hinges.edges)) @ of_arcs
        pattern = of_hinges.T @ coupled @ of_hinges + of_triangles.T @ of_triangles
        return pattern.tocsr()[self.free][:, self.free]

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
        angles, square, patch = hinges.nearest_to_rest(angles), self._thickness**2, flat.patch
        bent, mixed, strains, moments = flat.second_derivatives(U, angles, share)
        moments += square * hinges.moments(angles)[1]
        # Coordinates of the wall are the angles of its hinges, then the squared lengths of its edges.
        M = sp.block_array(
            [[square * hinges.stiffness_at(angles) + bent, mixed.T], [mixed, None]], format="csr"
        )
        corners = np.concatenate([hinges.corners, hinges.edges[:, [0, 1, 0, 0]]])
        J = np.concatenate([J, flat.edge_gradients(U)])
        triangles = (
            patch.F,
            patch.start,
            patch.corner,
            flat.hats,
            flat.areas,
            *flat.lame,
            strains,
            flat.relaxed,
        )
        inner = corners, *hinges.at_vertices, M.indptr, M.indices, M.data, J, moments
        rows = self.free, self.rows, pattern.start, pattern.column
        blocks = wall_blocks(U, *triangles, tensions, pressure, *inner, share, *rows)
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
    hinges : Hinges
    material : Material
        With a thickness.

    Attributes
    ----------
    hats : (m, 3, 2) float array
        Gradients of the hat functions in each triangle's plane; zero for those that do not count.
    areas : (m,) float array
        Times thickness and modulus over their means.
    lame : tuple of float
        lambda and mu.
    relaxed : bool
        True for a tension field, see :mod:`tension_field`.
    arcs : (e, h) csr_array
        From the angles of the hinges to the square roots of what arcs add to the squared lengths of edges.
    """

    def __init__(self, V: np.ndarray, patch: Patch, hinges: Hinges, material: Material) -> None:
        self.patch, self._hinges = patch, hinges
        self.hats, areas = _plane_hats(V, patch.F, is_well_shaped(cotangents(V, patch.F)))
        self.areas = material.thickness_factors * material.young_factors * areas
        firm, poisson = material.tensile_stiffness, material.poisson
        self.lame = lame, mu = firm * poisson / (1.0 - poisson**2), firm / (2.0 * (1.0 + poisson))
        # Strains, and stresses times area, by the squared lengths of the edges.
        (a, b), (c, d) = np.moveaxis(self.hats, 2, 0), np.moveaxis(self.hats[:, [1, 2, 0]], 2, 0)
        self._strains = -0.5 * np.stack([a * c, b * d, 0.5 * (a * d + b * c)], axis=1)
        law = np.diag([2.0 * mu, 2.0 * mu, 4.0 * mu])
        law[:2, :2] += lame
        firmness = np.einsum("t,tax,ab,tby->txy", self.areas, self._strains, law, self._strains)
        at, count = hinges.edge_of, len(hinges.edges)
        places = np.repeat(at, 3, axis=1).ravel(), np.tile(at, 3).ravel()
        self._firmness = sp.coo_array((firmness.ravel(), places), shape=(count, count)).tocsr()
        self.relaxed = material.is_relaxed
        # Wrinkles take up what the chords of arcs lack.
        self.arcs = (0.0 if self.relaxed else 1.0) * _arcs(V, hinges, material)
        self.arcs.eliminate_zeros()
        self._to_hinges = self.arcs.T.tocsr()
        self._at_rest = (self.arcs @ hinges.rest) ** 2

    def energy_and_gradient(self, U: np.ndarray, angles: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
        """Energy at ``U`` (n, 3), gradient (n, 3) and derivatives by ``angles`` (h,)."""
        patch, roots = self.patch, self.arcs @ angles
        energy, forces, pulls = self._stressed(U, roots)
        moments = self._to_hinges @ (2.0 * pulls * roots)
        return energy, _corner_sums(patch.start, patch.corner, self.hats, forces), moments

    def _stressed(self, U: np.ndarray, roots: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
        """Energy, forces of :func:`_stresses`, and derivatives (e,) by squared lengths."""
        at, triangles = self._hinges.edge_of, (self.patch.F, self.hats, self.areas, *self.lame)
        longer = roots * roots - self._at_rest
        energy, forces, pulls = _stresses(U, *triangles, at, self._strains, longer, self.relaxed)
        return energy, forces, np.bincount(at.ravel(), pulls.ravel(), minlength=len(roots))

    def second_derivatives(
        self, U: np.ndarray, angles: np.ndarray, share: float
    ) -> tuple[sp.csr_array, sp.csr_array, np.ndarray, np.ndarray]:
        """Second derivatives of the energy, so far as arcs cause them.

        Those by pairs of angles (h, h) and by squared lengths and angles (e, h), with ``share`` of what may
        not be positive, then strains (m, 3) of the arcs and derivatives (h,) by the angles.
        """
        roots = self.arcs @ angles
        pulls = self._stressed(U, roots)[2]
        lengthened = sp.diags_array(2.0 * roots) @ self.arcs
        mixed = self._firmness @ lengthened
        pulling = sp.diags_array(2.0 * np.where(pulls < 0.0, share * pulls, pulls))
        bent = lengthened.T @ mixed + self._to_hinges @ (pulling @ self.arcs)
        strains = np.einsum(
            "tax,tx->ta", self._strains, (roots * roots - self._at_rest)[self._hinges.edge_of]
        )
        return bent, mixed, strains, self._to_hinges @ (2.0 * pulls * roots)

    def edge_gradients(self, U: np.ndarray) -> np.ndarray:
        """Gradients (e, 4, 3) of squared lengths by the ends; two of four are zero."""
        edges = self._hinges.edges
        out = np.zeros((len(edges), 4, 3))
        out[:, 1] = 2.0 * (U[edges[:, 1]] - U[edges[:, 0]])
        out[:, 0] = -out[:, 1]
        return out


def _arcs(V: np.ndarray, hinges: Hinges, material: Material) -> sp.csr_array:
    """See :class:`Stretching`."""
    edges, at = hinges.edges, hinges.edge_of
    squares = ((V[edges[:, 1]] - V[edges[:, 0]]) ** 2).sum(axis=1)
    sums = np.bincount(at.ravel(), np.repeat(squares[at].sum(axis=1), 3), minlength=len(edges))
    count = np.bincount(at.ravel(), minlength=len(edges))
    mean = (sums - (count - 1.0) * squares) / (2.0 * count + 1.0)
    factors = np.broadcast_to(material.thickness_factors, len(at))
    thickness = material.thickness * np.bincount(at.ravel(), np.repeat(factors, 3), len(edges)) / count
    share = np.maximum(squares - _EVEN * mean, 0.0) / (1.0 + (squares / (_FOLDS * thickness) ** 2) ** 2)
    arcs = (sp.diags_array(np.sqrt(share / 12.0)) @ hinges.arc_angles).tocsr()
    arcs.eliminate_zeros()
    return arcs


def _incidence(at: np.ndarray, count: int) -> sp.csr_array:
    """Pattern (k, count) with the columns ``at`` (k, c) in the rows."""
    rows = np.repeat(np.arange(len(at)), at.shape[1])
    return sp.coo_array((np.ones(at.size, np.float32), (rows, at.ravel())), shape=(len(at), count)).tocsr()


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
    U: np.ndarray,
    F: np.ndarray,
    hats: np.ndarray,
    areas: np.ndarray,
    lame: float,
    mu: float,
    edge_of: np.ndarray,
    strains: np.ndarray,
    longer: np.ndarray,
    relaxed: bool,
) -> tuple[float, np.ndarray, np.ndarray]:
    """Energy, area times ``D S`` of every triangle (m, 3, 2), and derivatives (m, 3).

    S is the stress. The derivatives are those by the squared lengths of the triangle's edges, which arcs make
    ``longer`` (e,) by so much.
    """
    count = (len(F) + _PORTION - 1) // _PORTION
    energies, forces, pulls = np.zeros(count), np.empty((len(F), 3, 2)), np.zeros((len(F), 3))
    for portion in prange(count):
        own = 0.0
        for t in range(portion * _PORTION, min(len(F), (portion + 1) * _PORTION)):
            A, B, C = F[t, 0], F[t, 1], F[t, 2]
            D = forces[t]
            for a in range(3):
                x, y = U[B, a] - U[A, a], U[C, a] - U[A, a]
                D[a, 0] = x * hats[t, 1, 0] + y * hats[t, 2, 0]
                D[a, 1] = x * hats[t, 1, 1] + y * hats[t, 2, 1]
            area = areas[t]
            if area == 0.0:
                continue
            e00 = 0.5 * (D[0, 0] * D[0, 0] + D[1, 0] * D[1, 0] + D[2, 0] * D[2, 0] - 1.0)
            e11 = 0.5 * (D[0, 1] * D[0, 1] + D[1, 1] * D[1, 1] + D[2, 1] * D[2, 1] - 1.0)
            e01 = 0.5 * (D[0, 0] * D[0, 1] + D[1, 0] * D[1, 1] + D[2, 0] * D[2, 1])
            for k in range(3):
                added = longer[edge_of[t, k]]
                e00 += added * strains[t, 0, k]
                e11 += added * strains[t, 1, k]
                e01 += added * strains[t, 2, k]
            trace = e00 + e11
            s00, s11, s01 = lame * trace + 2.0 * mu * e00, lame * trace + 2.0 * mu * e11, 2.0 * mu * e01
            if relaxed:
                density, s00, s11, s01 = relaxed_stress(e00, e11, e01, lame, mu)
                own += area * density
            else:
                own += area * (0.5 * lame * trace * trace + mu * (e00 * e00 + e11 * e11 + 2.0 * e01 * e01))
            for k in range(3):
                stretch = s00 * strains[t, 0, k] + s11 * strains[t, 1, k]
                pulls[t, k] = area * (stretch + 2.0 * s01 * strains[t, 2, k])
            for a in range(3):
                x, y = D[a, 0], D[a, 1]
                D[a, 0], D[a, 1] = area * (x * s00 + y * s01), area * (x * s01 + y * s11)
        energies[portion] = own
    return sum_of_portions(energies), forces, pulls


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
