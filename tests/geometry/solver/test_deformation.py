"""The border of the room: deform and Deformation, what they do not depend on, and what they refuse."""

import numpy as np
import pytest
from hypothesis import given, strategies as st
from meshes import box, ends, grid, moved, rotation, soup, sphere, tube

from apd_viewer.errors import InputError
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.deformation_result import deform

V, F = box(2, 2, 5)
BASE, HANDLE = ends(V)
FIXED = np.concatenate([BASE, HANDLE])
TARGETS = np.vstack([V[BASE], moved(V[HANDLE], rotation([0, 1, 2], 0.8), [0.5, 0.0, 0.3])])
DIAGONAL = np.linalg.norm(np.ptp(V, axis=0))
both = pytest.mark.parametrize("method", ["arap", "paper"])


def run(V=V, F=F, fixed=FIXED, targets=TARGETS, method="paper", iterations=25, handle=HANDLE, **rest):
    return deform(V, F, fixed, targets, method, iterations, handle=handle, **{"contact": False, **rest})


# What the result does not depend on.


@both
def test_deform_renumbers_the_result_with_the_vertices_and_faces(method):
    rng = np.random.default_rng(0)
    order = rng.permutation(len(V))  # the vertex order[k] becomes k
    name = np.argsort(order)
    faces = np.array([np.roll(f, k) for f, k in zip(F, rng.integers(3, size=len(F)), strict=True)])
    shuffle = rng.permutation(len(FIXED))
    result = run(
        V[order],
        name[rng.permutation(faces)],
        name[FIXED][shuffle],
        TARGETS[shuffle],
        method,
        handle=name[HANDLE][::-1],
    )
    expected = run(method=method)
    assert np.abs(result.U - expected.U[order]).max() <= 1e-10 * DIAGONAL
    assert result.energy == pytest.approx(expected.energy, rel=1e-10)
    assert result.volume == pytest.approx(expected.volume, rel=1e-10)


@both
@given(st.floats(-4, 4), st.floats(-10, 10))
def test_deform_moves_the_result_when_everything_is_moved_rigidly(method, angle, shift):
    R = rotation([1, -2, 3], angle)
    result = run(V @ R.T + shift, targets=TARGETS @ R.T + shift, method=method)
    assert np.abs(result.U - run(method=method).U @ R.T - shift).max() <= 1e-10 * DIAGONAL


@both
@pytest.mark.parametrize("s", [1e-30, 1e-6, 1e-3, 1e3, 1e6, 1e30])
def test_deform_changes_nothing_but_the_unit_with_the_unit_of_length(method, s):
    result, expected = run(s * V, targets=s * TARGETS, method=method), run(method=method)
    assert np.abs(result.U / s - expected.U).max() <= 1e-11 * DIAGONAL
    assert result.area / s**2 == pytest.approx(expected.area, rel=1e-11)
    assert result.volume / s**3 == pytest.approx(expected.volume, rel=1e-11)
    assert result.energy / s**2 == pytest.approx(expected.energy, rel=1e-11)
    assert result.handle_drift / s == pytest.approx(expected.handle_drift, rel=1e-9, abs=1e-12)
    assert result.area_error == pytest.approx(expected.area_error, rel=1e-9)


@both
@pytest.mark.parametrize("s", [1e-3, 1e3])
def test_deform_takes_as_long_until_convergence_in_every_unit(method, s):
    assert run(s * V, targets=s * TARGETS, method=method, iterations=None).iterations == (
        run(method=method, iterations=None).iterations
    )


@both
def test_deform_far_from_the_origin_loses_only_the_digits_of_the_positions(method):
    result = run(V + 1e6, targets=TARGETS + 1e6, method=method)
    assert np.abs(result.U - 1e6 - run(method=method).U).max() <= 1e-8


@both
def test_deform_gives_the_mirror_image_the_mirrored_result(method):
    mirror = np.array([1.0, 1, -1])
    result = run(V * mirror, F[:, ::-1], targets=TARGETS * mirror, method=method)
    assert np.abs(result.U - run(method=method).U * mirror).max() <= 1e-10 * DIAGONAL


