"""Draw the figures of the documentation.

Run ``python resources/make_figures.py [folder]``; without a folder the pictures land beside this
script. It needs no display.
"""

from __future__ import annotations

import shutil
import sys
import tempfile
from pathlib import Path

import numpy as np

from apd_viewer.__main__ import main
from apd_viewer.figures.shapes import Picture, draw_shapes
from apd_viewer.files.samples import open_sample, resource
from apd_viewer.files.selections.survey_formats import read_transform
from apd_viewer.geometry.mesh.operators import face_areas
from apd_viewer.geometry.pose.constraints import constraints
from apd_viewer.geometry.solver.deform import deform
from apd_viewer.geometry.solver.methods import SHORT_NAMES
from apd_viewer.presentation.palette import label_colors
from apd_viewer.session.studies.sweep import SWEPT

ITERATIONS = 400
SIZE = (2000, 1000)


def methods(folder: Path) -> None:
    """The bottle twisted by 120 degrees by every method, coloured by local area change."""
    mesh, labels = open_sample("bottle")
    rest = face_areas(mesh.V, mesh.F)
    held = constraints(labels, mesh.V, [read_transform(resource("bottle-twist-120.def"))])
    shapes, words = [mesh.V], [["Rest"]]
    for method in SWEPT:
        result = deform(mesh.V, mesh.F, held.fixed, held.targets, method, ITERATIONS, handle=held.handles)
        change = np.abs(face_areas(result.U, mesh.F) / rest - 1)
        total = f"{100 * result.area_error:+.3f}".replace("-0.000", "0.000").replace("+0.000", "0.000")
        shapes.append(result.U)
        words.append(
            [
                SHORT_NAMES[method],
                f"total area {total} %",
                f"local change {100 * (change * rest).sum() / rest.sum():.2f} %",
                f"handle drift {result.handle_drift:.2f} cm",
            ]
        )
    assert draw_shapes(mesh, [Picture(folder / "methods.png", shapes, words, label_colors(labels))], SIZE)


def sweep(folder: Path) -> None:
    """Area, volume and energy of the bottle twisted by 0 to 180 degrees, by every method."""
    words = [str(resource("bottle.obj")), "--selection", str(resource("bottle.sel")), "--twist", "180deg"]
    with tempfile.TemporaryDirectory() as out:
        assert main(["sweep", *words, "--steps", "18", "-o", out]) == 0
        shutil.copy(Path(out) / "sweep.png", folder / "sweep.png")


def paper(folder: Path) -> None:
    """The shapes of the paper's tables, and the curves beside them."""
    with tempfile.TemporaryDirectory() as out:
        assert main(["paper", "-o", out]) == 0
        for name in ("bottle", "duck", "loss-against-angle", "handle"):
            shutil.copy(Path(out) / f"{name}.png", folder / f"paper-{name}.png")


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent
    for draw in (methods, sweep, paper):
        draw(target)
