"""Commands without a window or display: deform, info, replay."""

from __future__ import annotations

import json
import sys
import tempfile
from contextlib import ExitStack
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING

from apd_viewer.commands.paper import paper_parser
from apd_viewer.commands.parser import Parser
from apd_viewer.commands.sweep import sweep_parser
from apd_viewer.errors import InputError
from apd_viewer.figures.shapes import Picture, check_picture, draw_shapes, no_pictures
from apd_viewer.files.mesh_writing import Written, check_target, save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.files.report import room_of, write_report
from apd_viewer.files.selections.selection_files import read_selection_file
from apd_viewer.files.selections.survey_formats import read_region, read_transform
from apd_viewer.files.storage.atomic_file import replacing
from apd_viewer.geometry.analysis.inspection import inspect
from apd_viewer.geometry.analysis.self_intersections import crossings
from apd_viewer.geometry.analysis.shape_check import examined
from apd_viewer.geometry.pose.constraints import constraints
from apd_viewer.geometry.pose.frame import Frame
from apd_viewer.geometry.solver.deform import MOST_ITERATIONS, Result, deform
from apd_viewer.geometry.solver.goals import Region
from apd_viewer.geometry.solver.methods import (
    DEFAULT_AREA_STIFFNESS,
    DEFAULT_METHOD,
    DEFAULT_SHEAR_STIFFNESS,
    DEFAULT_TOLERANCE,
    METHODS,
)
from apd_viewer.language import tr
from apd_viewer.presentation.palette import label_colors
from apd_viewer.session.model.status_text import about_caps, of_crossings
from apd_viewer.session.studies.replay import replay

if TYPE_CHECKING:
    import argparse
    from collections.abc import Callable, Sequence

    from apd_viewer.files.selections.selection import Selection
    from apd_viewer.geometry.mesh.mesh import Mesh

_MOST_VERTICES = 100  # of a finding in a report
_PICTURE = (1600, 1000)  # pixels
_ROUNDED = 1e-6  # relative change of the area by the digits of a file that is worth a word


def _deform_parser() -> Parser:
    parser = Parser(prog="apd-viewer deform", description=tr("Deform a mesh without a window."))
    parser.add_argument("mesh", metavar="MESH")
    parser.add_argument(
        "--selection",
        metavar="SEL",
        required=True,
        help=tr(
            "one label per vertex (0 base, 1 free, 2 handle, 3 next handle, ...), or .json, .npz, .dmat, .ply"
        ),
    )
    parser.add_argument(
        "--transform",
        metavar="DEF",
        required=True,
        action="append",
        help=tr("4x4 matrix that moves the handle; repeat for each handle"),
    )
    parser.add_argument("-o", "--output", metavar="OUT", required=True, help=tr("mesh file to write"))
    parser.add_argument("--method", choices=METHODS, default=DEFAULT_METHOD, help=tr("default: %(default)s"))
    parser.add_argument(
        "--iterations", metavar="N", type=int, help=tr("run exactly N iterations; default: until converged")
    )
    parser.add_argument(
        "--tolerance",
        metavar="T",
        type=float,
        default=DEFAULT_TOLERANCE,
        help=tr("area tolerance of 'paper'; 0.001 is 0.1 %%"),
    )
    _add_targets(parser)
    _add_stiffness(parser)
    parser.add_argument("--report", metavar="R.json", type=Path, help=tr("write the measurements as JSON"))
    parser.add_argument("--picture", metavar="P.png", type=Path, help=tr("draw the mesh before and after"))
    parser.set_defaults(run=_deform)
    return parser


def _add_targets(parser: Parser) -> None:
    parser.add_argument(
        "--area",
        metavar="PERCENT",
        type=float,
        help=tr(
            "target of the total area, in percent of the rest area; default: 100 for 'exact' and 'paper'"
        ),
    )
    parser.add_argument(
        "--volume",
        metavar="PERCENT",
        type=float,
        help=tr("target of the volume, in percent of the rest volume; default: free"),
    )
    parser.add_argument(
        "--region",
        nargs="+",
        action="append",
        default=[],
        metavar=("NAME FILE", "PERCENT"),
        help=tr(
            "region to measure: name, file with one number per vertex (0 outside), optional target "
            "area in percent"
        ),
    )


