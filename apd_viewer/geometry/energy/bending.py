"""Bending energy: differences of deformation gradients around each vertex.

    E(U) = sum_i sum_t w_it |(D_t - mean_i D) - R_i (P_t - mean_i P)|^2,        t the triangles around i

``D_t`` (3, 3) maps vectors in the plane of triangle t at rest to the deformed one, and its normal to zero; at
rest it is the projection ``P_t = I - n_t n_t^T``. Where a surface bends, the tangent vectors of neighbouring
triangles turn against each other, and where a triangle turns over, those across the fold are reversed. A
change of mean curvature vectors [Wardetzky et al. 2007, Discrete quadratic curvature energies] says less: one
vector cannot tell a crease from its inversion. Stretching all triangles alike costs nothing.

While the rotations are held the energy is quadratic, a projective term [Bouaziz et al. 2014, Projective
Dynamics] of the second gradient [Mindlin 1964, Micro-structure in linear elasticity].
"""

import numpy as np
import scipy.sparse as sp
from numba import prange

from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.linalg.rotations import rotated_vector
from apd_viewer.geometry.linalg.threads import parallel, sum_of_portions
from apd_viewer.geometry.mesh.operators import cotangents, element_laplacian, face_areas, is_well_shaped
from apd_viewer.geometry.mesh.weighted_areas import Patch

# Cotangent above which a triangle gets less weight: its gradient changes more with a displacement, so that
# it would be stiffer than others.
_SLENDER = 2.0
# Vertices per parallel task.
_PORTION = 256


class Bending:
    """Bending energy relative to the rest shape, with a ring of triangles per vertex.

    The energy tends to the total area times the integral of the squared principal curvatures, which no
    refinement and no unit of length changes (see :func:`ring_weights`).

    Parameters
    ----------
    V : (n, 3) float array, rest positions
    patch : Patch
        The triangles. Needles do not count: their gradients are rounding.

    Attributes
    ----------
    weight : (m, 3) float array
        ``w_it`` of the corners.
    inverse : (n,) float array
        One over their sum around each vertex.
    hat_gradients : (m, 3, 3) float array
        Gradients of the hat functions of each triangle's corners.
    normals : (m, 3) float array
    mean : (n, 3, 3) float array
        Mean of ``n_t n_t^T`` around each vertex.
    per_curvature : (n,) float array
        Root of the energy of a ring whose curvature changes by 1.
    K : (n, n) csr_array
        A quarter of the energy's Hessian while the rotations are held.
    """

    def __init__(self, V: np.ndarray, patch: Patch) -> None:
        self.patch, F, n = patch, patch.F, len(V)
        cot, areas = cotangents(V, F), face_areas(V, F)
        sound = is_well_shaped(cot)
        part = np.where(sound, _SLENDER / np.maximum(np.abs(cot).max(axis=1), _SLENDER), 0.0)
        self.hat_gradients, self.normals = _hats_and_normals(V, F, np.where(sound, areas, 0.0))
        self.weight = ring_weights(V, patch, areas, part, self.normals, self.hat_gradients)
        total = np.bincount(F.ravel(), self.weight.ravel(), minlength=n)
        self.inverse = np.divide(1.0, total, out=np.zeros(n), where=total > 0.0)
        self.per_curvature = np.sqrt(areas.sum() * np.bincount(F.ravel(), np.repeat(areas / 3.0, 3), n))
        squares = (self.normals[:, :, None] * self.normals[:, None, :]).reshape(-1, 9)
        at = F.ravel().astype(np.int32), np.repeat(np.arange(len(F), dtype=np.int32), 3)
        sums = sp.coo_array((self.weight.ravel(), at), shape=(n, len(F))).tocsr() @ squares
        self.mean = (self.inverse[:, None] * sums).reshape(-1, 3, 3)
        self.K = self._matrix(cot, np.where(sound, areas, 1.0))

    def _matrix(self, cot: np.ndarray, areas: np.ndarray) -> sp.csr_array:
        """A quarter of the energy's Hessian for held rotations, (n, n)."""
        F, n = self.patch.F, len(self.inverse)
        K = element_laplacian(cot * (self.weight.sum(axis=1) / areas)[:, None], F, n)
        rows, columns = (x.ravel().astype(np.int32) for x in (np.repeat(F, 3, axis=1), np.tile(F, 3)))
        D = sp.diags_array(self.inverse)
        for axis in range(3):
            entries = (self.weight[:, :, None] * self.hat_gradients[:, None, :, axis]).ravel()
            M = sp.coo_array((entries, (rows, columns)), shape=(n, n)).tocsr()
            K = K - M.T @ D @ M
        return (0.5 * K).tocsr()

    def energy(self, U: np.ndarray, q: np.ndarray) -> float:
        """Bending energy at ``U`` (n, 3) with the rotations ``q`` (n, 4)."""
        patch, D = self.patch, gradients(U, self.patch.F, self.hat_gradients)
        rest = self.weight, self.inverse, self.mean, self.normals
        return float(_energy(patch.start, patch.corner, *rest, D, q))

    def moments(self, U: np.ndarray, scale: float) -> np.ndarray:
        """Bending part (n, 3, 3) of the local step's covariances at ``U`` (n, 3)."""
        patch, D = self.patch, gradients(U, self.patch.F, self.hat_gradients)
        return _moments(patch.start, patch.corner, self.weight, self.mean, D, scale)

    def right_hand_side(self, q: np.ndarray, scale: float) -> np.ndarray:
        """Right-hand side (n, 3) for rotations ``q`` (n, 4), times ``scale``."""
        patch = self.patch
        tensions = _tensions(patch.F, self.weight, self.mean, 0.5 * scale, q)
        return corner_sums(patch.start, patch.corner, self.hat_gradients, tensions)


