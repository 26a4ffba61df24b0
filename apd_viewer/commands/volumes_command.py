"""The ``volumes`` command: volumes by name, with published values for comparison."""

import argparse
import math
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from apd_viewer.commands.result_output import figure_files, mesh_remarks
from apd_viewer.commands.terminal.columns import column_count, padded_text
from apd_viewer.commands.terminal.command_output import CommandOutput, json_path
from apd_viewer.commands.terminal.mesh_options import open_input_mesh, parse_axis, unit_option_in_errors
from apd_viewer.commands.terminal.parser import Parser, add_option
from apd_viewer.errors import InputError
from apd_viewer.files.mesh_writing import check_files
from apd_viewer.files.meshes import open_mesh
from apd_viewer.files.report import hull_fields
from apd_viewer.files.storage.atomic_file import replacing_file, staging_folder
from apd_viewer.geometry.analysis.hull_readings import DENSEST, LOOSEST, PACKING
from apd_viewer.geometry.analysis.inspection import inspect
from apd_viewer.geometry.analysis.volume_readings import VolumeReadings, mesh_volumes
from apd_viewer.geometry.measuring.vessel import Vessel
from apd_viewer.geometry.mesh.arrays import checked_direction
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.language import tr
from apd_viewer.presentation import volume_text
from apd_viewer.presentation.number_format import format_short, format_significant
from apd_viewer.session.model.up_axis import UpAxis, standing_axis
from apd_viewer.session.quantities.expressions import parse_number, parse_volume
from apd_viewer.session.quantities.units import SYMBOLS, Unit
from apd_viewer.session.quantities.wall import WallText, parse_wall
from apd_viewer.session.quantities.wall_distribution import thickness_text


def volumes_parser() -> Parser:
    """Argument parser for the ``volumes`` command."""
    parser = Parser(
        prog="apd-viewer volumes",
        description=tr(
            "Measure the volumes of a shape: enclosed, convex hull, smallest box, bulk and material, beside "
            "published figures of the same quantity."
        ),
    )
    add_option(parser, "MESH")
    add_option(parser, "--rest REST", tr("mesh of the shape at rest, for the change"))
    add_option(parser, "--unit", tr("unit of length of both meshes"), choices=SYMBOLS, default="")
    add_option(parser, "--bag LITRES", tr("count the objects in a bag of this size; default: 45"))
    about = tr("wall thickness, such as 0.3mm, or a file of the wall distribution, for the material volume")
    add_option(parser, "--thickness LENGTH", about, default="")
    about = tr("density, such as 1.38 (g/cm³), for the bulk density")
    add_option(parser, "--density D", about, default="")
    about = tr('direction upwards for the brimful volume, such as y or "0 1 0"; default: where it can stand')
    add_option(parser, "--up AXIS", about)
    about = tr("volume that is filled in, such as 250ml or 80%% of the brimful one")
    add_option(parser, "--fill VOLUME", about)
    about = tr("openings that count as closed, counted from the lowest one up, such as 1 or 1,3")
    add_option(parser, "--closed N", about)
    add_option(parser, "--levels C.csv", tr("write the volume at each level"), type=Path)
    about = tr("draw the level over the volume, as F.png and F.svg")
    add_option(parser, "--figure F.png", about, type=Path)
    parser.set_defaults(run=_volumes)
    return parser


class _Filling(NamedTuple):
    up: np.ndarray | None
    fill: float | None
    closed: Sequence[Sequence[int]]


