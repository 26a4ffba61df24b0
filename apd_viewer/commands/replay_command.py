"""The command replay: re-run a saved session."""

from __future__ import annotations

import argparse
import math
import sys
import tempfile
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np

from apd_viewer.cases.session_replay import replay_session
from apd_viewer.commands.result_output import result_summary, show_progress_line, write_result
from apd_viewer.commands.scalar_output import (
    add_scalar_options,
    check_scalar_options,
    scalar_files,
    write_scalar_files,
)
from apd_viewer.commands.terminal.animation_options import (
    add_animation_option,
    is_film,
    scratch_path_beside,
)
from apd_viewer.commands.terminal.output_files import check_files
from apd_viewer.commands.terminal.parser import Parser
from apd_viewer.errors import InputError
from apd_viewer.files.animations.animation_files import (
    ANIMATION_FORMATS,
    check_animation,
    replacing_series,
    write_animation,
)
from apd_viewer.files.animations.animation_shapes import Animation, ShapeRecorder
from apd_viewer.files.mesh_writing import check_mesh_path
from apd_viewer.geometry.measuring.geodesics import geodesic_path
from apd_viewer.geometry.measuring.measurement import Measurement, measure
from apd_viewer.geometry.measuring.measurement_kind import MeasurementKind
from apd_viewer.geometry.measuring.surface_point import CarriedPath
from apd_viewer.language import tr
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.status_text import about_missing_target
from apd_viewer.session.model.view import SESSION_SUFFIX

# Shapes of an animation: ten seconds of them.
_MOST = 240


def replay_parser() -> Parser:
    """Parser of the command replay."""
    parser = Parser(prog="apd-viewer replay", description=tr("Re-run a saved session without a window."))
    parser.add_argument("session", metavar="SESSION", help=tr("session file (.apd) saved by the window"))
    parser.add_argument("-o", "--output", metavar="OUT", required=True, help=tr("mesh file to write"))
    parser.add_argument("--report", metavar="R.json", type=Path, help=tr("write the measurements as JSON"))
    add_scalar_options(parser)
    parser.add_argument(
        "--from-rest",
        action="store_true",
        help=tr("start from the rest shape; default: a saved shape that has converged is kept"),
    )
    add_animation_option(parser, films=False)
    parser.set_defaults(run=_replay)
    return parser


def _replay(options: argparse.Namespace) -> None:
    if Path(options.session).suffix.lower() != SESSION_SUFFIX:
        raise InputError(
            tr("{name} is not a session; give a .apd file.").format(name=Path(options.session).name)
        )
    output = check_mesh_path(options.output)
    check_scalar_options(options)
    _check_animations(options.animation)
    check_files([output, options.report, *scalar_files(options), *options.animation])
    progress = show_progress_line(None) if sys.stderr.isatty() else None
    with replacing_series(options.animation), ExitStack() as beside:
        shapes = ShapeRecorder(_scratch(beside), _MOST) if options.animation else None
        document, result = replay_session(
            options.session, options.from_rest, progress, None if shapes is None else shapes.add
        )
        mesh = document.mesh
        painted = document.labels, document.member
        write_scalar_files(beside, options, mesh, result.U, *painted, document.target_shape)
        more = measurements_report(document, result.U) if options.report else {}
        if shapes is not None:
            _write_animations(options.animation, document, shapes, beside)
        written = write_result(beside, mesh, result, options.report, output, document.target_shape, more)
    print(result_summary(mesh, result, output, written))
    if missing := about_missing_target(document):
        print(missing)


def _scratch(stack: ExitStack) -> Path:
    return Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="apd-viewer-")))


def _check_animations(paths: Sequence[Path]) -> None:
    for path in paths:
        if is_film(path):
            raise InputError(
                tr("{name} cannot show a replay; use {kinds}, or apd-viewer sweep.").format(
                    name=path.name, kinds=", ".join(ANIMATION_FORMATS)
                )
            )
        check_animation(path)


def _write_animations(
    paths: Sequence[Path], document: Document, shapes: ShapeRecorder, stack: ExitStack
) -> None:
    """Write the shapes of the replay, by their iterations."""
    if not shapes.files:
        raise InputError(
            tr("The saved shape has converged, so there is nothing to animate; add --from-rest.")
        )
    painted = document.labels, document.member
    animation = Animation(document.mesh, *painted, shapes.files, shapes.numbers, document.target_shape)
    for path in paths:
        write_animation(animation, scratch_path_beside(path, stack))


_FIELDS = {0: "angle", 1: "length", 2: "area"}


def measurements_report(document: Document, U: np.ndarray) -> dict[str, list[dict[str, Any]]]:
    """Field of a report with the measurements at rest and at ``U`` (n, 3), if any.

    Lengths are in mesh units, angles in degrees; what cannot be measured is None.
    """
    shapes, F = (("_rest", document.mesh.V), ("", U)), document.mesh.joined_F
    measured = [
        {
            "name": each.name,
            "kind": each.kind.value,
            **{
                f"{_FIELDS[power]}{suffix}": _number(value, power)
                for suffix, X in shapes
                for value, power in zip(_values(each, X, F), each.kind.powers, strict=True)
            },
        }
        for each in document.measurements
    ]
    return {"measurements": measured} if measured else {}


def _values(measurement: Measurement, U: np.ndarray, F: np.ndarray) -> tuple[float | None, ...]:
    path = None
    if measurement.kind is MeasurementKind.GEODESIC:
        try:
            path = CarriedPath.from_polyline(geodesic_path(U, F, *measurement.points), U, F)
        except InputError:
            path = CarriedPath.empty()
    return measure(measurement, U, F, path).values


def _number(value: float | None, power: int) -> float | None:
    if value is None or math.isnan(value):
        return None
    return math.degrees(value) if power == 0 else value
