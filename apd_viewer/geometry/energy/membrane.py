"""Membrane energy: weak resistance to shear, strong resistance to area change.

A triangle's deformation gradient ``D`` (3, 2) maps its rest plane to space; its singular values
s1 >= s2 are the stretches. Two terms, each a squared distance to the nearest matrix that it would
rather see [Bouaziz et al. 2014, Projective Dynamics: Fusing Constraint Projections for Fast Simulation]:

    E = sum_t A_t ( shear |D_t - R_t|^2 + area |D_t - P_t|^2 ),

``R`` the nearest with s1 = s2 = 1 (the triangle is only turned), ``P`` the nearest with s1 s2 = 1 (it may
be sheared, but keeps its area).

Its kernel has no branches, no calls and one flat array with constant strides: the compiler vectorizes over
lanes. A division or a root then takes no longer for eight triangles than for one.
"""

import numpy as np
from numba import prange

from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.linalg.rotations import quaternion_to_matrix
from apd_viewer.geometry.linalg.threads import parallel, sum_of_portions
from apd_viewer.geometry.mesh.operators import cotangents, element_laplacian, is_well_shaped
from apd_viewer.geometry.mesh.weighted_areas import Patch

# Twice the width of the widest registers: one half proceeds while the other waits for a division.
LANES = 16
# Rows of a lane: D, later T; s1, s2, p, cosine and sine of twice the angle of s1's direction, last Newton
# step, 1 for a triangle with a plane and 0 otherwise, energy.
ROWS = 14
_S1, _S2, _P, _C, _S, _STEP, _PLANE, _ENERGY = (k * LANES for k in range(6, ROWS))
# Convergence is quadratic: after so short a step only rounding errors are left.
_SHORT_STEP = 1e-8
# Ratio of stretches below which a triangle has no plane.
_FLAT = 1e-12


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def _compute_stretches(X: np.ndarray) -> None:
    """Compute the stretches of all lanes, and the start of Newton's method."""
    for i in range(LANES):
        x0, x1, x2 = X[i], X[2 * LANES + i], X[4 * LANES + i]
        y0, y1, y2 = X[LANES + i], X[3 * LANES + i], X[5 * LANES + i]
        a, b, d = x0 * x0 + x1 * x1 + x2 * x2, x0 * y0 + x1 * y1 + x2 * y2, y0 * y0 + y1 * y1 + y2 * y2
        # D^T D = m I + r [[c, s], [s, -c]]; (c, s) is the larger stretch's direction at twice its angle.
        m, h = 0.5 * (a + d), 0.5 * (a - d)
        r = np.sqrt(h * h + b * b)
        s1 = np.sqrt(m + r)
        z0, z1, z2 = x1 * y2 - x2 * y1, x2 * y0 - x0 * y2, x0 * y1 - x1 * y0
        s2 = np.sqrt(z0 * z0 + z1 * z1 + z2 * z2) / s1
        plane = s2 > _FLAT * s1
        s1, s2 = s1 if plane else 1.0, s2 if plane else 1.0
        X[_S1 + i], X[_S2 + i], X[_PLANE + i] = s1, s2, 1.0 if plane else 0.0
        X[_C + i], X[_S + i] = h / r if r > 0.0 else 1.0, b / r if r > 0.0 else 0.0
        X[_P + i] = s1 if s1 > 1.0 else 1.0


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def _newton_step(X: np.ndarray) -> None:
    """One step towards the minimiser ``p`` of ``(p - s1)^2 + (1/p - s2)^2``."""
    for i in range(LANES):
        s1, s2, p = X[_S1 + i], X[_S2 + i], X[_P + i]
        q = 1.0 / p
        q2 = q * q
        step = (p - s1 - (q - s2) * q2) / (1.0 + (3.0 * q - 2.0 * s2) * q2 * q)
        X[_P + i], X[_STEP + i] = p - step, abs(step) * q


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def _write_projections(X: np.ndarray, shear: float, area: float) -> None:
    """Write ``T = D (f1 v1 v1^T + f2 v2 v2^T)``, v the directions of the stretches."""
    for i in range(LANES):
        s1, s2, p1, plane = X[_S1 + i], X[_S2 + i], X[_P + i], X[_PLANE + i]
        p2 = 1.0 / p1
        f1, f2 = (shear + area * p1) / s1, (shear + area * p2) / s2
        mean, half = plane * (0.5 * (f1 + f2)) + (1.0 - plane) * (shear + area), plane * (0.5 * (f1 - f2))
        m00, m01, m11 = mean + half * X[_C + i], half * X[_S + i], mean - half * X[_C + i]
        for k in (0, 2, 4):
            x, y = X[k * LANES + i], X[(k + 1) * LANES + i]
            X[k * LANES + i], X[(k + 1) * LANES + i] = x * m00 + y * m01, x * m01 + y * m11
        moved, strained = (s1 - 1.0) ** 2 + (s2 - 1.0) ** 2, (s1 - p1) ** 2 + (s2 - p2) ** 2
        X[_ENERGY + i] = plane * (shear * moved + area * strained)


