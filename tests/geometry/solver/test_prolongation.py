"""The motion of a coarse surface on the fine one: exact where it can be, and smooth."""

import numpy as np
import pytest
from meshes import rotation, sphere
from remote_factor_double import Elsewhere

from apd_viewer.geometry.energy import solve_mesh
from apd_viewer.geometry.energy.solve_mesh import SolveMesh
from apd_viewer.geometry.mesh.prolongation import Prolongation
from apd_viewer.geometry.solver.deformation import Deformation

SPHERE, F = sphere(5)
V = SPHERE * [1.0, 1.0, 2.0]
Z = V[:, 2] / 4.0 + 0.5
FIXED = np.flatnonzero((Z < 0.15) | (Z > 0.85))


@pytest.fixture(scope="module")
def thinning():
    return SolveMesh(V, F).decimation


@pytest.fixture(scope="module")
def prolongation(thinning):
    return Prolongation(V, thinning.vertices, thinning.F, thinning.nearest)


def angles(U, F):
    """Angles between the normals of neighbouring triangles."""
    N = np.cross(U[F[:, 1]] - U[F[:, 0]], U[F[:, 2]] - U[F[:, 0]])
    N /= np.linalg.norm(N, axis=1, keepdims=True)
    edge = np.sort(F[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    a, b = np.argsort(edge[:, 0] * len(U) + edge[:, 1], kind="stable").reshape(-1, 2).T // 3
    return 2.0 * np.arcsin(np.linalg.norm(N[a] - N[b], axis=1) / 2.0)


def test_prolongation_carries_rigid_motions_exactly(prolongation, thinning):
    R, shift, X = rotation([1, 2, 3], 0.8), np.array([0.3, -0.2, 1.0]), V[thinning.vertices]
    q = np.tile([np.cos(0.4), *np.sin(0.4) * np.array([1, 2, 3]) / np.sqrt(14)], (len(X), 1))
    is_held = np.isin(thinning.vertices, FIXED)
    U = prolongation.moved_positions(V, X, q, X @ R.T + shift - X, is_held)
    assert np.abs(U - V @ R.T - shift).max() <= 1e-6


def test_prolongation_interpolates_and_gathers_by_transposed_weights(prolongation, thinning):
    rng, rows = np.random.default_rng(0), np.arange(0, len(V), 3)
    x, b = rng.normal(size=(len(thinning.vertices), 3)), rng.normal(size=(len(rows), 3))
    there = (prolongation.prolonged_values(x, rows) * b).sum()
    assert there == pytest.approx((x * prolongation.restricted_values(b, rows)).sum(), rel=1e-10)
    ones = prolongation.prolonged_values(np.ones_like(x), rows)
    assert np.abs(ones - 1.0).max() <= 1e-6


@pytest.mark.night
def test_prolongation_gives_previews_of_a_stiff_surface_no_dents(monkeypatch):
    """Rotations blended from the four nearest coarse vertices made it 5 times as rough as at rest."""
    ball, faces = sphere(6)
    V = ball * [1.0, 1.0, 2.0]
    fixed = np.flatnonzero(np.abs(V[:, 2]) > 1.4)
    targets = V[fixed].copy()
    above = targets[:, 2] > 0.0
    targets[above] = targets[above] @ rotation([0, 0, 1], np.radians(10.0)).T
    monkeypatch.setattr(Elsewhere, "there", False)
    solver = Deformation(V, faces, fixed, stiffness=1e-3, factored=Elsewhere)
    solver.aim(targets)
    most = 2.0 * angles(V, faces).max()
    while solver.ready:
        frame = solver.step()
        assert np.array_equal(frame.U[fixed], targets)
        assert abs(frame.area_error) <= 1e-10
        assert angles(frame.U, faces).max() <= most


@pytest.mark.night
def test_preview_of_a_stiff_surface_is_as_smooth_at_first_as_at_last(monkeypatch):
    """By the coarse surface: rotations of the level below left its angles with nearly twice the change."""
    ball, faces = sphere(6)
    V = ball * [1.0, 1.0, 2.0]
    fixed = np.flatnonzero(np.abs(V[:, 2]) > 1.68)
    targets = V[fixed] + np.outer(V[fixed, 2] > 0.0, [0.0, 0.0, 0.04])
    monkeypatch.setattr(Elsewhere, "there", False)
    solver = Deformation(V, faces, fixed, stiffness=1e-3, factored=Elsewhere)
    solver.aim(targets)
    coarse, changes = solver.solver.inner.coarse, []
    rest = angles(V[coarse.vertices], coarse.F)
    while solver.ready:
        assert np.array_equal(solver.step().U[fixed], targets)
        changes.append(np.sqrt(((angles(coarse.shapes()[0], coarse.F) - rest) ** 2).mean()))
    assert max(changes) <= 1.1 * changes[-1]


@pytest.mark.parametrize("motion", ["pulled", pytest.param("twisted", marks=pytest.mark.night)])
def test_prolongation_gives_previews_no_crease_along_the_border_of_what_is_held(motion, monkeypatch):
    """Four fine edges to a coarse one: it was 3.6 and 3.8 times as sharp as at rest."""
    monkeypatch.setattr(solve_mesh, "MOST_COARSE_VERTICES", 2_560)
    monkeypatch.setattr(Elsewhere, "there", False)
    ball, faces = sphere(6)
    V = ball * [1.0, 1.0, 2.0]
    fixed = np.flatnonzero(np.abs(V[:, 2]) > 1.68)
    targets, above = V[fixed].copy(), V[fixed, 2] > 0.0
    if motion == "pulled":
        targets[above, 2] += 0.04
    else:
        targets[above] = targets[above] @ rotation([0, 0, 1], np.radians(30.0)).T
    solver, rest = Deformation(V, faces, fixed, stiffness=1e-3, factored=Elsewhere), angles(V, faces)
    solver.aim(targets)
    while solver.ready:
        frame = solver.step()
        assert np.array_equal(frame.U[fixed], targets)
        assert abs(frame.area_error) <= 1e-10
        assert (angles(frame.U, faces) / rest).max() <= 3.0
