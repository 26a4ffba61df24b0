"""Input meshes of commands and their walls, with the options for both."""

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np

from apd_viewer.commands.terminal.parser import Parser, add_option
from apd_viewer.errors import InputError
from apd_viewer.files.meshes import open_mesh, read_mesh, recognized_suffix
from apd_viewer.files.storage.regular_files import STANDARD_INPUT, read_standard_input
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.language import tr
from apd_viewer.session.model.state import welded_state
from apd_viewer.session.model.up_axis import UpAxis
from apd_viewer.session.model.view import SESSION_SUFFIX
from apd_viewer.session.quantities.units import SYMBOLS, NoUnitError, Unit
from apd_viewer.session.quantities.wall import Wall, WallText, parse_wall
from apd_viewer.session.quantities.wall_distribution import thickness_text
from apd_viewer.session.quantities.wall_material import WALL_MATERIALS, wall_material
from apd_viewer.session.storage.session_file import open_session

_AXES = {axis.value.lower(): axis.direction for axis in UpAxis}


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
    weld: bool = False,
    unit: str = "",
    chord: float | None = None,
    edge: float | None = None,
) -> Mesh:
    """Mesh from a file, with its seams welded on request; raises InputError.

    Another ``unit`` than the file's counts, if it is given. The path ``-`` is the standard input. A CAD model
    is divided by ``chord`` and ``edge``.
    """
    mesh = _piped_mesh() if Path(path) == STANDARD_INPUT else open_mesh(path, chord, edge)
    mesh = replace(mesh, unit=unit) if unit else mesh
    return mesh.welded() if weld else mesh


def _piped_mesh() -> Mesh:
    """Mesh from the standard input, in a format recognized by its beginning."""
    content = read_standard_input()
    suffix = recognized_suffix(content)
    if suffix is None:
        raise InputError(tr("The format of the standard input is not recognized; give the name of a file."))
    return read_mesh(Path(f"standard-input{suffix}"), content)


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


def add_axis_option(parser: Parser) -> None:
    """Add the option for the direction of the plates."""
    add_option(parser, "--axis AXIS", tr('x, y, z or a direction such as "1 0 1"; default: x'), default="x")


def add_wall_options(parser: Parser) -> None:
    """Add the options for the elastic wall and the unit of its lengths."""
    about = tr("unit of length of the mesh; default: the session's")
    add_option(parser, "--unit", about, choices=SYMBOLS, default="")
    materials = ", ".join(material.name for material in WALL_MATERIALS)
    add_option(parser, "--material NAME", tr("material of the wall: {names}").format(names=materials))
    about = tr(
        "wall thickness, and distance that walls keep, such as 0.3mm, or a file of the wall distribution; "
        "default: 1/1000 of the diagonal"
    )
    add_option(parser, "--thickness LENGTH", about)
    add_option(parser, "--young E", tr("Young's modulus, such as 2.8GPa, for loads in newtons"))
    add_option(parser, "--poisson NU", tr("Poisson's ratio; default: 0.4, or that of the material"))


def parse_axis(text: str) -> np.ndarray:
    """Direction (3,) from "x", "-y", "+Z" or three numbers; raises InputError."""
    word = text.strip().lower()
    if (axis := _AXES.get(word, _AXES.get(f"+{word}"))) is not None:
        return axis
    try:
        axis = np.array([float(word) for word in text.replace(",", " ").split()])
    except ValueError:
        axis = np.zeros(0)
    if axis.shape != (3,) or not np.isfinite(axis).all() or not axis.any():
        raise InputError(
            tr("{text!r} is not a direction; enter x, y, z or three numbers such as 1 0 1.").format(text=text)
        )
    return axis


@unit_option_in_errors()
def given_wall(options: argparse.Namespace, mesh: Mesh, unit: Unit) -> Wall:
    """Wall properties from the options, for a mesh in ``unit``; raises InputError."""
    material = wall_material(options.material or "")
    if unit is Unit.NONE and (material or options.young):
        raise InputError(tr("A material needs the unit of the mesh; add --unit mm, cm, m, in or ft."))
    names = "density", "young", "poisson", "yield_radius"
    typed = {name: getattr(options, name, None) or "" for name in names}
    thickness = thickness_text(options.thickness or "", mesh, unit)
    wall = parse_wall(WallText(thickness, material=material, **typed), unit)
    if options.young and wall.thickness is None:
        raise InputError(tr("Newtons need the wall thickness as well; add --thickness."))
    return wall


def mesh_and_start(path: str, weld: bool) -> tuple[Mesh, np.ndarray | None, str]:
    """Undeformed mesh, a session's deformed shape (n, 3) or None, and the unit."""
    if Path(path).suffix.lower() != SESSION_SUFFIX:
        mesh = open_input_mesh(path, weld)
        return mesh, None, mesh.unit
    state, view = open_session(path)
    state = welded_state(state) if weld else state
    return state.document.mesh, None if state.is_at_rest else state.frame.U, view.unit
