"""The ``deform`` command: deform a mesh without a window or display."""

import argparse
import sys
import tempfile
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path

import numpy as np

from apd_viewer.commands import result_output
from apd_viewer.commands.motion_options import add_motion_options, motion_from
from apd_viewer.commands.terminal import setting_options
from apd_viewer.commands.terminal.command_output import CommandOutput, json_path
from apd_viewer.commands.terminal.mesh_options import add_division_options, add_weld_option, open_input_mesh
from apd_viewer.commands.terminal.parser import Parser, add_option, add_report_option
from apd_viewer.errors import InputError
from apd_viewer.figures.rendered_pictures import Picture, check_picture, draw_shapes, no_pictures_reason
from apd_viewer.files.mesh_writing import check_files, check_mesh_path, check_shapes, save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.files.report import report_fields
from apd_viewer.files.selections.selection import Selection, default_name
from apd_viewer.files.selections.selection_files import read_selection_file
from apd_viewer.files.selections.survey_formats import read_region, read_transform
from apd_viewer.files.storage.atomic_file import replacing_file
from apd_viewer.geometry.analysis.target_shape import TargetShape
from apd_viewer.geometry.goals.goals import Region
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, FREE, constraints
from apd_viewer.geometry.solver.deformation_result import Result, deform
from apd_viewer.geometry.solver.loose_components import GO, STAY
from apd_viewer.geometry.solver.methods import METHODS
from apd_viewer.geometry.solver.settings import SETTINGS
from apd_viewer.language import tr
from apd_viewer.presentation.palette import label_colors
from apd_viewer.session.model.document_parts import with_selection
from apd_viewer.session.model.handle_paths import intermediate_documents
from apd_viewer.session.model.named_obstacle import geometric_obstacles
from apd_viewer.session.model.state import initial_document
from apd_viewer.session.posing.motion_path import document_along_paths, motion_paths
from apd_viewer.session.storage.part_json import read_obstacles

# Left out: hold_area, implied by an area target, contact, whose default depends on the mesh size, and
# filled_volume, a volume target in a unit.
_SETTINGS = [name for name in SETTINGS if name not in ("hold_area", "contact", "filled_volume")]
_PICTURE = (1600, 1000)  # size of the picture in pixels


def deform_parser() -> Parser:
    """Argument parser for the ``deform`` command."""
    parser = Parser(prog="apd-viewer deform", description=tr("Deform a mesh without a window."))
    add_option(parser, "MESH")
    about = tr(
        "one label per vertex (0 base, 1 free, 2 handle, 3 next handle, ...), or .json, .npz, .dmat, .ply"
    )
    add_option(parser, "--selection SEL", about)
    about = tr("4x4 matrix that moves the handle; repeat for each handle")
    add_option(parser, "--transform DEF", about, default=[], action="append")
    add_motion_options(parser)
    add_option(parser, "-o, --output OUT", tr("mesh file to write"), required=True)
    setting_options.add_setting_options(parser, _SETTINGS)
    setting_options.add_contact_option(parser)
    add_option(parser, "--young E", tr("Young's modulus of the wall, such as 2.8GPa, for a pressure"))
    add_option(parser, "--iterations N", tr("run exactly N iterations; default: until converged"), type=int)
    about = tr(
        "connected parts without base or handle go along with the nearest surface, or stay; "
        "default: %(default)s"
    )
    add_option(parser, "--loose", about, choices=(GO, STAY), default=GO)
    about = tr("plates, spheres and cylinders that push, in the format of a session; turns contact on")
    add_option(parser, "--obstacles FILE.json", about, type=Path)
    add_weld_option(parser)
    add_division_options(parser)
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
    add_report_option(parser)
    about = tr("target shape: add the distance from the surface of another mesh to report and scalars")
    add_option(parser, "--compare OTHER", about)
    result_output.add_scalar_options(parser)
    add_option(parser, "--picture P.png", tr("draw the mesh before and after"), type=Path)
    parser.set_defaults(run=_deform)
    return parser


def _region(words: Sequence[str], vertices: int) -> Region:
    """Region from the values of the ``--region`` option."""
    if len(words) not in (2, 3):
        raise InputError(tr("--region takes a name, a file and an optional target area in percent."))
    name, path, *percent = words
    return Region(name, read_region(path, vertices), percent[0] if percent else None)


