"""Bytes a vertex that the solver holds after each stage of a drag on a large mesh, and at its peak.

    python tests/benchmarks/memory_by_stage.py FILE|EDGE [lines]

Counted by tracemalloc, which knows NumPy's arrays, with the mesh of the FILE or the sample bottle with edges
of that length, such as 0.141 for 655,000 vertices. The ends of its longest side are held, and previews move
one of them, as no factor is ever ready. In the end so many lines of the program are told that hold most, by
default 12.
"""

import os
import sys
import tracemalloc
from pathlib import Path

os.environ["NUMBA_NUM_THREADS"] = "1"

import numpy as np
from event_loop_gaps import rotation, sample_bottle  # it finds the support of the tests

from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import transform
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.restarts import prepare_previews
from apd_viewer.session.processes.request_solver import _prepare_mesh

END, HELD = 0.04, 2.0  # of the longest side, at each end; least bytes a vertex of a line that is told
PROGRAM = str(Path(__file__).parents[2] / "apd_viewer")


class NeverReady:
    """A factor in another process, which never comes."""

    is_in_other_process, ready, seconds = True, False, 0.0

    def __init__(self, *_: object) -> None:
        pass


def main(given: str, lines: str = "12") -> None:
    tracemalloc.start(12)
    mesh = Mesh(*sample_bottle(float(given))[:2]) if given.replace(".", "").isdigit() else open_mesh(given)
    count = len(mesh.V)
    print(f"{count:,} vertices; bytes a vertex: held, at most until then")

    def tell(stage: str) -> None:
        held, peak = tracemalloc.get_traced_memory()
        print(f"{stage:34}{held / count:6.0f}{peak / count:7.0f}", flush=True)
        tracemalloc.reset_peak()

    tell("read, with the file's own bytes")
    rest = RestMesh(mesh.V, mesh.F, mesh.weld)
    tell("rest shape")
    _prepare_mesh(rest)
    tell("coarse levels and prolongation")
    axis = int(np.argmax(np.ptp(mesh.V, axis=0)))
    along = (mesh.V[:, axis] - mesh.V[:, axis].min()) / np.ptp(mesh.V[:, axis])
    base, handle = np.flatnonzero(along < END), np.flatnonzero(along > 1.0 - END)
    fixed = np.concatenate([base, handle])
    solver = Deformation(mesh.V, mesh.F, fixed, handle=handle, rest=rest, factored=NeverReady)
    tell("goals and descents")
    prepare_previews(solver.solver)
    tell("previews prepared")
    turn = np.eye(4)
    turn[:3, :3] = rotation(np.eye(3)[axis], np.radians(1.0))
    targets = np.concatenate([mesh.V[base], transform(turn, mesh.V[handle])])
    solver.aim(targets[np.argsort(fixed)])
    solver.iterate()
    solver.frame()
    tell("first preview")
    for line in tracemalloc.take_snapshot().statistics("traceback")[: int(lines)]:
        own = [frame for frame in line.traceback if frame.filename.startswith(PROGRAM)]
        if own and line.size / count >= HELD:
            place = " < ".join(
                f"{Path(frame.filename).stem}:{frame.lineno}" for frame in list(reversed(own))[:3]
            )
            print(f"{line.size / count:8.0f}  {place}")


if __name__ == "__main__":
    main(*sys.argv[1:])
