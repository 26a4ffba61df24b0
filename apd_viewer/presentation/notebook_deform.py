"""Deform a mesh in one call, with progress and a result for notebooks."""

from __future__ import annotations

import base64
import inspect
from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import WRAPPER_ASSIGNMENTS, wraps
from html import escape
from typing import ParamSpec

import numpy as np

from apd_viewer.files.picture_files import png_content
from apd_viewer.geometry.mesh.arrays import checked_floats, checked_integers, diagonal, frozen
from apd_viewer.geometry.mesh.operators import face_areas
from apd_viewer.geometry.solver.deformation_result import Result, deform as quietly_deform
from apd_viewer.geometry.solver.methods import METHODS
from apd_viewer.language import tr
from apd_viewer.presentation import number_format
from apd_viewer.presentation.color_maps import DIVERGING
from apd_viewer.presentation.palette import FREE_COLOR
from apd_viewer.presentation.progress_line import ProgressLine
from apd_viewer.presentation.shape_picture import shape_picture

P = ParamSpec("P")
# Pickle finds a function by module and name, so the wrapper keeps its own module.
_SAME = [name for name in WRAPPER_ASSIGNMENTS if name != "__module__"]


def _wrap_deform(deform: Callable[P, Result]) -> Callable[P, NotebookResult]:
    """Wrap ``deform`` with a progress line and a result with pictures."""
    signature = inspect.signature(deform)

    @wraps(deform, assigned=_SAME)
    def shown(*given: P.args, **named: P.kwargs) -> NotebookResult:
        arguments = signature.bind(*given, **named).arguments
        asked = arguments.get("progress")
        is_wanted = isinstance(asked, bool | np.bool_) and bool(asked)
        line = ProgressLine(arguments.get("iterations")) if is_wanted else None
        if line is not None:
            named["progress"] = line
        try:
            result = deform(*given, **named)
        finally:
            if line is not None:
                line.end()
        rest, triangles = (
            checked_floats(arguments["V"], tr("Vertices")),
            checked_integers(arguments["F"], tr("Faces")),
        )
        return NotebookResult.from_result(result, frozen(rest), frozen(triangles))

    return shown


deform = _wrap_deform(quietly_deform)


_SIDE = 280  # pixels per side of each picture
_END = 0.1  # relative area change at the ends of the colour map
# Text inherits the page colour and lines are grey: legible on light and dark pages.
_CELL = "text-align:left;padding:2px 12px 2px 0;border-bottom:1px solid rgba(128,128,128,0.35)"


@dataclass(frozen=True, eq=False)
class NotebookResult(Result):
    """Result with a picture and a table of readings for notebooks.

    Attributes
    ----------
    rest : (n, 3) float array
        The rest shape.
    triangles : (m, 3) int array
    """

    rest: np.ndarray
    triangles: np.ndarray

    @classmethod
    def from_result(cls, result: Result, rest: np.ndarray, triangles: np.ndarray) -> NotebookResult:
        """Result with the mesh for its pictures, from a plain result."""
        given = {field.name: getattr(result, field.name) for field in fields(result)}
        return cls(**given, rest=rest, triangles=triangles)

    def _repr_html_(self) -> str:
        """HTML with pictures of both shapes and a table of readings."""
        return f'<div style="color:inherit;background:none">{self._figure()}{_table(result_rows(self))}</div>'

    def _figure(self) -> str:
        pixels = shape_picture([self.rest, self.U], self.triangles, [FREE_COLOR, change_colors(self)], _SIDE)
        source = base64.b64encode(png_content(pixels)).decode()
        said = tr("Rest shape and deformed shape, coloured by its local area change up to ±{end} %")
        caption = escape(said.format(end=number_format.format_short(100 * _END)))
        return f'<img src="data:image/png;base64,{source}" alt="{caption}" title="{caption}">'


def change_colors(result: NotebookResult) -> np.ndarray:
    """Colours (m, 3) uint8 of the triangles by their relative area change."""
    areas, now = (face_areas(X, result.triangles) for X in (result.rest, result.U))
    with np.errstate(divide="ignore", invalid="ignore"):
        change = np.nan_to_num(np.log(now / areas), nan=0.0, posinf=_END, neginf=-_END)
    return DIVERGING.colors(0.5 + 0.5 * change / _END)


def result_rows(result: NotebookResult) -> list[tuple[str, str]]:
    """Names and texts of the readings of a result."""
    ended = tr("{n:,} iterations, converged") if result.converged else tr("{n:,} iterations, not converged")
    region, seconds = tr("Region “{name}”"), number_format.format_significant(result.seconds, 3)
    return [
        (tr("Method"), METHODS[result.method].short_title),
        (tr("Effort"), f"{ended.format(n=result.iterations)}, {seconds}\u00a0s"),
        (tr("Area"), _change_text(result.area, result.area_rest)),
        *_volume_rows(result),
        *(
            (region.format(name=part.name), _change_text(part.area, part.area_rest))
            for part in result.regions
        ),
        (tr("Largest local area change"), f"{number_format.format_short(100 * result.local_change)}\u00a0%"),
        (
            tr("Largest edge strain"),
            f"{number_format.format_short_signed(100 * result.largest_edge_strain)}\u00a0%",
        ),
        (tr("Mean edge strain"), f"{number_format.format_short(100 * result.mean_edge_strain)}\u00a0%"),
        (tr("Handle drift"), number_format.format_length(result.handle_drift, diagonal(result.rest))),
        *((tr("Warning"), sentence) for sentence in result.warnings),
    ]


def _volume_rows(result: Result) -> list[tuple[str, str]]:
    """Row of the volume, capped if open; none if nothing is enclosed."""
    if result.volume is not None and result.volume_rest:
        return [(tr("Volume"), _change_text(result.volume, result.volume_rest))]
    if result.volume_capped is not None and result.volume_capped_rest:
        return [(tr("Volume, capped"), _change_text(result.volume_capped, result.volume_capped_rest))]
    return []


def _change_text(value: float, rest: float) -> str:
    change = number_format.format_signed(100.0 * (value / rest - 1.0), 3) if rest else "0.000"
    return tr("{now} of {rest} ({change} %)").format(
        now=number_format.format_significant(value),
        rest=number_format.format_significant(rest),
        change=change,
    )


def _table(rows: list[tuple[str, str]]) -> str:
    lines = (
        f'<tr style="background:none"><th scope="row" style="{_CELL}">{escape(name)}</th>'
        f'<td style="{_CELL}">{escape(reading)}</td></tr>'
        for name, reading in rows
    )
    return f'<table style="color:inherit;background:none;border-collapse:collapse">{"".join(lines)}</table>'
