"""The ``buckle`` command: linear buckling modes of a wall between two plates."""

import argparse
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from apd_viewer.commands.press_band_output import CylinderAsWide, cylinder_lines
from apd_viewer.commands.result_output import mesh_remarks
from apd_viewer.commands.terminal.command_output import CommandOutput
from apd_viewer.commands.terminal.mesh_options import (
    add_axis_option,
    add_wall_options,
    add_weld_option,
    given_wall,
    mesh_and_start,
    parse_axis,
)
from apd_viewer.commands.terminal.parser import Parser, add_option
from apd_viewer.commands.terminal.progress import Progress
from apd_viewer.errors import InputError
from apd_viewer.figures.rendered_pictures import Picture, check_picture, draw_shapes, no_pictures_reason
from apd_viewer.files.mesh_writing import check_files, check_mesh_path, check_shapes, save_mesh
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.mesh.arrays import checked_direction, used_vertices
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.normals import vertex_normals
from apd_viewer.geometry.solver.linear_buckling import MOST_MODES, BucklingModes, modes_between_plates
from apd_viewer.geometry.solver.methods import wall_material
from apd_viewer.language import tr
from apd_viewer.presentation.color_maps import DIVERGING
from apd_viewer.presentation.number_format import format_exact
from apd_viewer.presentation.obstacle_readings import force_text
from apd_viewer.presentation.shape_picture import VIEW_DIRECTION
from apd_viewer.session.model.up_axis import UpAxis, standing_axis
from apd_viewer.session.quantities.newton_conversion import NewtonConversion, newton_conversion
from apd_viewer.session.quantities.units import Unit

_DRAWN = 0.03  # displacement of drawn modes, in diagonals
_PICTURED = 4  # most modes in a figure
_PANEL, _LETTERS = (420, 520), 2.0  # px: size of the picture of a mode; legible at half of it
_ARROW, _GAP = 0.15, 0.04  # length of the arrows and distance from the mesh, in diagonals


def buckle_parser() -> Parser:
    """Argument parser for the ``buckle`` command."""
    parser = Parser(
        prog="apd-viewer buckle",
        description=tr(
            "Find the lowest linear buckling modes of a thin elastic wall at rest between two plates."
        ),
    )
    add_option(parser, "MESH", tr("mesh, or a session whose mesh at rest is taken"))
    add_axis_option(parser)
    add_option(parser, "--modes N", tr("number of modes; default: %(default)s"), type=int, default=4)
    about = tr("mesh file to write: the modes, enlarged, as OUT-1, OUT-2 and so on")
    add_option(parser, "-o, --output OUT", about, type=Path)
    add_option(parser, "--figure F.png", tr("draw the first four modes"), type=Path)
    about = tr("direction drawn upright; default: where the mesh can stand, or that of its format, or y")
    add_option(parser, "--up AXIS", about)
    add_wall_options(parser)
    add_option(parser, "--progress-lines", tr("report progress as lines of JSON"))
    add_weld_option(parser)
    parser.set_defaults(run=_buckle)
    return parser


def _buckle(options: argparse.Namespace) -> CommandOutput:
    if not 1 <= options.modes <= MOST_MODES:
        sentence = tr("The number of modes must be a whole number from 1 to {most:,}.")
        raise InputError(sentence.format(most=MOST_MODES))
    if options.figure:
        check_picture(options.figure)
    paths, out = list[Path](), options.output
    if out:
        check_mesh_path(out)
        paths = [out.with_name(f"{out.stem}-{k + 1}{out.suffix}") for k in range(options.modes)]
    check_files([*paths, options.figure])
    axis = checked_direction(parse_axis(options.axis))
    mesh, _, unit = mesh_and_start(options.mesh, options.weld)
    up = UpAxis.nearest(parse_axis(options.up)) if options.up else _up_axis(mesh)
    if out:
        check_shapes(mesh, out, np.ones(len(mesh.V), dtype=bool))
    wall = given_wall(options, mesh, Unit(options.unit or unit))
    rest = RestMesh(mesh.V, mesh.F, mesh.weld)
    material = wall_material(rest.diagonal, wall.thickness, wall.nu)
    newtons = newton_conversion(wall, material, rest)
    cylinder = CylinderAsWide.between_plates(rest, axis, material)
    progress, doing = Progress(options.progress_lines), tr("finding buckling modes")
    progress.show(0.0, doing)
    modes = modes_between_plates(rest, axis, material, options.modes)
    progress.show(1.0, doing)
    progress.end()
    shapes = [rest.to_mesh_coordinates(rest.V + _DRAWN * rest.diagonal * each) for each in modes.shapes]
    for U, path in zip(shapes, paths, strict=False):
        save_mesh(mesh, U, path, wall.unit.symbol)
    name = next(filter(None, (*paths, options.figure)), mesh.name)
    lines = [tr("{output}: buckling modes, drawn enlarged").format(output=name)]
    lines += _lines(modes, wall.unit, newtons, cylinder)
    if shapes and options.figure and not _draw(mesh, shapes, modes, axis, up, newtons, options.figure):
        lines.append(no_pictures_reason())
    return CommandOutput(
        [*lines, *mesh_remarks(mesh)], lambda: {"mesh": mesh.name, **_fields(modes, newtons, cylinder)}
    )


