"""3D view of a report, with its shapes as compact arrays."""

import base64
import json
from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from apd_viewer.files.html_page import PageView
from apd_viewer.geometry.mesh.decimation import decimated_mesh
from apd_viewer.language import tr, trc
from apd_viewer.presentation.scales import Scale

MOST_TRIANGLES = 120_000  # drawn smoothly without a graphics card, and less than 65,536 vertices
MOST_BYTES = 7_000_000  # of all arrays; base64 adds a third
_DIRECTIONS = 100  # 12 degrees apart, so that room is 2 % too small at most, less than the margin of a view
_STEPS = 65535  # of a coordinate in 16 bits, across the box of a shape
_NO_VALUE = (160, 160, 160)  # colour of a vertex without a triangle
_FILES = "report_view.css", "mesh_view.js", "report_view.js"


class ShapeView(NamedTuple):
    """Deformed shape: name, positions (n, 3), and shades (n,) uint8."""

    name: str
    U: np.ndarray
    shades: np.ndarray


class ViewedMesh(NamedTuple):
    """Mesh at rest (n, 3), its triangles (m, 3), and paint (n, 3) uint8."""

    V: np.ndarray
    F: np.ndarray
    paint: np.ndarray


def report_view(
    mesh: ViewedMesh,
    shapes: Sequence[ShapeView],
    current: int,
    scale: Scale,
    direction: Sequence[float],
    up: Sequence[float],
    most_bytes: int = MOST_BYTES,
) -> PageView:
    """View of a mesh at rest and deformed, for a page.

    Parameters
    ----------
    shapes : sequence of ShapeView
        Deformed ones, in the order of the motion.
    current : int
        Number of the one shown first.
    scale : Scale
        Of their shades.
    direction, up : (3,) floats
        From the shape to the viewer, and upwards.
    most_bytes : int
        Of all arrays; with more, some shapes are left out.
    """
    kept, T = decimated_mesh(mesh.V, mesh.F, MOST_TRIANGLES // 2)
    fixed = (2 if len(kept) <= _STEPS else 4) * T.size + 9 * len(kept)
    room = max(1, int((most_bytes - fixed) / (7 * max(len(kept), 1))))
    chosen = _evenly_chosen(len(shapes), current, room)
    told = {
        "direction": [float(x) for x in direction],
        "up": [float(x) for x in up],
        "wide": len(kept) > _STEPS,
        "triangles": _text(T, "<u4" if len(kept) > _STEPS else "<u2"),
        "palette": _text(_palette(scale), "u1"),
        "rest": {**_shape(mesh.V[kept]), "paint": _text(mesh.paint[kept], "u1")},
        "shapes": [
            {
                "name": shapes[k].name,
                **_shape(shapes[k].U[kept]),
                "shades": _text(shapes[k].shades[kept], "u1"),
            }
            for k in chosen
        ],
        "extent": _outermost([mesh.V[kept], *(shapes[k].U[kept] for k in chosen)]).ravel().tolist(),
        "current": chosen.index(current),
        "pause": tr("Pause"),
    }
    notes = []
    if len(T) < len(mesh.F) and len(mesh.F) > MOST_TRIANGLES:
        sentence = tr("The view has {shown:,} of {n:,} triangles, which keeps this file small.")
        notes.append(sentence.format(shown=len(T), n=len(mesh.F)))
    if len(chosen) < len(shapes):
        sentence = tr("The view has {shown:,} of {n:,} steps, which keeps this file small.")
        notes.append(sentence.format(shown=len(chosen), n=len(shapes)))
    folder = Path(__file__).parent
    style, *scripts = ((folder / name).read_text(encoding="utf-8") for name in _FILES)
    return PageView(_html(told, notes), style, "\n".join(scripts))


def _html(told: dict[str, Any], notes: Sequence[str]) -> str:
    """HTML of a view with its data."""
    titles = {"deformed": tr("Deformed"), "rest": tr("Rest"), "overlay": trc("two shapes", "Overlay")}
    # By names, since the texts in f-strings are not found for translation.
    play, step = escape(tr("Play")), escape(tr("Step of the motion"))
    label, group = escape(tr("3D view of the shape")), escape(tr("Shape"))
    choices = "".join(
        f'<label><input type="radio" name="shape" value="{value}"{"" if k else " checked"}>'
        f"<span>{escape(title)}</span></label>"
        for k, (value, title) in enumerate(titles.items())
    )
    steps = ""
    if len(told["shapes"]) > 1:
        steps = (
            f'<div class="steps"><button type="button">{play}</button>'
            f'<input type="range" min="0" value="0" aria-label="{step}">'
            "<output></output></div>"
        )
    hint = tr("Drag to turn, scroll to zoom after a click, double-click to fit. Keys: arrows, + and −, Home.")
    lines = "".join(f'<p class="note">{escape(text)}</p>' for text in (hint, *notes))
    # Escaped in a string of JSON, so that a name cannot end the element.
    data = json.dumps(told, separators=(",", ":")).replace("<", "\\u003c")
    return (
        f'<div class="view" role="group" aria-label="{label}">\n'
        f'<div class="bar"><div class="choices" role="radiogroup" aria-label="{group}">'
        f"{choices}</div>{steps}</div>\n"
        f'<div class="stage"></div>\n{lines}\n<script type="application/json">{data}</script>\n</div>'
    )


def _evenly_chosen(count: int, current: int, most: int) -> list[int]:
    """Numbers of at most ``most`` shapes, evenly spaced, with the current one."""
    if count <= most:
        return list(range(count))
    if most == 1:
        return [current]
    chosen = np.linspace(0, count - 1, most).round().astype(int)
    chosen[np.abs(chosen - current).argmin()] = current
    return sorted(set(chosen.tolist()))


def _shape(X: np.ndarray) -> dict[str, Any]:
    """Positions (n, 3) as 16-bit whole numbers across their own box."""
    low, high = (X.min(axis=0), X.max(axis=0)) if len(X) else (np.zeros(3), np.zeros(3))
    size = np.where(high > low, high - low, 1.0)
    levels = np.rint((X - low) / size * _STEPS)
    return {"low": low.tolist(), "size": size.tolist(), "positions": _text(levels, "<u2")}


def _outermost(shapes: Sequence[np.ndarray]) -> np.ndarray:
    """Outermost points (100, 3) of shapes in directions all around."""
    k = np.arange(_DIRECTIONS) + 0.5
    height, turn = 1.0 - 2.0 * k / _DIRECTIONS, np.pi * (1.0 + 5.0**0.5) * k
    level = np.sqrt(1.0 - height**2)
    D = np.column_stack([level * np.cos(turn), level * np.sin(turn), height])
    found = np.stack([X[(X @ D.T).argmax(axis=0)] for X in shapes if len(X)])
    best = np.einsum("sdi,di->sd", found, D).argmax(axis=0)
    outermost: np.ndarray = found[best, np.arange(_DIRECTIONS)]
    return outermost


def _palette(scale: Scale) -> np.ndarray:
    """RGB (256, 3) of all shades; 0 is no value."""
    shades = np.arange(1, 256)
    signed = scale.measure.is_signed
    positions = 0.5 + (shades - 128) / 254.0 if signed else (shades - 1) / 254.0
    return np.vstack([[_NO_VALUE], scale.colors(positions)])


def _text(array: np.ndarray, kind: str) -> str:
    return base64.b64encode(np.ascontiguousarray(array).astype(kind).tobytes()).decode("ascii")
