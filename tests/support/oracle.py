"""ARAP and the paper's method once more, naively: loops, SVD, dense linear algebra; nothing shared."""

import numpy as np


def edges_of(V, F):
    """Every directed edge (i, j) with its weight, each cotangent clamped by itself."""
    w = {}
    for f in F:
        for c in range(3):
            k, i, j = int(f[c]), int(f[(c + 1) % 3]), int(f[(c + 2) % 3])
            a, b = V[i] - V[k], V[j] - V[k]
            half = max(0.0, a @ b / np.linalg.norm(np.cross(a, b))) / 2
            w[i, j] = w.get((i, j), 0.0) + half
            w[j, i] = w.get((j, i), 0.0) + half
    return w


def best_rotations(V, U, w):
    S = np.zeros((len(V), 3, 3))
    for (i, j), weight in w.items():
        S[i] += weight * np.outer(U[i] - U[j], V[i] - V[j])
    A, _, Bt = np.linalg.svd(S)
    A[:, :, 2] *= np.sign(np.linalg.det(A @ Bt))[:, None]
    return A @ Bt


def energy(V, U, w, R=None):
    """Eq. 1: every undirected edge twice, once with the rotation of either end."""
    R = best_rotations(V, U, w) if R is None else R
    return sum(weight * np.sum((U[i] - U[j] - R[i] @ (V[i] - V[j])) ** 2) for (i, j), weight in w.items())


def normal_equations(V, w, R):
    """L and b, such that the energy's gradient is 4 (L U - b)."""
    L, b = np.zeros((len(V), len(V))), np.zeros((len(V), 3))
    for (i, j), weight in w.items():
        L[i, i] += weight
        L[i, j] -= weight
        b[i] += weight / 2 * (R[i] + R[j]) @ (V[i] - V[j])
    return L, b


def solve_held(A, rhs, fixed, targets):
    free = np.setdiff1d(np.arange(len(A)), fixed)
    X = np.empty((len(A), 3))
    X[fixed] = targets
    X[free] = np.linalg.solve(A[np.ix_(free, free)], rhs[free] - A[np.ix_(free, fixed)] @ targets)
    return X


def arap_iteration(V, w, R, fixed, targets):
    """Global step, then local step."""
    U = solve_held(*normal_equations(V, w, R), fixed, targets)
    return U, best_rotations(V, U, w)


def arap(V, F, fixed, targets, iterations):
    """So many iterations from the rest pose."""
    w, R = edges_of(V, F), np.tile(np.eye(3), (len(V), 1, 1))
    for _ in range(iterations):
        U, R = arap_iteration(V, w, R, fixed, targets)
    return U


def areas(U, F):
    return np.linalg.norm(np.cross(U[F[:, 1]] - U[F[:, 0]], U[F[:, 2]] - U[F[:, 0]]), axis=1) / 2


def paper(V, F, base, handle, asked, iterations, a_round=20, tolerance=1e-3, kappa=1.0):
    """Li & Hui: Eq. 2, 6, 8 and the blend of Eq. 9 at the end of every round and of the last iteration.

    Returns the shape and the positions of the handle.
    """
    w, fixed, h = edges_of(V, F), np.concatenate([base, handle]), asked
    R, rest_area = np.tile(np.eye(3), (len(V), 1, 1)), areas(V, F).sum()
    m = np.bincount(F.ravel(), np.repeat(areas(V, F) / 3, 3))
    M = np.diag(m / m.mean())
    for k in range(1, iterations + 1):
        U, R = arap_iteration(V, w, R, fixed, np.vstack([V[base], h]))
        if k % a_round and k < iterations:
            continue
        s = np.sqrt(rest_area / areas(U, F).sum())
        B_c, H_c = V[base].mean(axis=0), h.mean(axis=0)
        c, moved_h = B_c + s * (U - B_c), h + (s - 1) * (H_c - B_c)
        L, b = normal_equations(V, w, R)
        shape = solve_held(M + kappa * L, M @ c + kappa * b, fixed, np.vstack([V[base], moved_h]))
        if abs(areas(shape, F).sum() / rest_area - 1) > tolerance:
            h = moved_h
    return shape, moved_h
