"""The ``remesh`` command: even triangles on the surface of a mesh."""

import argparse
from pathlib import Path

import numpy as np

from apd_viewer.commands.terminal.command_output import CommandOutput
from apd_viewer.commands.terminal.mesh_options import open_input_mesh
from apd_viewer.commands.terminal.parser import Parser, add_option
from apd_viewer.errors import InputError
from apd_viewer.files.formats.cad import even_triangles
from apd_viewer.files.mesh_writing import check_mesh_path, save_mesh
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.operators import area, aspect_ratios, face_areas
from apd_viewer.language import tr


def remesh_parser() -> Parser:
    """Argument parser for the ``remesh`` command."""
    parser = Parser(
        prog="apd-viewer remesh",
        description=tr(
            "Divide the surface of a mesh into even triangles, for needles and scans. Sharp edges are kept; "
            "the order of the vertices is new, so selections of the mesh do not fit."
        ),
    )
    add_option(parser, "MESH")
    about = tr("edge length, mesh units; default: 1/60 of the diagonal")
    add_option(parser, "--edge LENGTH", about, type=float)
    about = tr("largest distance from the surface, mesh units; default: 1/2,000 of the diagonal")
    add_option(parser, "--chord LENGTH", about, type=float)
    add_option(parser, "-o, --output OUT", tr("mesh to write"), required=True)
    parser.set_defaults(run=_remesh)
    return parser


def _remesh(options: argparse.Namespace) -> CommandOutput:
    output = check_mesh_path(options.output)
    if options.edge is not None and not 0.0 < options.edge < np.inf:
        raise InputError(tr("Enter an edge length above 0."))
    if options.chord is not None and not 0.0 < options.chord < np.inf:
        raise InputError(tr("Enter a distance from the surface above 0."))
    mesh = open_input_mesh(options.mesh)
    V, F, edge = even_triangles(mesh.V, mesh.joined_F, options.edge, options.chord)
    even = Mesh(V, F, Path(output), unit=mesh.unit)
    save_mesh(even, V, output)
    told = {
        "mesh": str(options.mesh),
        "output": str(output),
        "edge": edge,
        "area": area(V, F),
        "area_before": area(mesh.V, mesh.F),
    }
    for name, each in (("", even), ("_before", mesh)):
        told |= {
            f"vertices{name}": len(each.V),
            f"triangles{name}": len(each.F),
            f"worst_aspect{name}": worst_aspect(each.V, each.F),
        }
    line = tr("{name}: {vertices:,} vertices, {triangles:,} triangles, worst aspect ratio {aspect:.3g}")
    lines = [
        line.format(name=each.name, vertices=len(each.V), triangles=len(each.F), aspect=told[key])
        for each, key in ((mesh, "worst_aspect_before"), (even, "worst_aspect"))
    ]
    lines.append(tr("edges of about {edge:.3g}").format(edge=edge))
    return CommandOutput(lines, lambda: told)


def worst_aspect(V: np.ndarray, F: np.ndarray) -> float:
    """Largest aspect ratio of the triangles ``F`` (m, 3) that have an area."""
    return float(aspect_ratios(V, F, face_areas(V, F)).max(initial=0.0))
