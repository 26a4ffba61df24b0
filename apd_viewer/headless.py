"""The commands that need no window and no display."""

from __future__ import annotations

import json
import sys
from contextlib import ExitStack
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING

from apd_viewer import papertables
from apd_viewer.errors import InputError
from apd_viewer.files.meshes import Written, check_target, open_mesh, save_mesh
from apd_viewer.files.replacing import make_folder, replacing
from apd_viewer.files.report import write_report
from apd_viewer.files.selection_files import read_selection_file
from apd_viewer.files.selections import read_region, read_transform
from apd_viewer.geometry.constraints import constraints
from apd_viewer.geometry.deform import MOST_ITERATIONS, Result, deform
from apd_viewer.geometry.deformation import Frame
from apd_viewer.geometry.goals import Region
from apd_viewer.geometry.inspection import inspect
from apd_viewer.geometry.methods import (
    DEFAULT_AREA_STIFFNESS,
    DEFAULT_METHOD,
    DEFAULT_SHEAR_STIFFNESS,
    DEFAULT_TOLERANCE,
    METHODS,
)
from apd_viewer.parser import Parser
from apd_viewer.session.replaying import replay

if TYPE_CHECKING:
    import argparse
    from collections.abc import Callable, Sequence

    from apd_viewer.geometry.mesh import Mesh

_MOST_VERTICES = 100  # of a finding in a report
_ROUNDED = 1e-6  # relative change of the area by the digits of a file that is worth a word


def _deform_parser() -> Parser:
    parser = Parser(prog="apd-viewer deform", description="Deform a mesh without a window.")
    parser.add_argument("mesh", metavar="MESH")
    parser.add_argument(
        "--selection",
        metavar="SEL",
        required=True,
        help="one number a vertex: 0 held, 1 free, 2 handle, 3 the next, ...; or .json, .npz, .dmat, .ply",
    )
    parser.add_argument(
        "--transform",
        metavar="DEF",
        required=True,
        action="append",
        help="4x4 matrix that moves the handle; once for each handle",
    )
    parser.add_argument("-o", "--output", metavar="OUT", required=True, help="mesh file to write")
    parser.add_argument("--method", choices=METHODS, default=DEFAULT_METHOD, help="default: %(default)s")
    parser.add_argument("--iterations", metavar="N", type=int, help="exactly N; default: until converged")
    parser.add_argument(
        "--tolerance",
        metavar="T",
        type=float,
        default=DEFAULT_TOLERANCE,
        help="of the area, for 'paper'; 0.001 is 0.1 %%",
    )
    _add_targets(parser)
    _add_stiffness(parser)
    parser.add_argument("--report", metavar="R.json", type=Path, help="write the readings as JSON")
    parser.add_argument("--picture", metavar="P.png", type=Path, help="draw the mesh before and after")
    parser.set_defaults(run=_deform)
    return parser


def _add_targets(parser: Parser) -> None:
    parser.add_argument(
        "--area",
        metavar="PERCENT",
        type=float,
        help="total area asked for, in percent of the rest area; 100 for 'exact' and 'paper'",
    )
    parser.add_argument(
        "--volume", metavar="PERCENT", type=float, help="volume asked for; without, it is free"
    )
    parser.add_argument(
        "--region",
        nargs="+",
        action="append",
        default=[],
        metavar=("NAME FILE", "PERCENT"),
        help="a part to measure: its name, a file of one number a vertex (0 outside), and the area asked for",
    )


def _add_stiffness(parser: Parser) -> None:
    for option, default, what in (
        ("--stiffness", 0.0, "of bending, 0 (cloth) to 0.1 (sheet metal); CGAL's alpha for 'sr-arap'"),
        ("--area-stiffness", DEFAULT_AREA_STIFFNESS, "how firmly 'local' keeps every triangle's area"),
        ("--shear-stiffness", DEFAULT_SHEAR_STIFFNESS, "how firmly 'local' keeps every triangle's shape"),
    ):
        parser.add_argument(
            option, metavar="A", type=float, default=default, help=f"{what}; default: %(default)s"
        )


def _region(words: Sequence[str], vertices: int) -> Region:
    """A region from the words after ``--region``."""
    if len(words) not in (2, 3):
        raise InputError("--region takes a name, a file and, if an area is asked for, a percentage.")
    name, path, *percent = words
    try:
        area = float(percent[0]) if percent else None
    except ValueError as error:
        raise InputError(f"--region {name}: {percent[0]} is no percentage; write a number.") from error
    return Region(name, read_region(path, vertices), area)


def _info_parser() -> Parser:
    parser = Parser(prog="apd-viewer info", description="Say what is in a mesh file.")
    parser.add_argument("mesh", metavar="MESH")
    parser.add_argument("--json", action="store_true", help="for scripts")
    parser.set_defaults(run=_info)
    return parser


