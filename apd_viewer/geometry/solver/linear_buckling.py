"""Linear buckling analysis of a thin wall between two plates.

The plates close by a small distance, to which the wall responds by displacements u, linear in it. With the
distance grows the change of the Hessian, ``lambda G`` with ``G`` its derivative along u, until along a mode x

    (K + lambda G) x = 0,

and the wall may leave its shape. lambda is the deflection, and ``lambda u . K u`` the load [Bathe 2014,
Finite Element Procedures, 2nd ed.]. Real walls have imperfections and buckle earlier. Of cylinders the load
is known, and the share of it that designs count on.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigsh

from apd_viewer.errors import InputError
from apd_viewer.geometry.energy.material import Material
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.energy.wall_map import wall_map_of
from apd_viewer.geometry.energy.wall_surface import WallSurface
from apd_viewer.geometry.linalg.block_cholesky import BlockPattern
from apd_viewer.geometry.mesh.arrays import checked, checked_direction
from apd_viewer.geometry.solver.methods import DEFAULT_POISSON, wall_material
from apd_viewer.language import tr

# Stiffness of the plates, in those of the stiffest vertex.
_PLATES = 1e6
# Largest displacement for a difference of Hessians, in diagonals.
_DIFFERENCE = 1e-6
# Motions of a rigid body that move touching vertices by less do not count as moving them.
_UNMOVED = 1e-9
MOST_MODES = 50
# Of cylinders: largest radius over thickness that was tested, directions in which widths are measured, and
# least ratio of the smallest width to the largest one.
_THINNEST, _DIRECTIONS, _ROUND = 1500.0, 36, 0.9


class BucklingModes(NamedTuple):
    """Buckling modes of a wall between two plates, lowest load first.

    Attributes
    ----------
    loads : (k,) float array
        As of a press: energy per length, of a material of stiffness 1.
    deflections : (k,) float array
        How far the plates have closed then, mesh units.
    shapes : (k, n, 3) float array
        Displacements in the order of the file, the largest 1 long.

    Examples
    --------
    >>> import apd_viewer
    >>> import trimesh
    >>> tube = trimesh.creation.cylinder(1.0, 2.0, sections=24)
    >>> modes = apd_viewer.buckling_modes(tube.vertices, tube.faces, (0, 0, 1), 0.05, count=2)
    >>> modes.shapes.shape, bool(modes.loads[0] <= modes.loads[1])
    ((2, 50, 3), True)
    """

    loads: np.ndarray
    deflections: np.ndarray
    shapes: np.ndarray


@checked
def buckling_modes(
    V: np.ndarray,
    F: np.ndarray,
    axis: Sequence[float] | np.ndarray,
    wall_thickness: float | np.ndarray | None = None,
    count: int = 4,
    *,
    poisson: float = DEFAULT_POISSON,
    held: bool = False,
    weld: bool = False,
) -> BucklingModes:
    """Find the lowest buckling modes of a thin wall between two plates.

    Gas, pressure, targets, creases and contact of the walls are left out.

    Parameters
    ----------
    V, F : (n, 3) float and (m, 3) int arrays
    axis : (3,) floats
        Direction in which the plates press.
    wall_thickness, poisson, weld
        See :class:`~apd_viewer.geometry.solver.deformation.Deformation`.
    count : int
        Largest number of modes; there may be fewer.
    held : bool
        Whether vertices at the plates stick to them; by default they slide.

    Returns
    -------
    BucklingModes

    Raises
    ------
    InputError
        If the input cannot be used; the message says why.

    Examples
    --------
    >>> import apd_viewer
    >>> import trimesh
    >>> ball = trimesh.creation.icosphere(2)
    >>> modes = apd_viewer.buckling_modes(ball.vertices, ball.faces, (0, 0, 1), 0.02)
    >>> folded = ball.vertices + 0.1 * modes.shapes[0]
    """
    rest = RestMesh.from_arrays(V, F, weld)
    thickness = wall_map_of(wall_thickness, rest.V, rest.F)
    return modes_between_plates(rest, axis, wall_material(rest.diagonal, thickness, poisson), count, held)


def modes_between_plates(
    rest: RestMesh,
    axis: Sequence[float] | np.ndarray,
    material: Material,
    count: int,
    held: bool = False,
) -> BucklingModes:
    """Lowest buckling modes of a rest mesh; see :func:`buckling_modes`."""
    press = _SmallPress(rest, checked_direction(axis), material, held)
    deflections, shapes = press.lowest_modes(min(int(count), MOST_MODES))
    whole = shapes[:, rest.weld.inverse]
    whole /= np.maximum(np.linalg.norm(whole, axis=2).max(axis=1), 1e-300)[:, None, None]
    return BucklingModes(deflections * press.apparent_stiffness, deflections, whole)


class _SmallPress:
    """Linear response of a wall to plates that close by 1, and its Hessian's change.

    Attributes
    ----------
    apparent_stiffness : float
        Load of a deflection of 1.
    """

    def __init__(self, rest: RestMesh, axis: np.ndarray, material: Material, held: bool) -> None:
        self._surface = surface = WallSurface(rest.solve_mesh, np.zeros(0, dtype=int), material)
        X = surface.U[surface.free]
        couplings = surface.couplings.tocsr()
        couplings.sort_indices()
        start, column = couplings.indptr.astype(np.int64), couplings.indices.astype(np.int64)
        self._pattern, self._size = BlockPattern(X, start, column), 3 * len(X)
        height = X @ axis
        low, high = height.min(), height.max()
        if not high - low > 2.0 * material.thickness:
            raise InputError(tr("The mesh is flat along this direction; choose another one."))
        below, above = (abs(height - end) <= material.thickness for end in (low, high))
        touching = np.flatnonzero(below | above)
        stops = np.eye(3) if held else np.outer(axis, axis)
        blocks, own = self._hessian_at(surface.U), self._pattern.diagonal[touching]
        K = self._matrix(blocks)
        # The Hessian is that of a wall on soft springs, which alone resist a translation.
        self._springs = np.repeat((K @ np.tile(axis, len(X))).reshape(-1, 3) @ axis, 3)
        firm = _PLATES * float(np.abs(blocks[self._pattern.diagonal]).max())
        blocks[own] += firm * stops
        self._stopped, self._factor = self._matrix(blocks), self._pattern.factor(blocks, np.float64)
        self._rigid = _free_motions(X - X.mean(axis=0), touching, stops)
        push = np.zeros_like(X)
        push[touching] = np.where(below[touching], 0.5 * firm, -0.5 * firm)[:, None] * axis
        u = self._respond(push.ravel())
        self.apparent_stiffness = float(u @ (K @ u))
        step = _DIFFERENCE * rest.diagonal / float(np.abs(u).max())
        move = step * self._at_all_vertices(u)
        ahead, behind = (self._hessian_at(rest.solve_mesh.V + way) for way in (move, -move))
        self._change = self._matrix((ahead - behind) / (2.0 * step))

    def _at_all_vertices(self, x: np.ndarray) -> np.ndarray:
        """Displacements (n, 3) of those of the free vertices, (3f,)."""
        out = np.zeros_like(self._surface.rest.V)
        out[self._surface.free] = x.reshape(-1, 3)
        return out

    def _hessian_at(self, U: np.ndarray) -> np.ndarray:
        """Blocks of the Hessian at the positions ``U`` (n, 3)."""
        self._surface.restart(U)
        tensions = np.zeros(len(self._surface.stretching.areas))
        return 4.0 * self._surface.blocks(self._pattern, tensions, 0.0, 1.0)

    def _matrix(self, blocks: np.ndarray) -> sp.bsr_array:
        shape = self._size, self._size
        return sp.bsr_array((blocks, self._pattern.column, self._pattern.start), shape=shape).copy()

    def _without_rigid(self, x: np.ndarray) -> np.ndarray:
        x = x.ravel()
        return x - self._rigid @ (self._rigid.T @ x)

    def _respond(self, forces: np.ndarray) -> np.ndarray:
        """Displacements (3f,) by forces (3f,), without motions as a rigid body."""
        own = self._without_rigid(forces)
        x = self._factor.solve(own.reshape(-1, 3)).ravel()
        x += self._factor.solve((own - self._stopped @ x).reshape(-1, 3)).ravel()
        return self._without_rigid(x)

    def lowest_modes(self, count: int) -> tuple[np.ndarray, np.ndarray]:
        """Deflections (k,) and shapes (k, n, 3) of the lowest modes."""
        n = self._size
        count = min(count, n // 3)

        def operator(apply: Callable[[np.ndarray], np.ndarray]) -> LinearOperator:
            return LinearOperator((n, n), matvec=apply, dtype=float)

        weakened = operator(lambda x: -self._without_rigid(self._change @ self._without_rigid(x)))
        stiff = operator(lambda x: self._stopped @ x.ravel())
        first = np.random.default_rng(0).standard_normal(n)
        try:
            found, X = eigsh(
                weakened,
                count,
                stiff,
                which="LA",
                Minv=operator(self._respond),
                v0=self._respond(first),
                ncv=min(n, 2 * count + 40),
                tol=1e-6,
            )
        except ArpackNoConvergence as error:
            found, X = error.eigenvalues, error.eigenvectors
        found, X = found[found > 0.0], X[:, found > 0.0]
        deflections = (1.0 - self._springs @ X**2) / found
        order = np.argsort(deflections)
        shapes = np.array([self._at_all_vertices(x) for x in X.T[order]])
        return deflections[order], shapes.reshape(len(order), *self._surface.rest.V.shape)


def _free_motions(X: np.ndarray, touching: np.ndarray, stops: np.ndarray) -> np.ndarray:
    """Orthonormal motions (3f, r) as a rigid body that plates do not stop.

    Parameters
    ----------
    X : (f, 3) float array
        Positions about their centre.
    touching : (t,) int array
        Vertices at the plates.
    stops : (3, 3) float array
        Part of a displacement there that plates stop.
    """
    shifts = [np.broadcast_to(row, X.shape) for row in np.eye(3)]
    motions = np.stack([*shifts, *(np.cross(row, X) for row in np.eye(3))])
    basis = np.linalg.qr(motions.reshape(6, -1).T)[0]
    stopped = (basis.reshape(-1, 3, 6)[touching].transpose(0, 2, 1) @ stops).transpose(0, 2, 1)
    _, sizes, turns = np.linalg.svd(stopped.reshape(-1, 6), full_matrices=True)
    sizes = np.append(sizes, np.zeros(6 - len(sizes)))
    return basis @ turns[sizes <= _UNMOVED].T


def classical_load(material: Material) -> float:
    """Axial load at which a perfect cylinder of a thin wall buckles.

    It does not depend on the radius: ``2 pi E t^2 / sqrt(3 (1 - nu^2))`` [Timoshenko and Gere 1961, Theory of
    Elastic Stability, 2nd ed., section 11.1], in the units of a press: energy per length, of a material of
    stiffness 1.

    Parameters
    ----------
    material : Material
        Of a thin wall.
    """
    return float(4.0 * np.pi * np.sqrt(material.plate_rigidity * material.tensile_stiffness))


def knock_down_factor(slenderness: float) -> float | None:
    """Share of the classical load that designs count on; None beyond the tests.

    It is a lower bound of them, ``1 - 0.901 (1 - exp(-sqrt(R / t) / 16))`` [Weingarten, Seide and Peterson
    1968, Buckling of thin-walled circular cylinders, NASA SP-8007].

    Parameters
    ----------
    slenderness : float
        Radius over wall thickness.
    """
    if not 0.0 < slenderness < _THINNEST:
        return None
    return float(1.0 - 0.901 * (1.0 - np.exp(-np.sqrt(slenderness) / 16.0)))


def round_radius(points: np.ndarray, axis: np.ndarray) -> float | None:
    """Half the mean width of a body across an axis; None unless about round.

    Parameters
    ----------
    points : (n, 3) float array
    axis : (3,) float array
        Of length 1.
    """
    first = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    first /= np.linalg.norm(first)
    angles = np.linspace(0.0, np.pi, _DIRECTIONS, endpoint=False)
    across = np.outer(np.cos(angles), first) + np.outer(np.sin(angles), np.cross(axis, first))
    widths = np.ptp(points @ across.T, axis=0)
    is_round = widths.min() > _ROUND * widths.max()
    return 0.5 * float(widths.mean()) if is_round else None
