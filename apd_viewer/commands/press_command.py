"""The ``press`` command: press a mesh between two closing plates."""

import argparse
from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from apd_viewer.commands.press_band_output import CylinderAsWide, band_fields, band_lines, band_rows
from apd_viewer.commands.press_output import (
    load_conditions,
    press_report,
    press_rows,
    press_summary,
    pressure_pascals,
    still_weight,
    weight_fields,
    weight_lines,
)
from apd_viewer.commands.result_output import figure_files, mesh_remarks
from apd_viewer.commands.terminal.command_output import CommandOutput, json_path
from apd_viewer.commands.terminal.mesh_options import (
    add_axis_option,
    add_wall_options,
    add_weld_option,
    given_wall,
    mesh_and_start,
    parse_axis,
)
from apd_viewer.commands.terminal.parser import Parser, add_option, add_report_option
from apd_viewer.commands.terminal.progress import Progress
from apd_viewer.commands.terminal.setting_options import (
    add_criteria,
    add_setting_options,
    given_criteria,
    volume_arguments,
)
from apd_viewer.errors import InputError
from apd_viewer.files.mesh_writing import check_files, check_mesh_path, check_shapes, save_mesh
from apd_viewer.files.storage.atomic_file import replacing_file, staging_folder
from apd_viewer.files.tables import write_table
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.mesh.arrays import checked_direction, used_vertices
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.solver.convergence import DISTURBANCE, Convergence
from apd_viewer.geometry.solver.methods import DEFAULT_METHOD, METHODS, wall_material as thin_wall_material
from apd_viewer.geometry.solver.plate_press import DEFAULT_ITERATIONS, DEFAULT_STEPS, PlatePress
from apd_viewer.geometry.solver.press_band import (
    DEEPEST_DENTS,
    DEFAULT_DENTS,
    MOST_RUNS,
    PressBand,
    dented_positions,
)
from apd_viewer.geometry.solver.pressed_mesh import Pressed, press_between
from apd_viewer.geometry.solver.settings import Settings
from apd_viewer.language import tr
from apd_viewer.presentation.number_format import format_pressure
from apd_viewer.session.quantities.expressions import parse_number
from apd_viewer.session.quantities.newton_conversion import NewtonConversion, newton_conversion
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.wall import Wall, press_method
from apd_viewer.session.quantities.wall_material import parse_pressure, parse_pressure_difference

_PRESSING = [name for name, method in METHODS.items() if method.may_use_contact]
_DENT_LENGTH = 0.5  # length over which dents are smooth, in roots of diagonal times thickness
_MODULI = "stiffness", "area_stiffness", "shear_stiffness", "tension_field", "hardening"
_SETTINGS = *_MODULI, "area", "volume", "pressure"


def press_parser() -> Parser:
    """Argument parser for the ``press`` command."""
    parser = Parser(
        prog="apd-viewer press",
        description=tr(
            "Press a mesh between two plates that close in steps. Nothing needs to be held. Walls do not "
            "pass through each other, and the mesh comes to rest at each step."
        ),
    )
    add_option(parser, "MESH", tr("mesh at rest, or a session whose shape springs back and is pressed"))
    add_axis_option(parser)
    about = tr("final distance of the plates, in mesh units or as a fraction of the extent such as 20%%")
    add_option(parser, "--to DISTANCE", about, required=True)
    add_option(parser, "--steps N", tr("default: %(default)s"), type=int, default=DEFAULT_STEPS)
    add_option(parser, "-o, --output OUT", tr("mesh file to write"), type=Path)
    about = tr("write distance, loads, energy and volume of each step")
    add_option(parser, "--curve C.csv", about, type=Path)
    add_option(parser, "--figure F.png", tr("draw load and volume, as F.png and F.svg"), type=Path)
    add_report_option(parser)
    about = tr(
        "default: 'wall' where thickness and Young's modulus are known and no stiffness is given, otherwise "
        "'{method}'"
    ).format(method=DEFAULT_METHOD)
    add_option(parser, "--method", about, choices=_PRESSING)
    add_setting_options(parser, _SETTINGS)
    add_criteria(parser, DISTURBANCE)
    add_wall_options(parser)
    about = tr(
        "enclosed gas, openings capped: 1atm where newtons are known, or pressure times volume in surface "
        "areas; default: none"
    )
    add_option(parser, "--gas PRESSURE", about)
    add_option(parser, "--density D", tr("density, such as 1.38 (g/cm³), for the mass"))
    about = tr("walls bent to less than this radius keep a crease; default: that of the material, or none")
    add_option(parser, "--yield-radius LENGTH", about)
    about = tr("press so many times, each with other dents in the wall at rest, and tell the band of loads")
    add_option(parser, "--runs N", about, type=int, default=1)
    about = tr("depth of these dents, in percent of the wall thickness; default: 10 for several runs")
    add_option(parser, "--dents PERCENT", about, type=float)
    about = tr("weight on the upper plate, such as 2kg or 20N: the deflection at which the wall bears it")
    add_option(parser, "--weight W", about)
    about = tr("height from which this weight is dropped, such as 1.2m: the deflection at which it stops")
    add_option(parser, "--drop HEIGHT", about)
    add_option(parser, "--release", tr("open the plates again at the end, and write the remaining shape"))
    about = tr("mesh file to write as well: the shape before the plates open again")
    add_option(parser, "--crushed C", about, type=Path)
    about = tr("iteration limit per step; default: %(default)s")
    add_option(parser, "--iterations N", about, type=int, default=DEFAULT_ITERATIONS)
    add_option(parser, "--progress-lines", tr("report progress as lines of JSON"))
    add_weld_option(parser)
    parser.set_defaults(run=_press)
    return parser


