"""Commands as tools: schemas of their arguments, and words of their command lines."""

import argparse
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from apd_viewer.commands.buckle_command import buckle_parser
from apd_viewer.commands.deform_command import deform_parser
from apd_viewer.commands.info_command import info_parser
from apd_viewer.commands.press_command import press_parser
from apd_viewer.commands.terminal.parser import Parser
from apd_viewer.commands.volumes_command import volumes_parser
from apd_viewer.errors import InputError
from apd_viewer.files.storage.confinement import check_inside
from apd_viewer.files.storage.regular_files import STANDARD_INPUT
from apd_viewer.language import tr
from apd_viewer.session.quantities.wall_distribution import distribution_file

TOOLS = {
    "info": info_parser,
    "deform": deform_parser,
    "press": press_parser,
    "buckle": buckle_parser,
    "volumes": volumes_parser,
}
# Left out: "motion" in words has the other motions, and the server itself asks for JSON.
_HIDDEN = {"help", "log_level", "json", "progress_lines"}


def tool_fields(name: str, overwriting: bool = False) -> dict[str, Any]:
    """Description of a tool for clients, with the JSON schema of its arguments."""
    parser = TOOLS[name]()
    actions = _arguments(parser)
    return {
        "name": name,
        "description": parser.description,
        "inputSchema": {
            "type": "object",
            "properties": {key: _schema(parser, action) for key, action in actions.items()},
            "required": [key for key, action in actions.items() if action.required],
            "additionalProperties": False,
        },
        "annotations": {
            "readOnlyHint": name == "info",
            "destructiveHint": overwriting and name != "info",
            "openWorldHint": False,
        },
    }


def _arguments(parser: Parser) -> dict[str, argparse.Action]:
    """Arguments of a command by their names in the schema."""
    found = {}
    for action in parser._actions:
        is_other_motion = action.dest == "motion" and "--motion" not in action.option_strings
        if action.dest not in _HIDDEN and not is_other_motion:
            found[action.dest] = action
    return found


def _schema(parser: Parser, action: argparse.Action) -> dict[str, Any]:
    """JSON schema of an argument."""
    value: dict[str, Any] = {"type": "string"}
    if action.nargs == 0:
        value = {"type": "boolean"}
    elif action.choices:
        value = {"enum": list(action.choices)}
    elif action.type in (int, float):
        value = {"type": "integer" if action.type is int else "number"}
    elif action.type not in (None, Path) and action.dest != "motion":  # a number, or something in words
        value = {"type": ["number", "string"]}
    if action.nargs == "+":
        value = {"type": "array", "items": value, "minItems": 1}
    if isinstance(action, argparse._AppendAction) and action.dest != "motion":
        value = {"type": "array", "items": value}
    said = parser._get_formatter()._expand_help(action) if action.help else str(action.metavar)
    return value | {"description": said}


def command_words(name: str, arguments: dict[str, Any], folder: Path) -> list[str]:
    """Words of a command line whose files are all in ``folder``.

    Raises
    ------
    InputError
        If an argument is unknown or of the wrong type, or leads out of the folder.
    """
    known = _arguments(TOOLS[name]())
    words, last = [name], list[str]()
    for key, value in arguments.items():
        if key not in known:
            sentence = tr("“{name}” is no argument of {tool}; use those of its schema.")
            raise InputError(sentence.format(name=key, tool=name))
        if value is not None:
            (words if known[key].option_strings else last).extend(_words_of(known[key], key, value, folder))
    return [*words, "--json", *(["--", *last] if last else [])]


def _words_of(action: argparse.Action, key: str, value: Any, folder: Path) -> Iterator[str]:
    """Words of one argument."""
    # "-o, --output" and "--contact, --no-contact": the long one, and the positive one.
    option = next((name for name in action.option_strings if name.startswith("--")), "")
    if action.nargs == 0:
        if not isinstance(value, bool):
            raise _type_error(key, "true, false")
        yield from [option] if value else action.option_strings[1:]
    elif isinstance(action, argparse._AppendAction) and action.dest != "motion":
        if not isinstance(value, list):
            raise _type_error(key, "[…]")
        for each in value:
            yield from _words_of_value(option, action.nargs, key, each, folder)
    else:
        yield from _words_of_value(option, action.nargs, key, value, folder)


def _words_of_value(option: str, nargs: Any, key: str, value: Any, folder: Path) -> Iterator[str]:
    if nargs == "+":
        if not isinstance(value, list) or not value:
            raise _type_error(key, "[…]")
        words = [_checked_text(key, each, folder) for each in value]
        if any(word.startswith("-") for word in words):  # the parser would take it for an option
            raise InputError(tr("A value of “{name}” begins with a dash; rename it.").format(name=key))
        yield from (option, *words)
        return
    text = _checked_text(key, value, folder)
    yield f"{option}={text}" if option else text


def _checked_text(key: str, value: Any, folder: Path) -> str:
    """Text of a value; raises InputError if it leads out of the folder."""
    if isinstance(value, bool) or not isinstance(value, (str, int, float)):
        raise _type_error(key, tr("a text or a number"))
    text = str(value)
    # Any text may be the name of a file, and the colours of a file may follow its name.
    file = distribution_file(text)
    for path in (text, str(file[0]) if file else text):
        if Path(path) == STANDARD_INPUT:
            raise InputError(tr("The standard input carries messages; name a file in place of “-”."))
        check_inside(path, folder)
    return text


def _type_error(key: str, kind: str) -> InputError:
    return InputError(tr("“{name}” has to be {kind}.").format(name=key, kind=kind))
