"""Cases with known shapes, from the elastica to the Möbius band."""

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import ellipe, ellipeinc, ellipk

from apd_viewer.geometry.analysis.self_intersections import crossings
from apd_viewer.geometry.mesh.operators import face_areas, volume
from apd_viewer.geometry.solver.convergence import Convergence
from apd_viewer.geometry.solver.deformation_result import deform
from apd_viewer.language import tr
from apd_viewer.verification.case_meshes import grid, lune, subdivided_triangles
from apd_viewer.verification.verification_case import (
    CaseQuantity,
    CaseResults,
    ResultPair,
    VerificationCase,
    mean_area_change,
)

_PLAIN_ITERATIONS = 1000
_STRICT = Convergence(energy_tolerance=1e-9)  # at 1e-7 the error of the sags is 0.02 % larger
_THIN = 1e-4  # thickness of a nearly inextensible wall, as a fraction of the size of the shape


def _shape(
    F: np.ndarray,
    path: np.ndarray,
    sides: tuple[np.ndarray, np.ndarray],
    is_plain: bool,
    thickness: float | None = None,
) -> np.ndarray:
    """Shape with base and handle, given as ``sides``, held along a path (s, n, 3).

    A wall if a thickness is given, else fabric.
    """
    held, handle = np.concatenate(sides), sides[1]
    V, targets = path[0], path[1:, held]
    if is_plain:
        return deform(V, F, held, targets[-1], "arap", _PLAIN_ITERATIONS, handle=handle).U
    return deform(
        *(V, F, held, targets, "local" if thickness is None else "wall"),
        wall_thickness=thickness,
        poisson=0.0,
        handle=handle,
        contact=False,
        convergence=_STRICT,
    ).U


def _distance(U: np.ndarray, goal: np.ndarray, free: np.ndarray, size: float) -> ResultPair:
    """RMS distance of the free vertices from their goal, relative to a size."""
    return ResultPair(0.0, float(np.sqrt(((U - goal)[free] ** 2).sum(axis=1).mean())) / size)


# Elastica

_DISTANCES, _STRIP_WIDTH = (0.75, 0.5, 0.25), 0.1


def elastica_sag(distance: float) -> float:
    """Sag of a pinned strip of length 1, its ends at a ``distance``."""
    k = brentq(lambda k: 2.0 * ellipe(k * k) / ellipk(k * k) - 1.0 - distance, 1e-6, 1.0 - 1e-12)
    return float(k / ellipk(k * k))


