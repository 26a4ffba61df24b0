"""Poses of meshes that cross themselves without contact, walked in contact; every frame checked by ipctk.

    python tests/benchmarks/contact_proof.py [--poses twist:400 push:0.5 ...] [--jitters N] MESH ...

A mesh is held at a tenth of its length at either end of its longest axis, the sample bottle ("bottle") as it
is painted. The far end is turned or folded over by degrees, or pushed by a part of the length. Targets of a
jittered run are off by up to 1 % of the diagonal, seeded.
"""

import argparse
import os
import sys
from pathlib import Path

os.environ.setdefault("NUMBA_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import ipctk
import numpy as np
from scipy.spatial.transform import Rotation

sys.path.insert(0, str(Path(__file__).parents[1] / "support"))
from meshes import sample_bottle

from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.linalg.threads import cores_for
from apd_viewer.geometry.solver.deformation import Deformation

ENDS, JITTER = 0.1, 0.01
# Parts of a path, degrees or shares; and frames at least between two of them.
LEGS, EACH = {"twist": 67.0, "fold": 34.0, "push": 0.16}, 4


class Painted:
    """A mesh held at two ends."""

    def __init__(self, name: str) -> None:
        if name == "bottle":
            self.V, self.F, labels = sample_bottle()
            high, low = labels == 2, labels == 0
        else:
            mesh = open_mesh(name)
            self.V, self.F = mesh.V, mesh.F
        self.axis = int(np.ptp(self.V, axis=0).argmax())
        x = self.V[:, self.axis]
        self.length = float(np.ptp(x))
        if name != "bottle":
            high, low = x > x.max() - ENDS * self.length, x < x.min() + ENDS * self.length
        self.fixed, self.handle = np.flatnonzero(high | low), np.flatnonzero(high)
        self.rows = high[self.fixed]

    def path(self, pose: str, shift: np.ndarray) -> list[np.ndarray]:
        """Targets one after another; the shift is reached with the last."""
        kind, amount = pose.split(":")
        most = float(amount)
        along, across = np.eye(3)[self.axis], np.eye(3)[(self.axis + 1) % 3]
        pivot, targets = self.V.mean(axis=0), []
        for share in np.linspace(0.0, 1.0, 1 + int(np.ceil(most / LEGS[kind])))[1:]:
            X = self.V[self.fixed].copy()
            if kind == "push":
                X[self.rows] -= share * most * self.length * along
            else:
                turn = Rotation.from_rotvec(share * np.radians(most) * (along if kind == "twist" else across))
                X[self.rows] = turn.apply(X[self.rows] - pivot) + pivot
            X[self.rows] += share * shift
            targets.append(X)
        return targets


def row(painted: Painted, pose: str, shift: np.ndarray, told: argparse.Namespace, contact: bool) -> str:
    """Cells of a run: where it went, its crossed frames, and its largest errors."""
    V, F, fixed = painted.V, painted.F, painted.fixed
    how = {"method": told.method, "stiffness": told.stiffness}
    solver = Deformation(V, F, fixed, handle=painted.handle, contact=contact, **how)
    exempt = solver.contact.contact.exempt_vertices if contact else []
    G = np.asfortranarray(F[~np.isin(F, exempt).any(axis=1)], dtype=np.int32)
    mesh = ipctk.CollisionMesh(np.asfortranarray(V), ipctk.edges(G), G)
    crossed = frames = 0
    area = held = 0.0
    path, most = painted.path(pose, shift), told.frames
    for leg, targets in enumerate(path):
        solver.aim(targets)
        count, last = 0, leg == len(path) - 1
        while frames < most and not solver.settled and (last or count < EACH or solver.is_on_its_way):
            frame = solver.step()
            frames += 1
            count += 1
            crossed += ipctk.has_intersections(mesh, np.asfortranarray(frame.U))
            area = max(area, abs(frame.area_error))
            if contact:
                reached = solver.contact.held_positions[: len(fixed)]
                held = max(held, float(np.abs(frame.U[fixed] - reached).max()))
        if frames >= most or solver.share_reached < 1.0:
            break
    share = 100.0 * (leg + (solver.contact.path_fraction if contact else 1.0)) / len(path)
    end = "settled" if solver.settled else "going on"
    stopped = ", stopped" if contact and solver.contact.is_stopped else ""
    return f"{share:.0f} %, {end}{stopped} | {frames} | {crossed} | {len(exempt)} | {area:.0e} | {held:.0e} |"


def main() -> None:
    """Print a row for every run."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("meshes", nargs="+")
    parser.add_argument("--poses", nargs="+", default=["twist:400", "fold:200", "push:0.95"])
    parser.add_argument("--method", default="exact", choices=["exact", "local", "arap"])
    parser.add_argument("--stiffness", type=float, default=0.0)
    parser.add_argument("--jitters", type=int, default=0)
    parser.add_argument("--frames", type=int, default=1000, help="at most")
    told = parser.parse_args()
    print("| mesh | pose | run | reached | frames | crossed | exempt | area error | held off by |")
    print("|---|---|---|---|---|---|---|---|---|")
    for path in told.meshes:
        painted = Painted(path)
        name = Path(path).name
        diagonal = np.linalg.norm(np.ptp(painted.V, axis=0))
        with cores_for(len(painted.V)):
            for pose in told.poses:
                begin = f"| {name} | {pose} |"
                still = np.zeros(3)
                print(begin, "no contact |", row(painted, pose, still, told, False), flush=True)
                for seed in range(told.jitters + 1):
                    shift = np.random.default_rng(seed).uniform(-1, 1, 3) * JITTER * diagonal * (seed > 0)
                    print(begin, f"{seed} |", row(painted, pose, shift, told, True), flush=True)


main()
