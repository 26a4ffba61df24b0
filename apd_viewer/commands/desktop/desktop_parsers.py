"""Parsers of the desktop commands, by name."""

from collections.abc import Callable

from apd_viewer.commands.desktop.desktop_command import desktop_parser
from apd_viewer.commands.desktop.thumbnail_command import thumbnail_parser
from apd_viewer.commands.terminal.parser import Parser

DESKTOP_PARSERS: dict[str, Callable[[], Parser]] = {"desktop": desktop_parser, "thumbnail": thumbnail_parser}