@unit_option_in_errors()
def _volumes(options: argparse.Namespace) -> CommandOutput:
    check_files([options.levels, *figure_files(options.figure), json_path(options.json)])
    mesh = open_input_mesh(options.mesh)
    unit = Unit(options.unit or mesh.unit)
    litres = _bag(options.bag, unit)
    if options.density and not options.thickness:
        raise InputError(tr("A bulk density needs the wall thickness as well; add --thickness."))
    before = None if options.rest is None else open_mesh(options.rest)
    thickness = thickness_text(options.thickness, before or mesh, unit)
    wall = parse_wall(WallText(thickness, options.density), unit)
    meshes = [mesh, *([] if before is None else [before])]
    up, fill, closed = _filling(options, meshes, unit)
    now, *others = (
        mesh_volumes(each, wall.thickness, up, fill, at) for each, at in zip(meshes, closed, strict=True)
    )
    rest = others[0] if others else None
    now = now if rest is None else now.of_rest(rest)
    if options.levels is not None and up is not None:
        _write_levels(options.levels, Vessel(mesh.V, mesh.F, up, closed[0]))
    if options.figure is not None and up is not None:
        titles = [mesh.name, *([] if before is None else [tr("{name}, at rest").format(name=before.name)])]
        shapes = zip(titles, meshes, closed, strict=True)
        vessels = {name: Vessel(each.V, each.F, up, at) for name, each, at in shapes}
        _draw_levels(options.figure, vessels, fill, unit)
    rows = tuple(volume_text.volume_rows(rest or now, now, unit, wall.density, litres, _up_name(up)))
    lines = [volume_lines(mesh.name, rows, rest is not None)]
    for each, found in ((mesh, now), (before, rest)):
        if each is None or found is None:
            continue
        remarks = mesh_remarks(each)
        if found.enclosed is None:
            remarks.insert(
                0, tr("There is no volume: {why}.").format(why=inspect(each).missing_volume_phrase)
            )
        lines += [f"{each.name}: {sentence}" for sentence in remarks]
    names = mesh.name, None if before is None else before.name
    report = partial(volumes_report, names, now, rest, unit, wall.density, litres)
    return CommandOutput(lines, report)


def _filling(options: argparse.Namespace, meshes: Sequence[Mesh], unit: Unit) -> _Filling:
    """Direction, volume and closed openings, None if unknown; raises InputError."""
    rest, nothing = meshes[-1], _Filling(None, None, [()] * len(meshes))
    wanted = any(
        value is not None for value in (options.fill, options.levels, options.figure, options.closed)
    )
    if options.up is not None:
        up = checked_direction(parse_axis(options.up))
    elif (axis := standing_axis(rest)) is not None:
        up = axis.direction
    elif wanted:
        raise InputError(tr("It is not clear on which side the shape stands; add --up, such as --up y."))
    else:
        return nothing
    closed = [_closed_openings(options.closed, rest, up)] * len(meshes)
    if not np.array_equal(meshes[0].F, rest.F):
        closed[0] = _closed_openings(options.closed, meshes[0], up)
    try:
        vessel = Vessel(rest.V, rest.F, up, closed[-1])
    except InputError:
        if wanted or options.up is not None:
            raise
        return nothing
    if options.fill is None:
        return _Filling(up, None, closed)
    is_share = options.fill.strip().endswith("%")
    fill = vessel.brimful * parse_number(options.fill, {}) if is_share else parse_volume(options.fill, unit)
    vessel.level(fill)  # raises InputError unless the shape at rest holds it
    return _Filling(up, fill, closed)


def _closed_openings(text: str | None, mesh: Mesh, up: np.ndarray) -> Sequence[int]:
    """Vertex at each opening of a list of numbers, such as 1,3; raises InputError."""
    if text is None:
        return ()
    openings = Vessel.openings(mesh.V, mesh.F, up).tolist()
    numbers = [word.strip() for word in text.split(",")]
    if wrong := [word for word in numbers if word not in map(str, range(1, len(openings) + 1))]:
        raise InputError(
            tr("There is no opening “{number}”; the openings are counted from 1, the lowest, to {n}.").format(
                number=wrong[0], n=len(openings)
            )
        )
    return [openings[int(word) - 1] for word in numbers]


def _up_name(up: np.ndarray | None) -> str:
    """Name of an axis, such as +Y, or the components of another direction."""
    if up is None:
        return ""
    nearest = UpAxis.nearest(up)
    if up @ nearest.direction == 1.0:
        return nearest.value
    return " ".join(format_significant(float(x), 3) for x in up)


def _levels(vessel: Vessel) -> np.ndarray:
    """Volumes and levels above the lowest point, evenly spaced up to the brim, (k, 2)."""
    levels = np.linspace(vessel.bottom, vessel.brim, _LEVELS)
    return np.array([(vessel.volume(level), level - vessel.bottom) for level in levels])


def _write_levels(path: Path, vessel: Vessel) -> None:
    """Write the volume at evenly spaced levels up to the brim as CSV."""
    rows = [(format(level, ".9g"), format(volume, ".9g")) for volume, level in _levels(vessel)]
    with replacing_file(path) as scratch:
        scratch.write_text("\n".join(map(",".join, [("level", "volume"), *rows])) + "\n", encoding="utf-8")