@both
def test_deform_gives_the_same_answer_to_the_same_question(method):
    assert np.array_equal(run(method=method).U, run(method=method).U)


GIVEN = V, F, FIXED, TARGETS, HANDLE
LAYOUTS = {
    "lists": lambda: (V.tolist(), F.tolist(), FIXED.tolist(), TARGETS.tolist(), HANDLE.tolist()),
    "integers": lambda: (V.astype(int), F, FIXED, TARGETS, HANDLE),
    "Fortran": lambda: (
        np.asfortranarray(V),
        np.asfortranarray(F),
        FIXED,
        np.asfortranarray(TARGETS),
        HANDLE,
    ),
    "strided": lambda: (np.repeat(V, 2, 0)[::2], np.repeat(F, 2, 1)[:, ::2], FIXED, TARGETS, HANDLE),
    "small unsigned": lambda: (
        V,
        F.astype(np.uint8),
        FIXED.astype(np.uint16),
        TARGETS,
        HANDLE.astype(np.int8),
    ),
    "large unsigned": lambda: (V, F.astype("u8"), FIXED.astype("u8"), TARGETS, HANDLE.astype("u8")),
    "other endian": lambda: (
        V.astype(">f8"),
        F.astype(">i4"),
        FIXED.astype(">i8"),
        TARGETS.astype(">f8"),
        HANDLE,
    ),
    "read-only": lambda: tuple(np.frombuffer(x.tobytes(), x.dtype).reshape(x.shape) for x in GIVEN),
    "columns of ids": lambda: (V, F, FIXED[:, None], TARGETS, HANDLE[None]),
}


@pytest.mark.parametrize("layout", LAYOUTS)
def test_deform_takes_every_layout_in_memory_for_the_same(layout):
    v, f, fixed, targets, handle = LAYOUTS[layout]()
    assert np.array_equal(run(v, f, fixed, targets, iterations=3, handle=handle).U, run(iterations=3).U)


@both
def test_deformation_does_not_write_to_what_is_given_and_the_result_cannot_be_written_to(method):
    given_ = [x.copy() for x in GIVEN]
    solver = Deformation(given_[0], given_[1], given_[2], method=method, handle=given_[4])
    start = V + 0.01
    solver.aim(given_[3], U=start)
    frames = [solver.step() for _ in range(25)]
    kept = [frame.U.copy() for frame in frames]
    solver.step()
    for array, copy in zip([*given_, start], [*GIVEN, V + 0.01], strict=True):
        assert np.array_equal(array, copy)
        assert array.flags.writeable
    # Frames are handed to another thread: a later step must not change them.
    for frame, copy in zip(frames, kept, strict=True):
        assert np.array_equal(frame.U, copy)
        assert not frame.U.flags.writeable
    assert not run(method=method).U.flags.writeable


# One call, and one iteration at a time.


@both
def test_deform_by_so_many_iterations_is_so_many_steps(method):
    solver = Deformation(V, F, FIXED, method=method, handle=HANDLE, plain=True)
    solver.aim(TARGETS)
    seen = []
    result = run(method=method, iterations=25, progress=seen.append)
    for shown in seen:
        frame = solver.step()
        assert np.array_equal(frame.U, shown.U)
        assert frame.iteration == shown.iteration
        assert frame.area_error == shown.area_error
    assert [frame.iteration for frame in seen] == list(range(1, 26))
    assert np.array_equal(result.U, seen[-1].U)
    assert result.iterations == 25
    assert result.energy == pytest.approx(solver.rest.energy(result.U), rel=1e-14)


