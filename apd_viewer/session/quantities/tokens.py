"""Tokens of an expression."""

from __future__ import annotations

import re

from apd_viewer.errors import InputError
from apd_viewer.language import in_quotes, tr
from apd_viewer.session.quantities.expression_functions import VARIADIC_FUNCTIONS

SPELLINGS = str.maketrans(
    dict.fromkeys("−–‐‑", "-")
    | dict.fromkeys("×·⋅∙∗", "*")
    | dict.fromkeys("÷∕⁄", "/")
    | dict.fromkeys("µμ", "u")
    | {"²": "^2 ", "³": "^3 ", "°": " deg ", "π": " pi "}
)
_TOKEN = r"(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?|[^\W\d_]\w*|\*\*|[-+*/^%(),]"
_AMONG_ARGUMENTS = re.compile(rf"\s*({_TOKEN})")
_ELSEWHERE = re.compile(rf"\s*([0-9]+,[0-9]+(?:[eE][+-]?[0-9]+)?|{_TOKEN})")


def tokenize(text: str) -> list[str]:
    """Tokens of a text, left to right; raises InputError."""
    tokens: list[str] = []
    # For each open parenthesis, whether commas separate arguments; elsewhere they are decimal commas.
    lists = [False]
    at = 0
    while at < len(text):
        found = (_AMONG_ARGUMENTS if lists[-1] else _ELSEWHERE).match(text, at)
        if not found:
            raise InputError(
                tr("{text} is not allowed here; remove it.").format(text=quoted_input(text[at:].lstrip()[0]))
            )
        token, at = found[1], found.end()
        if token == "(":
            lists.append(tokens[-1:] != [] and tokens[-1] in VARIADIC_FUNCTIONS)
        elif token == ")" and len(lists) > 1:
            lists.pop()
        tokens.append(token)
    return tokens


def is_number(token: str) -> bool:
    """True if a token begins like a number."""
    return token[:1].isdecimal() or token[:1] == "."


def quoted_input(text: str) -> str:
    """Typed text for a sentence: shortened, invisible characters as codes."""
    short = text if len(text) <= 20 else f"{text[:19]}…"
    return (
        in_quotes(short)
        if short.isprintable()
        else tr("The character U+{code:04X}").format(code=ord(text[0]))
    )
