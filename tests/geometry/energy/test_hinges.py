"""Bending of hinges: exact for constant curvature on every triangulation, and what the limits are."""

import numpy as np
import pytest
from meshes import grid, rotation, sphere
from scipy.spatial import Delaunay

from apd_viewer.geometry.energy.hinges import Hinges, angles_and_gradients

CURVATURES = {"along x": (1, 0, 0), "along y": (0, 1, 0), "twist": (0, 0, 1), "dome": (1, 1, 0)}
POISSON, RIGIDITY = 0.3, 2.5


def irregular(n, jitter, seed=0, line=0.0):
    """Unit square, triangulated by Delaunay from displaced points of a grid, but for those on a ``line``."""
    V, _ = grid(n, n, 1 / n, 1 / n)
    inside = ((V[:, :2] > 1e-9) & (V[:, :2] < 1 - 1e-9)).all(axis=1) & (np.abs(V[:, 0] - line) > 1e-9)
    V[inside, :2] += np.random.default_rng(seed).uniform(-jitter / n, jitter / n, (inside.sum(), 2))
    F = Delaunay(V[:, :2]).simplices
    X = V[F]
    up = np.cross(X[:, 1] - X[:, 0], X[:, 2] - X[:, 0])[:, 2]
    F[up < 0] = F[up < 0][:, ::-1]
    return V, F[np.abs(up) > 1e-12]