@both
def test_deform_without_a_count_runs_until_converged(method):
    seen = []
    result = run(method=method, iterations=None, progress=seen.append)
    assert result.converged
    assert [frame.converged for frame in seen] == [False] * (len(seen) - 1) + [True]
    assert np.abs(seen[-1].U - seen[-2].U).max() <= 1e-5 * DIAGONAL
    assert (result.method, result.iterations) == (method, len(seen))
    assert result.seconds >= result.factor_seconds >= 0.0
    assert result.seconds >= result.seconds_per_iteration * result.iterations * 0.99


@both
def test_deformation_that_has_not_been_aimed_is_at_rest(method):
    frame = Deformation(V, F, FIXED, method=method, handle=HANDLE).step()
    assert np.abs(frame.U - V).max() <= 1e-13 * DIAGONAL
    assert frame.converged


@both
def test_deformation_aim_continues_when_repeated_and_starts_from_a_given_shape(method):
    def frames(solver, count):
        return [solver.step().U for _ in range(count)][-1]

    straight = Deformation(V, F, FIXED, method=method, handle=HANDLE, plain=True)
    straight.aim(TARGETS)
    first = frames(straight, 10)
    expected = frames(straight, 1)
    if method == "arap":  # the paper's method continues from the shape before the correction
        resumed = Deformation(V, F, FIXED, method=method, handle=HANDLE, plain=True)
        resumed.aim(TARGETS, U=first)
        assert np.abs(frames(resumed, 1) - expected).max() <= 1e-11 * DIAGONAL

    # Back at rest, whatever has happened before, it does what a new solver does.
    straight.aim(TARGETS, U=V)
    assert np.abs(frames(straight, 10) - first).max() <= 1e-11 * DIAGONAL
    assert straight.step().iteration == 11

    straight.aim(TARGETS)
    assert straight.step().iteration == 1
    warm = Deformation(V, F, FIXED, method=method, handle=HANDLE, plain=True)
    warm.aim(TARGETS)
    frames(warm, 60)
    warm.aim(TARGETS)
    # Continuing from the settled shape, one step stays near it; from rest it would be far off.
    assert np.abs(frames(warm, 1) - run(method=method, iterations=60).U).max() <= 0.02 * DIAGONAL
    assert (
        np.abs(run(method=method, iterations=1).U - run(method=method, iterations=60).U).max()
        > 0.02 * DIAGONAL
    )


@both
def test_deformation_returns_to_rest_by_a_drag_there_and_back(method):
    solver = Deformation(V, F, FIXED, method=method, handle=HANDLE)
    for targets in (TARGETS, V[FIXED]):
        solver.aim(targets)
        for _ in range(400):
            frame = solver.step()
    assert np.abs(frame.U - V).max() <= 1e-5 * DIAGONAL
    assert abs(frame.area_error) <= 1e-6


def test_deformation_can_share_the_rest_mesh():
    rest = RestMesh(V, F)
    solver = Deformation(V, F, FIXED, method="paper", handle=HANDLE, rest=rest)
    assert solver.rest is rest
    solver.aim(TARGETS)
    for _ in range(25):
        frame = solver.step()
    assert np.array_equal(frame.U, run().U)


def test_result_readings_are_those_of_the_shape():
    result = run()
    assert result.volume_rest == pytest.approx(2 * 2 * 5, rel=1e-13)
    assert result.area_rest == pytest.approx(2 * 4 + 4 * 10, rel=1e-13)
    assert result.warnings == ()
    opened = run(F=F[:-1])
    assert opened.volume is opened.volume_rest is None
    assert opened.volume_capped is not None
    assert opened.warnings == ()


# Welding.


def as_soup(seed=None):
    W, G = soup(V, F)
    if seed is not None:
        G = np.random.default_rng(seed).permutation(G)
    original = F.ravel()
    copies = [np.flatnonzero(original == v) for v in range(len(V))]
    return W, G, original, copies