def _add_stiffness(parser: Parser) -> None:
    for option, default, what in (
        (
            "--stiffness",
            0.0,
            tr("bending stiffness, 0 (cloth) to 0.1 (sheet metal); CGAL's alpha for 'sr-arap'"),
        ),
        (
            "--area-stiffness",
            DEFAULT_AREA_STIFFNESS,
            tr("how strongly 'local' keeps the area of each triangle"),
        ),
        (
            "--shear-stiffness",
            DEFAULT_SHEAR_STIFFNESS,
            tr("how strongly 'local' keeps the shape of each triangle"),
        ),
    ):
        parser.add_argument(
            option,
            metavar="A",
            type=float,
            default=default,
            help=tr("{what}; default: %(default)s").format(what=what),
        )


def _region(words: Sequence[str], vertices: int) -> Region:
    """A region from the words after ``--region``."""
    if len(words) not in (2, 3):
        raise InputError(tr("--region takes a name, a file and an optional target area in percent."))
    name, path, *percent = words
    try:
        area = float(percent[0]) if percent else None
    except ValueError as error:
        raise InputError(
            tr("--region {name}: {percent} is not a percentage; enter a number.").format(
                name=name, percent=percent[0]
            )
        ) from error
    return Region(name, read_region(path, vertices), area)


def _info_parser() -> Parser:
    parser = Parser(prog="apd-viewer info", description=tr("Check a mesh file and describe its contents."))
    parser.add_argument("mesh", metavar="MESH")
    parser.add_argument("--json", action="store_true", help=tr("print JSON, for scripts"))
    parser.set_defaults(run=_info)
    return parser


def _replay_parser() -> Parser:
    parser = Parser(prog="apd-viewer replay", description=tr("Re-run a saved session without a window."))
    parser.add_argument("session", metavar="SESSION", help=tr("session file (.apd) saved by the window"))
    parser.add_argument("-o", "--output", metavar="OUT", required=True, help=tr("mesh file to write"))
    parser.add_argument("--report", metavar="R.json", type=Path, help=tr("write the measurements as JSON"))
    parser.add_argument(
        "--from-rest",
        action="store_true",
        help=tr("start from the rest shape; default: a saved shape that has converged is kept"),
    )
    parser.set_defaults(run=_replay)
    return parser


def _deform(options: argparse.Namespace) -> None:
    output = check_target(options.output)
    if options.picture:
        check_picture(options.picture)
    mesh = open_mesh(options.mesh)
    selection = read_selection_file(options.selection, mesh)
    held = constraints(selection.labels, mesh.V, [read_transform(path) for path in options.transform])
    result = deform(
        mesh.V,
        mesh.F,
        held.fixed,
        held.targets,
        options.method,
        options.iterations,
        options.tolerance,
        options.stiffness,
        handle=held.handles,
        area_stiffness=options.area_stiffness,
        shear_stiffness=options.shear_stiffness,
        area=options.area,
        volume=options.volume,
        regions=[_region(words, len(mesh.V)) for words in options.region],
        progress=_progress(options.iterations) if sys.stderr.isatty() else None,
    )
    picture = _picture(mesh, selection, result) if options.picture else None
    with ExitStack() as beside:  # what comes beside the mesh takes its place only once the mesh has
        if picture:
            beside.enter_context(replacing(options.picture)).write_bytes(picture)
        written = _written(beside, mesh, result, options.report, output)
    print(_summary(mesh, result, output, written))
    if options.picture and not picture:
        print(no_pictures())


def _picture(mesh: Mesh, selection: Selection, result: Result) -> bytes | None:
    """Picture of the painted rest mesh and the result; None without OpenGL."""
    with tempfile.TemporaryDirectory(prefix="apd-viewer-") as folder:
        path = Path(folder) / "picture.png"
        readings = [" ".join(line.split()) for line in _readings(result)]
        words = [[tr("Rest")], [METHODS[result.method].short_title, *readings]]
        shapes = Picture(path, [mesh.V, result.U], words, label_colors(selection.labels))
        return path.read_bytes() if draw_shapes(mesh, [shapes], _PICTURE) else None


def _written(beside: ExitStack, mesh: Mesh, result: Result, report: Path | None, output: Path) -> Written:
    if report:
        write_report(beside.enter_context(replacing(report)), mesh, result)
    return save_mesh(mesh, result.U, output)


def _replay(options: argparse.Namespace) -> None:
    output = check_target(options.output)
    progress = _progress(None) if sys.stderr.isatty() else None
    mesh, result = replay(options.session, options.from_rest, progress)
    with ExitStack() as beside:
        written = _written(beside, mesh, result, options.report, output)
    print(_summary(mesh, result, output, written))


