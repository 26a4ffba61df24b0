"""The option ``--weld``."""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.language import tr


def add_weld_option(parser: argparse.ArgumentParser) -> None:
    """Add the option."""
    parser.add_argument(
        "--weld",
        action="store_true",
        help=tr(
            "weld seams: boundary vertices within 1/10,000 of the size of the mesh move together; the file "
            "written has all its vertices"
        ),
    )


def open_input_mesh(path: str | Path, weld: bool, unit: str = "") -> Mesh:
    """The mesh in a file, with its seams welded on request; raises InputError.

    Another ``unit`` than the file's counts, if it is given.
    """
    mesh = open_mesh(path)
    mesh = replace(mesh, unit=unit) if unit else mesh
    return mesh.welded() if weld else mesh
