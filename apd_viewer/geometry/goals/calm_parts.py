"""Calm parts: levels of vertices by the influence of the handles' motion.

A surface that preserves only its total area compensates a stretch by shrinking everywhere, even in limbs far
from the gesture. The reach of a gesture follows from the harmonic functions h, 1 on a handle and 0 on all
other held vertices: ``|grad h|^2`` falls by powers of ten into dead ends of the surface. Each of its levels
has an area goal of its own, so that a stretch is compensated nearby. Outer levels often have several parts,
such as a belly and the legs: the largest connected part has a separate goal, since otherwise the others would
compensate its bulges. The levels depend only on the set of held vertices, not on their positions, so that
nothing jumps while a handle moves.

They are found by conjugate gradients. The preconditioner adds to Jacobi's the correction of the coarse level,
``P (P^T A P)^-1 P^T`` [Brandt 1977, Multi-level adaptive solutions to boundary-value problems].
"""

import numpy as np
from scipy.sparse import csr_array, diags_array
from scipy.sparse.linalg import LinearOperator, cg

from apd_viewer.geometry.energy.solve_mesh import SolveMesh
from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.linalg.linear_solver import LinearSolver
from apd_viewer.geometry.linalg.parallel_ops import inner_product
from apd_viewer.geometry.mesh.edges_and_components import vertex_components
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.operators import face_areas
from apd_viewer.geometry.pose.constraints import FREE, HANDLE, SoftConstraints, next_paint_sentence

# Base-10 logarithms of the relative flux. Above the first value no vertex is calm, such as in a bottle
# twisted as a whole, with half the mean flux. The other values are the centres of the levels; the last has no
# lower end.
CALM_LEVELS = (-0.5, -1.0, -2.0, -3.0, -4.0)
_LEAST_FLUX = 1e-12
# Rounding level of the integral of |grad h|^2, which is near one in any unit of length.
_ROUNDING = 1e-12
# Smallest fraction of the total area for a level to get a goal of its own.
_LEAST_SHARE = 1e-3
# Fraction of the mean area below which the gradients in a triangle are rounding errors.
_SLIVER = 1e-4
# Number of vertices above which a few two-grid steps replace a factorization of the full matrix.
LARGE = 200_000
_STEPS = 10


def calm_level_weights(
    solve_mesh: SolveMesh, held: np.ndarray, handle_of: np.ndarray, soft: SoftConstraints
) -> np.ndarray:
    """Weights (g, n) of the vertices in each calm level that has an area goal.

    Parameters
    ----------
    solve_mesh : SolveMesh
    held : (k,) int array
        Ascending.
    handle_of : (k,) int array
        For each the number of its handle, from 1; 0 is base.
    soft : SoftConstraints
        Vertices pulled along by handles.

    Returns
    -------
    (g, n) float array
        From 0 to 1; 0 in loose parts, which keep their area by themselves, and where all around is held.
    """
    levels = _hats(log_handle_flux(solve_mesh, held, handle_of, soft)) * _is_reached(solve_mesh, held)
    # The level next to the handles is not split: two goals there would conflict in a strong pull.
    found = [*levels[:1], *(part for level in levels[1:] for part in _parts(solve_mesh, level))]
    return np.array([level for level in found if _is_large_enough(solve_mesh, level)]).reshape(
        -1, len(solve_mesh.V)
    )


def _parts(solve_mesh: SolveMesh, level: np.ndarray) -> list[np.ndarray]:
    """Weights of the largest connected component of a ``level`` (n,), and the rest."""
    within = (level > 0.0)[solve_mesh.F].all(axis=1)
    number = vertex_components(solve_mesh.F[within], len(level))
    largest = number == np.argmax(np.bincount(number, level * solve_mesh.vertex_areas))
    others = level * ~largest
    return [level * largest, others] if _is_large_enough(solve_mesh, others) else [level]


def _is_large_enough(solve_mesh: SolveMesh, level: np.ndarray) -> bool:
    """True if the area of a ``level`` (n,) is large enough for a goal."""
    return bool(inner_product(level, solve_mesh.vertex_areas) >= _LEAST_SHARE * solve_mesh.vertex_areas.sum())


