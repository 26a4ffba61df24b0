"""Draw the figures of the README.

Run ``python resources/make_figures.py [folder]``; without a folder the pictures land beside this
script. It needs no display.
"""

from __future__ import annotations

import os
import shutil
import sys
import tempfile
from pathlib import Path

import numpy as np

from apd_viewer.__main__ import main
from apd_viewer.figures.drawing import color_map
from apd_viewer.files.samples import open_sample, resource
from apd_viewer.files.selections import read_transform
from apd_viewer.geometry.constraints import constraints
from apd_viewer.geometry.deform import deform
from apd_viewer.geometry.operators import face_areas

ITERATIONS = 400
NAMES = {"arap": "ARAP", "paper": "Paper", "exact": "Exact", "local": "Local"}
LIMIT = 10.0  # percent; the colours end here
SIZE = (2000, 1000)
INK = "#24292f"
LOOK = np.array([0.55, 0.28, 1.0])


def methods(folder: Path) -> None:
    """The bottle twisted by 120 degrees by every method, coloured by local area change."""
    if sys.platform.startswith("linux"):
        os.environ["VTK_DEFAULT_OPENGL_WINDOW"] = "vtkEGLRenderWindow"
    import pyvista as pv

    mesh, labels = open_sample("bottle")
    rest = face_areas(mesh.V, mesh.F)
    held = constraints(labels, mesh.V, [read_transform(resource("bottle-twist-120.def"))])
    panels = [(mesh.V, "Rest", "")]
    for method, name in NAMES.items():
        result = deform(mesh.V, mesh.F, held.fixed, held.targets, method, ITERATIONS, handle=held.handles)
        change = np.abs(face_areas(result.U, mesh.F) / rest - 1)
        words = (
            f"total area {100 * result.area_error:+.3f} %\n"
            f"local change {100 * (change * rest).sum() / rest.sum():.2f} %\n"
            f"handle drift {result.handle_drift:.2f} cm"
        )
        panels.append((result.U, name, words.replace("-0.000", "0.000").replace("+0.000", "0.000")))

    plotter = pv.Plotter(off_screen=True, shape=(1, len(panels)), border=False, window_size=list(SIZE))
    plotter.set_background("white")
    everything = np.concatenate([U for U, _, _ in panels])
    for column, (U, title, words) in enumerate(panels):
        plotter.subplot(0, column)
        surface = pv.PolyData.from_regular_faces(U, mesh.F)
        surface.cell_data["change"] = 100 * np.log(face_areas(U, mesh.F) / rest)
        plotter.add_mesh(
            surface,
            scalars="change",
            cmap=color_map(),
            clim=(-LIMIT, LIMIT),
            show_scalar_bar=False,
            smooth_shading=True,
            ambient=0.25,
            specular=0.1,
        )
        plotter.add_text(title, position=(40, SIZE[1] - 80), font_size=20, color=INK, font="arial")
        if words:
            plotter.add_text(words, position=(40, 30), font_size=12, color=INK, font="arial")
        else:
            plotter.add_scalar_bar(
                "local area change, %",
                position_x=0.08,
                position_y=0.02,
                width=0.8,
                height=0.09,
                n_labels=3,
                fmt="%.0f",
                color=INK,
                font_family="arial",
                title_font_size=26,
                label_font_size=24,
            )
        aim(plotter, everything)
    plotter.enable_anti_aliasing("ssaa")
    plotter.screenshot(folder / "methods.png")
    plotter.close()


def aim(plotter: object, points: np.ndarray) -> None:
    """Look at all of ``points`` in the same way in every panel."""
    low, high = points.min(axis=0), points.max(axis=0)
    camera = plotter.camera
    camera.parallel_projection = True
    camera.parallel_scale = 0.66 * (high - low)[1]
    camera.focal_point = (low + high) / 2 - [0.0, 0.06 * (high - low)[1], 0.0]
    camera.position = camera.focal_point + 100 * LOOK / np.linalg.norm(LOOK)
    camera.up = (0.0, 1.0, 0.0)
    plotter.renderer.reset_camera_clipping_range()


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