def _up_axis(mesh: Mesh) -> UpAxis:
    suffix = "" if mesh.path is None else mesh.path.suffix
    return standing_axis(mesh) or UpAxis.from_suffix(suffix) or UpAxis.PLUS_Y


def _fields(
    modes: BucklingModes, newtons: NewtonConversion | None, cylinder: CylinderAsWide | None
) -> dict[str, object]:
    fields = {"buckling_loads": modes.loads.tolist(), "buckling_deflections": modes.deflections.tolist()}
    if newtons is not None:
        fields["buckling_loads_newton"] = (newtons.newtons_per_load * modes.loads).tolist()
    return fields if cylinder is None else fields | {"classical_load": cylinder.classical_load}


def _lines(
    modes: BucklingModes, unit: Unit, newtons: NewtonConversion | None, cylinder: CylinderAsWide | None
) -> list[str]:
    words = tr("mode {number}  buckles at {load}, deflection {deflection}")
    lines = []
    for k, (load, deflection) in enumerate(zip(modes.loads, modes.deflections, strict=True)):
        gone = unit.format_length(format_exact(float(deflection), 4))
        lines.append(words.format(number=k + 1, load=force_text(float(load), newtons), deflection=gone))
    if not lines:
        lines.append(tr("No buckling mode was found."))
    lines.append(
        tr(
            "Of a perfect wall at rest between smooth plates, without gas, pressure, targets, creases and "
            "contact of its walls; dents lower the loads."
        )
    )
    return lines if cylinder is None else lines + cylinder_lines(np.zeros(0), newtons, cylinder)


def _draw(
    mesh: Mesh,
    shapes: Sequence[np.ndarray],
    modes: BucklingModes,
    axis: np.ndarray,
    up: UpAxis,
    newtons: NewtonConversion | None,
    path: Path,
) -> bool:
    """Draw the first modes with arrows of the plates; False without OpenGL."""
    shown = slice(_PICTURED)
    words = [
        [tr("mode {number}").format(number=k + 1), force_text(float(load), newtons)]
        for k, load in enumerate(modes.loads[shown])
    ]
    N = vertex_normals(mesh.V, mesh.joined_F)
    outwards = [np.einsum("ij,ij->i", N, each) for each in modes.shapes[shown]]
    colors = [DIVERGING.colors(0.5 + 0.5 * each / abs(each).max()) for each in outwards]
    x, y, z = VIEW_DIRECTION @ up.frame
    return draw_shapes(
        mesh,
        [Picture(path, shapes[shown], words, colors)],
        (_PANEL[0] * len(words), _PANEL[1]),
        (x, y, z),
        tuple(up.direction),
        legend=False,
        letters=_LETTERS,
        arrows=_arrows(mesh.V[used_vertices(mesh.F)], axis),
    )


def _arrows(X: np.ndarray, axis: np.ndarray) -> np.ndarray:
    """Tails and tips of two arrows that press points (n, 3) along an axis, (2, 2, 3)."""
    low, high = X.min(axis=0), X.max(axis=0)
    size, heights, centre = np.linalg.norm(high - low), X @ axis, 0.5 * (low + high)
    beyond = size * np.array([_GAP + _ARROW, _GAP])
    levels = np.array([heights.min() - beyond, heights.max() + beyond]) - centre @ axis
    arrows: np.ndarray = centre + levels[..., None] * axis
    return arrows
