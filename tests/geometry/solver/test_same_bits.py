"""The same bits on any number of threads: shapes and readings of all methods and options."""

import json
import os
import subprocess
import sys
import textwrap

import pytest

THREADS = ("1", "4")
# Steps of deformations, in a process that may use more threads than there are cores: a hash of all shapes and
# readings, and what must have taken part.
STEPS = """
    import hashlib, json, sys
    import numba, numpy as np
    from meshes import grid, moved, rotation, sample_bottle
    from apd_viewer.geometry.analysis.area_change import local_change
    from apd_viewer.geometry.contact.near_pairs import NearPairs
    from apd_viewer.geometry.goals.goals import Region
    from apd_viewer.geometry.linalg import threads
    from apd_viewer.geometry.solver.deformation import Deformation

    threads._WORTH_WAKING = 0  # all threads, for small meshes and coarse levels too

    def bottle():
        V, F, labels = sample_bottle(2.5)
        height, cap, U = np.ptp(V[:, 1]), np.flatnonzero(labels == 2), V.copy()
        U[cap] = moved(V[cap], rotation([0.0, 1.0, 0.0], np.radians(100.0)), [0.0, -0.15 * height, 0.0])
        return V, F, np.flatnonzero(labels != 1), cap, U

    def hairpin():
        V, F = grid(60, 18, 1 / 12, 1 / 12)
        x, R = V[:, 0], 1.0 / np.pi
        turn = np.pi * np.clip(x - 2.0, 0.0, 1.0)
        along = np.where(x < 2, x, np.where(x > 3, 5 - x, 2 + R * np.sin(turn)))
        V = np.column_stack([along, V[:, 1] + 0.02 * x, -R * np.cos(turn)])
        upper, U = np.flatnonzero(x >= 4.0), V.copy()
        U[upper, 2] -= 0.6
        return V, F, np.concatenate([np.flatnonzero(x <= 1.0), upper]), upper, U

    def belt(V, F, fixed):
        near = np.setdiff1d(np.arange(len(V)), fixed)
        return Region("belt", near[: len(near) // 2], 102.0)

    def digest(count, shape, steps, goals, options):
        numba.set_num_threads(count)
        (V, F, fixed, handle, U), said, pairs = shape, hashlib.sha256(), 0
        if goals is not None:
            options = dict(options, area=100.0, regions=(belt(V, F, fixed),), **goals)
        solver = Deformation(V, F, fixed, handle=handle, **options)
        solver.aim(U[fixed])
        for _ in range(steps):
            frame = solver.step()
            change = local_change(frame.U, F, solver.rest.face_areas)
            readings = change.mean, change.p99, change.largest, change.below.tobytes()
            said.update(frame.U.tobytes() + repr((frame, readings)).encode())
            pairs += frame.contact.pairs if frame.contact else 0
        if solver.contact:
            # Steps are rounded to single precision, which hides most of what the forces differ by.
            near, closer = NearPairs(V, F, np.zeros((1, len(V)), np.int64), 0.3), V * [1.0, 1.0, 0.2]
            near.rebuild_at(closer)
            force, touching, least = near.gradient(closer)
            assert touching > 1_000
            said.update(force.tobytes())
        return said.hexdigest(), pairs

    for case in json.loads(sys.argv[1]):
        shape = {"bottle": bottle, "hairpin": hairpin}[case.pop("shape")]()
        steps, goals = case.pop("steps"), case.pop("goals", None)
        print(json.dumps([digest(int(k), shape, steps, goals, case) for k in sys.argv[2:]]))
"""
CASES = {
    "exact": {"method": "exact"},
    "local": {"method": "local"},
    "arap": {"method": "arap"},
    "paper": {"method": "paper"},
    "stiffness": {"method": "exact", "stiffness": 1e-3},
    "goals": {"steps": 2, "method": "local", "stiffness": 1e-3, "goals": {"volume": 95.0}},
    "contact": {
        "shape": "hairpin",
        "steps": 32,
        "method": "local",
        "stiffness": 1e-4,
        "contact": True,
        "thickness": 0.14,
        "goals": {},
    },
}


DAILY = ["goals", "contact"]  # nearly all kernels


@pytest.mark.parametrize(
    "cases",
    [DAILY, pytest.param([case for case in CASES if case not in DAILY], marks=pytest.mark.night)],
    ids=" ".join,
)
def test_deformation_has_shapes_and_readings_of_the_same_bits_on_any_number_of_threads(cases):
    asked = [{"shape": "bottle", "steps": 5, **CASES[case]} for case in cases]
    done = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(STEPS), json.dumps(asked), *THREADS],
        env={**os.environ, "NUMBA_NUM_THREADS": THREADS[-1], "PYTHONPATH": os.pathsep.join(sys.path)},
        capture_output=True,
        text=True,
        check=False,
        timeout=600,
    )
    assert done.returncode == 0, done.stderr
    for case, line in zip(cases, done.stdout.splitlines(), strict=True):
        first, *others = json.loads(line)
        assert others == [first] * len(others), case
        assert (first[1] > 0) == (case == "contact"), "parts of the surface must have been in touch"
