"""Command line parser with translated headings."""

from __future__ import annotations

import argparse
from typing import Any

from apd_viewer.language import tr


class Parser(argparse.ArgumentParser):
    """Parser with one-line errors and help in the language of the user."""

    def __init__(self, **settings: Any) -> None:
        super().__init__(add_help=False, formatter_class=_Help, **settings)
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

    def error(self, message: str) -> None:  # type: ignore[override]
        """Print the error in one line, without argparse's usage."""
        said = tr("error: {message}; see {program} --help").format(message=message, program=self.prog)
        self.exit(2, f"{said}\n")


class _Help(argparse.HelpFormatter):
    """Help formatter with translated headings; argparse's own errors stay English."""

    def add_usage(self, usage: Any, actions: Any, groups: Any, prefix: str | None = None) -> None:
        """Translate the heading of the usage."""
        super().add_usage(usage, actions, groups, tr("usage: ") if prefix is None else prefix)

    def start_section(self, heading: str | None) -> None:
        """Translate the heading of a section."""
        words = {"options": tr("options"), "positional arguments": tr("positional arguments")}
        super().start_section(None if heading is None else words.get(heading, heading))
