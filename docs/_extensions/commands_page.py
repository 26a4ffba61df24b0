"""Commands and their options, written from the parsers themselves."""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterator

from plain_markdown import escaped, table

from apd_viewer.__main__ import _view_parser
from apd_viewer.commands.desktop.desktop_command import DESKTOP_PARSERS as OF_DESKTOP
from apd_viewer.commands.parsers import PARSERS

_WIDTH = 72  # columns of a usage line


def parsers() -> list[argparse.ArgumentParser]:
    """Parsers of the window and of all commands."""
    return [_view_parser(), *(make() for make in (PARSERS | OF_DESKTOP).values())]


def options(parser: argparse.ArgumentParser) -> list[argparse.Action]:
    """Arguments and options of a command, in the order of its help."""
    return [action for group in parser._action_groups for action in group._group_actions]


def names(action: argparse.Action) -> list[str]:
    """Names under which an option is given; of an argument, what stands for it."""
    return list(action.option_strings) or [str(action.metavar or action.dest)]


def anchor(command: str, name: str) -> str:
    """Anchor of an option on the page, as Sphinx makes it."""
    bare = name.lstrip("-") if name.startswith("-") else f"arg-{name}"
    return f"cmdoption-{command.replace(' ', '-')}-{bare}"


def commands_page() -> str:
    """Markdown with a section for each command."""
    return "\n".join(line for parser in parsers() for line in _section(parser))


def _section(parser: argparse.ArgumentParser) -> Iterator[str]:
    formatter = type(parser._get_formatter())(prog=parser.prog, width=_WIDTH)
    formatter.add_usage(parser.usage, parser._actions, parser._mutually_exclusive_groups, "")
    yield from (f"## {parser.prog}", "", escaped(parser.description or ""), "")
    yield from _usage(formatter.format_help().strip())
    yield from (f"```{{program}} {parser.prog}", "```", "")
    for action in options(parser):
        said = formatter._expand_help(action) if action.help else ""
        yield from (f"````{{option}} {_signature(action)}", "", escaped(said), "````", "")


def _usage(text: str) -> Iterator[str]:
    """How a command is called; a table, where each line says what it is for."""
    lines = [re.fullmatch(r"\s*(\S.*?) {2,}(\S.*)", line) for line in text.splitlines()]
    rows = [(f"`{line[1]}`", escaped(line[2])) for line in lines if line is not None]
    if len(rows) == len(lines) > 1:
        yield from (table(("call", "what it does"), rows), "")
    else:
        yield from ("```text", text, "```", "")


def _signature(action: argparse.Action) -> str:
    """An option as it is typed, all of its names with what follows them."""
    if not action.option_strings:
        return names(action)[0]
    formatter = argparse.HelpFormatter("")
    follows = "" if action.nargs == 0 else formatter._format_args(action, action.dest.upper())
    return ", ".join(f"{name} {follows}".strip() for name in action.option_strings)
