"""Tension field: a membrane that wrinkles finer than its mesh.

Of all wrinkles within a triangle the best ones leave it no compressive stress [Pipkin 1986, The relaxed
energy density for isotropic elastic membranes]. With the principal strains ``e >= f``, Young's modulus times
thickness C and Poisson's ratio nu, a unit of area has the energy

    that of the material     if it is taut, f + nu e >= 0,
    C e^2 / 2                if it is wrinkled, e > 0, as in uniaxial tension along the wrinkles,
    0                        if it is slack.

This is convex in the strain, and its stress is continuous, so that the Hessian has no negative part. A small
share of the material's own energy is left everywhere, lest slack triangles be lost.
"""

import numpy as np

from apd_viewer.geometry.linalg.kernels import njit

# Share of its own energy that a membrane keeps where it is wrinkled or slack.
_LEFT = 1e-4


@njit(cache=True, nogil=True, error_model="numpy")
def _principal(e00: float, e11: float, e01: float) -> tuple[float, float, float, float]:
    """Principal values ``e >= f``, cosine and sine of twice the angle of e."""
    m, h = 0.5 * (e00 + e11), 0.5 * (e00 - e11)
    r = np.sqrt(h * h + e01 * e01)
    c, s = (h / r, e01 / r) if r > 0.0 else (1.0, 0.0)
    return m + r, m - r, c, s


@njit(cache=True, nogil=True, error_model="numpy")
def relaxed_stress(
    e00: float, e11: float, e01: float, lame: float, mu: float
) -> tuple[float, float, float, float]:
    """Energy per area and stress ``s00, s11, s01`` at a strain.

    Parameters
    ----------
    e00, e11, e01 : float
    lame, mu : float
        lambda and mu in plane stress.
    """
    trace = lame * (e00 + e11)
    s00, s11, s01 = trace + 2.0 * mu * e00, trace + 2.0 * mu * e11, 2.0 * mu * e01
    energy = 0.5 * (s00 * e00 + s11 * e11) + s01 * e01
    e, f, c, s = _principal(e00, e11, e01)
    if lame * (e + f) + 2.0 * mu * f >= 0.0:
        return energy, s00, s11, s01
    young = 4.0 * mu * (lame + mu) / (lame + 2.0 * mu)
    along = (1.0 - _LEFT) * young * max(e, 0.0)
    s00, s11 = _LEFT * s00 + 0.5 * along * (1.0 + c), _LEFT * s11 + 0.5 * along * (1.0 - c)
    return _LEFT * energy + 0.5 * along * max(e, 0.0), s00, s11, _LEFT * s01 + 0.5 * along * s


@njit(cache=True, nogil=True, error_model="numpy")
def relaxed_moduli(e00: float, e11: float, e01: float, lame: float, mu: float, out: np.ndarray) -> None:
    """Write derivatives (3, 3) of the stress by ``e00, e11, 2 e01``; never negative.

    Parameters
    ----------
    e00, e11, e01, lame, mu
        See :func:`relaxed_stress`.
    out : (3, 3) float array
    """
    whole = lame + 2.0 * mu
    e, f, c, s = _principal(e00, e11, e01)
    share = 1.0 if lame * (e + f) + 2.0 * mu * f >= 0.0 else _LEFT
    out[:] = 0.0
    out[0, 0] = out[1, 1] = share * whole
    out[0, 1] = out[1, 0] = share * lame
    out[2, 2] = share * mu
    if share == 1.0 or e <= 0.0:
        return
    # Uniaxial: stiff along the wrinkles, which turn towards a shear strain.
    young = (1.0 - share) * 4.0 * mu * (lame + mu) / whole
    turning = 2.0 * young * e / (e - f)
    p0, p1, p2 = 0.5 * (1.0 + c), 0.5 * (1.0 - c), 0.5 * s
    q0, q1, q2 = -0.5 * s, 0.5 * s, 0.5 * c
    _add_square(young, p0, p1, p2, out)
    _add_square(turning, q0, q1, q2, out)


@njit(cache=True, nogil=True)
def _add_square(factor: float, p0: float, p1: float, p2: float, out: np.ndarray) -> None:
    """Add ``factor p p^T`` to ``out`` (3, 3)."""
    out[0, 0] += factor * p0 * p0
    out[1, 1] += factor * p1 * p1
    out[2, 2] += factor * p2 * p2
    out[0, 1] += factor * p0 * p1
    out[0, 2] += factor * p0 * p2
    out[1, 2] += factor * p1 * p2
    out[1, 0], out[2, 0], out[2, 1] = out[0, 1], out[0, 2], out[1, 2]