@both
def test_deform_treats_a_soup_exactly_like_the_surface_it_came_from(method):
    W, G, original, copies = as_soup()
    fixed = np.concatenate([copies[v] for v in FIXED])
    targets = np.vstack([np.tile(t, (len(copies[v]), 1)) for v, t in zip(FIXED, TARGETS, strict=True)])
    handle = np.concatenate([copies[v] for v in HANDLE])
    result, expected = run(W, G, fixed, targets, method, handle=handle), run(method=method)
    for c in copies:
        assert (result.U[c] == result.U[c[0]]).all()
    assert np.abs(result.U - expected.U[original]).max() <= 1e-10 * DIAGONAL
    assert result.volume == pytest.approx(expected.volume, rel=1e-10)
    assert result.energy == pytest.approx(expected.energy, rel=1e-10)
    assert result.handle_drift == pytest.approx(expected.handle_drift, rel=1e-9, abs=1e-12)
    assert result.warnings == ()


@both
@pytest.mark.parametrize("which", [0, -1])
def test_deform_holds_all_of_several_copies_when_one_is_held(method, which):
    W, G, original, copies = as_soup()
    fixed, handle = np.array([copies[v][which] for v in FIXED]), [copies[v][which] for v in HANDLE]
    result = run(W, G, fixed, TARGETS, method, handle=handle)
    assert np.abs(result.U - run(method=method).U[original]).max() <= 1e-10 * DIAGONAL


def test_deform_does_not_depend_on_which_copy_the_handle_names():
    W, G, original, copies = as_soup()
    fixed = np.concatenate([copies[v] for v in FIXED])
    targets = np.vstack([np.tile(t, (len(copies[v]), 1)) for v, t in zip(FIXED, TARGETS, strict=True)])
    result = run(W, G, fixed, targets, handle=[copies[v][-1] for v in HANDLE])
    assert np.abs(result.U - run().U[original]).max() <= 1e-10 * DIAGONAL


@both
def test_deform_takes_a_vertex_of_no_face_along(method):
    W = np.vstack([V[:3], [[7.0, 8.0, 9.0]], V[3:], [[-0.1, 0.2, 0.3]]])
    name = np.r_[:3, 4 : len(V) + 1]
    result = run(W, name[F], name[FIXED], TARGETS, method, handle=name[HANDLE])
    surface, before = result.U[name], W[name]
    for k in (3, -1):
        nearest = np.argmin(np.linalg.norm(before - W[k], axis=1))
        beside = np.linalg.norm(result.U[k] - surface[nearest]) / np.linalg.norm(W[k] - before[nearest])
        assert beside == pytest.approx(1.0, abs=0.2), "it keeps its place beside the surface"
        assert np.abs(result.U[k] - W[k]).max() > 0.01
    assert np.abs(result.U[name] - run(method=method).U).max() <= 1e-10 * DIAGONAL
    assert result.warnings == ()


@both
def test_deform_does_not_take_all_else_for_settled_because_of_a_stray_vertex_far_away(method):
    result = run(np.vstack([V, [[1e7, 0.0, 0.0]]]), method=method, iterations=None)
    expected = run(method=method, iterations=None)
    assert result.iterations == expected.iterations
    assert np.abs(result.U[:-1] - expected.U).max() <= 1e-10 * DIAGONAL


@both
def test_deform_may_let_a_separate_piece_without_held_vertices_stay_and_mentions_it(method):
    S, G = sphere(1)
    W = np.vstack([V, S + 0.1, S + 7.3])
    n, k = len(V), len(S)
    result = run(W[: n + k], np.vstack([F, G + n]), method=method, loose="stay")
    assert np.array_equal(result.U[n:], W[n : n + k])
    assert result.warnings == ("1 connected part without base or handle; it stays where it is.",)
    result = run(W, np.vstack([F, G + n, G + n + k]), method=method, loose="stay")
    assert np.array_equal(result.U[n:], W[n:])
    assert result.warnings == ("2 connected parts without base or handle; they stay where they are.",)
    if method == "arap":
        assert np.abs(result.U[:n] - run(method=method).U).max() <= 1e-10 * DIAGONAL