@njit(cache=True, nogil=True)
def project_lanes(X: np.ndarray, shear: float, area: float) -> None:
    """Weighted projections ``T = shear R + area P`` of LANES deformation gradients D.

    Where a triangle has collapsed, T is ``(shear + area) D``: zero is a subgradient.

    Parameters
    ----------
    X : (ROWS * LANES,) float array
        Lane i has D (3, 2) in ``X[i], X[LANES + i], ...``, row by row, and T on return; in the last row then
        ``shear |D - R|^2 + area |D - P|^2``.
    """
    _compute_stretches(X)
    for _ in range(_NEWTON_STEPS):
        _newton_step(X)
        longest = 0.0
        for i in range(LANES):
            longest = max(longest, X[_STEP + i])
        if longest < _SHORT_STEP:
            break
    _write_projections(X, shear, area)


_NEWTON_STEPS = 20
# Triangles per parallel task.
_PORTION = 32 * LANES


@njit(inline="always")
def larger_stretch(s1: float, s2: float) -> float:
    """Minimiser ``p >= 1`` of ``(p - s1)^2 + (1/p - s2)^2``, for s1 >= s2 >= 0."""
    # From this start Newton's method converges monotonically: the second derivative stays positive.
    p = max(s1, 1.0)
    for _ in range(_NEWTON_STEPS):
        q = 1.0 / p
        slope = p - s1 - (q - s2) * q * q
        step = slope / (1.0 + (3.0 * q - 2.0 * s2) * q * q * q)
        p -= step
        # Convergence is quadratic: after so short a step only rounding errors are left.
        if abs(step) < 1e-8 * p:
            break
    return p


# Inlined: a call would update the reference counts of all arrays for every triangle.
@njit(inline="always")
def _load(X: np.ndarray, lane: int, t: int, F: np.ndarray, rest: np.ndarray, U: np.ndarray) -> None:
    """Write the deformation gradient of triangle ``t`` into a lane."""
    x1, x2, y2 = rest[t, 0], rest[t, 1], rest[t, 2]
    i, j, k = F[t, 0], F[t, 1], F[t, 2]
    for a in range(3):
        x = (U[j, a] - U[i, a]) / x1
        # Ignored triangles, with x1 = 0, need finite values.
        X[2 * a * LANES + lane] = x if x1 != 0.0 else 0.0
        X[(2 * a + 1) * LANES + lane] = (U[k, a] - U[i, a] - x * x2) / y2 if x1 != 0.0 else 0.0


@njit(inline="always")
def _store(X: np.ndarray, lane: int, t: int, rest: np.ndarray, cot: np.ndarray, forces: np.ndarray) -> None:
    """Write the corner forces of triangle ``t``, from a lane's T."""
    x1, x2, y2 = rest[t, 0], rest[t, 1], rest[t, 2]
    # Corners at (0, 0), (x1, 0), (x2, y2); edge forces are weighted by the opposite cotangents.
    ci, cj, ck = 0.25 * cot[t, 0], 0.25 * cot[t, 1], 0.25 * cot[t, 2]
    for a in range(3):
        x, y = X[2 * a * LANES + lane], X[(2 * a + 1) * LANES + lane]
        ij, ik, jk = ck * x * x1, cj * (x * x2 + y * y2), ci * (x * (x2 - x1) + y * y2)
        forces[3 * t, a], forces[3 * t + 1, a], forces[3 * t + 2, a] = -ij - ik, ij - jk, ik + jk


