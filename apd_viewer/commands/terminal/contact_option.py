"""The option for contact."""

from __future__ import annotations

import argparse

from apd_viewer.commands.terminal.parser import Parser
from apd_viewer.geometry.solver.methods import MOST_VERTICES_IN_CONTACT, contact_by_default
from apd_viewer.language import tr


def add_contact_option(parser: Parser) -> None:
    """Add ``--contact`` and ``--no-contact``; None without either."""
    parser.add_argument(
        "--contact",
        action=argparse.BooleanOptionalAction,
        help=tr(
            "keep walls from passing through each other, or not; default: up to {most:,} vertices, by "
            "methods that can"
        ).format(most=MOST_VERTICES_IN_CONTACT),
    )


def has_contact(options: argparse.Namespace, vertices: int) -> bool:
    """True if the options of ``deform`` mean contact for so many vertices."""
    if options.contact is not None:
        return bool(options.contact)
    if options.obstacles:
        return True
    return options.iterations is None and contact_by_default(options.method, vertices)