def test_deform_may_hold_a_piece_by_one_vertex():
    S, G = sphere(1)
    W, n = np.vstack([V, S + 9.0]), len(V)
    fixed, targets = np.append(FIXED, n + 5), np.vstack([TARGETS, W[n + 5] + 1.0])
    result = run(W, np.vstack([F, G + n]), fixed, targets, "arap")
    assert np.abs(result.U[n:] - W[n:] - 1.0).max() <= 1e-12
    assert result.warnings == ()


# What is refused.


def not_a_number(X, row=1):
    X = X.astype(float)
    X[row, 0] = np.nan
    return X


REFUSED = {
    "vertices are pairs": ({"V": V[:, :2]}, "Vertices must be an"),
    "vertices not numbers": ({"V": not_a_number(V)}, "1 vertex has a coordinate that is not a number"),
    "faces are quads": ({"F": np.array([[0, 1, 2, 3]])}, "Faces must be an"),
    "no faces": ({"F": F[:0]}, "No faces"),
    "no faces in a list": ({"F": []}, "faces|Faces"),
    "face too far": ({"F": np.vstack([F, [[0, 1, len(V)]]])}, "1 face refers to missing vertices"),
    "face negative": ({"F": F - 1}, "faces refer to missing vertices"),
    "no area": ({"V": V * [0.0, 0.0, 1.0]}, "The mesh has no area"),
    "nothing held": ({"fixed": [], "targets": np.zeros((0, 3)), "handle": []}, "No vertices are held"),
    "held too far": ({"fixed": np.append(FIXED[:-1], len(V))}, "A held vertex does not exist: IDs run"),
    "held negative": ({"fixed": np.append(FIXED[:-1], -1)}, "A held vertex does not exist"),
    "everything held": ({"fixed": np.arange(len(V)), "targets": V}, "Every vertex is held"),
    "handle too far": ({"handle": [len(V)]}, "A handle vertex does not exist"),
    "no handle": ({"handle": None}, "needs base and handle"),
    "empty handle": ({"handle": []}, "needs base and handle"),
    "no base": ({"handle": FIXED}, "needs base and handle"),
    "handle is free": ({"handle": np.setdiff1d(np.arange(len(V)), FIXED)[:3]}, "handle"),
    "targets too few": ({"targets": TARGETS[:-1]}, f"Targets must be {len(FIXED)} finite positions"),
    "targets are pairs": ({"targets": TARGETS[:, :2]}, "Targets must be"),
    "targets are flat": ({"targets": TARGETS.ravel()}, "Targets must be"),
    "targets not numbers": ({"targets": not_a_number(TARGETS)}, "Targets must be"),
    "targets infinite": ({"targets": TARGETS + np.inf}, "Targets must be"),
    "targets missing": ({"targets": None}, "Targets must be"),
    "method unknown": ({"method": "magic"}, "Unknown method 'magic'; choose one of"),
    "method missing": ({"method": None}, "Unknown method"),
    "tolerance zero": ({"tolerance": 0.0}, "tolerance must be a number from"),
    "tolerance negative": ({"tolerance": -1e-3}, "tolerance must be a number from"),
    "tolerance not a number": ({"tolerance": np.nan}, "tolerance must be a number from"),
    "no iterations": ({"iterations": 0}, "iterations must be"),
    "negative iterations": ({"iterations": -5}, "iterations must be"),
}


@pytest.mark.parametrize(("changed", "sentence"), REFUSED.values(), ids=REFUSED.keys())
def test_deform_refuses_what_cannot_be_used_with_a_sentence(changed, sentence):
    with pytest.raises(InputError, match=sentence):
        run(**changed)


def faces_of_loose_piece():
    S, G = sphere(0)
    return np.vstack([V, S + 9.0]), np.vstack([F, G + len(V)])


LOOSE_V, LOOSE_F = faces_of_loose_piece()
UNUSED_V = np.vstack([V, [[9.0, 9.0, 9.0]]])

