"""The command volumes: volumes by name, beside published figures of the same."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from apd_viewer.commands.result_output import mesh_remarks
from apd_viewer.commands.terminal.parser import Parser
from apd_viewer.commands.terminal.unit_option import naming_unit_option
from apd_viewer.commands.volumes_output import volume_lines, volumes_report
from apd_viewer.errors import InputError
from apd_viewer.files.meshes import open_mesh
from apd_viewer.files.storage.atomic_file import replacing_file
from apd_viewer.geometry.analysis.inspection import inspect
from apd_viewer.geometry.analysis.volume_readings import mesh_volumes
from apd_viewer.language import tr
from apd_viewer.presentation.volume_text import DEFAULT_BAG, volume_rows
from apd_viewer.session.quantities.expressions import parse_number
from apd_viewer.session.quantities.units import SYMBOLS, Unit
from apd_viewer.session.quantities.wall_mass import parse_density, parse_thickness


def volumes_parser() -> Parser:
    """Parser of the command."""
    parser = Parser(
        prog="apd-viewer volumes",
        description=tr(
            "Measure the volumes of a shape, each by its own name: enclosed, convex hull, smallest box, bulk "
            "and material; beside published figures of the same quantity."
        ),
    )
    parser.add_argument("mesh", metavar="MESH")
    parser.add_argument("--rest", metavar="REST", help=tr("mesh of the shape at rest, for the change"))
    parser.add_argument("--unit", choices=SYMBOLS, default="", help=tr("unit of length of both meshes"))
    parser.add_argument(
        "--bag", metavar="LITRES", help=tr("count the objects in a bag of this size; default: 45")
    )
    parser.add_argument(
        "--thickness", metavar="LENGTH", help=tr("of the wall, such as 0.3mm, for the material volume")
    )
    parser.add_argument(
        "--density", metavar="D", help=tr("of the material, such as 1.38 (g/cm³), for the bulk density")
    )
    parser.add_argument("--json", metavar="V.json", type=Path, help=tr("write the readings as JSON"))
    parser.set_defaults(run=_volumes)
    return parser


@naming_unit_option()
def _volumes(options: argparse.Namespace) -> None:
    mesh = open_mesh(options.mesh)
    unit = Unit(options.unit or mesh.unit)
    litres = _bag(options.bag, unit)
    if options.density is not None and options.thickness is None:
        raise InputError(tr("A bulk density needs the wall as well; add --thickness."))
    thickness = None if options.thickness is None else parse_thickness(options.thickness, unit)
    heavy = None if options.density is None else parse_density(options.density)
    before = None if options.rest is None else open_mesh(options.rest)
    now = mesh_volumes(mesh, thickness)
    rest = None if before is None else mesh_volumes(before, thickness)
    if options.json is not None:
        names = mesh.name, None if before is None else before.name
        report = volumes_report(names, now, rest, unit, heavy, litres)
        with replacing_file(options.json) as scratch:
            scratch.write_text(json.dumps(report, indent=2) + "\n", encoding="utf-8")
    rows = tuple(volume_rows(rest or now, now, unit, heavy, litres))
    print(volume_lines(mesh.name, rows, rest is not None))
    for each, found in ((mesh, now), (before, rest)):
        if each is None or found is None:
            continue
        said = mesh_remarks(each)
        if found.enclosed is None:
            said.insert(0, tr("There is no volume: {why}.").format(why=inspect(each).missing_volume_phrase))
        for sentence in said:
            print(f"{each.name}: {sentence}")


def _bag(text: str | None, unit: Unit) -> float:
    """Litres from a text; raises InputError."""
    if text is None:
        return DEFAULT_BAG
    if unit is Unit.NONE:
        raise InputError(tr("A bag in litres needs the unit of the mesh; add --unit mm, cm, m, in or ft."))
    litres = parse_number(text, {})
    if not litres > 0.0:
        raise InputError(tr("Enter a bag of more than 0 litres, such as --bag 45."))
    return litres