def _deform(options: argparse.Namespace) -> CommandOutput:
    output = check_mesh_path(options.output)
    if options.picture:
        check_picture(options.picture)
    result_output.check_scalar_options(options)
    check_files([output, options.picture, json_path(options.json), *result_output.scalar_files(options)])
    mesh = open_input_mesh(options.mesh, options.weld, options.unit, options.chord, options.edge)
    obstacles = read_obstacles(options.obstacles) if options.obstacles else ()
    contact = setting_options.has_contact(options, len(mesh.V))
    if options.thickness is not None and not contact:
        raise InputError(tr("--thickness is the distance that walls keep in contact; add --contact."))
    selection = _selection(options, mesh)
    check_shapes(mesh, output, selection.labels != BASE)
    regions = [_region(words, len(mesh.V)) for words in options.region]
    ways = [
        constraints(selection.labels, mesh.V, poses, obstacles=bool(obstacles) or _is_filled(options))
        for poses in _handle_poses(options, mesh, selection)
    ]
    held = ways[-1]
    pushing = geometric_obstacles(obstacles, mesh.V)
    target = TargetShape(open_mesh(options.compare)) if options.compare else None
    last = options.iterations, options.most_iterations
    result = deform(
        mesh.V,
        mesh.F,
        held.fixed,
        held.targets if len(ways) == 1 else np.array([way.targets for way in ways]),
        iterations=options.iterations,
        handle=held.handles,
        loose=options.loose,
        **setting_options.setting_arguments(options, mesh) | {"contact": contact or options.contact},
        obstacles=pushing,
        shifts=np.array([each.shift for each in obstacles]).reshape(-1, 3),
        regions=regions,
        weld=options.weld,
        progress=result_output.progress_line_callback(*last) if sys.stderr.isatty() else None,
    )
    picture = _picture(mesh, selection, result) if options.picture else None
    with ExitStack() as beside:  # output files are replaced together, the mesh before the files beside it
        if picture:
            beside.enter_context(replacing_file(options.picture)).write_bytes(picture)
        painted = selection.labels, _member(regions, len(mesh.V))
        result_output.write_scalar_files(beside, options, mesh, result.U, *painted, target)
        written = save_mesh(mesh, result.U, output)
    lines = [result_output.result_summary(mesh, result, output, written)]
    lines += [no_pictures_reason()] if options.picture and not picture else []
    return CommandOutput(lines, lambda: report_fields(mesh, result, target))


def _handle_poses(options: argparse.Namespace, mesh: Mesh, selection: Selection) -> list[list[np.ndarray]]:
    """Poses (4, 4) of the handles at each waypoint."""
    if not options.motion:
        return [[read_transform(path) for path in options.transform]]
    if options.transform:
        raise InputError(tr("Give either --transform or a motion such as --twist, not both."))
    document = with_selection(initial_document(mesh), selection)
    paths = motion_paths(document, motion_from(options, document, mesh.unit))
    ended = document_along_paths(document, paths)
    ways = [[handle.pose for handle in each.handles] for each in (*intermediate_documents(ended), ended)]
    if options.iterations is not None and len(ways) > 1:
        raise InputError(tr("With --iterations handles turn at most half a turn; enter less, or omit it."))
    return ways


def _is_filled(options: argparse.Namespace) -> bool:
    return options.volume is not None or options.pressure is not None


def _selection(options: argparse.Namespace, mesh: Mesh) -> Selection:
    """Painted selection from the options; optional only if obstacles push the mesh."""
    moves = options.transform or options.motion or options.obstacles or _is_filled(options)
    if options.selection and moves:
        return read_selection_file(options.selection, mesh)
    if not options.obstacles:
        raise InputError(
            tr("Give --selection with --transform or a motion such as --twist, or --obstacles that push.")
        )
    labels, member = np.full(len(mesh.V), FREE, dtype=np.uint8), np.zeros(len(mesh.V), dtype=np.uint8)
    return Selection(labels, member, (default_name(tr("Handle"), 1),))


def _member(regions: Sequence[Region], vertices: int) -> np.ndarray:
    """Region number of each vertex, 0 for none; the last one where regions overlap."""
    member = np.zeros(vertices, dtype=np.uint8)
    for k, region in enumerate(regions, start=1):
        member[region.vertices] = k
    return member


def _picture(mesh: Mesh, selection: Selection, result: Result) -> bytes | None:
    """Picture of the painted rest mesh and the result; None without OpenGL."""
    with tempfile.TemporaryDirectory(prefix="apd-viewer-") as folder:
        path = Path(folder) / "picture.png"
        lines = [" ".join(line.split()) for line in result_output.result_lines(result)]
        words = [[tr("Rest")], [METHODS[result.method].short_title, *lines]]
        shapes = Picture(path, [mesh.V, result.U], words, [label_colors(selection.labels)])
        return path.read_bytes() if draw_shapes(mesh, [shapes], _PICTURE) else None