def parse_distance(text: str) -> float | str:
    """Distance in mesh units, or percentage of the extent, from text."""
    if text.strip().endswith("%"):
        return f"{parse_number(text.strip()[:-1], {})!r}%"
    return parse_number(text, {})


def _press(options: argparse.Namespace) -> CommandOutput:
    meshes = [path for path in (options.output, options.crushed) if path]
    written = [*meshes, options.curve, *figure_files(options.figure), json_path(options.json)]
    if not any(written) and not options.json:
        raise InputError(tr("Nothing would be written; add -o, --curve, --figure or --json."))
    for path in meshes:
        check_mesh_path(path)
    check_files(written)
    axis = parse_axis(options.axis)
    mesh, start, unit = mesh_and_start(options.mesh, options.weld)
    for path in meshes:
        check_shapes(mesh, path, np.ones(len(mesh.V), dtype=bool))
    wall = _wall(options, mesh, Unit(options.unit or unit))
    rest = RestMesh(mesh.V, mesh.F, mesh.weld)
    method = _method(options, wall)
    moduli = options.stiffness, options.area_stiffness, options.shear_stiffness
    material = Settings(method, *moduli).material
    if METHODS[method].is_wall:
        material = thin_wall_material(rest.diagonal, wall.thickness, wall.nu)
    newtons = newton_conversion(wall, material, rest)
    keeps_apart = bool(options.thickness) and not METHODS[method].is_wall
    settings = {name: getattr(options, name) for name in _SETTINGS} | {
        **volume_arguments(options.volume, wall.unit.symbol),
        "method": method,
        "wall_thickness": wall.thickness if METHODS[method].is_wall else None,
        "poisson": wall.nu,
        # None for the method 'wall': contact would add its thickness to the gap between the plates.
        "thickness": float(wall.thickness) if wall.thickness and keeps_apart else None,
        "yield_radius": wall.yield_radius,
        "gas": _gas_amount(options.gas, newtons, rest),
        "pressure": _pressure(options.pressure, newtons),
        "convergence": Convergence(**given_criteria(options)),
    }
    to = parse_distance(options.to)
    cylinder = CylinderAsWide.between_plates(rest, checked_direction(axis), material)
    weight = still_weight(options.weight, options.drop, newtons, wall.unit)
    presses = _presses(options, rest, _dent_depth(options, method, wall), axis, to, start, settings)
    found, band = presses[0], PressBand(tuple(presses)) if len(presses) > 1 else None
    heights = band.buckle_heights(mesh.joined_F, axis) if band else np.zeros(0)
    with ExitStack() as beside:
        if options.curve:
            rows = band_rows(band, newtons) if band else press_rows(found, newtons)
            table = beside.enter_context(replacing_file(options.curve))
            write_table(table, list(rows[0]), [list(row.values()) for row in rows])
        if options.figure:
            # Imported here: matplotlib is slow to import, and must not delay the parsing of a command line.
            from apd_viewer.figures.curves import draw_press_curves

            folder = beside.enter_context(staging_folder(options.figure.parent))
            force = (
                (newtons.newtons_per_load, load_conditions(found.stretching, newtons, wall))
                if newtons
                else None
            )
            draw_press_curves(found, folder / options.figure.name, force, band)
        if options.crushed:
            save_mesh(mesh, found.steps[-1].U, options.crushed, wall.unit.symbol)
        if options.output:
            save_mesh(mesh, found.U, options.output, wall.unit.symbol)
    first = next(filter(None, written), Path(mesh.name))
    extent = float(np.ptp(found.steps[0].U[used_vertices(mesh.F)] @ checked_direction(axis)))
    lines = [press_summary(found, rest, first, wall, newtons, extent, is_alone=band is None)]
    if (pascals := pressure_pascals(settings, newtons)) is not None:
        lines.append(
            tr("inside  a constant pressure of {pressure}").format(pressure=format_pressure(pascals))
        )
    lines += weight_lines(weight, found)
    lines += band_lines(band, options.dents, heights, newtons, cylinder) if band else []

    def fields() -> dict[str, object]:
        said = press_report(mesh, rest, found, settings, wall, newtons) | weight_fields(weight, found)
        return said | ({"band": band_fields(band, options.dents, heights, newtons, cylinder)} if band else {})

    return CommandOutput([*lines, *mesh_remarks(mesh)], fields)


