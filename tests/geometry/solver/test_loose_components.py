"""Loose parts go along with the nearest surface as rigid bodies, or stay."""

import igl
import numpy as np
import pytest
from meshes import rotation, sphere
from scipy.spatial.distance import pdist

from apd_viewer.errors import InputError
from apd_viewer.geometry.mesh.operators import face_areas, volume
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.deformation_result import deform
from apd_viewer.geometry.solver.methods import METHODS

LONG = 6.0


def finger() -> tuple[np.ndarray, np.ndarray]:
    """A long closed body along z."""
    V, F = sphere(4)
    return V * [1.0, 1.0, LONG], F


def nail(z: float, angle: float, size: float = 0.4) -> tuple[np.ndarray, np.ndarray]:
    """A flat closed plate just above the skin of the finger."""
    V, F = sphere(2)
    V = V * [0.05 * size, 0.3 * size, 0.5 * size]
    radius = np.sqrt(1.0 - (z / LONG) ** 2)
    lean = rotation([0.0, 1.0, 0.0], np.arctan2(z / LONG, radius * LONG) * -1.0)
    V = V @ lean.T + [radius + 0.06 * size, 0.0, z]
    return V @ rotation([0.0, 0.0, 1.0], angle).T, F


def assembled(*parts):
    """Several meshes as one, and the slice of the vertices of each."""
    V, F, slices, n = [], [], [], 0
    for W, G in parts:
        V.append(W)
        F.append(G + n)
        slices.append(slice(n, n + len(W)))
        n += len(W)
    return np.vstack(V), np.vstack(F), slices


PLACES = [(-2.0, 0.3), (0.0, 2.0), (1.0, 4.0), (3.0, 5.5), (0.9 * LONG, 1.0)]
V, F, (BODY, *NAILS) = assembled(finger(), *(nail(*place) for place in PLACES))
BODY_F = F[: len(finger()[1])]
BASE, HANDLE = np.flatnonzero(V[BODY][:, 2] < -0.8 * LONG), np.flatnonzero(V[BODY][:, 2] > 0.8 * LONG)
FIXED = np.concatenate([BASE, HANDLE])
BEND = rotation([1.0, 0.0, 0.0], np.pi / 3)
PIVOT = np.array([0.0, 0.0, -2.0])
TARGETS = np.vstack([V[BASE], (V[HANDLE] - PIVOT) @ BEND.T + PIVOT])


def run(method="exact", V=V, F=F, iterations=None, **rest):
    return deform(V, F, FIXED, TARGETS, method, iterations, handle=HANDLE, **{"contact": False, **rest})


def from_skin(U: np.ndarray, part: slice) -> np.ndarray:
    """Distance of each vertex of a part from the body."""
    return np.sqrt(igl.point_mesh_squared_distance(U[part], U[BODY], BODY_F)[0])


@pytest.fixture(scope="module")
def bent():
    return run()


def test_loose_components_keep_their_distance_from_the_skin_in_a_bend_of_sixty_degrees(bent):
    for part in NAILS:
        size = np.linalg.norm(np.ptp(V[part], axis=0))
        assert np.abs(bent.U[part] - V[part]).max() > 0.5 * size, "the bend reaches it"
        before, after = from_skin(V, part), from_skin(bent.U, part)
        assert after.mean() == pytest.approx(before.mean(), abs=0.01 * size)
        assert after.min() == pytest.approx(before.min(), abs=0.01 * size)


def test_loose_components_move_rigidly(bent):
    for part in NAILS:
        np.testing.assert_allclose(pdist(bent.U[part]), pdist(V[part]), rtol=0, atol=1e-13)
        # Not turned inside out either.
        faces = nail(0.0, 0.0)[1]
        assert volume(bent.U[part], faces) == pytest.approx(volume(V[part], faces), rel=1e-12)


