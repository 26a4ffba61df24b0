"""The ``deck`` command: shell model and boundary conditions for FE programs."""

import argparse

from apd_viewer.commands.motion_options import add_input_options, read_input
from apd_viewer.commands.result_output import mesh_remarks
from apd_viewer.commands.terminal.command_output import CommandOutput
from apd_viewer.commands.terminal.mesh_options import unit_option_in_errors
from apd_viewer.commands.terminal.parser import Parser, add_option
from apd_viewer.files.fe_deck import SIX_NODES, THREE_NODES, check_deck, write_deck
from apd_viewer.geometry.mesh.arrays import diagonal
from apd_viewer.language import tr
from apd_viewer.session.deck_setup import deck_of, deck_wall
from apd_viewer.session.model.status_text import deck_sentence
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.wall import WallText
from apd_viewer.session.quantities.wall_distribution import thickness_text
from apd_viewer.session.quantities.wall_material import WALL_MATERIALS, wall_material


def deck_parser() -> Parser:
    """Argument parser for the ``deck`` command."""
    parser = Parser(
        prog="apd-viewer deck",
        description=tr(
            "Write a deck for CalculiX or Abaqus: the rest shape as shells, base fixed, handles moved."
        ),
    )
    add_input_options(parser)
    about = tr("steps of the motion; default: one per 30 degrees of rotation")
    add_option(parser, "--steps N", about, type=int)
    about = tr("S6 has nodes on its edges; S3 is smaller, and bends too little in CalculiX")
    add_option(parser, "--elements", about, choices=(SIX_NODES, THREE_NODES), default=SIX_NODES)
    _add_wall_options(parser)
    add_option(parser, "-o, --output OUT.inp", tr("deck to write"), required=True)
    parser.set_defaults(run=_deck)
    return parser


def _add_wall_options(parser: Parser) -> None:
    materials = ", ".join(material.name for material in WALL_MATERIALS)
    for option, metavar, what in (
        ("--material", "NAME", tr("material of the wall: {names}").format(names=materials)),
        (
            "--thickness",
            "LENGTH",
            tr("such as 0.3mm, or a file of the wall distribution; default: 1/1000 of the diagonal"),
        ),
        ("--density", "D", tr("density, such as 1.38 (g/cm³)")),
        ("--young", "E", tr("Young's modulus, such as 2.8GPa; default: 1 in the units of the deck")),
        ("--poisson", "NU", tr("Poisson's ratio; default: 0.4, or that of the material")),
    ):
        parser.add_argument(option, metavar=metavar, default="", help=what)


@unit_option_in_errors()
def _deck(options: argparse.Namespace) -> CommandOutput:
    output = check_deck(options.output)
    document, view, motion = read_input(options)
    unit = Unit(options.unit or view.unit)
    thickness = thickness_text(options.thickness, document.mesh, unit)
    given = thickness, options.density, options.young, options.poisson, "", options.material
    wall_material(options.material)  # raises InputError if unknown
    text = WallText.from_field_texts(
        *(word or known for word, known in zip(given, view.wall.field_texts, strict=True))
    )
    wall = deck_wall(text, unit, diagonal(document.mesh.V))
    deck = deck_of(document, wall, options.steps, motion)._replace(element=options.elements)
    write_deck(output, deck)
    lines = [deck_sentence(str(output), deck), *mesh_remarks(document.mesh)]
    counts = {"shells": len(deck.used_faces), "held_nodes": deck.held_count, "steps": len(deck.steps)}
    return CommandOutput(lines, lambda: {"mesh": document.mesh.name, "deck": str(output), **counts})
