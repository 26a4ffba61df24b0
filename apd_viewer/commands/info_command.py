"""The ``info`` command: check a mesh file and describe its contents."""

import argparse
import json
from dataclasses import fields

from apd_viewer.commands.terminal.parser import Parser, add_option
from apd_viewer.commands.terminal.weld_option import add_weld_option, open_input_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.files.report import shape_check_fields, target_distance_fields
from apd_viewer.geometry.analysis.inspection import inspect
from apd_viewer.geometry.analysis.shape_check import check_shape
from apd_viewer.geometry.analysis.target_shape import TargetShape
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
    add_option(parser, "--json", tr("print JSON, for scripts"))
    add_option(parser, "--compare OTHER", tr("measure the distance from the surface of another mesh"))
    add_weld_option(parser)
    parser.set_defaults(run=_info)
    return parser


def _info(options: argparse.Namespace) -> None:
    mesh = open_input_mesh(options.mesh, options.weld)
    found, check = inspect(mesh), check_shape(mesh.V, mesh.joined_F)
    all_found = [
        *found.findings,
        *exempt_zone_findings(mesh, check.crossing),
        *crossing_findings(mesh, check.crossing),
    ]
    apart = {}
    if options.compare:
        apart = target_distance_fields(TargetShape(open_mesh(options.compare)), mesh, mesh.V)
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
        report: dict[str, object] = {"mesh": str(options.mesh), "unit": mesh.unit or None}
        report |= {_KEYS.get(field.name, field.name): getattr(found, field.name) for field in fields(found)}
        report["double_wall"] = found.double_wall and found.double_wall._asdict()
        print(json.dumps({**report, **shape_check_fields(check), **apart, "findings": findings}, indent=2))
        return
    unit = Unit(mesh.unit)
    size = unit.format_length(" x ".join(f"{extent:.6g}" for extent in found.size))
    print(
        tr("{name}: {vertices:,} vertices, {faces:,} triangles, {pieces:,} connected part(s)").format(
            name=mesh.name, vertices=found.vertices, faces=found.faces, pieces=found.components
        )
    )
    print(tr("size    {size}").format(size=size))
    print(tr("area    {reading}").format(reading=unit.format_area(f"{found.area:.6g}")))
    volume = tr("none: {reason}").format(reason=found.missing_volume_reason)
    if found.volume is not None:
        volume = unit.format_volume(f"{found.volume:.6g}")
    print(tr("volume  {reading}").format(reading=volume))
    if found.volume_capped is not None:
        print(f"        {unit.format_volume(f'{found.volume_capped:.6g}')} {caps_phrase(found.openings)}")
    packed = tr("box     {reading}, the volume of the smallest bounding box found")
    print(packed.format(reading=unit.format_volume(f"{check.packed_box:.6g}")))
    if mesh.origin is not None and mesh.origin.extras:
        also = tr("also    {things}; exporting to any format but {kind} loses them")
        print(also.format(things=comma_separated(mesh.origin.extras), kind=mesh.origin.suffix[1:].upper()))
    if apart:
        print(_distance_text(apart))
    for sentence in [finding.sentence for finding in all_found] or [tr("No issues found.")]:
        print(sentence)


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