def _hats_and_normals(V: np.ndarray, F: np.ndarray, areas: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Gradients of the triangles' hat functions (m, 3, 3), and normals (m, 3).

    Zero where ``areas`` (m,) are.
    """
    X, double = V[F], 2.0 * areas[:, None]
    across = np.cross(X[:, 1] - X[:, 0], X[:, 2] - X[:, 0])
    normals = np.divide(across, double, out=np.zeros_like(across), where=double > 0.0)
    hats = np.cross(normals[:, None, :], X[:, [2, 0, 1]] - X[:, [1, 2, 0]])
    double = double[:, :, None]
    return np.divide(hats, double, out=np.zeros_like(hats), where=double > 0.0), normals


@parallel(fastmath={"contract"})
def gradients(U: np.ndarray, F: np.ndarray, hat_gradients: np.ndarray) -> np.ndarray:
    """Deformation gradients ``D_t = sum_c u_c g_c^T`` (m, 3, 3) of the triangles.

    g are the gradients of the hat functions.
    """
    out = np.empty((len(F), 3, 3))
    for t in prange(len(F)):
        i, j, k = F[t, 0], F[t, 1], F[t, 2]
        for a in range(3):
            x, y = U[j, a] - U[i, a], U[k, a] - U[i, a]
            for b in range(3):
                out[t, a, b] = x * hat_gradients[t, 1, b] + y * hat_gradients[t, 2, b]
    return out


@parallel(fastmath={"contract"})
def _moments(
    start: np.ndarray, corner: np.ndarray, weight: np.ndarray, mean: np.ndarray, D: np.ndarray, scale: float
) -> np.ndarray:
    """Bending moments ``scale sum_t w_it D_t (mean_i - n_t n_t^T)``, (n, 3, 3)."""
    out = np.empty_like(mean)
    for i in prange(len(out)):
        s = np.zeros((3, 3))
        for e in range(start[i], start[i + 1]):
            t, c = corner[e] // 3, corner[e] % 3
            for a in range(3):
                for b in range(3):
                    s[a, b] += weight[t, c] * D[t, a, b]
        for a in range(3):
            x, y, z = scale * s[a, 0], scale * s[a, 1], scale * s[a, 2]
            for b in range(3):
                out[i, a, b] = x * mean[i, 0, b] + y * mean[i, 1, b] + z * mean[i, 2, b]
    return out


@parallel(fastmath={"contract"})
def _energy(
    start: np.ndarray,
    corner: np.ndarray,
    weight: np.ndarray,
    inverse: np.ndarray,
    mean: np.ndarray,
    normals: np.ndarray,
    D: np.ndarray,
    q: np.ndarray,
) -> float:
    count = (len(mean) + _PORTION - 1) // _PORTION
    energies = np.zeros(count)
    for portion in prange(count):
        for i in range(portion * _PORTION, min(len(mean), (portion + 1) * _PORTION)):
            # Reference for D_t + R_i n_t n_t^T: the ring's mean of D_t, plus R_i times that of n_t n_t^T.
            d = np.zeros((3, 3))
            for e in range(start[i], start[i + 1]):
                t, c = corner[e] // 3, corner[e] % 3
                share = inverse[i] * weight[t, c]
                for a in range(3):
                    for b in range(3):
                        d[a, b] += share * D[t, a, b]
            for b in range(3):
                x, y, z = rotated_vector(q, i, mean[i, 0, b], mean[i, 1, b], mean[i, 2, b])
                d[0, b] += x
                d[1, b] += y
                d[2, b] += z
            own = 0.0
            for e in range(start[i], start[i + 1]):
                t, c = corner[e] // 3, corner[e] % 3
                x, y, z = rotated_vector(q, i, normals[t, 0], normals[t, 1], normals[t, 2])
                change = 0.0
                for b in range(3):
                    n = normals[t, b]
                    change += (D[t, 0, b] + n * x - d[0, b]) ** 2
                    change += (D[t, 1, b] + n * y - d[1, b]) ** 2
                    change += (D[t, 2, b] + n * z - d[2, b]) ** 2
                own += weight[t, c] * change
            energies[portion] += own
    return sum_of_portions(energies)


@parallel(fastmath={"contract"})
def _tensions(F: np.ndarray, weight: np.ndarray, mean: np.ndarray, scale: float, q: np.ndarray) -> np.ndarray:
    """Tensions ``scale sum_i w_it R_i mean_i`` of the triangles t, (m, 3, 3)."""
    out = np.zeros((len(F), 3, 3))
    for t in prange(len(F)):
        for c in range(3):
            i, w = F[t, c], scale * weight[t, c]
            for b in range(3):
                x, y, z = rotated_vector(q, i, mean[i, 0, b], mean[i, 1, b], mean[i, 2, b])
                out[t, 0, b] += w * x
                out[t, 1, b] += w * y
                out[t, 2, b] += w * z
    return out


@parallel(fastmath={"contract"})
def corner_sums(
    start: np.ndarray, corner: np.ndarray, hat_gradients: np.ndarray, T: np.ndarray
) -> np.ndarray:
    """Forces ``sum_t T_t g_t`` on the vertices, (n, 3), from tensions of triangles.

    g is the gradient of the vertex's hat function.
    """
    out = np.empty((len(start) - 1, 3))
    for i in prange(len(out)):
        x = y = z = 0.0
        for e in range(start[i], start[i + 1]):
            t, c = corner[e] // 3, corner[e] % 3
            gx, gy, gz = hat_gradients[t, c, 0], hat_gradients[t, c, 1], hat_gradients[t, c, 2]
            x += T[t, 0, 0] * gx + T[t, 0, 1] * gy + T[t, 0, 2] * gz
            y += T[t, 1, 0] * gx + T[t, 1, 1] * gy + T[t, 1, 2] * gz
            z += T[t, 2, 0] * gx + T[t, 2, 1] * gy + T[t, 2, 2] * gz
        out[i, 0], out[i, 1], out[i, 2] = x, y, z
    return out


# Variance of gradients, relative to their mean square, below which it is only rounding error.
_ALIKE = 1e-9


def ring_weights(
    V: np.ndarray,
    patch: Patch,
    areas: np.ndarray,
    area_share: np.ndarray,
    normals: np.ndarray,
    hat_gradients: np.ndarray,
) -> np.ndarray:
    """Weight ``w_it`` of each triangle t in the rings of its corners i, (m, 3).

    Let u be a quadratic function of the place around vertex i, seen along the normal, and H its second
    derivatives. The weights are in proportion to ``part_t A_t``, and such that
    ``sum_t w_it |grad_t u - mean|^2 = A m_i |H|^2`` in the mean of all H, with m_i the vertex areas and A
    the total area: the sum over all vertices is A times the integral of ``|H|^2``. On equilateral triangles
    that holds for each H; on right-angled ones the directions differ by up to a half.

    Parameters
    ----------
    V : (n, 3) float array
    patch : Patch
    areas, area_share : (m,) float arrays
        Areas of the triangles, and the part of them that counts.
    normals : (m, 3) float array
    hat_gradients : (m, 3, 3) float array
        Gradients of the hat functions of each triangle's corners.
    """
    total = float(areas.sum())
    return _weights(V, patch.F, patch.start, patch.corner, areas, area_share, normals, hat_gradients, total)


@njit(cache=True, nogil=True)
def _tangents(normal: np.ndarray) -> np.ndarray:
    """Unit vectors (2, 3) perpendicular to a normal and to each other."""
    x, y, z = normal
    size = np.sqrt(x * x + y * y + z * z)
    x, y, z = (x / size, y / size, z / size) if size > 0.0 else (0.0, 0.0, 1.0)
    # Perpendicular also to the coordinate axis at the largest angle to the normal.
    a, b, c = abs(x), abs(y), abs(z)
    if a <= b and a <= c:
        u, v, w = 0.0, z, -y
    elif b <= c:
        u, v, w = -z, 0.0, x
    else:
        u, v, w = y, -x, 0.0
    size = np.sqrt(u * u + v * v + w * w)
    u, v, w = u / size, v / size, w / size
    out = np.empty((2, 3))
    out[0, 0], out[0, 1], out[0, 2] = u, v, w
    out[1, 0], out[1, 1], out[1, 2] = y * w - z * v, z * u - x * w, x * v - y * u
    return out


@parallel()
def _weights(
    V: np.ndarray,
    F: np.ndarray,
    start: np.ndarray,
    corner: np.ndarray,
    areas: np.ndarray,
    area_share: np.ndarray,
    normals: np.ndarray,
    hats: np.ndarray,
    area: float,
) -> np.ndarray:
    out = np.zeros((len(F), 3))
    for i in prange(len(V)):
        normal, m, counts = np.zeros(3), 0.0, 0.0
        for e in range(start[i], start[i + 1]):
            t = corner[e] // 3
            for a in range(3):
                normal[a] += areas[t] * normals[t, a]
            m += areas[t] / 3.0
            counts += area_share[t] * areas[t]
        if counts == 0.0:
            continue
        variance, square = _variance(
            V, F, i, corner[start[i] : start[i + 1]], areas, area_share, counts, _tangents(normal), hats
        )
        if variance > _ALIKE * square:
            scale = 3.0 * area * m / (variance * counts)
            for e in range(start[i], start[i + 1]):
                t = corner[e] // 3
                out[t, corner[e] % 3] = scale * area_share[t] * areas[t]
    return out


@njit(cache=True, nogil=True)
def _variance(
    V: np.ndarray,
    F: np.ndarray,
    i: int,
    corner: np.ndarray,
    areas: np.ndarray,
    area_share: np.ndarray,
    counts: float,
    tangents: np.ndarray,
    hats: np.ndarray,
) -> tuple[float, float]:
    """Variance and mean square of the gradients of three functions over a ring.

    The functions are orthonormal in H; ``counts`` is the area of the ring that counts.
    """
    mean, square = np.zeros((3, 3)), 0.0
    for e in range(len(corner)):
        t = corner[e] // 3
        share = area_share[t] * areas[t] / counts
        slopes = np.zeros((3, 3))
        for c in range(3):
            u = v = 0.0
            for a in range(3):
                d = V[F[t, c], a] - V[i, a]
                u += tangents[0, a] * d
                v += tangents[1, a] * d
            for a in range(3):
                slopes[0, a] += 0.5 * u * u * hats[t, c, a]
                slopes[1, a] += 0.5 * v * v * hats[t, c, a]
                slopes[2, a] += np.sqrt(0.5) * u * v * hats[t, c, a]
        for k in range(3):
            for a in range(3):
                mean[k, a] += share * slopes[k, a]
                square += share * slopes[k, a] * slopes[k, a]
    variance = square
    for k in range(3):
        for a in range(3):
            variance -= mean[k, a] * mean[k, a]
    return variance, square
