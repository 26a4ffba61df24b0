"""Command line; only ``apd-viewer [FILE]`` opens a window and needs a display."""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import apd_viewer
from apd_viewer.commands.terminal.command_output import json_path
from apd_viewer.commands.terminal.parser import Parser, add_option
from apd_viewer.commands.terminal.streams import discard_output, exit_on_signals, prepare_streams, print_error
from apd_viewer.errors import InputError
from apd_viewer.files.mesh_formats import READABLE_NAMES
from apd_viewer.language import comma_separated, tr

_OF_DESKTOP = "desktop", "thumbnail"
COMMANDS = (
    *("buckle", "deck", "deform", "info", "mcp", "paper", "press", "remesh", "replay"),
    *("serve", "study", "sweep", "verify", "volumes"),
    *_OF_DESKTOP,
)
_USAGE = tr(
    """\
apd-viewer [FILE]                    open the window on FILE or on the sample bottle
apd-viewer deform MESH ... -o OUT    deform a mesh without a window
apd-viewer deck SESSION -o OUT.inp   shells with boundary conditions for CalculiX or Abaqus
apd-viewer info MESH                 check a mesh file and describe its contents
apd-viewer buckle MESH ...           loads at which a thin wall between two plates buckles
apd-viewer press MESH ... -o OUT     press a mesh between two plates
apd-viewer remesh MESH -o OUT        divide the surface of a mesh into even triangles
apd-viewer replay SESSION -o OUT     re-run a saved session without a window
apd-viewer serve                     deform meshes for another program, over a pipe
apd-viewer mcp FOLDER                offer commands as tools to a language model, over a pipe
apd-viewer study PLAN.csv -o DIR     run many cases in parallel; "study design" writes plans
apd-viewer sweep SESSION -o DIR      area, volume and energy along the motion of the handle
apd-viewer volumes MESH              volumes, beside published figures of crushed bottles
apd-viewer verify [--case A,H]       compare the program with exact answers
apd-viewer paper [-o DIR]            reproduce the paper's tables on the sample bottle and duck
apd-viewer desktop --install         open files with it on Linux; --remove undoes that
apd-viewer thumbnail FILE OUT.png    draw a small picture of a session or a mesh
"""
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit status, 2 after an ``error:`` line."""
    words = list(sys.argv[1:] if arguments is None else arguments)
    prepare_streams()
    try:
        _run(words)
    except InputError as error:
        print_error(tr("error: {sentence}").format(sentence=" ".join(str(error).split())))
        return 2
    except BrokenPipeError:  # the reading process, such as head, has exited
        discard_output()
    except OSError as error:
        discard_output()
        print_error(
            tr("error: the output cannot be written ({reason}).").format(reason=error.strerror or error)
        )
        return 2
    except KeyboardInterrupt:
        print_error(tr("interrupted; no file is left unfinished"))
        return 130
    return 0


def _run(words: list[str]) -> None:
    try:
        options = parse_arguments(words)
        # Imported here: this import would double the time of --version and --help, which exit earlier.
        from apd_viewer import log

        with log.recording_log(options.log_level):
            if words and words[0] in COMMANDS:
                with exit_on_signals():
                    _run_command(options)
            else:
                options.run(options)
    except SystemExit:
        sys.stdout.flush()
        raise
    sys.stdout.flush()


def _run_command(options: argparse.Namespace) -> None:
    """Run a command and show its output; raises SystemExit with a status above 0."""
    if (path := json_path(options.json)) is not None:
        # Imported here: the thumbnails of a file manager should not wait for it.
        from apd_viewer.files.mesh_writing import check_writable

        check_writable(path)
    output = options.run(options)
    output.show(options.json)
    if output.status:
        raise SystemExit(output.status)


def parse_arguments(words: list[str]) -> argparse.Namespace:
    """Options parsed from the words of the command line."""
    if not words or words[0] not in COMMANDS:
        parser = _view_parser()
        name = words[0] if len(words) > 1 else ""  # only commands take arguments
        if name and not name.startswith("-") and not Path(name).suffix and not Path(name).exists():
            parser.error(tr("“{name}” is neither a file nor a command").format(name=name))
        return parser.parse_args(words)
    count = 2 if words[:2] == ["study", "design"] else 1
    return _command_parser(" ".join(words[:count])).parse_args(words[count:])


def _view_parser() -> Parser:
    about = tr("Area-preserving deformation of 3D objects.")
    parser = Parser(has_output=False, prog="apd-viewer", usage=_USAGE, description=about)
    parser.add_argument(
        "file",
        nargs="?",
        metavar="FILE",
        help=tr("mesh ({formats}) or session (.apd) to open").format(formats=comma_separated(READABLE_NAMES)),
    )
    version = f"apd-viewer {apd_viewer.__version__}"
    parser.add_argument("--version", action="version", version=version, help=tr("show the version and exit"))
    add_option(parser, "--clicked", tr("for desktops: open the window, and show errors of FILE in it"))
    _describe_environment(parser)
    parser.set_defaults(run=lambda options: apd_viewer.show_window(options.file, options.clicked))
    return parser


# As in the manual, reference/settings.md.
VARIABLES = {
    "APD_VIEWER_LANGUAGE": tr("language of the window and of the command line; goes before the settings"),
    "APD_VIEWER_LANGUAGES": tr("another folder of translations"),
    "APD_VIEWER_LOGS": tr("another folder for logs"),
    "NUMBA_NUM_THREADS": tr("the most cores for the kernels"),
}


def _describe_environment(parser: Parser) -> None:
    """Append the environment variables to the help."""
    group = parser.add_argument_group(tr("environment variables"))
    for name, about in VARIABLES.items():
        group._group_actions.append(argparse.Action([name], name, nargs=0, help=about))


def _command_parser(command: str) -> Parser:
    if command in _OF_DESKTOP:
        # Imported here, without the other parsers: a file manager is waiting for the thumbnail.
        from apd_viewer.commands.desktop.desktop_command import DESKTOP_PARSERS as OF_DESKTOP

        return OF_DESKTOP[command]()
    # Imported here: these imports are slow, and opening a window does not need them.
    from apd_viewer.commands.parsers import PARSERS

    return PARSERS[command]()


if __name__ == "__main__":
    sys.exit(main())
