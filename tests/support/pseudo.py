"""A language that nobody speaks, made from the sources: what is not in it was never marked as words."""

import re
from functools import cache
from pathlib import Path

from babel.messages.catalog import Catalog
from babel.messages.extract import extract_from_file
from babel.messages.mofile import write_mo

ROOT = Path(__file__).parents[2]
KEYWORDS = {"tr": None, "trn": (1, 2), "trc": ((1, "c"), 2)}
MARKING = re.compile(r"\b(tr|trn|trc)\b")  # half of the sources mark nothing, and are slow to take apart
# German has the plurals of English, and Qt has German words of its own.
LANGUAGE = "de"
OPEN, CLOSE = "⟦", "⟧"
# What a translation must leave as it is: fields for values, argparse's among them, and tags.
KEPT = re.compile(r"\{[^{}]*(?:\{[^{}]*\}[^{}]*)*\}|%\(\w+\)[rs]|%[rs%]|<[^<>]+>")
MARKED = re.compile(f"{OPEN}[^{OPEN}{CLOSE}]*{CLOSE}")


@cache
def messages():
    """All that is marked for translation: (message, context) each; a message may be a pair, one and many."""
    sources = sorted((ROOT / "apd_viewer").rglob("*.py"))
    speaking = [path for path in sources if MARKING.search(path.read_text(encoding="utf-8"))]
    found = (each for path in speaking for each in extract_from_file("python", path, keywords=KEYWORDS))
    return tuple((message, context) for _, message, _, context in found)


def fields(text):
    """The fields for values in a text, in the order of the alphabet."""
    return sorted(found for found in KEPT.findall(text) if found[0] in "{%")


def pseudo(text):
    """The text in marks and 40 % longer; what stands for values stays, outside of the marks.

    Numbers are written as nobody does who has a decimal point.
    """
    if text == "1,234.5":
        return "1’234,5"
    return _besides_fields(_bracketed, text)


def _besides_fields(change, text):
    parts = re.split(f"({KEPT.pattern})", text)
    return "".join(part if number % 2 else change(part) for number, part in enumerate(parts))


def _bracketed(text):
    head, body, tail = re.fullmatch(r"(\s*)(.*?)(\s*)", text, re.DOTALL).groups()
    return f"{head}{OPEN}{_lengthened(body)}{CLOSE}{tail}" if body else text


def _lengthened(text):
    """Letters are doubled here and there; none behind an ampersand, by which menus are opened."""
    result = ""
    for number, sign in enumerate(text):
        result += sign
        if sign.isalpha() and text[number - 1 : number] != "&" and len(result) < 1.4 * (number + 1):
            result += sign.lower()
    return result


def kana(text):
    """The text in full-width katakana, as long as its words: letters that are as wide as high."""
    signs = "アイウエオカキクケコサシスセソタチツテトナニヌネノ"
    return _besides_fields(
        lambda part: re.sub(r"(?<!&)[A-Za-z]{1,2}", lambda two: signs[ord(two[0][0]) % len(signs)], part),
        text,
    )


def write_catalogue(folder, spoken=pseudo):
    """Write the language into a folder of catalogues."""
    catalogue = Catalog(locale=LANGUAGE)
    for message, context in messages():
        words = tuple(map(spoken, message)) if isinstance(message, tuple) else spoken(message)
        catalogue.add(message, words, context=context)
    place = folder / LANGUAGE / "LC_MESSAGES"
    place.mkdir(parents=True)
    with (place / "apd_viewer.mo").open("wb") as stream:
        write_mo(stream, catalogue)