# What no sentence is fixed for yet; that it is an InputError, and not a crash or nonsense, is.
AWKWARD = {
    "faces are fractions": {"F": F + 0.5},
    "faces not numbers": {"F": not_a_number(F)},
    "faces are text": {"F": F.astype(str)},
    "faces are truth values": {"F": F > 3},
    "faces are ragged": {"F": [[0, 1, 2], [3, 4]]},
    "vertices are ragged": {"V": [[0.0, 0.0, 0.0], [1.0]]},
    "vertices are complex": {"V": V + 1j},
    "held are fractions": {"fixed": FIXED + 0.5},
    "held not numbers": {"fixed": np.append(FIXED[:-1], np.nan)},
    "held missing": {"fixed": None},
    "held as a mask": {"fixed": np.isin(np.arange(len(V)), FIXED), "targets": V, "method": "arap"},
    "handle as a mask": {"handle": np.isin(np.arange(len(V)), HANDLE)},
    "handle beyond what is held": {"handle": np.append(HANDLE, np.setdiff1d(np.arange(len(V)), FIXED)[0])},
    "one vertex, two targets": {"fixed": [*FIXED, BASE[0]], "targets": [*TARGETS, [1.0, 2, 3]]},
    "targets are ragged": {"targets": [[0.0, 0.0, 0.0], [1.0]]},
    "targets are text": {"targets": "there"},
    "tolerance missing": {"tolerance": None},
    "tolerance is text": {"tolerance": "0.1 %"},
    "iterations are fractions": {"iterations": 2.5},
    "iterations not a number": {"iterations": np.nan},
    "iterations infinite": {"iterations": np.inf},
    "iterations are text": {"iterations": "many"},
    "all but a loose piece held": {"V": LOOSE_V, "F": LOOSE_F, "fixed": np.arange(len(V)), "targets": V},
    "all but an unused vertex held": {"V": UNUSED_V, "fixed": np.arange(len(V)), "targets": V},
    "only an unused vertex held": {
        "V": UNUSED_V,
        "fixed": [len(V)],
        "targets": UNUSED_V[-1:],
        "method": "arap",
    },
    "areas beyond the number range": {"V": V * 1e160, "targets": TARGETS * 1e160},
    "areas below the number range": {"V": V * 1e-200, "targets": TARGETS * 1e-200},
}


def stop_after_a_while(frame):
    assert frame.iteration <= 100, "does not end"


@pytest.mark.parametrize("changed", AWKWARD.values(), ids=AWKWARD.keys())
def test_deform_raises_an_input_error_whatever_is_wrong(changed):
    with pytest.raises(InputError) as refused:
        run(**changed, progress=stop_after_a_while)
    assert str(refused.value).endswith(".")


@pytest.mark.parametrize(
    "U", [V[:3], V[:, :2], V.ravel(), not_a_number(V), np.full_like(V, np.inf), [[0.0]], "there"]
)
def test_deformation_aim_refuses_to_start_from_what_is_no_shape(U):
    solver = Deformation(V, F, FIXED, method="arap")
    with pytest.raises(InputError):
        solver.aim(TARGETS, U=U)
    # and has left the solver as it was
    assert np.abs(solver.step().U - V).max() <= 1e-13 * DIAGONAL


def test_deformation_aim_leaves_the_solver_as_it_was_when_refused():
    solver = Deformation(V, F, FIXED, handle=HANDLE)
    solver.aim(TARGETS)
    solver.step()
    with pytest.raises(InputError):
        solver.aim(TARGETS[1:])
    assert solver.step().iteration == 2


def test_deformation_tolerance_is_checked_whenever_it_is_set():
    solver = Deformation(V, F, FIXED, handle=HANDLE)
    for tolerance in (0.0, -1.0, np.nan):
        with pytest.raises(InputError, match="tolerance must be a number from"):
            solver.tolerance = tolerance


@both
def test_deform_holds_a_vertex_once_that_is_named_twice_with_one_target(method):
    twice = np.r_[FIXED, FIXED[2:5]], np.vstack([TARGETS, TARGETS[2:5]])
    assert np.array_equal(run(fixed=twice[0], targets=twice[1], method=method).U, run(method=method).U)