def flattened_rows(n):
    """Unit square of rows of triangles two thirds as high as equilateral ones."""
    V, F = grid(n, 3 * n // 2, 1 / n, 2 / (3 * n))
    V[:, 0] += 0.5 / n * (np.round(V[:, 1] * 1.5 * n) % 2)
    return V, F


MESHES = {
    "squares": grid(12, 12, 1 / 12, 1 / 12),
    "flattened": flattened_rows(12),
    "irregular": irregular(12, 0.3),
    "more so": irregular(12, 0.4, 1),
}


def bent(V, curvatures, size=1e-4):
    a, b, c = curvatures
    x, y = V[:, 0], V[:, 1]
    return V + size * np.outer(0.5 * a * x * x + 0.5 * b * y * y + c * x * y, [0, 0, 1])


def energy(hinges, U):
    return hinges.moments(angles_and_gradients(U, hinges.corners)[0])[0]


def plate_energy(curvatures, size=1e-4):
    """Energy of a unit of area by the theory of Kirchhoff."""
    a, b, c = np.array(curvatures) * size
    return 0.5 * RIGIDITY * ((1 - POISSON) * (a * a + b * b + 2 * c * c) + POISSON * (a + b) ** 2)


@pytest.mark.parametrize("curvatures", CURVATURES.values(), ids=CURVATURES)
@pytest.mark.parametrize("mesh", MESHES)
def test_hinges_bend_like_a_plate_on_every_triangulation(mesh, curvatures):
    """All but the rim: there the slope across a free edge is that of least energy."""
    V, F = MESHES[mesh]
    inner = (np.abs(V[F].mean(axis=1)[:, :2] - 0.5) < 0.33).all(axis=1)
    hinges = Hinges(V, F, RIGIDITY, POISSON)
    areas = 0.5 * np.cross(V[F][:, 1] - V[F][:, 0], V[F][:, 2] - V[F][:, 0])[:, 2]
    found = hinges.triangle_energies(angles_and_gradients(bent(V, curvatures), hinges.corners)[0])
    assert found[inner].sum() == pytest.approx(areas[inner].sum() * plate_energy(curvatures), rel=2e-3)
    assert energy(hinges, bent(V, curvatures)) == pytest.approx(found.sum(), rel=1e-9)


@pytest.mark.parametrize("curvatures", CURVATURES.values(), ids=CURVATURES)
@pytest.mark.parametrize("mesh", MESHES)
def test_hinges_tell_the_curvature_along_edges(mesh, curvatures):
    """But for some at the rim with too few hinges around them, which are taken for straight."""
    V, F = MESHES[mesh]
    F = F.copy()
    F[::3] = F[::3, ::-1]
    hinges, size = Hinges(V, F, RIGIDITY, POISSON), 1e-4
    A, B = V[hinges.edges[:, 0], :2], V[hinges.edges[:, 1], :2]
    (a, b, c), (x, y) = curvatures, (B - A).T
    expected = size * np.abs(a * x * x + b * y * y + 2 * c * x * y) / np.hypot(x, y)
    found = np.abs(hinges.arc_angles @ angles_and_gradients(bent(V, curvatures, size), hinges.corners)[0])
    right = np.abs(found - expected) < 1e-3 * expected.max()
    has_hinge = np.arange(len(right)) < len(hinges.corners)
    assert right[has_hinge & ((np.abs(0.5 * (A + B) - 0.5) < 0.4).all(axis=1) | (found > 0.0))].all()
    assert right[~has_hinge].mean() > 0.5


@pytest.mark.parametrize("mixed", [False, True], ids=["wound alike", "wound differently"])
def test_hinges_bend_from_the_edge_of_a_clamp(mixed):
    """Its curvature ends at once where a wall is held flat."""
    V, F = irregular(12, 0.4, line=1 / 3)
    clamps = (V[F][:, :, 0] < 1 / 3 + 1e-9).all(axis=1)
    middle = V[F].mean(axis=1)
    inner = ~clamps & (middle[:, 0] < 0.83) & (np.abs(middle[:, 1] - 0.5) < 0.33)
    U = V + 0.5e-4 * np.outer(np.maximum(V[:, 0] - 1 / 3, 0.0) ** 2, [0, 0, 1])
    if mixed:
        F[::3] = F[::3, ::-1]
    hinges = Hinges(V, F, RIGIDITY, POISSON, clamps)
    areas = np.linalg.norm(np.cross(V[F][:, 1] - V[F][:, 0], V[F][:, 2] - V[F][:, 0]), axis=1) / 2
    found = hinges.triangle_energies(angles_and_gradients(U, hinges.corners)[0])
    assert found[inner] == pytest.approx(areas[inner] * plate_energy((1, 0, 0)), rel=1e-3)
    assert not found[clamps].any()


def test_hinges_need_no_energy_to_turn_and_have_the_gradient_of_their_energy():
    V, F = sphere(1)
    hinges, rng = Hinges(V, F, RIGIDITY, POISSON), np.random.default_rng(2)
    assert energy(hinges, V @ rotation([1, 2, 3], 2.0).T + 5.0) < 1e-24
    U, way = V + 0.1 * rng.normal(size=V.shape), rng.normal(size=V.shape)
    angles, J = angles_and_gradients(U, hinges.corners)
    along = (hinges.gradient(hinges.moments(angles)[1], J) * way).sum()
    step = 1e-6
    assert along == pytest.approx(
        (energy(hinges, U + step * way) - energy(hinges, U - step * way)) / (2 * step), rel=1e-7
    )


def test_hinges_do_not_mind_how_triangles_are_wound():
    V, F = MESHES["irregular"]
    mixed = F.copy()
    mixed[::3] = mixed[::3, ::-1]
    U = bent(V, (1.0, -0.5, 0.3), 0.1)
    one, other = (energy(Hinges(V, each, RIGIDITY, POISSON), U) for each in (F, mixed))
    assert one == pytest.approx(other, rel=1e-9)


def test_hinges_resist_every_change_of_angle():
    """Compared with plain hinges the stiffness has bounds: nothing bends for nothing."""
    V, F = MESHES["more so"]
    Q = Hinges(V, F, 1.0, POISSON).Q.toarray()
    assert np.abs(Q - Q.T).max() < 1e-12 * np.abs(Q).max()
    values = np.linalg.eigvalsh(Q)
    assert values[0] > 1e-3 * values[-1]


def test_hinges_name_the_edges_of_more_than_two_triangles():
    V = np.array([[0, 0, 0], [0, 0, 1], [1, 0, 0], [0, 1, 0], [-1, -1, 0.0]])
    hinges = Hinges(V, np.array([[0, 1, 2], [0, 1, 3], [0, 1, 4]]), 1.0, 0.0)
    assert len(hinges.corners) == 0
    assert hinges.others.tolist() == [[0, 1]]


def folded(angle):
    """Two triangles with a hinge at that angle."""
    return np.array([[0, 0, 0], [1, 0, 0], [0.5, -1, 0], [0.5, np.cos(angle), np.sin(angle)]])


PAIR = np.array([[1, 0, 2], [0, 1, 3]])


@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize("rest", [0.0, 0.5])
def test_hinges_cannot_shut(rest, side):
    """To the last the moment opens them, and it grows beyond all bounds."""
    hinges = Hinges(folded(rest), PAIR, RIGIDITY, POISSON)
    sign = np.sign(hinges.rest[0]) if rest else 1.0
    angles = side * np.pi * (1.0 - np.array([0.2, 0.11, 0.09, 0.03, 0.01, 1e-3, 1e-5]))
    energies, moments = zip(*(hinges.moments(np.array([angle])) for angle in angles), strict=True)
    moments = side * np.ravel(moments)
    assert (np.diff(energies) > 0.0).all()
    assert (np.diff(moments) > 0.0).all()
    assert moments[0] == pytest.approx(hinges.Q[0, 0] * (0.8 * np.pi - side * sign * rest), rel=1e-9)
    assert moments[-1] > 1e3 * moments[0]
    step = 1e-7
    for angle in angles[:-2]:
        there, back = (hinges.moments(np.array([angle + k * step])) for k in (1, -1))
        moment = hinges.moments(np.array([angle]))[1]
        assert moment[0] == pytest.approx((there[0] - back[0]) / (2 * step), rel=1e-5)
        change = (there[1][0] - back[1][0]) / (2 * step)
        assert hinges.stiffness_at(np.array([angle]))[0, 0] == pytest.approx(change, rel=1e-5)


def test_hinges_that_rest_shut_may_open_on_either_side():
    hinges = Hinges(folded(np.pi - 0.01), PAIR, RIGIDITY, POISSON)
    other = angles_and_gradients(folded(np.pi + 0.02), hinges.corners)[0]
    assert hinges.rest[0] * other[0] < 0.0
    assert np.abs(hinges.turned(other)) == pytest.approx(0.03, rel=1e-9)
    assert hinges.moments(other)[0] == pytest.approx(0.5 * hinges.Q[0, 0] * 0.03**2, rel=1e-9)


def test_hinges_turn_beside_triangles_with_a_corner_twice():
    """Welding leaves such triangles on inner edges, which they would open."""
    V, F = MESHES["irregular"]
    degenerate = np.column_stack([F[:20, 0], F[:20, 0], F[:20, 1]])
    alone, beside = (Hinges(V, G, RIGIDITY, POISSON) for G in (F, np.vstack([F, degenerate])))
    np.testing.assert_array_equal(np.sort(beside.corners, axis=0), np.sort(alone.corners, axis=0))
    assert not len(beside.others)
