"""Input meshes of commands, with the options ``--weld`` and ``--unit``."""

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from apd_viewer.commands.terminal.parser import add_option
from apd_viewer.errors import InputError
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.language import tr
from apd_viewer.session.quantities.units import NoUnitError


def add_weld_option(parser: argparse.ArgumentParser) -> None:
    """Add the option to weld open seams, ``--weld``."""
    about = tr(
        "weld seams: boundary vertices within 1/10,000 of the size of the mesh move together; the file "
        "written has all its vertices"
    )
    add_option(parser, "--weld", about)


def add_division_options(parser: argparse.ArgumentParser) -> None:
    """Add the options to divide a CAD model, ``--chord`` and ``--edge``."""
    about = tr("distance from the surface of a STEP or IGES model, mm; default: 1/2,000 of its diagonal")
    add_option(parser, "--chord LENGTH", about, type=float)
    about = tr("edge length of the even triangles of such a model, mm, or 0 for none; default: 1/60 of it")
    add_option(parser, "--edge LENGTH", about, type=float)


def open_input_mesh(
    path: str | Path,
    weld: bool,
    unit: str = "",
    chord: float | None = None,
    edge: float | None = None,
) -> Mesh:
    """Mesh from a file, with its seams welded on request; raises InputError.

    Another ``unit`` than the file's counts, if it is given. A CAD model is divided by ``chord`` and ``edge``.
    """
    mesh = open_mesh(path, chord, edge)
    mesh = replace(mesh, unit=unit) if unit else mesh
    return mesh.welded() if weld else mesh


@contextmanager
def unit_option_in_errors() -> Iterator[None]:
    """Context in which errors about lengths without a unit suggest ``--unit``."""
    try:
        yield
    except NoUnitError as error:
        raise InputError(
            tr("The unit of the mesh is not set; add --unit mm, cm, m, in or ft for {word}.").format(
                word=error.word
            )
        ) from error
