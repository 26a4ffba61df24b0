"""The ``info`` command: check a mesh file and describe its contents."""

import argparse
from dataclasses import fields
from typing import Any

from apd_viewer.commands.terminal.command_output import CommandOutput
from apd_viewer.commands.terminal.mesh_options import add_division_options, add_weld_option, open_input_mesh
from apd_viewer.commands.terminal.parser import Parser, add_option
from apd_viewer.files.meshes import open_mesh
from apd_viewer.files.report import shape_check_fields, target_distance_fields
from apd_viewer.geometry.analysis.inspection import Inspection, inspect
from apd_viewer.geometry.analysis.mesh_findings import Finding
from apd_viewer.geometry.analysis.shape_check import ShapeCheck, check_shape
from apd_viewer.geometry.analysis.target_shape import TargetShape
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.language import comma_separated, tr
from apd_viewer.session.model.status_text import caps_phrase, crossing_findings, exempt_zone_findings
from apd_viewer.session.quantities.units import Unit

_MOST_VERTICES = 100  # vertices listed per finding in a report
# Report keys kept under older names than the fields.
_KEYS = {"components": "pieces", "missing_volume_reason": "why_no_volume"}


def info_parser() -> Parser:
    """Argument parser for the ``info`` command."""
    parser = Parser(prog="apd-viewer info", description=tr("Check a mesh file and describe its contents."))
    add_option(parser, "MESH")
    add_option(parser, "--compare OTHER", tr("measure the distance from the surface of another mesh"))
    add_weld_option(parser)
    add_division_options(parser)
    parser.set_defaults(run=_info)
    return parser


def _info(options: argparse.Namespace) -> CommandOutput:
    mesh = open_input_mesh(options.mesh, options.weld, chord=options.chord, edge=options.edge)
    found, check = inspect(mesh), check_shape(mesh.V, mesh.joined_F)
    all_found = [
        *found.findings,
        *exempt_zone_findings(mesh, check.crossing),
        *crossing_findings(mesh, check.crossing),
    ]
    apart = {}
    if options.compare:
        apart = target_distance_fields(TargetShape(open_mesh(options.compare)), mesh, mesh.V)
    lines = _description(mesh, found, check)
    lines += [_distance_text(apart)] if apart else []
    sentences = [finding.sentence for finding in all_found]
    if check.crossing is None:
        sentences.append(tr("self-intersections: not checked"))
    lines += sentences or [tr("No issues found.")]

    def report() -> dict[str, Any]:
        told: dict[str, Any] = {"mesh": str(options.mesh), "unit": mesh.unit or None}
        told |= {_KEYS.get(field.name, field.name): getattr(found, field.name) for field in fields(found)}
        told["double_wall"] = found.double_wall and found.double_wall._asdict()
        return {**told, **shape_check_fields(check), **apart, "findings": [*map(_finding_fields, all_found)]}

    return CommandOutput(lines, report)


def _description(mesh: Mesh, found: Inspection, check: ShapeCheck) -> list[str]:
    """Lines on size, area, volume and contents of a mesh."""
    unit = Unit(mesh.unit)
    size = unit.format_length(" x ".join(f"{extent:.6g}" for extent in found.size))
    volume = tr("none: {reason}").format(reason=found.missing_volume_reason)
    if found.volume is not None:
        volume = unit.format_volume(f"{found.volume:.6g}")
    lines = [
        tr("{name}: {vertices:,} vertices, {faces:,} triangles, {pieces:,} connected part(s)").format(
            name=mesh.name, vertices=found.vertices, faces=found.faces, pieces=found.components
        ),
        tr("size    {size}").format(size=size),
        tr("area    {reading}").format(reading=unit.format_area(f"{found.area:.6g}")),
        tr("volume  {reading}").format(reading=volume),
    ]
    if found.volume_capped is not None:
        capped = unit.format_volume(f"{found.volume_capped:.6g}")
        lines.append(f"        {capped} {caps_phrase(found.openings)}")
    packed = tr("box     {reading}, the volume of the smallest bounding box found")
    lines.append(packed.format(reading=unit.format_volume(f"{check.packed_box:.6g}")))
    if mesh.origin is not None and mesh.origin.extras:
        also = tr("also    {things}; exporting to any format but {kind} loses them")
        things, kind = comma_separated(mesh.origin.extras), mesh.origin.suffix[1:].upper()
        lines.append(also.format(things=things, kind=kind))
    return lines


def _finding_fields(finding: Finding) -> dict[str, Any]:
    vertices = finding.vertices
    return {
        "kind": finding.kind,
        "sentence": finding.sentence,
        "vertex_count": len(vertices),
        "vertices": vertices[:_MOST_VERTICES].tolist(),
    }


def _distance_text(distances: dict[str, float]) -> str:
    line = tr(
        "apart   {largest_distance:.6g} at most, {rms_distance:.6g} RMS, {mean_distance:.6g} on average; "
        "from the other mesh {largest_distance_back:.6g}, {rms_distance_back:.6g}, {mean_distance_back:.6g}"
    )
    by_vertex = tr(
        "        same vertices {largest_distance_by_vertex:.6g} at most, {rms_distance_by_vertex:.6g} RMS, "
        "{mean_distance_by_vertex:.6g} on average"
    )
    lines = [line, by_vertex] if "rms_distance_by_vertex" in distances else [line]
    return "\n".join(each.format(**distances) for each in lines)