@parallel(error_model="numpy", fastmath={"contract"})
def _forces(
    F: np.ndarray,
    rest: np.ndarray,
    cot: np.ndarray,
    U: np.ndarray,
    shear: float,
    area: float,
    forces: np.ndarray,
) -> float:
    """Write a quarter of the projections' corner forces; return the energy."""
    count = (len(F) + _PORTION - 1) // _PORTION
    energies = np.empty(count)
    for portion in prange(count):
        X, sum_ = np.zeros(ROWS * LANES), 0.0
        for first in range(portion * _PORTION, min(len(F), (portion + 1) * _PORTION), LANES):
            lanes = min(LANES, len(F) - first)
            for lane in range(lanes):
                _load(X, lane, first + lane, F, rest, U)
            project_lanes(X, shear, area)
            for lane in range(lanes):
                t = first + lane
                _store(X, lane, t, rest, cot, forces)
                sum_ += 0.5 * rest[t, 0] * rest[t, 2] * X[(ROWS - 1) * LANES + lane]
        energies[portion] = sum_
    return sum_of_portions(energies)


@parallel()
def _vertex_sums(start: np.ndarray, corner: np.ndarray, forces: np.ndarray) -> np.ndarray:
    """Sums (n, 3) of the corner ``forces`` (3 m, 3) at every vertex."""
    out = np.empty((len(start) - 1, 3))
    for i in prange(len(out)):
        x = y = z = 0.0
        for e in range(start[i], start[i + 1]):
            c = corner[e]
            x += forces[c, 0]
            y += forces[c, 1]
            z += forces[c, 2]
        out[i, 0], out[i, 1], out[i, 2] = x, y, z
    return out


@parallel()
def _rotate_forces(F: np.ndarray, turns: np.ndarray, forces: np.ndarray) -> None:
    """Rotate each triangle's ``forces`` (3 m, 3) by its first corner's ``turns``."""
    for portion in prange((len(F) + _PORTION - 1) // _PORTION):
        R = np.empty((3, 3))
        for t in range(portion * _PORTION, min(len(F), (portion + 1) * _PORTION)):
            quaternion_to_matrix(turns[F[t, 0]], R)
            for c in range(3):
                x, y, z = forces[3 * t + c, 0], forces[3 * t + c, 1], forces[3 * t + c, 2]
                for a in range(3):
                    forces[3 * t + c, a] = R[a, 0] * x + R[a, 1] * y + R[a, 2] * z


class Membrane:
    """Membrane energy of a surface, with its triangles' rest shapes in the plane.

    Parameters
    ----------
    V : (n, 3) float array, rest positions
    patch : Patch
        The triangles.
    shear, area : float
        Weights of the two terms.

    Attributes
    ----------
    patch : Patch
    rest : (m, 3) float array
        The triangles' corners in their rest planes, (0, 0), (x1, 0) and (x2, y2), as ``x1, x2, y2``; x1 is 0
        for slivers, which do not count.
    K : (n, n) csr_array
        A quarter of the Hessian of the energy while the projections are held; positive semi-definite.
    energy : float
        At the positions of the last local step.
    """

    def __init__(self, V: np.ndarray, patch: Patch, shear: float, area: float) -> None:
        self.shear, self.area = shear, area
        self.patch, F = patch, patch.F
        self._cot = cotangents(V, F)
        e, f = V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]]
        x1 = np.linalg.norm(e, axis=1)
        # Deformation gradients of needles are rounding errors; the ARAP cells still hold needles together.
        usable = is_well_shaped(self._cot)
        x1 = np.where(usable, x1, 0.0)
        x2 = np.divide((e * f).sum(axis=1), x1, out=np.zeros_like(x1), where=usable)
        y2 = np.divide(np.linalg.norm(np.cross(e, f), axis=1), x1, out=np.ones_like(x1), where=usable)
        self.rest = np.column_stack([x1, x2, y2])
        self._cot[~usable] = 0.0
        self._forces = np.empty((3 * len(F), 3))
        self.local_step(V)
        self.K = 0.5 * (shear + area) * element_laplacian(self._cot, F, len(V))

    def local_step(self, U: np.ndarray) -> None:
        """Compute the projections at ``U`` (n, 3)."""
        weights = self.shear, self.area
        self.energy = float(_forces(self.patch.F, self.rest, self._cot, U, *weights, self._forces))

    def rotate_projections(self, rotations: np.ndarray) -> None:
        """Rotate the projections by unit quaternions ``rotations`` (n, 4) at the vertices."""
        _rotate_forces(self.patch.F, rotations, self._forces)

    def right_hand_side(self) -> np.ndarray:
        """Right-hand side ``b`` (n, 3) of the projections: ``grad E = 4 (K U - b)``."""
        return _vertex_sums(self.patch.start, self.patch.corner, self._forces)