def calmness(mesh: Mesh, labels: np.ndarray, soft: SoftConstraints) -> np.ndarray:
    """Lack of the handles' influence (n,): 0 where they deform the surface, 1 far off.

    It is 1 beyond the last level, and NaN for held vertices and loose parts.

    Parameters
    ----------
    mesh : Mesh
    labels : (n,) int array
        See :func:`apd_viewer.geometry.pose.constraints.constraints`.
    soft : SoftConstraints
    """
    if next_paint_sentence(labels) is not None:
        return np.zeros(len(labels))
    weld = mesh.weld
    shape = SolveMesh(mesh.V[weld.first], weld.inverse[mesh.F])
    fixed = np.flatnonzero(labels != FREE)
    held, first = np.unique(weld.inverse[fixed], return_index=True)
    handle_of = np.maximum(labels[fixed[first]].astype(np.int64) - HANDLE + 1, 0)
    drawn, which = np.unique(weld.inverse[soft.ids], return_index=True)
    x = log_handle_flux(shape, held, handle_of, soft.subset(which)._replace(ids=drawn))
    return np.where(_is_free(shape, held), calmness_from_flux(x), np.nan)[weld.inverse]


def calmness_from_flux(x: np.ndarray) -> np.ndarray:
    """Calmness from flux: 0 above the first level, 1 from the last one on."""
    return np.clip((CALM_LEVELS[0] - x) / (CALM_LEVELS[0] - CALM_LEVELS[-1]), 0.0, 1.0)


def _hats(x: np.ndarray) -> np.ndarray:
    """Piecewise linear level weights (g, n) at the logarithmic flux ``x`` (n,)."""
    middles = np.array(CALM_LEVELS)[::-1]
    return np.array([np.interp(x, middles, row) for row in np.eye(len(middles))])[-2::-1]


def log_handle_flux(
    solve_mesh: SolveMesh, held: np.ndarray, handle_of: np.ndarray, soft: SoftConstraints
) -> np.ndarray:
    """Base-10 logarithm (n,) of the handles' relative harmonic flux.

    The flux at a vertex is ``|grad h|^2`` averaged over its triangles, relative to its flux-weighted mean.

    Parameters
    ----------
    solve_mesh, held, handle_of, soft
        See :func:`calm_level_weights`.
    """
    V, F, free = solve_mesh.V, solve_mesh.F, _is_free(solve_mesh, held)
    size = face_areas(V, F)
    size[size <= _SLIVER * size.mean()] = 0.0
    h = _potentials(solve_mesh, held, handle_of, soft, free)
    whole, squared, flux, around = _fluxes(V, F, size, h, free)
    if whole <= _ROUNDING:
        return np.zeros(len(V))  # no free surface connects a handle with other held vertices
    share = flux / np.maximum(around, 1e-300) * (whole / squared)
    return np.log10(np.maximum(share, _LEAST_FLUX))


def _potentials(
    solve_mesh: SolveMesh, held: np.ndarray, handle_of: np.ndarray, soft: SoftConstraints, is_free: np.ndarray
) -> np.ndarray:
    """Harmonic functions (n, h): 1 on a handle, 0 on all other held vertices."""
    n, handles = len(solve_mesh.V), np.arange(1, int(handle_of.max(initial=0)) + 1)
    h = np.zeros((n, len(handles)))
    h[held] = handle_of[:, None] == handles
    if not is_free.any() or not len(handles):
        return h
    springs, drawn = np.zeros(n), np.zeros_like(h)
    springs[soft.ids] = soft.density * solve_mesh.vertex_areas[soft.ids]
    drawn[soft.ids, soft.handle] = springs[soft.ids]
    b = drawn - solve_mesh.L @ h
    if n <= LARGE or len(solve_mesh.decimation.vertices) > n / 2:
        free = np.flatnonzero(is_free)
        matrix = (solve_mesh.L.tocsr()[free][:, free] + diags_array(springs[free])).tocsr()
        h[free] = LinearSolver(matrix, solve_mesh.V[free]).solve_refined(b[free])
        return h
    P, L, R = solve_mesh.interpolation, solve_mesh.L, solve_mesh.coarse_laplacian
    return h + solve_two_grid(L, springs, is_free, b, P, R, solve_mesh.coarse_mesh.V, _STEPS)


def _is_free(solve_mesh: SolveMesh, held: np.ndarray) -> np.ndarray:
    """Mask (n,) of the free vertices, the unknowns of the solver."""
    moves = solve_mesh.is_connected_to(held)
    moves[held] = False
    return moves


def _is_reached(solve_mesh: SolveMesh, held: np.ndarray) -> np.ndarray:
    """Mask (n,) of the corners of deformable triangles."""
    reached = np.zeros(len(solve_mesh.V), dtype=bool)
    reached[solve_mesh.F[_is_free(solve_mesh, held)[solve_mesh.F].any(axis=1)]] = True
    return reached


