"""Twelve meshes with one defect each, here and in libigl and Open3D, where they are installed.

    python tests/benchmarks/defects.py

Each is deformed by ARAP with base and handle held, 30 iterations (here until it has settled, by "arap" and
"exact"). A mesh is survived if every position is finite, the held vertices are on their targets (to 1e-9 of
the size), a piece that nothing holds has not moved, and no vertex is flung farther than three sizes away.
"""

import contextlib
import importlib
import os
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "support"))
from defective import Defective, suite

from apd_viewer.geometry.solver.deformation_result import deform

ITERATIONS = 30


def here(method: str):
    return lambda case: (
        deform(case.V, case.F, case.fixed, case.targets, method, handle=case.handle, loose="stay").U
    )


def libigl(case: Defective) -> np.ndarray:
    igl = importlib.import_module("igl")
    data = igl.ARAPData()
    data.max_iter = ITERATIONS
    data.energy = igl.ARAPEnergyType.ARAP_ENERGY_TYPE_SPOKES
    F, fixed = case.F.astype(np.int64), case.fixed.astype(np.int64)
    igl.arap_precomputation(case.V, F, 3, fixed, data)
    return igl.arap_solve(case.targets, data, case.V.copy())


def open3d(case: Defective) -> np.ndarray:
    o3d = importlib.import_module("open3d")
    mesh = o3d.geometry.TriangleMesh(
        o3d.utility.Vector3dVector(case.V), o3d.utility.Vector3iVector(case.F.astype(np.int32))
    )
    done = mesh.deform_as_rigid_as_possible(
        o3d.utility.IntVector(case.fixed.astype(np.int32)),
        o3d.utility.Vector3dVector(case.targets),
        max_iter=ITERATIONS,
    )
    return np.asarray(done.vertices)


def verdict(case: Defective, U: np.ndarray) -> str:
    size = np.linalg.norm(np.ptp(case.V[case.labels != 1], axis=0))
    if U.shape != case.V.shape or not np.isfinite(U).all():
        return "not finite"
    if np.abs(U[case.fixed] - case.targets).max() > 1e-9 * size:
        return "off target"
    if len(case.unheld) and not np.array_equal(U[case.unheld], case.V[case.unheld]):
        return "unheld piece moves"
    if np.linalg.norm(U - case.V, axis=1).max() > 3.0 * size:
        return "flung away"
    used = np.isin(np.arange(len(U)), case.F)
    free = used & (case.labels == 1)
    free[case.unheld] = False
    if np.abs(U[free] - case.V[free]).max() < 1e-9 * size:
        return "does not follow"
    return "survives"


def attempt(program, case: Defective) -> str:
    """The verdict, in a process of its own: some end with it."""
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        with contextlib.suppress(BaseException):
            try:
                said = verdict(case, program(case))
            except ImportError:
                said = "not installed"
            except Exception as error:
                said = f"refuses ({type(error).__name__})"
            os.write(writer, said.encode())
        os._exit(0)
    os.close(writer)
    with os.fdopen(reader, "rb") as stream:
        said = stream.read().decode()
    os.waitpid(child, 0)
    return said or "crashes"


def main() -> None:
    programs = {"arap": here("arap"), "exact": here("exact"), "libigl": libigl, "Open3D": open3d}
    survived = dict.fromkeys(programs, 0)
    print("| mesh | " + " | ".join(programs) + " |")
    print("|---|" + "---|" * len(programs))
    for name, case in suite().items():
        verdicts = [attempt(program, case) for program in programs.values()]
        for program, said in zip(programs, verdicts, strict=True):
            survived[program] += said == "survives"
        print(f"| {name} | " + " | ".join(verdicts) + " |", flush=True)
    print("| **of 12** | " + " | ".join(str(count) for count in survived.values()) + " |")


if __name__ == "__main__":
    main()