def _paper_parser() -> Parser:
    parser = Parser(prog="apd-viewer paper", description="Re-run the paper's tables on the samples.")
    parser.add_argument("-o", "--output", metavar="DIR", type=Path, help="folder for a CSV and pictures")
    parser.set_defaults(run=_paper)
    return parser


def _replay_parser() -> Parser:
    parser = Parser(prog="apd-viewer replay", description="Go on with a saved session without a window.")
    parser.add_argument("session", metavar="SESSION", help="file that the window has saved (.apd)")
    parser.add_argument("-o", "--output", metavar="OUT", required=True, help="mesh file to write")
    parser.add_argument("--report", metavar="R.json", type=Path, help="write the readings as JSON")
    parser.add_argument(
        "--from-rest",
        action="store_true",
        help="begin with the rest shape; without, a saved shape that has settled stays as it is",
    )
    parser.set_defaults(run=_replay)
    return parser


def _deform(options: argparse.Namespace) -> None:
    output = check_target(options.output)
    if options.picture:
        from apd_viewer.ui.picture import check_picture, draw

        check_picture(options.picture)
    mesh = open_mesh(options.mesh)
    labels = read_selection_file(options.selection, mesh).labels
    held = constraints(labels, mesh.V, [read_transform(path) for path in options.transform])
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
    with ExitStack() as beside:  # what comes beside the mesh takes its place only once the mesh has
        if options.picture:
            draw(mesh, labels, result, beside.enter_context(replacing(options.picture)))
        written = _written(beside, mesh, result, options.report, output)
    print(_summary(result, output, written))


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
    print(_summary(result, output, written))


def _progress(iterations: int | None) -> Callable[[Frame], None]:
    """Draw one line on the terminal, over and over, that says how far the iterations are."""

    def show(frame: Frame) -> None:
        last = frame.iteration == (iterations or MOST_ITERATIONS) or (frame.settled and not iterations)
        if frame.iteration % 20 and not last:
            return
        done = f"{frame.iteration:,}" + (f" of {iterations:,}" if iterations else "")
        print(
            f"\riteration {done}   area {100 * frame.area_error:+.3f} %   ",
            end="\n" if last else "",
            file=sys.stderr,
            flush=True,
        )

    return show


def _summary(result: Result, output: Path, written: Written) -> str:
    state = "converged" if result.converged else "not converged"
    effort = f"{result.iterations:,} iterations in {result.seconds:.1f} s"
    lines = [
        f"{output}: {result.method}, {state} after {effort}",
        f"area    {_reading(result.area, result.area_rest)}",
    ]
    if result.volume is not None and result.volume_rest:
        lines.append(f"volume  {_reading(result.volume, result.volume_rest)}")
    lines += [f"“{part.name}”  {_reading(part.area, part.area_rest)}" for part in result.regions]
    lines.append(f"triangles change by up to {100 * result.local_change:.3g} %")
    lines.append(f"handle  {result.handle_drift:.4g} from where it was put")
    if abs(written.area / result.area - 1.0) > _ROUNDED:
        lines.append(f"rounding in the file changes the area to {written.area:.6g}; OBJ and OFF round less")
    if written.dropped:
        kept = output.suffix[1:].upper()
        lines.append(f"written as {kept}, without the {', '.join(written.dropped)} of the mesh")
    return "\n".join([*lines, *result.warnings])


def _reading(value: float, rest: float) -> str:
    change = round(100 * (value / rest - 1), 3) + 0.0 if rest else 0.0  # and no minus before a zero
    return f"{value:.6g} of {rest:.6g} ({change:+.3f} %)"


def _info(options: argparse.Namespace) -> None:
    mesh = open_mesh(options.mesh)
    found = inspect(mesh)
    if options.json:
        findings = [
            {
                "kind": finding.kind,
                "sentence": finding.sentence,
                "vertex_count": len(finding.vertices),
                "vertices": finding.vertices[:_MOST_VERTICES].tolist(),
            }
            for finding in found.findings
        ]
        report = {field.name: getattr(found, field.name) for field in fields(found)}
        print(json.dumps({"mesh": str(options.mesh), **report, "findings": findings}, indent=2))
        return
    size = " x ".join(f"{extent:.6g}" for extent in found.size)
    print(f"{mesh.name}: {found.vertices:,} vertices, {found.faces:,} triangles, {found.pieces:,} piece(s)")
    print(f"size    {size}")
    print(f"area    {found.area:.6g}")
    print(f"volume  {f'none: {found.why_no_volume}' if found.volume is None else f'{found.volume:.6g}'}")
    for sentence in [finding.sentence for finding in found.findings] or ["Nothing unusual was found."]:
        print(sentence)


def _paper(options: argparse.Namespace) -> None:
    if options.output:
        make_folder(options.output)
    table = list(papertables.rows(options.output))
    print(papertables.markdown(table))
    if options.output:
        papertables.write_csv(table, options.output / "tables.csv")


PARSERS: dict[str, Callable[[], Parser]] = {
    "deform": _deform_parser,
    "info": _info_parser,
    "paper": _paper_parser,
    "replay": _replay_parser,
}
