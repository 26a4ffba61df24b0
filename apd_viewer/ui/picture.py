"""Draw a mesh before and after its deformation, without a window or a display."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.replacing import replacing
from apd_viewer.geometry.deform import Result
from apd_viewer.geometry.mesh import Mesh
from apd_viewer.language import tr
from apd_viewer.ui.palette import label_colors

_SIZE = (1600, 1000)
_INK = "#24292f"
_DIRECTION = np.array([0.55, 0.28, 1.0])


def draw(mesh: Mesh, labels: np.ndarray, result: Result, path: Path) -> None:
    """Write a picture of the rest pose and the deformed pose side by side.

    Parameters
    ----------
    mesh : Mesh
    labels : (n,) int array
        Base, free, handle: painted in the colours of the window.
    result : Result
    path : Path
        PNG file.

    Raises
    ------
    InputError
        If the name does not end in .png or the file cannot be written.
    """
    check_picture(path)
    if sys.platform.startswith("linux"):
        # VTK would try the X server first, complain where there is none, and die where it is broken.
        os.environ["VTK_DEFAULT_OPENGL_WINDOW"] = "vtkEGLRenderWindow"
    import pyvista as pv

    from apd_viewer.ui.shading import headlight, shade

    plotter = pv.Plotter(off_screen=True, shape=(1, 2), border=False, window_size=list(_SIZE), lighting=None)
    plotter.set_background("white")
    change = f"{100 * result.area_error:+.3f} %"
    # In English whatever the user speaks: VTK's letters are Latin ones.
    captions = (
        f"rest   area {result.area_rest:.5g}",
        f"{result.method}   area {result.area:.5g}  ({change})",
    )
    for column, (U, caption) in enumerate(zip((mesh.V, result.U), captions, strict=True)):
        plotter.subplot(0, column)
        surface = pv.PolyData.from_regular_faces(U, mesh.F)
        surface.point_data["label"] = label_colors(labels)
        shade(plotter.add_mesh(surface, scalars="label", rgb=True, smooth_shading=True))
        plotter.renderer.AddLight(headlight())
        plotter.add_text(caption, position=(40, _SIZE[1] - 70), font_size=18, color=_INK, font="arial")
        _aim(plotter, np.concatenate([mesh.V, result.U]))
    plotter.enable_anti_aliasing("ssaa")
    with replacing(path) as scratch:
        plotter.screenshot(scratch)
    plotter.close()


def check_picture(path: Path) -> None:
    """Raise InputError unless ``path`` names a picture."""
    if path.suffix.lower() != ".png":
        raise InputError(tr("{name} is no name for a picture; end it in .png.").format(name=path.name))


def _aim(plotter: object, points: np.ndarray) -> None:
    """Look at all of ``points`` in the same way in either half, so that the two compare."""
    low, high = points.min(axis=0), points.max(axis=0)
    centre, radius = (low + high) / 2, np.linalg.norm(high - low) / 2
    camera = plotter.camera  # type: ignore[attr-defined]
    distance = 1.12 * radius / np.sin(np.radians(camera.view_angle / 2))
    camera.focal_point = centre
    camera.position = centre + distance * _DIRECTION / np.linalg.norm(_DIRECTION)
    camera.up = (0.0, 1.0, 0.0)
    plotter.renderer.reset_camera_clipping_range()  # type: ignore[attr-defined]