def _draw_levels(path: Path, vessels: dict[str, Vessel], fill: float | None, unit: Unit) -> None:
    """Draw the levels of shapes by name; the first is filled."""
    # Imported here: matplotlib is slow to import, and must not delay the parsing of a command line.
    from apd_viewer.figures.curves import draw_fill_levels

    litres = unit.to_litres(max(vessel.brimful for vessel in vessels.values()))
    word, fraction = ("", 1.0) if litres is None else unit.capacity_unit(litres)
    scale = fraction * (unit.to_litres(1.0) or 1.0)
    curves = {name: _levels(vessel) * (scale, 1.0) for name, vessel in vessels.items()}
    filled, first = None, next(iter(vessels.values()))
    if fill is not None and fill <= first.brimful:
        level = first.level(fill) - first.bottom
        words = tr("{volume}: level {level}").format(
            volume=f"{format_short(scale * fill)}\u00a0{word}".strip(),
            level=unit.format_length(format_significant(level, 4)),
        )
        filled = words, scale * fill, level
    with staging_folder(path.parent) as folder:
        draw_fill_levels(curves, (word, unit.symbol), folder / path.name, filled)


def _bag(text: str | None, unit: Unit) -> float:
    """Volume of a bag in litres from its text; raises InputError."""
    if text is None:
        return volume_text.DEFAULT_BAG
    if unit is Unit.NONE:
        raise InputError(tr("A bag in litres needs the unit of the mesh; add --unit mm, cm, m, in or ft."))
    litres = parse_number(text, {})
    if not litres > 0.0:
        raise InputError(tr("Enter a bag of more than 0 litres, such as --bag 45."))
    return litres


_WIDTH, _GAP = 28, 2
_LEVELS = 101


def volume_lines(name: str, rows: Sequence[volume_text.VolumeRow], has_rest: bool) -> str:
    """Terminal lines about all volume quantities."""
    lines = [name]
    width = max([_WIDTH, *(column_count(row.title) + _GAP for row in rows)])
    for row in rows:
        text = _reading_text(row.now)
        if has_rest:
            text = tr("{now} of {rest}").format(now=text, rest=_reading_text(row.rest))
            text += f"  {row.change}" if row.change else ""
        lines.append(padded_text(row.title, width) + text)
        lines += [f"    {row.definition}"] if row.definition else []
        for words, source, *_ in row.published:
            lines.append("    " + tr("published: {words} [{source}]").format(words=words, source=source))
    return "\n".join(lines)


def _reading_text(reading: volume_text.TextWithRange) -> str:
    value, spread = reading
    return f"{value} ({spread})" if spread else value


def volumes_report(
    names: tuple[str, str | None],
    now: VolumeReadings,
    rest: VolumeReadings | None,
    unit: Unit,
    density: float | None,
    bag: float,
) -> dict[str, Any]:
    """Fields of the JSON report on volumes.

    Parameters
    ----------
    names : tuple of str
        Of the mesh and of the rest shape, if there is one.
    unit, density, bag
        See :func:`~apd_viewer.presentation.volume_text.volume_rows`.
    """
    report: dict[str, Any] = {
        "mesh": names[0],
        "rest": names[1],
        "unit": unit.value or None,
        "packing": PACKING,
        "packing_range": (LOOSEST, DENSEST),
        "bag_litres": bag,
        **_fields(now, unit, density, bag),
    }
    if rest is not None:
        report |= {f"{name}_rest": value for name, value in _fields(rest, unit, density, bag).items()}
    return report | {"published": _published_figures()}


def _fields(found: VolumeReadings, unit: Unit, density: float | None, bag: float) -> dict[str, Any]:
    counts = [volume_text.object_count(bag, found, unit, packing) for packing in (LOOSEST, DENSEST)]
    densities = [volume_text.bulk_density(density, found, packing) for packing in (LOOSEST, DENSEST)]
    return {
        "area": found.area,
        "enclosed_volume": found.enclosed,
        "openings": found.openings,
        "packed_volume": found.hull.box,
        **hull_fields(found.hull),
        "objects_in_bag": volume_text.object_count(bag, found, unit),
        "objects_in_bag_range": counts,
        "bulk_density": volume_text.bulk_density(density, found),
        "bulk_density_range": densities,
        "material_volume": found.material,
        "capacity": found.capacity,
        "brimful_volume": found.brimful,
        "fill_level": None if found.filling is None else found.filling.level,
        "freeboard": None if found.filling is None else found.filling.freeboard,
        "spilled_volume": None if found.filling is None else found.filling.spilled,
    }


def _published_figures() -> dict[str, list[dict[str, Any]]]:
    return {
        quantity.value: [
            {name: None if value == math.inf else value for name, value in figure._asdict().items()}
            for figure in figures
        ]
        for quantity, figures in volume_text.PUBLISHED_VOLUMES.items()
    }
