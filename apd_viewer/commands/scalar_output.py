"""Options for the scalars of a result, and their files."""

from __future__ import annotations

import argparse
from contextlib import ExitStack
from pathlib import Path

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.scalar_files import ScalarRows, check_scalar_file, write_scalars
from apd_viewer.files.storage.atomic_file import replacing_file
from apd_viewer.geometry.analysis.scalars import shape_scalars
from apd_viewer.geometry.analysis.target_shape import TargetShape
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.language import tr


def add_scalar_options(parser: argparse.ArgumentParser) -> None:
    """Add the options for scalars."""
    parser.add_argument(
        "--scalars",
        metavar="S.ply",
        type=Path,
        help=tr("write area change, strain, displacement and labels: .ply, or .csv with a row per vertex"),
    )
    parser.add_argument(
        "--triangle-scalars",
        metavar="T.csv",
        type=Path,
        help=tr("write those of the triangles, with a row per triangle"),
    )


def scalar_files(options: argparse.Namespace) -> tuple[Path | None, Path | None]:
    """Files of the values of vertices and of triangles; None if not asked for."""
    return options.scalars, options.triangle_scalars


def check_scalar_options(options: argparse.Namespace) -> None:
    """Raise InputError if a file cannot hold scalars."""
    if options.scalars:
        check_scalar_file(options.scalars)
    if options.triangle_scalars and options.triangle_scalars.suffix.lower() != ".csv":
        name = options.triangle_scalars.name
        raise InputError(tr("{name} is not a table; use the ending .csv.").format(name=name))


def write_scalar_files(
    stack: ExitStack,
    options: argparse.Namespace,
    mesh: Mesh,
    U: np.ndarray,
    labels: np.ndarray,
    member: np.ndarray,
    target: TargetShape | None = None,
) -> None:
    """Write the files asked for; they replace old ones when ``stack`` is closed."""
    asked = (options.scalars, ScalarRows.VERTICES), (options.triangle_scalars, ScalarRows.TRIANGLES)
    if not any(path for path, _ in asked):
        return
    scalars = shape_scalars(mesh, U, labels, member, target)
    for path, rows in asked:
        if path:
            write_scalars(stack.enter_context(replacing_file(path)), mesh, U, scalars, rows)