def test_deform_keeps_the_exact_area_and_counts_the_loose_parts(bent):
    total = face_areas(V, F).sum()
    assert bent.area_rest == pytest.approx(total, rel=1e-14)
    assert face_areas(bent.U, F).sum() == pytest.approx(total, rel=1e-10)
    assert bent.area == pytest.approx(face_areas(bent.U, F).sum(), rel=1e-12)
    assert bent.volume == pytest.approx(volume(bent.U, F), rel=1e-9)


def test_deform_counts_the_loose_parts_in_targets_too():
    result = run(iterations=5, area=104.0, volume=98.0)
    assert face_areas(result.U, F).sum() == pytest.approx(1.04 * face_areas(V, F).sum(), rel=1e-9)
    assert volume(result.U, F) == pytest.approx(0.98 * volume(V, F), rel=1e-9)


def test_deform_holds_vertices_exactly_and_says_the_loose_parts(bent):
    assert np.array_equal(bent.U[FIXED], TARGETS)
    assert bent.warnings == (
        "5 connected parts without base or handle; they go along with the nearest surface.",
    )


@pytest.mark.parametrize(("held", "is_said"), [(slice(0, 10), True), (slice(None), False)])
def test_deform_moves_a_part_with_a_handle_alone_as_a_whole_and_says_so(held, is_said):
    own = np.arange(NAILS[0].start, NAILS[0].stop)[held]
    fixed, targets = np.append(FIXED, own), np.vstack([TARGETS, V[own] + [1.0, 0.0, 0.0]])
    result = deform(V, F, fixed, targets, "arap", 200, handle=[HANDLE, own])
    np.testing.assert_allclose(pdist(result.U[NAILS[0]]), pdist(V[NAILS[0]]), rtol=0, atol=1e-6)
    (warning,) = result.warnings
    assert ("1 connected part with a handle but no base" in warning) is is_said


def test_deform_does_not_say_two_handles_on_a_part_without_base():
    fixed = np.append(FIXED, [NAILS[0].start, NAILS[0].stop - 1])
    handles = [HANDLE, fixed[-2:-1], fixed[-1:]]
    (warning,) = deform(V, F, fixed, V[fixed], "arap", 1, handle=handles).warnings
    assert "no base" not in warning


def test_loose_components_are_not_felt_by_the_body():
    alone = run("arap", V[BODY], BODY_F, 20)
    assert np.abs(run("arap", iterations=20).U[BODY] - alone.U).max() <= 1e-12


@pytest.mark.parametrize(
    "method", [name for name, each in METHODS.items() if not each.moves_handles and not each.is_wall]
)
def test_loose_components_move_rigidly_when_all_is_moved_rigidly(method):
    W = V @ rotation([1.0, 2.0, -1.0], 2.5).T + [0.3, -4.0, 2.0]
    result = deform(V, F, FIXED, W[FIXED], method, 3, handle=HANDLE)
    # Beside a handle that moved rigidly, before anything has converged.
    np.testing.assert_allclose(result.U[NAILS[-1]], W[NAILS[-1]], rtol=0, atol=1e-11)


def test_loose_components_may_each_stay():
    result = run("arap", iterations=5, loose=[NAILS[1].start + 3, NAILS[4].stop - 1])
    stays = [bool(np.array_equal(result.U[part], V[part])) for part in NAILS]
    assert stays == [False, True, False, False, True]
    (warning,) = result.warnings
    assert warning.startswith("3 connected parts without base or handle; they go along")
    assert warning.endswith("2 connected parts without base or handle; they stay where they are.")


def test_loose_components_may_all_stay():
    result = run("arap", iterations=5, loose="stay")
    assert np.array_equal(result.U[BODY.stop :], V[BODY.stop :])


def test_loose_components_beside_the_base_do_not_move_a_bit():
    W, G, (_, part) = assembled(finger(), nail(-0.95 * LONG, 1.0))
    result = run("arap", W, G, 3)
    assert np.array_equal(result.U[part], W[part])


@pytest.mark.parametrize("loose", ["fly", [len(V)], [-1], [0.5]])
def test_loose_components_refuse_what_is_no_choice(loose):
    with pytest.raises(InputError):
        run("arap", iterations=1, loose=loose)


