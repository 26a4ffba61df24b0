"""The ``replay`` command: solve a saved session again."""

import argparse
import math
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from apd_viewer.cases.case import document_turns
from apd_viewer.commands import result_output
from apd_viewer.commands.terminal.animation_options import add_animation_option, is_film, scratch_path_beside
from apd_viewer.commands.terminal.command_output import CommandOutput, json_path
from apd_viewer.commands.terminal.parser import Parser, add_option, add_report_option
from apd_viewer.errors import InputError
from apd_viewer.files.animations import animation_files
from apd_viewer.files.animations.animation_shapes import Animation, ShapeRecorder
from apd_viewer.files.mesh_writing import check_files, check_mesh_path, save_mesh
from apd_viewer.files.report import report_fields
from apd_viewer.geometry.measuring.geodesics import geodesic_path
from apd_viewer.geometry.measuring.measurement import Measurement, measure
from apd_viewer.geometry.measuring.measurement_kind import MeasurementKind
from apd_viewer.geometry.measuring.surface_point import CarriedPath
from apd_viewer.geometry.pose.constraints import Constraints
from apd_viewer.geometry.pose.frame import Frame
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.deformation_result import Result, deformation_result, iterate_to_result
from apd_viewer.language import tr
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.document_parts import obstacle_shifts
from apd_viewer.session.model.state import State
from apd_viewer.session.model.status_text import missing_target_sentence
from apd_viewer.session.model.up_axis import mesh_up_axis
from apd_viewer.session.model.view import SESSION_SUFFIX, View
from apd_viewer.session.processes.document_deformation import deformation_of, document_iteration
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.storage.session_file import open_session

# Largest number of shapes in an animation, for a length of ten seconds.
_MOST = 240


def replay_parser() -> Parser:
    """Argument parser for the ``replay`` command."""
    parser = Parser(prog="apd-viewer replay", description=tr("Re-run a saved session without a window."))
    add_option(parser, "SESSION", tr("session file (.apd) saved by the window"))
    add_option(parser, "-o, --output OUT", tr("mesh file to write"), required=True)
    add_report_option(parser)
    result_output.add_scalar_options(parser)
    about = tr("start from the rest shape; default: a saved shape that has converged is kept")
    add_option(parser, "--from-rest", about)
    add_animation_option(parser, films=False)
    parser.set_defaults(run=_replay)
    return parser


def _replay(options: argparse.Namespace) -> CommandOutput:
    if Path(options.session).suffix.lower() != SESSION_SUFFIX:
        raise InputError(
            tr("{name} is not a session; give a .apd file.").format(name=Path(options.session).name)
        )
    output = check_mesh_path(options.output)
    result_output.check_scalar_options(options)
    _check_animations(options.animation)
    check_files([output, json_path(options.json), *result_output.scalar_files(options), *options.animation])
    progress = result_output.progress_line_callback(None) if sys.stderr.isatty() else None
    with animation_files.replacing_series(options.animation), ExitStack() as beside:
        shapes = ShapeRecorder(_scratch(beside), _MOST) if options.animation else None
        document, result = replay_session(
            options.session, options.from_rest, progress, None if shapes is None else shapes.add
        )
        mesh = document.mesh
        painted = document.labels, document.member
        result_output.write_scalar_files(beside, options, mesh, result.U, *painted, document.target_shape)
        _, view = open_session(options.session)
        if shapes is not None:
            _write_animations(options.animation, document, view, shapes, beside)
        unit = Unit(view.unit)
        written = save_mesh(mesh, result.U, output, mesh.unit if unit.is_guess else unit.symbol)
    lines = [result_output.result_summary(mesh, result, output, written)]
    lines += [missing] if (missing := missing_target_sentence(document)) else []
    report = partial(report_fields, mesh, result, document.target_shape)
    return CommandOutput(lines, lambda: {**report(), **measurements_report(document, result.U)})


def _scratch(stack: ExitStack) -> Path:
    return Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="apd-viewer-")))


def _check_animations(paths: Sequence[Path]) -> None:
    for path in paths:
        if is_film(path):
            raise InputError(
                tr("{name} cannot show a replay; use {kinds}, or apd-viewer sweep.").format(
                    name=path.name, kinds=", ".join(animation_files.ANIMATION_FORMATS)
                )
            )
        animation_files.check_animation(path)


def _write_animations(
    paths: Sequence[Path], document: Document, view: View, shapes: ShapeRecorder, stack: ExitStack
) -> None:
    """Write the shapes of the replay, timed by their iterations, as animations."""
    if not shapes.files:
        raise InputError(
            tr("The saved shape has converged, so there is nothing to animate; add --from-rest.")
        )
    painted = document.labels, document.member
    animation = Animation(
        *(document.mesh, *painted, shapes.files, shapes.numbers, document.target_shape),
        unit=view.unit,
        up_frame=mesh_up_axis(document.mesh, view.up_axis).frame,
    )
    for path in paths:
        animation_files.write_animation(animation, scratch_path_beside(path, stack))


