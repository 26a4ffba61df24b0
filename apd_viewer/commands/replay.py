"""The command replay: re-run a saved session."""

from __future__ import annotations

import sys
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

from apd_viewer.commands.measurement_output import measurements_report
from apd_viewer.commands.result_output import progress_line, summary, write_result
from apd_viewer.commands.scalar_output import add_scalar_options, check_scalar_options, write_scalar_files
from apd_viewer.commands.terminal.parser import Parser
from apd_viewer.files.mesh_writing import check_target
from apd_viewer.language import tr
from apd_viewer.session.model.status_text import about_missing_target
from apd_viewer.session.studies.replay import replay

if TYPE_CHECKING:
    import argparse


def replay_parser() -> Parser:
    """Parser of the command replay."""
    parser = Parser(prog="apd-viewer replay", description=tr("Re-run a saved session without a window."))
    parser.add_argument("session", metavar="SESSION", help=tr("session file (.apd) saved by the window"))
    parser.add_argument("-o", "--output", metavar="OUT", required=True, help=tr("mesh file to write"))
    parser.add_argument("--report", metavar="R.json", type=Path, help=tr("write the measurements as JSON"))
    add_scalar_options(parser)
    parser.add_argument(
        "--from-rest",
        action="store_true",
        help=tr("start from the rest shape; default: a saved shape that has converged is kept"),
    )
    parser.set_defaults(run=_replay)
    return parser


def _replay(options: argparse.Namespace) -> None:
    output = check_target(options.output)
    check_scalar_options(options)
    progress = progress_line(None) if sys.stderr.isatty() else None
    document, result = replay(options.session, options.from_rest, progress)
    mesh = document.mesh
    with ExitStack() as beside:
        painted = document.labels, document.member
        write_scalar_files(beside, options, mesh, result.U, *painted, document.target)
        more = measurements_report(document, result.U) if options.report else {}
        written = write_result(beside, mesh, result, options.report, output, document.target, more)
    print(summary(mesh, result, output, written))
    if missing := about_missing_target(document):
        print(missing)
