"""Rendering of shapes side by side, in a separate process.

Without OpenGL, VTK crashes the process that renders.
"""

import json
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pyvista as pv
from matplotlib.colors import LinearSegmentedColormap

from apd_viewer.geometry.mesh.operators import face_areas
from apd_viewer.presentation.color_maps import DIVERGING
from apd_viewer.ui.scene.surface_shading import headlight, shade

_LIMIT = 10.0  # area change in percent at the ends of the colour scale
_INK, _QUIET = "#1d2129", "#5a6270"
_EDGE, _TITLE, _BELOW = 0.05, 0.03, 0.17  # space for text, as fractions of the height
_MARGIN = 1.04
_LETTERS = 44  # picture height in pixels per point of title size


def main(job: str) -> None:
    """Draw the pictures of a job, printing the number of each when it is done."""
    if sys.platform.startswith("linux"):
        # By default VTK tries the X server first: it warns if there is none, and crashes if it is broken.
        os.environ["VTK_DEFAULT_OPENGL_WINDOW"] = "vtkEGLRenderWindow"
    folder = Path(job)
    description = json.loads((folder / "job.json").read_text(encoding="utf-8"))
    F, rest = np.load(folder / "faces.npy"), np.load(folder / "rest.npy")
    shapes = [np.load(path) for picture in description["pictures"] for path in picture["shapes"]]
    _draw(description, F, rest, shapes)


def _draw(job: dict[str, Any], F: np.ndarray, rest: np.ndarray, shapes: list[np.ndarray]) -> None:
    count, size = len(job["pictures"][0]["shapes"]), job["size"]
    plotter = pv.Plotter(off_screen=True, shape=(1, count), border=False, window_size=size, lighting=None)
    plotter.set_background("white")
    for renderer in plotter.renderers:
        renderer.AddLight(headlight())
    plotter.enable_anti_aliasing("ssaa")
    look, up = np.array(job["look"]), np.array(job["up"])
    arrows, above = np.array(job["arrows"]).reshape(-1, 2, 3), 0.02 + _EDGE + _TITLE * job["letters"]
    fit = _common_view([*shapes, *arrows], look, up, size[0] / count / size[1], above)
    areas = face_areas(rest, F)
    for number, picture in enumerate(job["pictures"]):
        for column in range(count):
            plotter.subplot(0, column)
            plotter.renderer.clear_actors()
            U, paints = shapes[number * count + column], picture["paints"]
            if column < len(paints):
                _show(plotter, F, U, np.load(paints[column]), rgb=True)
            else:
                _show_change(plotter, F, U, areas)
            for tail, tip in arrows:
                plotter.add_mesh(pv.Arrow(tail, tip - tail, scale="auto"), color=_QUIET)
            _write(plotter, picture["words"][column], max(map(len, picture["words"])), size[1], job)
            _set_camera(plotter, look, up, *fit)
        plotter.subplot(0, 0)
        _legend(plotter, job["legend"], size[0] / count, job["font"])
        plotter.screenshot(picture["path"])
        print(number, flush=True)  # noqa: T201
    plotter.close()


def _show(plotter: Any, F: np.ndarray, U: np.ndarray, scalars: np.ndarray, **settings: Any) -> None:
    surface = pv.PolyData.from_regular_faces(U, F)
    shade(plotter.add_mesh(surface, scalars=scalars, smooth_shading=True, show_scalar_bar=False, **settings))


def _show_change(plotter: Any, F: np.ndarray, U: np.ndarray, areas: np.ndarray) -> None:
    with np.errstate(divide="ignore", invalid="ignore"):
        change = np.nan_to_num(100 * np.log(face_areas(U, F) / areas))
    colors = LinearSegmentedColormap.from_list("change", np.array(DIVERGING.knots) / 255.0)
    _show(plotter, F, U, change, cmap=colors, clim=(-_LIMIT, _LIMIT))


def _write(plotter: Any, words: Sequence[str], most: int, high: int, job: dict[str, Any]) -> None:
    """Write a title at the top and lines at the bottom, padded to ``most`` lines."""
    letters = high / _LETTERS * job["letters"]
    left, top = 0.03 * high, high * (1 - _EDGE - _TITLE * job["letters"])
    title, *lines = words
    lines += [" "] * (most - len(words))  # padding aligns the first lines of all panels
    look: dict[str, Any] = {"font": "arial", "font_file": job["font"]}
    plotter.add_text(title, position=(left, top), font_size=letters, color=_INK, **look)
    if lines:
        low = (left, 0.035 * high)
        plotter.add_text("\n".join(lines), position=low, font_size=0.66 * letters, color=_QUIET, **look)


def _legend(plotter: Any, title: str, wide: float, font: str | None) -> None:
    """Draw the colour legend below the rest shape."""
    if not title:
        return
    high = plotter.window_size[1]
    letters = 0.66 * high / _LETTERS
    left = (0.03 * high + 1.5 * letters) / wide  # indented by half the width of the first number
    plotter.add_text(
        title,
        position=(0.03 * high, 0.11 * high),
        font_size=letters,
        color=_QUIET,
        font="arial",
        font_file=font,
        name="legend",
    )
    plotter.add_scalar_bar(
        "",
        position_x=left,
        position_y=0.03,
        width=1.0 - 2 * left,
        height=0.075,
        n_labels=3,
        fmt="%.0f",
        color=_QUIET,
        font_family="arial",
        label_font_size=round(2.0 * letters),
        unconstrained_font_size=True,
        render=False,
    )


def _common_view(
    shapes: list[np.ndarray], view_direction: np.ndarray, up: np.ndarray, aspect: float, above: float
) -> tuple[np.ndarray, float, float]:
    """Centre, half height and depth of a view of all shapes.

    ``aspect`` is the width of a panel over its height, ``above`` the share of the title.
    """
    toward = view_direction / np.linalg.norm(view_direction)
    right = np.cross(up, toward)
    right /= np.linalg.norm(right)
    axes = np.array([right, np.cross(toward, right), toward])
    low = np.min([(U @ axes.T).min(axis=0) for U in shapes], axis=0)
    high = np.max([(U @ axes.T).max(axis=0) for U in shapes], axis=0)
    width, height, depth = high - low
    half = _MARGIN * max(width / aspect, height / (1 - above - _BELOW)) / 2
    middle = (low + high) / 2
    middle[1] += (above - _BELOW) * half  # centres the shapes between title and lines
    return middle @ axes, float(half), float(depth)


def _set_camera(
    plotter: Any, view_direction: np.ndarray, up: np.ndarray, middle: np.ndarray, half: float, depth: float
) -> None:
    """Set the camera of a panel to the view common to all shapes."""
    camera = plotter.camera
    camera.parallel_projection = True
    camera.parallel_scale = half
    camera.focal_point = middle
    camera.position = middle + (depth + half) * 2 * view_direction / np.linalg.norm(view_direction)
    camera.up = up
    plotter.renderer.reset_camera_clipping_range()