def measurements_report(document: Document, U: np.ndarray) -> dict[str, list[dict[str, Any]]]:
    """Report field with the measurements at rest and at ``U`` (n, 3), if any.

    Lengths are in mesh units, angles in degrees; missing values are None.
    """
    shapes, F = (("_rest", document.mesh.V), ("", U)), document.mesh.joined_F

    def values(measurement: Measurement, X: np.ndarray) -> tuple[float | None, ...]:
        path = None
        if measurement.kind is MeasurementKind.GEODESIC:
            try:
                path = CarriedPath.from_polyline(geodesic_path(X, F, *measurement.points), X, F)
            except InputError:
                path = CarriedPath.empty()
        return measure(measurement, X, F, path, closed=document.closed_openings).values

    measured = [
        {
            "name": each.name,
            "kind": each.kind.value,
            **{
                f"{name}{suffix}": _number(value, power)
                for suffix, X in shapes
                for value, (name, power) in zip(values(each, X), each.kind.fields.items(), strict=True)
            },
        }
        for each in document.measurements
    ]
    return {"measurements": measured} if measured else {}


def _number(value: float | None, power: int) -> float | None:
    if value is None or math.isnan(value):
        return None
    return math.degrees(value) if power == 0 else value


def replay_session(
    path: str | Path,
    from_rest: bool = False,
    progress: Callable[[Frame], None] | None = None,
    on_shape: Callable[[np.ndarray], None] | None = None,
) -> tuple[Document, Result]:
    """Solve a saved session until its shape has converged.

    A saved shape that has already settled is only measured again.

    Parameters
    ----------
    from_rest : bool
        Begin with the rest shape, and go to where the handles are.
    progress : callable, optional
        Called with every Frame.
    on_shape : callable, optional
        Called with the shape (n, 3) that is gone on from, and with that of every frame; not called where the
        shape has settled.

    Raises
    ------
    InputError
        If the session cannot be opened, or nothing can be deformed in it; the message says why.
    """
    state, _ = open_session(path)
    document, started = state.document, time.perf_counter()
    if document.paint_problem:
        raise InputError(f"{Path(path).name}: {document.paint_problem}")
    held = document.constraints()
    solver = deformation_of(document, held)
    if not from_rest and _has_settled(state, held, solver):
        solver.aim(
            held.targets, state.frame.U, held.soft_targets, obstacle_shifts(document), _obstacle_shifts(state)
        )
        frame = replace(state.frame, iteration=0, handle_drift=_drift(held, state.frame.U))
        turns = document_turns(document, frame.U)
        return document, deformation_result(solver, frame, time.perf_counter() - started, 0.0, turns)
    way = document.relative_to_rest if from_rest else document
    walk = document_iteration(
        solver, way, None if from_rest else state.frame.U, start_shifts=_obstacle_shifts(state)
    )
    if on_shape:
        on_shape(way.initial_positions if from_rest else state.frame.U)

    def hear(frame: Frame) -> None:
        if on_shape:
            on_shape(frame.U)
        if progress:
            progress(frame)

    asked, turned = hear if on_shape or progress else None, partial(document_turns, document)
    return document, iterate_to_result(solver, walk, started, None, asked, turned)


def _has_settled(state: State, held: Constraints, solver: Deformation) -> bool:
    """True if the saved shape has converged with all targets met."""
    frame, document = state.frame, state.document
    if not frame.settled or (frame.converged and state.has_unmet_target):
        return False
    kept = held.fixed
    if document.settings.traits.moves_handles:
        kept = np.setdiff1d(kept, np.concatenate(held.handles))
    away = frame.U[kept] - held.targets[np.searchsorted(held.fixed, kept)]
    return bool(np.abs(away).max(initial=0.0) <= solver.rest.in_place_tolerance)


def _obstacle_shifts(state: State) -> np.ndarray | None:
    """Displacements of the obstacles in the saved shape; None if unknown."""
    come = state.frame.shifts
    return come if len(come) == len(obstacle_shifts(state.document)) else None


def _drift(held: Constraints, U: np.ndarray) -> float:
    """Largest distance of a handle's centre from its target."""
    places = [np.searchsorted(held.fixed, ids) for ids in held.handles]
    away = U[held.fixed] - held.targets
    return max((float(np.linalg.norm(away[rows].mean(axis=0))) for rows in places), default=0.0)
