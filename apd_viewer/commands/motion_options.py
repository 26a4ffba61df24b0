"""Command-line options for motions: paint, pose matrices, and typed motions."""

import argparse
from collections.abc import Sequence
from pathlib import Path

from apd_viewer.commands.terminal.mesh_options import open_input_mesh, unit_option_in_errors
from apd_viewer.commands.terminal.parser import add_option
from apd_viewer.errors import InputError
from apd_viewer.files.selections.selection_files import read_selection_file
from apd_viewer.files.selections.survey_formats import read_transform
from apd_viewer.language import tr
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.document_parts import with_selection
from apd_viewer.session.model.state import initial_document, welded_state
from apd_viewer.session.model.view import SESSION_SUFFIX, View
from apd_viewer.session.posing.motion import MOTION_KINDS
from apd_viewer.session.posing.motion_path import MotionStep
from apd_viewer.session.posing.motion_text import motion_steps
from apd_viewer.session.quantities.units import SYMBOLS, Unit
from apd_viewer.session.storage.session_file import open_session


def add_input_options(parser: argparse.ArgumentParser) -> None:
    """Add options for a session, or a mesh with its paint, and for the motion."""
    parser.add_argument(
        "file", metavar="SESSION", help=tr("session (.apd), or a mesh with --selection and a motion")
    )
    add_option(parser, "--selection SEL", tr("for a mesh: base, handles and regions"))
    about = tr("for a mesh: 4x4 matrix that moves the handle; repeat for each handle")
    add_option(parser, "--transform DEF", about, action="append", default=[])
    add_motion_options(parser)


def add_motion_options(parser: argparse.ArgumentParser) -> None:
    """Add the motion options; their order is the order of the steps."""
    group = parser.add_argument_group(
        tr("motion of the handles"),
        tr("All amounts grow together; motions apply in the order given. Negative amounts need “=”."),
    )

    def add(option: str, words: str, metavar: str, what: str) -> None:
        how = {"dest": "motion", "action": "append", "default": [], "type": words.format}
        group.add_argument(option, metavar=metavar, help=what, **how)  # type: ignore[arg-type]

    for word, kind in MOTION_KINDS.items():
        metavar = kind.amount.value if kind.takes_single_amount else "WORDS"
        add(f"--{word}", f"{word} {{}}", metavar, kind.help)
    add("--handle", "handle {}:", "N", tr("handle moved by the following options; default: 1"))
    add("--motion", "{}", "WORDS", tr("motion in words, as in a plan: “twist 120deg; push 30%%”"))
    add_option(group, "--unit", tr("unit of the mesh, for lengths such as 2cm"), choices=SYMBOLS, default="")


def read_input(
    options: argparse.Namespace, weld: bool = False
) -> tuple[Document, View, tuple[MotionStep, ...]]:
    """Painted document, view and motion from the options; the motion may be empty.

    With ``weld`` the seams of the mesh are welded.

    Raises
    ------
    InputError
        If the options of :func:`add_input_options` do not go together, or a file cannot be read.
    """
    path = Path(options.file)
    if path.suffix.lower() == SESSION_SUFFIX:
        if options.selection or options.transform:
            raise InputError(tr("A session has its own paint and motion; omit --selection and --transform."))
        state, view = open_session(path)
        document = (welded_state(state) if weld else state).document
        return document, view, motion_from(options, document, view.unit)
    if not options.selection or not (options.transform or options.motion):
        raise InputError(
            tr(
                "{name} is not a session; give a .apd file, or --selection with --transform or a motion "
                "such as --twist."
            ).format(name=path.name)
        )
    if options.transform and options.motion:
        raise InputError(tr("Give either --transform or a motion such as --twist, not both."))
    mesh = open_input_mesh(path, weld)
    document = with_selection(initial_document(mesh), read_selection_file(options.selection, mesh))
    document = _posed_document(document, options.transform)
    return document, View(unit=mesh.unit), motion_from(options, document, mesh.unit)


def _posed_document(document: Document, transforms: Sequence[str]) -> Document:
    """Document with its handles posed by matrices from files."""
    if transforms and len(transforms) != len(document.handles):
        raise InputError(
            tr("There are {handles} handles but {motions} motions; give one for each handle.").format(
                handles=len(document.handles), motions=len(transforms)
            )
        )
    for k, path in enumerate(transforms):
        document = document.with_pose(k, read_transform(path))
    return document


@unit_option_in_errors()
def motion_from(
    options: argparse.Namespace, document: Document, unit_symbol: str = ""
) -> tuple[MotionStep, ...]:
    """Motion of a mesh from the options; empty without motion options.

    Parameters
    ----------
    document : Document
        Painted document.
    unit_symbol : str
        Unit of the mesh, unless an option gives one.

    Raises
    ------
    InputError
        If the motion is none, or does not fit the mesh.
    """
    if not options.motion:
        return ()
    return motion_steps(document, "; ".join(options.motion), Unit(options.unit or unit_symbol))