@njit(cache=True, nogil=True)
def _fluxes(
    V: np.ndarray, F: np.ndarray, size: np.ndarray, h: np.ndarray, free: np.ndarray
) -> tuple[float, float, np.ndarray, np.ndarray]:
    """Integrals of ``q = sum |grad h|^2`` for the functions ``h`` (n, k).

    Those of ``q`` and ``q^2`` over all triangles, of areas ``size`` (m,), and three times those of ``q`` and
    of 1 around every vertex (n,), where held triangles are left out.
    """
    whole, squared, flux, around = 0.0, 0.0, np.zeros(len(V)), np.zeros(len(V))
    for t in range(len(F)):
        if size[t] == 0.0:
            continue
        a, b, c = F[t, 0], F[t, 1], F[t, 2]
        ux, uy, uz = V[b, 0] - V[a, 0], V[b, 1] - V[a, 1], V[b, 2] - V[a, 2]
        vx, vy, vz = V[c, 0] - V[a, 0], V[c, 1] - V[a, 1], V[c, 2] - V[a, 2]
        q, double = 0.0, 2.0 * size[t]
        for k in range(h.shape[1]):
            # The gradient of h, but for a quarter turn in the plane and a division by twice the area.
            along, across = (h[b, k] - h[a, k]) / double, (h[c, k] - h[a, k]) / double
            x, y, z = across * ux - along * vx, across * uy - along * vy, across * uz - along * vz
            q += x * x + y * y + z * z
        whole += size[t] * q
        squared += size[t] * q * q
        if free[a] or free[b] or free[c]:
            for v in (a, b, c):
                flux[v] += size[t] * q
                around[v] += size[t]
    return whole, squared, flux, around


# Shift of the coarse matrix, relative to its mean diagonal entry; without it, coarse unknowns that only one
# fine vertex uses would make it singular.
_SHIFT = 1e-6


def solve_two_grid(
    L: csr_array,
    springs: np.ndarray,
    is_free: np.ndarray,
    B: np.ndarray,
    P: csr_array,
    R: csr_array,
    coarse_V: np.ndarray,
    steps: int,
) -> np.ndarray:
    """Approximate ``(L + springs)^-1 B`` by preconditioned conjugate gradients.

    Parameters
    ----------
    L : (n, n) csr_array
        Symmetric positive semi-definite.
    springs : (n,) float array
        Added to its diagonal.
    is_free : (n,) bool array
        The unknowns; all other rows and columns are left out.
    B : (n, k) float array
    P : (n, c) csr_array
        Interpolation from the coarse unknowns.
    R : (c, c) csr_array
        ``P^T L P``.
    coarse_V : (c, 3) float array
        Positions of the coarse unknowns.
    steps : int
        Each reduces the error by about a third.

    Returns
    -------
    (n, k) float array
        Zero but for the unknowns.
    """
    # With E the rows of P at the unknowns and H all others, E^T L E takes far fewer products than without R.
    others, elastic = np.flatnonzero(~is_free), np.flatnonzero(springs)
    H, S, LO = P[others], P[elastic], L[others]
    mixed = (LO @ P).T @ H
    coarse = R - mixed - mixed.T + H.T @ (LO[:, others] @ H) + S.T @ diags_array(springs[elastic]) @ S
    used = np.flatnonzero(P.T @ is_free.astype(float))
    coarse = coarse.tocsr()[used][:, used]
    coarse += diags_array(np.full(len(used), _SHIFT * coarse.diagonal().mean()))
    factor, diagonal = LinearSolver(coarse.tocsr(), coarse_V[used]), L.diagonal() + springs
    inverse = np.divide(is_free, diagonal, out=np.zeros_like(diagonal), where=is_free)

    def corrected(r: np.ndarray) -> np.ndarray:
        e = np.zeros(P.shape[1])
        e[used] = factor.solve((P.T @ r)[used, None])[:, 0]
        return is_free * (P @ e)

    A = LinearOperator(L.shape, lambda x: is_free * (L @ x + springs * x), dtype=np.float64)
    M = LinearOperator(L.shape, lambda r: inverse * r + corrected(r), dtype=np.float64)
    columns = (cg(A, b, corrected(b), rtol=0.0, maxiter=steps, M=M)[0] for b in (B.T * is_free))
    return np.column_stack(list(columns))