ids = st.one_of(
    st.lists(st.integers(-2, 12), max_size=8),
    st.lists(st.floats(width=32), max_size=4),
    st.lists(st.booleans(), max_size=9),
    st.none(),
)


@given(ids, ids, st.sampled_from(["arap", "paper", "magic"]), st.integers(-1, 3) | st.floats())
def test_deform_uses_or_refuses_ids_whatever_they_are(fixed, handle, method, iterations):
    W, G = grid(2, 2)
    try:
        targets = W[np.array(fixed, dtype=int)] + 0.25
    except (TypeError, ValueError, IndexError, OverflowError, RuntimeWarning):
        targets = np.zeros((0 if fixed is None else len(fixed), 3))
    try:
        result = deform(W, G, fixed, targets, method, iterations, handle=handle, progress=stop_after_a_while)
    except InputError:
        return
    assert np.isfinite(result.U).all()
    assert result.iterations == iterations
    if method == "arap":
        assert np.array_equal(result.U[np.asarray(fixed, dtype=int)], targets)


# Extremes that are legal.


@both
@pytest.mark.parametrize("turns", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("axis", [[0, 0, 1], [1, 0, 0]])
def test_deform_converges_with_huge_rotations_of_the_handle(method, turns, axis):
    targets = np.vstack([V[BASE], moved(V[HANDLE], rotation(axis, 2 * np.pi * turns))])
    result = run(targets=targets, method=method, iterations=None)
    assert result.converged
    assert np.isfinite(result.U).all()
    if turns >= 1:  # positions do not remember whole turns
        assert np.abs(result.U - V).max() <= 1e-9


@both
def test_deform_converges_with_few_free_vertices_between_base_and_handle(method):
    W, G = tube(8, 2)
    base, handle = ends(W)
    targets = np.vstack([W[base], moved(W[handle], rotation([0, 0, 1], 0.3), [0, 0, 0.1])])
    result = run(W, G, np.concatenate([base, handle]), targets, method, None, handle)
    assert result.converged
    assert abs(result.area_error) <= (1e-3 if method == "paper" else 0.2)


@both
def test_deform_converges_with_one_free_vertex(method):
    fixed = np.delete(np.arange(len(V)), 20)
    result = run(fixed=fixed, targets=V[fixed], method=method, handle=fixed[-5:], iterations=None)
    assert result.converged
    assert np.abs(result.U - V).max() <= 1e-12


@both
def test_deform_converges_with_one_triangle(method):
    W, G = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]])
    result = run(W, G, [0, 1], [[0.0, 0, 0], [2, 0, 0]], method, None, [1])
    assert result.converged
    assert np.isfinite(result.U).all()
    if method == "paper":
        assert abs(result.area_error) <= 1e-3
    assert result.U[0].tolist() == [0, 0, 0]


@both
def test_deform_converges_with_the_handle_in_two_places(method):
    W, G = sphere(2)
    base = np.flatnonzero(W[:, 2] < -0.8)
    handle = np.flatnonzero(np.abs(W[:, 0]) > 0.85)
    fixed = np.concatenate([base, handle])
    targets = np.vstack([W[base], W[handle] @ rotation([0, 0, 1], 0.5).T])
    result = run(W, G, fixed, targets, method, None, handle)
    assert result.converged
    assert abs(result.area_error) <= (1e-3 if method == "paper" else 1.0)


@pytest.mark.parametrize("far", [1e39, 1e200])
def test_deformation_refuses_vertices_that_lie_far_off_in_a_sentence(far):
    W, G = sphere(2)
    W[100, 0] = far
    with pytest.raises(InputError, match=f"coordinates as large as {far:.3g}".replace("+", r"\+")):
        Deformation(W, G, np.flatnonzero(np.abs(W[:, 2]) > 0.8), method="arap", stiffness=0.01)