def _presses(
    options: argparse.Namespace,
    rest: RestMesh,
    depth: float | None,
    axis: np.ndarray,
    to: float | str,
    start: np.ndarray | None,
    settings: Mapping[str, Any],
) -> list[Pressed]:
    """Press the mesh as often as asked, with other dents of a ``depth`` each time."""
    progress, presses = Progress(options.progress_lines), list[Pressed]()

    def show(done: float) -> None:
        progress.show((len(presses) + done) / options.runs, tr("pressing"))

    for run in range(options.runs):
        own = rest
        if depth is not None:
            length = _DENT_LENGTH * np.sqrt(rest.diagonal * settings["wall_thickness"])
            V = dented_positions(rest, depth, length, (options.seed or 0) + run)
            own = RestMesh(rest.to_mesh_coordinates(V), rest.F, rest.weld)
        plates = PlatePress(own, axis, to, options.steps, options.iterations, start=start, **settings)
        presses.append(press_between(plates, options.release, show))
    progress.end()
    return presses


def _dent_depth(options: argparse.Namespace, method: str, wall: Wall) -> float | None:
    """Depth of the dents, mesh units; None without. Raises InputError."""
    if not 1 <= options.runs <= MOST_RUNS:
        sentence = tr("The number of runs must be a whole number from 1 to {most:,}.")
        raise InputError(sentence.format(most=MOST_RUNS))
    if options.dents is None and options.runs > 1:
        options.dents = DEFAULT_DENTS
    if options.dents is None:
        return None
    if not 0.0 < options.dents <= DEEPEST_DENTS:
        sentence = tr("The depth of the dents must be above 0 and at most {most:g} % of the wall thickness.")
        raise InputError(sentence.format(most=DEEPEST_DENTS))
    if wall.thickness is None or not METHODS[method].is_wall:
        raise InputError(tr("Dents are of a thin wall; add --method wall and --thickness."))
    return options.dents / 100.0 * wall.thickness


def _wall(options: argparse.Namespace, mesh: Mesh, unit: Unit) -> Wall:
    """Wall properties from the options, for a mesh in ``unit``; raises InputError."""
    wall = given_wall(options, mesh, unit)
    is_thin = METHODS[_method(options, wall)].is_wall
    if options.young and not options.stiffness and not is_thin:
        raise InputError(tr("Newtons need walls that resist bending; add --method wall."))
    # Walls without bending stiffness keep no creases, whatever their material.
    keeps_creases = options.yield_radius or options.stiffness or is_thin
    return wall if keeps_creases else replace(wall, yield_radius=None)


def _method(options: argparse.Namespace, wall: Wall) -> str:
    """Chosen method; by default 'wall' if the wall's rigidity is known."""
    if options.method is not None:
        return str(options.method)
    return press_method(wall, options.stiffness, DEFAULT_METHOD)


def _gas_amount(text: str | None, newtons: NewtonConversion | None, rest: RestMesh) -> float | None:
    """Gas amount (pressure times volume) from its text; raises InputError."""
    if text is None:
        return None
    pascals = parse_pressure(text)
    if pascals is None:
        return parse_number(text, {})
    return _known(newtons).gas_amount(pascals, rest)


def _pressure(text: str | None, newtons: NewtonConversion | None) -> float | None:
    """Pressure of the model from its text; raises InputError."""
    if text is None:
        return None
    return parse_pressure_difference(text) / _known(newtons).pascals_per_pressure


def _known(newtons: NewtonConversion | None) -> NewtonConversion:
    if newtons is None:
        raise InputError(
            tr("A pressure with a unit needs newtons; add --material, or --thickness and --young.")
        )
    return newtons
