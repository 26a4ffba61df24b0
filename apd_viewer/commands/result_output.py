"""Output of a deformation: files, scalars, progress and summary."""

import argparse
import sys
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path

import numpy as np

from apd_viewer.commands.terminal.parser import add_option
from apd_viewer.errors import InputError
from apd_viewer.files.mesh_writing import WrittenMesh
from apd_viewer.files.scalar_files import ScalarRows, check_scalar_file, write_scalars
from apd_viewer.files.storage.atomic_file import replacing_file
from apd_viewer.geometry.analysis.mesh_findings import file_findings
from apd_viewer.geometry.analysis.scalars import shape_scalars
from apd_viewer.geometry.analysis.self_intersections import crossings
from apd_viewer.geometry.analysis.shape_check import seam_findings
from apd_viewer.geometry.analysis.target_shape import TargetShape
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.frame import Frame
from apd_viewer.geometry.solver.convergence import DEFAULT_CONVERGENCE
from apd_viewer.geometry.solver.deformation_result import Result
from apd_viewer.language import comma_separated, in_quotes, tr
from apd_viewer.presentation.progress_line import frame_line
from apd_viewer.session.model.status_text import caps_phrase, crossing_findings

_ROUNDED = 1e-6  # relative area change by rounding in the written file that calls for a warning


def progress_line_callback(
    iterations: int | None, most_iterations: int = DEFAULT_CONVERGENCE.most_iterations
) -> Callable[[Frame], None]:
    """Callback to show the progress of the iterations on one terminal line."""

    def show(frame: Frame) -> None:
        last = frame.iteration == (iterations or most_iterations) or (frame.settled and not iterations)
        if frame.iteration % 20 and not last:
            return
        print(f"\r{frame_line(frame, iterations)}   ", end="\n" if last else "", file=sys.stderr, flush=True)

    return show


def result_summary(mesh: Mesh, result: Result, output: Path, written: WrittenMesh) -> str:
    """Terminal lines about a finished deformation."""
    effort = tr("{n:,} iterations in {seconds:.1f} s").format(n=result.iterations, seconds=result.seconds)
    state = tr("{output}: {method}, converged after {effort}")
    if not result.converged:
        state = tr("{output}: {method}, not converged after {effort}")
    lines = [state.format(output=output, method=result.method, effort=effort), *result_lines(result)]
    crossing = crossings(result.U, mesh.joined_F)
    lines += [found.sentence for found in crossing_findings(mesh, crossing)]
    lines += [tr("self-intersections: not checked")] if crossing is None else []
    lines += [f"{in_quotes(part.name)}  {_reading(part.area, part.area_rest)}" for part in result.regions]
    lines.append(tr("largest local area change {change:.3g} %").format(change=100 * result.local_change))
    strains = 100 * result.largest_edge_strain, 100 * result.mean_edge_strain
    sentence = tr("largest edge strain {largest:+.3g} %, mean {mean:.3g} %")
    lines.append(sentence.format(largest=strains[0], mean=strains[1]))
    lines.append(tr("handle drift {drift:.4g}").format(drift=result.handle_drift))
    lines.append(tr("stability: {words}").format(words=result.stability))
    if abs(written.area / result.area - 1.0) > _ROUNDED:
        lines.append(
            tr("rounding in the file changes the area to {area:.6g}; OBJ and OFF are more precise").format(
                area=written.area
            )
        )
    if written.dropped:
        kept = output.suffix[1:].upper()
        lines.append(
            tr("written as {kind}, without the {things} of the mesh").format(
                kind=kept, things=comma_separated(written.dropped)
            )
        )
    return "\n".join([*lines, *result.warnings, *mesh.remarks])


def mesh_remarks(mesh: Mesh) -> list[str]:
    """Sentences about open seams of a mesh and peculiarities of its file."""
    return [found.sentence for found in (*seam_findings(mesh), *file_findings(mesh))]


def result_lines(result: Result) -> list[str]:
    """Lines about the area and volume relative to rest, and capped openings."""
    lines = [tr("area    {reading}").format(reading=_reading(result.area, result.area_rest))]
    if result.volume is not None and result.volume_rest:
        lines.append(tr("volume  {reading}").format(reading=_reading(result.volume, result.volume_rest)))
    elif result.volume_capped is not None and result.volume_capped_rest:
        reading = _reading(result.volume_capped, result.volume_capped_rest)
        lines.append(tr("volume  {reading}").format(reading=reading))
        lines.append(f"        {caps_phrase(result.openings)}")
    return lines


def _reading(value: float, rest: float) -> str:
    change = round(100 * (value / rest - 1), 3) + 0.0 if rest else 0.0  # adding 0.0 avoids a negative zero
    return tr("{value:.6g} of {rest:.6g} ({change:+.3f} %)").format(value=value, rest=rest, change=change)


def add_scalar_options(parser: argparse.ArgumentParser) -> None:
    """Add the options for scalar files of vertices and triangles."""
    about = tr("write area change, strain, displacement and labels: .ply, or .csv with one row per vertex")
    add_option(parser, "--scalars S.ply", about, type=Path)
    about = tr("write the scalars of the triangles, one row per triangle")
    add_option(parser, "--triangle-scalars T.csv", about, type=Path)


def figure_files(figure: Path | None) -> list[Path]:
    """The two files of a figure; none if it was not requested."""
    return [figure.with_name(f"{figure.stem}.{kind}") for kind in ("png", "svg")] if figure else []


def scalar_files(options: argparse.Namespace) -> tuple[Path | None, Path | None]:
    """Requested files of vertex and of triangle scalars; None if not requested."""
    return options.scalars, options.triangle_scalars


def check_scalar_options(options: argparse.Namespace) -> None:
    """Raise InputError if a file cannot hold scalars."""
    if options.scalars:
        check_scalar_file(options.scalars)
    if options.triangle_scalars and options.triangle_scalars.suffix.lower() != ".csv":
        name = options.triangle_scalars.name
        raise InputError(tr("{name} is not a table; use the ending .csv.").format(name=name))


def write_scalar_files(
    stack: ExitStack,
    options: argparse.Namespace,
    mesh: Mesh,
    U: np.ndarray,
    labels: np.ndarray,
    member: np.ndarray,
    target: TargetShape | None = None,
) -> None:
    """Write the requested scalar files; old files are replaced as ``stack`` closes."""
    asked = (options.scalars, ScalarRows.VERTICES), (options.triangle_scalars, ScalarRows.TRIANGLES)
    if not any(path for path, _ in asked):
        return
    scalars = shape_scalars(mesh, U, labels, member, target)
    for path, rows in asked:
        if path:
            write_scalars(stack.enter_context(replacing_file(path)), mesh, U, scalars, rows)
