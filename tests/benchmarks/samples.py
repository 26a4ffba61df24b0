"""Fold the sample cloth twice and press the sample cushion: crossings, areas and time of every frame.

    python tests/benchmarks/samples.py [fold] [hand] [plates]

The handle goes by 3° or 0.25 cm, four iterations each, as in a slow drag. Then the cloth is painted across,
and folded once more. Plates press the cushion to 40 % of its height, in 24 steps. Crossings and changes are
those of every frame; a change is the mean of that of each triangle's area, weighted by its area. Times are
those of the processor, on one core, without these checks.
"""

import os
import sys
import time
from collections.abc import Callable
from dataclasses import replace

os.environ.setdefault("NUMBA_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

from apd_viewer.files.samples import resource_path
from apd_viewer.files.selections.survey_formats import read_transform
from apd_viewer.geometry.analysis.self_intersections import crossings
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.operators import face_areas
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE
from apd_viewer.geometry.solver.plate_press import PlatePress
from apd_viewer.geometry.warmup import warm_up
from apd_viewer.session.file_jobs import sample_state
from apd_viewer.session.model.document import Document
from apd_viewer.session.processes.document_deformation import deformation_of

COLUMNS = (
    "",
    "frames",
    "crossed",
    "area error",
    "largest change",
    "at the end",
    "ms",
    "median",
    "p95",
    "settled",
)
ACROSS = 5.0  # cm: what is farther from the middle is held, or handle, in the second fold
ABOVE = 0.1  # cm: its axis is above the folded cloth
LIFTED = 3.0  # degrees
SETTLING, MOST = 300, 100  # frames at most: let go, and of each step of the plates


class Watch:
    """Times and readings of the frames of a surface."""

    def __init__(self, V: np.ndarray, F: np.ndarray) -> None:
        self._F, self._rest = F, face_areas(V, F)
        self._times: list[float] = []
        self._changes: list[float] = []
        self._worst, self._crossed = 0.0, 0

    def time(self, iterate: Callable[[], object]) -> None:
        begun = time.process_time()
        iterate()
        self._times.append(1e3 * (time.process_time() - begun))

    def look(self, U: np.ndarray) -> None:
        now = face_areas(U, self._F)
        self._changes.append(100.0 * np.abs(now - self._rest).sum() / self._rest.sum())
        self._worst = max(self._worst, abs(now.sum() / self._rest.sum() - 1.0))
        self._crossed += bool(len(crossings(U, self._F)))

    def print_row(self, name: str, settled: bool) -> None:
        """Print a row of the table."""
        changes = f"{max(self._changes):.3f} % | {self._changes[-1]:.3f} %"
        times = np.mean(self._times), *np.percentile(self._times, [50, 95])
        pace = " | ".join(f"{milliseconds:.0f}" for milliseconds in times)
        frames = f"{len(self._changes)} | {self._crossed} | {self._worst:.0e}"
        print(f"| {name} | {frames} | {changes} | {pace} | {settled} |", flush=True)


def drag(name: str, document: Document, poses: list[np.ndarray], U: np.ndarray) -> np.ndarray:
    """Shape after a drag of the handle along ``poses`` from the shape ``U``; prints two rows."""
    held = document.constraints()
    solver = deformation_of(document, held)
    solver.aim(held.targets, U)
    dragged = Watch(document.mesh.V, document.mesh.F)
    for pose in poses:
        solver.aim(document.with_pose(0, pose).constraints().targets)
        count = 0
        while count < 4 or solver.is_on_its_way:
            dragged.time(solver.iterate)
            dragged.look(solver.frame().U)
            count += 1
    reached = solver.share_reached
    dragged.print_row(f"{name}, dragged to {100.0 * reached:.0f} %", solver.settled)
    resting = Watch(document.mesh.V, document.mesh.F)
    for _ in range(SETTLING):
        resting.time(solver.iterate)
        resting.look(solver.frame().U)
        if solver.settled:
            break
    resting.print_row(f"{name}, let go", solver.settled)
    return solver.frame().U


def turned(axis: int, sign: float, pivot: np.ndarray, degrees: float) -> np.ndarray:
    """Pose (4, 4) of a turn about a coordinate axis through ``pivot``."""
    pose, (i, j) = np.eye(4), ((axis + 1) % 3, (axis + 2) % 3)
    c, s = np.cos(np.radians(degrees)), sign * np.sin(np.radians(degrees))
    pose[[i, i, j, j], [i, j, i, j]] = c, -s, s, c
    pose[:3, 3] = pivot - pose[:3, :3] @ pivot
    return pose


def fold() -> None:
    """Fold the cloth by its handle, and once more across."""
    document = sample_state("cloth").document
    angles = np.arange(LIFTED, 180.0 + LIFTED, LIFTED)
    pivot = document.pivot(0)
    poses = [turned(0, 1.0, pivot, angle) for angle in angles]
    np.testing.assert_allclose(poses[-1], read_transform(resource_path("cloth-fold.def")), atol=1e-9)
    U = frozen(drag("first fold", document, poses, document.mesh.V))
    x = document.mesh.V[:, 0]
    labels = np.where(x < -ACROSS, BASE, np.where(x > ACROSS, HANDLE, FREE)).astype(np.uint8)
    document = replace(document, labels=frozen(labels), initial_positions=U)
    pivot = np.array([0.0, U[:, 1].max() + ABOVE, 0.0])
    drag("second fold", document, [turned(2, 1.0, pivot, angle) for angle in angles], U)


def hand() -> None:
    """Press the cushion by its handle."""
    document = sample_state("cushion").document
    down = read_transform(resource_path("cushion-press.def"))
    poses = [np.eye(4) + share * (down - np.eye(4)) for share in np.linspace(0.0, 1.0, 21)[1:]]
    drag("pressed by hand", document, poses, document.mesh.V)


def plates() -> None:
    """Press the cushion between plates."""
    document = sample_state("cushion").document
    V, F = document.mesh.V, document.mesh.F
    names = "method", "stiffness", "area_stiffness", "shear_stiffness", "area"
    settings = {name: getattr(document.settings, name) for name in names}
    press = PlatePress(RestMesh(V, F), np.eye(3)[1], 0.4 * np.ptp(V[:, 1]), 24, **settings)
    watch = Watch(V, F)
    for share in np.linspace(0.0, 1.0, 25)[1:]:
        press.set_target(share)
        count = 0
        while not press.solver.settled and not press.is_stopped and count < MOST:
            watch.time(press.solver.iterate)
            watch.look(press.solver.frame().U)
            count += 1
    watch.print_row(f"between plates, {100.0 * press.travel_fraction:.0f} % of the way", press.solver.settled)


def main() -> None:
    """Print the table."""
    warm_up()
    print(f"| {' | '.join(COLUMNS)} |\n{'|---' * len(COLUMNS)}|")
    for name in sys.argv[1:] or ("fold", "hand", "plates"):
        {"fold": fold, "hand": hand, "plates": plates}[name]()


if __name__ == "__main__":
    main()
