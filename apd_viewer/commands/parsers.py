"""Parsers of the commands, by name."""

from __future__ import annotations

from collections.abc import Callable

from apd_viewer.commands.deck import deck_parser
from apd_viewer.commands.deform import deform_parser
from apd_viewer.commands.info import info_parser
from apd_viewer.commands.paper import paper_parser
from apd_viewer.commands.press import press_parser
from apd_viewer.commands.replay import replay_parser
from apd_viewer.commands.studies.study import study_parser
from apd_viewer.commands.studies.study_design import design_parser
from apd_viewer.commands.sweep import sweep_parser
from apd_viewer.commands.terminal.parser import Parser
from apd_viewer.commands.volumes import volumes_parser

PARSERS: dict[str, Callable[[], Parser]] = {
    "deck": deck_parser,
    "deform": deform_parser,
    "info": info_parser,
    "paper": paper_parser,
    "press": press_parser,
    "replay": replay_parser,
    "study": study_parser,
    "study design": design_parser,
    "sweep": sweep_parser,
    "volumes": volumes_parser,
}
