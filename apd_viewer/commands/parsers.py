"""Parsers of the commands, by name."""

from collections.abc import Callable

from apd_viewer.commands.buckle_command import buckle_parser
from apd_viewer.commands.deck_command import deck_parser
from apd_viewer.commands.deform_command import deform_parser
from apd_viewer.commands.info_command import info_parser
from apd_viewer.commands.mcp_command import mcp_parser
from apd_viewer.commands.paper_command import paper_parser
from apd_viewer.commands.press_command import press_parser
from apd_viewer.commands.remesh_command import remesh_parser
from apd_viewer.commands.replay_command import replay_parser
from apd_viewer.commands.serve_command import serve_parser
from apd_viewer.commands.study_command import design_parser, study_parser
from apd_viewer.commands.sweep_command import sweep_parser
from apd_viewer.commands.terminal.parser import Parser
from apd_viewer.commands.verify_command import verify_parser
from apd_viewer.commands.volumes_command import volumes_parser

PARSERS: dict[str, Callable[[], Parser]] = {
    "buckle": buckle_parser,
    "deck": deck_parser,
    "deform": deform_parser,
    "info": info_parser,
    "mcp": mcp_parser,
    "paper": paper_parser,
    "press": press_parser,
    "remesh": remesh_parser,
    "replay": replay_parser,
    "serve": serve_parser,
    "study": study_parser,
    "study design": design_parser,
    "sweep": sweep_parser,
    "verify": verify_parser,
    "volumes": volumes_parser,
}
