"""The ``serve`` command: the solver for other programs, over the standard streams."""

import argparse
import os

from apd_viewer.commands.solver_service import SolverService
from apd_viewer.commands.terminal.command_output import CommandOutput
from apd_viewer.commands.terminal.parser import Parser
from apd_viewer.commands.terminal.streams import message_streams
from apd_viewer.language import tr


def serve_parser() -> Parser:
    """Argument parser for the ``serve`` command."""
    parser = Parser(
        has_output=False,
        prog="apd-viewer serve",
        description=tr(
            "Deform meshes for another program: it writes messages to the standard input and reads the "
            "answers from the standard output, until it closes the input. The manual describes the messages."
        ),
    )
    parser.set_defaults(run=_serve, json=None)
    return parser


def _serve(_: argparse.Namespace) -> CommandOutput:
    with message_streams() as (source, sink):
        # There is nothing to save, and an iteration may take long: the process ends at once.
        SolverService(source, sink, lambda: os._exit(0)).run()
    return CommandOutput((), dict)
