"""Deform a mesh in one call, with progress and a result for notebooks."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import WRAPPER_ASSIGNMENTS, wraps
from typing import ParamSpec

import numpy as np

from apd_viewer.geometry.mesh.arrays import checked_floats, checked_integers, frozen
from apd_viewer.geometry.solver.deformation_result import Result
from apd_viewer.geometry.solver.deformation_result import deform as quietly_deform
from apd_viewer.language import tr
from apd_viewer.presentation.notebooks.pictured_result import PicturedResult
from apd_viewer.presentation.notebooks.progress_line import ProgressLine

P = ParamSpec("P")
# Processes are sent a function by its module and name.
_SAME = [name for name in WRAPPER_ASSIGNMENTS if name != "__module__"]


def _is_asked(progress: object) -> bool:
    return isinstance(progress, bool | np.bool_) and bool(progress)


def _shown(deform: Callable[P, Result]) -> Callable[P, PicturedResult]:
    """The function with the progress and the result of notebooks."""
    signature = inspect.signature(deform)

    @wraps(deform, assigned=_SAME)
    def shown(*given: P.args, **named: P.kwargs) -> PicturedResult:
        arguments = signature.bind(*given, **named).arguments
        line = ProgressLine(arguments.get("iterations")) if _is_asked(arguments.get("progress")) else None
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
        return PicturedResult.of(result, frozen(rest), frozen(triangles))

    return shown


deform = _shown(quietly_deform)