def _progress(iterations: int | None) -> Callable[[Frame], None]:
    """Show the progress of the iterations on one terminal line."""

    def show(frame: Frame) -> None:
        last = frame.iteration == (iterations or MOST_ITERATIONS) or (frame.settled and not iterations)
        if frame.iteration % 20 and not last:
            return
        area = 100 * frame.area_error
        said = tr("iteration {done:,}   area {area:+.3f} %").format(done=frame.iteration, area=area)
        if iterations:
            said = tr("iteration {done:,} of {all:,}   area {area:+.3f} %").format(
                done=frame.iteration, all=iterations, area=area
            )
        print(
            f"\r{said}   ",
            end="\n" if last else "",
            file=sys.stderr,
            flush=True,
        )

    return show


def _summary(mesh: Mesh, result: Result, output: Path, written: Written) -> str:
    effort = tr("{n:,} iterations in {seconds:.1f} s").format(n=result.iterations, seconds=result.seconds)
    state = tr("{output}: {method}, converged after {effort}")
    if not result.converged:
        state = tr("{output}: {method}, not converged after {effort}")
    lines = [state.format(output=output, method=result.method, effort=effort), *_readings(result)]
    lines += [found.sentence for found in of_crossings(mesh, crossings(result.U, mesh.joined_F))]
    lines += [f"“{part.name}”  {_reading(part.area, part.area_rest)}" for part in result.regions]
    lines.append(tr("largest local area change {change:.3g} %").format(change=100 * result.local_change))
    lines.append(tr("handle drift {drift:.4g}").format(drift=result.handle_drift))
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
                kind=kept, things=", ".join(written.dropped)
            )
        )
    return "\n".join([*lines, *result.warnings])


def _readings(result: Result) -> list[str]:
    lines = [tr("area    {reading}").format(reading=_reading(result.area, result.area_rest))]
    if result.volume is not None and result.volume_rest:
        lines.append(tr("volume  {reading}").format(reading=_reading(result.volume, result.volume_rest)))
    elif result.volume_capped is not None and result.volume_capped_rest:
        reading = _reading(result.volume_capped, result.volume_capped_rest)
        lines.append(
            tr("volume  {reading}, {caps}").format(reading=reading, caps=about_caps(result.openings))
        )
    return lines


def _reading(value: float, rest: float) -> str:
    change = round(100 * (value / rest - 1), 3) + 0.0 if rest else 0.0  # and no minus before a zero
    return tr("{value:.6g} of {rest:.6g} ({change:+.3f} %)").format(value=value, rest=rest, change=change)


def _info(options: argparse.Namespace) -> None:
    mesh = open_mesh(options.mesh)
    found, examination = inspect(mesh), examined(mesh.V, mesh.joined_F)
    all_found = [*found.findings, *of_crossings(mesh, examination.crossing)]
    if options.json:
        findings = [
            {
                "kind": finding.kind,
                "sentence": finding.sentence,
                "vertex_count": len(finding.vertices),
                "vertices": finding.vertices[:_MOST_VERTICES].tolist(),
            }
            for finding in all_found
        ]
        room = room_of(examination)
        report = {field.name: getattr(found, field.name) for field in fields(found)}
        print(json.dumps({"mesh": str(options.mesh), **report, **room, "findings": findings}, indent=2))
        return
    size = " x ".join(f"{extent:.6g}" for extent in found.size)
    print(
        tr("{name}: {vertices:,} vertices, {faces:,} triangles, {pieces:,} connected part(s)").format(
            name=mesh.name, vertices=found.vertices, faces=found.faces, pieces=found.pieces
        )
    )
    print(tr("size    {size}").format(size=size))
    print(tr("area    {reading}").format(reading=f"{found.area:.6g}"))
    volume = tr("none: {reason}").format(reason=found.why_no_volume)
    if found.volume is not None:
        volume = f"{found.volume:.6g}"
    print(tr("volume  {reading}").format(reading=volume))
    if found.volume_capped is not None:
        print(f"        {found.volume_capped:.6g} {about_caps(found.openings)}")
    packed = tr("box     {reading}, the volume of the smallest bounding box found")
    print(packed.format(reading=f"{examination.packed:.6g}"))
    for sentence in [finding.sentence for finding in all_found] or [tr("No issues found.")]:
        print(sentence)


PARSERS: dict[str, Callable[[], Parser]] = {
    "deform": _deform_parser,
    "info": _info_parser,
    "paper": paper_parser,
    "replay": _replay_parser,
    "sweep": sweep_parser,
}