def _strip(n: int, is_plain: bool) -> CaseResults:
    uv, F = grid(n, max(2, round(_STRIP_WIDTH * n)))
    V = np.insert(uv * [1.0, _STRIP_WIDTH], 2, 0.0, axis=1)
    rows = np.arange(len(V)).reshape(n + 1, -1)
    shapes = [
        _shape(F, np.array([V, V * [d, 1.0, 1.0]]), (rows[0], rows[-1]), is_plain, 1.0 / 300.0)
        for d in _DISTANCES
    ]
    sags = [float(np.abs(U[rows[n // 2], 2]).mean()) for U in shapes]
    answers = [ResultPair(elastica_sag(d), sag) for d, sag in zip(_DISTANCES, sags, strict=True)]
    return CaseResults(tuple(answers), np.column_stack([_DISTANCES, sags]))


def _elastica_curve() -> np.ndarray:
    distances = np.linspace(0.2, 0.99, 80)
    return np.column_stack([distances, [elastica_sag(d) for d in distances]])


# Kresling cell

_TALL, _TURN, _SIDES = 1.6, np.pi / 6.0, 6


def kresling_height(tall: float, turn: float) -> float:
    """Height of the second shape of a hexagonal Kresling cell of radius 1."""
    other = np.pi - 2.0 * np.pi / _SIDES - turn
    return float(np.sqrt(tall**2 - 2.0 * (np.cos(turn) - np.cos(other))))


def _hexagon(height: float, turn: float) -> np.ndarray:
    angle = 2.0 * np.pi / _SIDES * np.arange(_SIDES) + turn
    return np.column_stack([np.cos(angle), np.sin(angle), np.full(_SIDES, height)])


def _kresling(n: int, is_plain: bool) -> CaseResults:
    A, B, C = _hexagon(0.0, 0.0), _hexagon(_TALL, _TURN), _hexagon(2.0 * _TALL, 0.0)
    a, b, c = (np.roll(ring, 1, axis=0) for ring in (A, B, C))
    kinds = (a, A, B), (a, B, b), (c, B, C), (c, b, B)
    V, F = subdivided_triangles(np.concatenate([np.stack(kind, axis=1) for kind in kinds]), n)
    base, top = np.flatnonzero(V[:, 2] == 0.0), np.flatnonzero(V[:, 2] == 2.0 * _TALL)
    push = 2.0 * (_TALL - kresling_height(_TALL, _TURN)) / (2.0 * _TALL)
    path = V * np.column_stack([np.ones((21, 2)), 1.0 - push * np.linspace(0.0, 1.0, 21)])[:, None]
    U = _shape(F, path, (base, top), is_plain, _THIN)
    corners = [int(np.linalg.norm(V - corner, axis=1).argmin()) for corner in B]
    turn = np.degrees(np.angle((U[corners] @ [1.0, 1j, 0.0]) / (B @ [1.0, 1j, 0.0])))
    answers = ResultPair(60.0, float(turn.mean())), ResultPair(0.0, mean_area_change(V, U, F))
    return CaseResults(answers, np.column_stack([np.arange(1, _SIDES + 1), turn]))


# Spindle of Minding

_SPINDLE = 0.75


def spindle(latitude: np.ndarray, angle: np.ndarray, k: float) -> np.ndarray:
    """Points (n, 3) of the spindle of largest radius ``k``, isometric to a sphere."""
    r = k * np.cos(latitude)
    return np.column_stack([r * np.cos(angle), r * np.sin(angle), ellipeinc(latitude, k * k)])


def spindle_volume(k: float) -> float:
    """Volume of the spindle of largest radius ``k``."""
    section = quad(lambda s: np.cos(s) ** 2 * np.sqrt(1.0 - (k * np.sin(s)) ** 2), 0.0, np.pi / 2.0)[0]
    return float(2.0 * np.pi * k**2 * section)


def _minding(n: int, is_plain: bool) -> CaseResults:
    parameters, F = lune(n, 5)
    height, across = parameters.T
    latitude, angle = np.pi / 2.0 * height, 2.0 * np.pi * _SPINDLE * (across - 0.5)
    path = np.array([spindle(latitude, angle / k, k) for k in np.linspace(1.0, _SPINDLE, 11)])
    left, right = np.flatnonzero((across == 0.0) | (np.abs(height) == 1.0)), np.flatnonzero(across == 1.0)
    U = _shape(F, path, (left, right), is_plain)
    free = np.flatnonzero((across > 0.0) & (across < 1.0) & (np.abs(height) < 1.0))
    enclosed = ResultPair(spindle_volume(_SPINDLE), abs(volume(U, F)))
    opposite = np.flatnonzero(across == 0.5)
    profile = np.column_stack([U[opposite, 2], np.linalg.norm(U[opposite, :2], axis=1)])
    return CaseResults((enclosed, _distance(U, path[-1], free, 2.0 * _SPINDLE)), profile)


def _spindle_curve() -> np.ndarray:
    points = spindle(np.linspace(-np.pi / 2.0, np.pi / 2.0, 91), np.zeros(91), _SPINDLE)
    return points[:, [2, 0]]


# Helicoid to catenoid


def bonnet(u: np.ndarray, v: np.ndarray, t: float) -> np.ndarray:
    """Points (n, 3) of isometric surfaces, helicoid (0) to catenoid (pi / 2)."""
    helicoid = np.column_stack([np.sinh(v) * np.sin(u), -np.sinh(v) * np.cos(u), u])
    catenoid = np.column_stack([np.cosh(v) * np.cos(u), np.cosh(v) * np.sin(u), v])
    found: np.ndarray = np.cos(t) * helicoid + np.sin(t) * catenoid
    return found


def _helicoid(n: int, is_plain: bool) -> CaseResults:
    uv, F = grid(3 * n, n)
    u, v = 2.0 * np.pi * uv[:, 0], 2.0 * uv[:, 1] - 1.0
    path = np.array([bonnet(u, v, t) for t in np.linspace(0.0, np.pi / 2.0, 11)])
    ids = np.arange(len(uv)).reshape(3 * n + 1, n + 1)
    # Two rows, to hold the slope as well: a free slope relaxes in a layer, with an error of order h.
    free, base = ids[2:-2, 2:-2].ravel(), ids[:2].ravel()
    U = _shape(F, path, (base, np.setdiff1d(ids, np.concatenate([free, base]))), is_plain)
    area = ResultPair(float(2.0 * np.pi + np.pi * np.sinh(2.0)), float(face_areas(U, F).sum()))
    middle = U[ids[3 * n // 2]]
    profile = np.column_stack([middle[:, 2], np.linalg.norm(middle[:, :2], axis=1)])
    return CaseResults((_distance(U, path[-1], free, 2.0), area), profile)


def _catenoid_curve() -> np.ndarray:
    z = np.linspace(-1.0, 1.0, 81)
    return np.column_stack([z, np.cosh(z)])


# Möbius band

_SHORTEST_BAND = float(np.sqrt(3.0))  # length over width of the shortest smooth band of paper
_BAND_LENGTHS, _BAND_THICKNESS, _BAND_GAP = (3.0, 1.6), 0.005, 0.02  # widths
_STRETCHED = 1e-3  # mean area change that paper cannot follow
# Rounding chooses the folds, and one choice in ten is a poor one: so the least energy of three starts counts.
_STARTS, _JITTER = 3, 1e-9


def _band_path(V: np.ndarray, length: float) -> np.ndarray:
    """Path (s, n, 3) of a strip's last row: half a turn, then an arc to the first row.

    It lies across the end of an arc as long as the middle line would be but for its ``slack``.
    """
    steps = np.linspace(0.0, 1.0, 41)
    bow, slack = 0.3, 0.75
    angle = np.concatenate([bow * steps[::4], np.full(41, bow), bow + (2.0 * np.pi - bow) * steps])
    turn = np.concatenate([np.zeros(11), np.pi * steps, np.full(41, np.pi)])
    arc = np.concatenate([1.0 - (1.0 - slack) * steps[::4], np.full(82, slack)])
    gap = np.concatenate([np.zeros(52), _BAND_GAP * steps])
    radius, zero = arc * length / np.maximum(angle, 1e-9), np.zeros_like(angle)
    middle = np.column_stack([radius * np.sin(angle) - gap, zero, radius * (1.0 - np.cos(angle))])
    normal = np.column_stack([-np.sin(angle), zero, np.cos(angle)])
    across = np.cos(turn)[:, None] * [0.0, 1.0, 0.0] + np.sin(turn)[:, None] * normal
    return middle[:, None] + V[:, 1, None] * across[:, None]


def _band(n: int, length: float, seed: int) -> tuple[float, bool, float]:
    """Energy of a half-turned band, success of joining its ends, and mean area change."""
    uv, F = grid(round(length * n), n)
    V = np.insert((uv - [0.0, 0.5]) * [length, 1.0], 2, 0.0, axis=1)
    first, last = np.flatnonzero(uv[:, 0] == 0.0), np.flatnonzero(uv[:, 0] == 1.0)
    path = _band_path(V, length)
    path[:, first] = V[first]
    held = np.concatenate([first, last])
    free = np.setdiff1d(F, held)
    V[free] += _JITTER * np.random.default_rng(seed).standard_normal((len(free), 3))
    energies: list[float] = []
    found = deform(
        *(V, F, held, path[1:, held], "wall"),
        wall_thickness=_BAND_THICKNESS,
        handle=last,
        contact=True,
        thickness=0.8 * _BAND_THICKNESS,
        progress=lambda frame: energies.append(frame.energy or 0.0),
    )
    crossed = crossings(found.U, F)
    meets = found.converged and found.share_reached == 1.0 and crossed is not None and not len(crossed)
    return energies[-1], meets, mean_area_change(V, found.U, F)


def _bands(n: int, _: bool) -> CaseResults:
    long, short = _BAND_LENGTHS
    long_meets, long_change = min(_band(n, long, seed) for seed in range(_STARTS))[1:]
    short_meets, short_change = _band(n, short, 0)[1:]
    refused = not short_meets or short_change > _STRETCHED
    answers = ResultPair(1.0, long_meets), ResultPair(0.0, long_change), ResultPair(1.0, refused)
    changes = [100.0 * long_change, 100.0 * short_change]
    return CaseResults(answers, np.column_stack([_BAND_LENGTHS, changes]))


ELASTICA = VerificationCase(
    "B",
    tr("Strip pushed together (elastica)"),
    "A. E. H. Love, A Treatise on the Mathematical Theory of Elasticity, 4th ed., 1927, § 262",
    tuple(
        CaseQuantity(tr("sag, ends at {distance:g}").format(distance=distance), 0.0005)
        for distance in _DISTANCES
    ),
    (20, 40, 80),
    _strip,
    has_plain=True,
    axes=(tr("distance of the ends / length"), tr("sag / length")),
    curve=_elastica_curve,
)
KRESLING = VerificationCase(
    "F",
    tr("Kresling cell folded"),
    "B. Kresling, Natural twist buckling in shells, Proc. IASS-IACM, 2008",
    (
        CaseQuantity(tr("turn of the middle ring, degrees"), 0.1 / 60.0),
        CaseQuantity(tr("mean area change"), 0.0001),
    ),
    (3, 6, 12),
    _kresling,
    has_plain=True,
    axes=(tr("corner of the middle ring"), tr("turn, degrees")),
    curve=lambda: np.array([[1.0, 60.0], [_SIDES, 60.0]]),
)
SPINDLE = VerificationCase(
    "G",
    tr("Slit sphere wound up (Minding)"),
    "F. Minding, Journal für die reine und angewandte Mathematik 19, 370, 1839",
    (
        CaseQuantity(tr("volume"), 0.005),
        CaseQuantity(tr("distance from the spindle, RMS / diameter"), 0.005),
    ),
    (8, 16, 32),
    _minding,
    has_plain=True,
    axes=(tr("height"), tr("radius")),
    curve=_spindle_curve,
)
CATENOID = VerificationCase(
    "H",
    tr("Helicoid bent to a catenoid (Bonnet)"),
    "M. P. do Carmo, Differential Geometry of Curves and Surfaces, 1976, § 4.2",
    (
        CaseQuantity(tr("distance from the catenoid, RMS / width"), 0.001, least_order=1.8),
        CaseQuantity(tr("area"), 0.001, least_order=1.8),
    ),
    (16, 32, 64),
    _helicoid,
    has_plain=True,
    axes=(tr("height"), tr("radius")),
    curve=_catenoid_curve,
)
MOEBIUS_BAND = VerificationCase(
    "I",
    tr("Paper Möbius band"),
    "R. E. Schwartz, arXiv:2308.12641, 2023",
    (
        CaseQuantity(tr("the ends of a band 3.0 widths long meet (1: yes)"), 0.0),
        CaseQuantity(tr("mean area change of this band"), _STRETCHED, is_chaotic=True),
        CaseQuantity(tr("1.6 widths are too short: it stretches, or does not meet (1: yes)"), 0.0),
    ),
    (10,),
    _bands,
    axes=(tr("length / width"), tr("mean area change, %")),
    curve=lambda: np.array([[_SHORTEST_BAND, 0.0], [_BAND_LENGTHS[0], 0.0]]),
)