def test_loose_components_turn_with_the_one_triangle_that_they_touch():
    S, G = sphere(1)
    W, T, (_, ball) = assembled((V[BODY], BODY_F), (0.02 * S + [0.0, 1.03, 0.0], G))
    result = run("arap", W, T)
    turn = np.linalg.lstsq(W[ball] - W[ball].mean(axis=0), result.U[ball] - result.U[ball].mean(axis=0))[0].T
    np.testing.assert_allclose(turn @ turn.T, np.eye(3), atol=1e-12)
    angle = np.degrees(np.arccos((np.trace(turn) - 1.0) / 2.0))
    assert 5.0 < angle < 60.0, "between base and handle"


def test_loose_components_of_a_mesh_with_repeated_vertices_go_along_alike():
    soup, corners = V[F.ravel()], np.arange(F.size).reshape(-1, 3)
    first = np.full(len(V), -1)
    first[F.ravel()[::-1]] = np.arange(F.size)[::-1]
    result = deform(soup, corners, first[FIXED], TARGETS, "arap", 5, handle=first[HANDLE])
    part, expected = NAILS[2], run("arap", iterations=5)
    np.testing.assert_allclose(result.U[first[part]], expected.U[part], rtol=0, atol=1e-5)


# In contact


@pytest.fixture(scope="module")
def carried():
    """The nails, all but the last going along."""
    return Deformation(V, F, FIXED, handle=HANDLE, loose=[NAILS[-1].start]).loose


def test_loose_components_together_groups_a_part_with_the_skin_below_it_and_with_nothing_else(carried):
    (group,) = carried.exempt_groups
    for part in NAILS[:-1]:
        (number,) = np.unique(group[part])
        assert number > 0
        skin = np.flatnonzero(group == -number)
        assert len(skin) >= 3
        assert skin.max() < BODY.stop
        size = np.linalg.norm(np.ptp(V[part], axis=0))
        assert np.linalg.norm(V[skin] - V[part].mean(axis=0), axis=1).max() < 2.5 * size
        assert (np.abs(group) == number).sum() == len(skin) + len(V[part])
    assert not group[NAILS[-1]].any(), "what stays is carried by nothing"


def test_loose_components_pass_on_the_whole_forces_on_a_part(carried):
    g = np.random.default_rng(0).normal(size=V.shape)
    before = g.copy()
    carried.transfer_gradient(g)
    going = np.concatenate([before[part] for part in NAILS[:-1]])
    assert np.allclose((g - before)[BODY].sum(axis=0), going.sum(axis=0), atol=1e-9)
    assert np.array_equal(g[BODY.stop :], before[BODY.stop :])


def test_loose_components_let_a_shift_of_the_skin_do_the_work_of_the_forces_on_a_part(carried):
    """The slope along a shift of all: by the forces passed on, and by those on all vertices."""
    U, shift, g = run(loose="go").U, np.array([0.3, -0.2, 0.1]), np.zeros(V.shape)
    g[NAILS[0]] = np.random.default_rng(1).normal(size=V[NAILS[0]].shape)
    far = carried.with_followers(np.where(np.arange(len(V))[:, None] < BODY.stop, U + shift, V))
    near = carried.with_followers(np.where(np.arange(len(V))[:, None] < BODY.stop, U, V))
    expected = (g[NAILS[0]] * (far - near)[NAILS[0]]).sum()
    carried.transfer_gradient(g)
    assert (g[BODY] @ shift).sum() == pytest.approx(expected, rel=1e-9)


def test_loose_components_limit_the_skin_to_go_no_farther_than_the_part_on_it(carried):
    shares = np.ones(len(V))
    shares[NAILS[1].start] = 0.25
    carried.limit_step_fractions(shares)
    skin = np.flatnonzero(shares[BODY] < 1.0)
    assert len(skin) >= 3
    assert (shares[skin] == 0.25).all()
