"""Command-line parser in the user's language."""

import argparse
import re
import sys
from collections.abc import Iterable
from typing import Any

from apd_viewer.commands.terminal.columns import column_count, wrapped_lines
from apd_viewer.commands.terminal.command_output import STANDARD_OUTPUT
from apd_viewer.language import tr, trn

# Texts of argparse in Python 3.10 to 3.13, listed for translation; argparse looks them up itself.
_OF_ARGPARSE = (
    tr("usage: "),
    tr("options"),
    tr("positional arguments"),
    tr("argument %(argument_name)s: %(message)s"),
    tr("the following arguments are required: %s"),
    tr("one of the arguments %s is required"),
    tr("unrecognized arguments: %s"),
    tr("ambiguous option: %(option)s could match %(matches)s"),
    tr("not allowed with argument %s"),
    tr("ignored explicit argument %r"),
    tr("expected one argument"),
    tr("expected at most one argument"),
    tr("expected at least one argument"),
    tr("invalid %(type)s value: %(value)r"),
    tr("invalid choice: %(value)r (choose from %(choices)s)"),
    trn("expected %s argument", "expected %s arguments", 2),
)
argparse._ = tr  # type: ignore[attr-defined]
argparse.ngettext = trn  # type: ignore[attr-defined]


class _Formatter(argparse.HelpFormatter):
    """Help text at the terminal's width, also in languages without spaces."""

    def _format_usage(
        self, usage: str | None, actions: Iterable[argparse.Action], groups: Iterable[Any], prefix: str | None
    ) -> str:
        head = tr("usage: ") if prefix is None else prefix
        room = column_count(head)
        return head + super()._format_usage(usage, actions, groups, " " * room)[room:]

    def _split_lines(self, text: str, width: int) -> list[str]:
        if column_count(text) == len(text):
            return super()._split_lines(text, width)
        return wrapped_lines(text, width)

    def _fill_text(self, text: str, width: int, indent: str) -> str:
        if column_count(text) == len(text):
            return super()._fill_text(text, width, indent)
        return "\n".join(indent + line for line in wrapped_lines(text, width - len(indent)))


_JSON = "--json"
# A word after it that is its file, not the next one of the command: named as JSON, or a device.
_JSON_FILE = re.compile(r".*\.json|/dev/.*", re.IGNORECASE)
_NEGATIVE = re.compile(r"-[\d.]+[a-zA-Z%]+")  # -50mbar, which argparse takes for an option


class Parser(argparse.ArgumentParser):
    """Parser with one-line errors and with help in the user's language.

    Parameters
    ----------
    has_output : bool
        The command has an output for scripts.
    """

    def __init__(self, has_output: bool = True, **settings: Any) -> None:
        super().__init__(add_help=False, formatter_class=_Formatter, **settings)
        self.add_argument("-h", "--help", action="help", help=tr("show this help message and exit"))
        self.add_argument(
            "--log-level",
            metavar="LEVEL",
            choices=("debug", "info", "warning", "error"),
            help=tr(
                "least severity to log and to print: debug, info, warning or error; "
                "by default info is logged and nothing is printed"
            ),
        )
        if has_output:
            about = tr("print JSON in place of text, or write it to a file beside the text")
            self.add_argument(_JSON, metavar="FILE.json", nargs="?", help=about)

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Parse words; that after ``--json`` is its file only if it ends like one."""
        words = sys.argv[1:] if args is None else args
        return super().parse_known_args(_with_values_joined(words), namespace)

    def error(self, message: str) -> None:  # type: ignore[override]
        """Print the error in one line, without argparse's usage."""
        said = tr("error: {message}; see {program} --help").format(message=message, program=self.prog)
        self.exit(2, f"{said}\n")


def _with_values_joined(words: Iterable[str]) -> list[str]:
    """Words with ``--json`` and negative quantities joined to their values."""
    joined = list[str]()
    for word in words:
        if joined and joined[-1] == _JSON and _JSON_FILE.fullmatch(word):
            joined[-1] = f"{_JSON}={word}"
        elif joined and re.fullmatch(r"--[a-z-]+", joined[-1]) and _NEGATIVE.fullmatch(word):
            joined[-1] = f"{joined[-1]}={word}"
        else:
            joined.append(word)
    return [f"{_JSON}={STANDARD_OUTPUT}" if word == _JSON else word for word in joined]


def add_report_option(parser: Parser) -> None:
    """Add ``--report``, another name of ``--json`` with a file."""
    add_option(parser, "--report R.json", tr("another name of --json R.json"), dest=_JSON.lstrip("-"))


def add_option(parser: argparse._ActionsContainer, words: str, about: str = "", **how: Any) -> None:
    """Add an option given as in the help, such as "-o, --output DIR" or "MESH".

    Without a value and without choices an option is a flag. ``how`` is for argparse.
    """
    *names, last = words.split()
    if not last.startswith("-"):
        how["metavar"] = last
        names = names or [last.partition(".")[0].lower()]
    else:
        names.append(last)
        if not how.keys() & {"action", "choices"}:
            how["action"] = "store_true"
    parser.add_argument(*(name.rstrip(",") for name in names), help=about or None, **how)
