"""The command info: check a mesh file and describe its contents."""

from __future__ import annotations

import json
from dataclasses import fields
from typing import TYPE_CHECKING

from apd_viewer.commands.parser import Parser
from apd_viewer.files.meshes import open_mesh
from apd_viewer.files.report import room_of
from apd_viewer.geometry.analysis.inspection import inspect
from apd_viewer.geometry.analysis.shape_check import examined
from apd_viewer.geometry.analysis.surface_distance import surface_distance
from apd_viewer.language import tr
from apd_viewer.session.model.status_text import about_caps, of_crossings

if TYPE_CHECKING:
    import argparse

    from apd_viewer.geometry.mesh.mesh import Mesh


_MOST_VERTICES = 100  # of a finding in a report


def info_parser() -> Parser:
    """Parser of the command info."""
    parser = Parser(prog="apd-viewer info", description=tr("Check a mesh file and describe its contents."))
    parser.add_argument("mesh", metavar="MESH")
    parser.add_argument("--json", action="store_true", help=tr("print JSON, for scripts"))
    parser.add_argument(
        "--compare", metavar="OTHER", help=tr("measure the distance from the surface of another mesh")
    )
    parser.set_defaults(run=_info)
    return parser


def _info(options: argparse.Namespace) -> None:
    mesh = open_mesh(options.mesh)
    found, examination = inspect(mesh), examined(mesh.V, mesh.joined_F)
    all_found = [*found.findings, *of_crossings(mesh, examination.crossing)]
    apart = _apart(mesh, open_mesh(options.compare)) if options.compare else {}
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
        print(
            json.dumps({"mesh": str(options.mesh), **report, **room, **apart, "findings": findings}, indent=2)
        )
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
    if apart:
        print(_said(apart))
    for sentence in [finding.sentence for finding in all_found] or [tr("No issues found.")]:
        print(sentence)


def _apart(mesh: Mesh, other: Mesh) -> dict[str, float]:
    """Distances of a mesh from another, and back, for the report."""
    there = surface_distance(mesh.V, mesh.F, other.V, other.F)
    back = surface_distance(other.V, other.F, mesh.V, mesh.F)
    return {
        "largest_distance": there.largest,
        "rms_distance": there.rms,
        "largest_distance_back": back.largest,
        "rms_distance_back": back.rms,
    }


def _said(apart: dict[str, float]) -> str:
    line = tr("apart   {there:.6g} at most, {rms:.6g} RMS; from the other mesh {back:.6g}, {back_rms:.6g}")
    there, rms, back, back_rms = apart.values()
    return line.format(there=there, rms=rms, back=back, back_rms=back_rms)
