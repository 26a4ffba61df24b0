"""Input meshes of commands, with the options ``--weld`` and ``--unit``."""

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from apd_viewer.commands.terminal.parser import add_option
from apd_viewer.errors import InputError
from apd_viewer.files.meshes import open_mesh, read_mesh, recognized_suffix
from apd_viewer.files.storage.regular_files import STANDARD_INPUT, read_standard_input
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


def open_input_mesh(path: str | Path, weld: bool = False, unit: str = "") -> Mesh:
    """Mesh from a file, with its seams welded on request; raises InputError.

    Another ``unit`` than the file's counts, if it is given. The path ``-`` is the standard input.
    """
    mesh = _piped_mesh() if Path(path) == STANDARD_INPUT else open_mesh(path)
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
