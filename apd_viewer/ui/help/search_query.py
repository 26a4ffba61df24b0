"""Ranking of texts by the words of a wish, such as "make the brush smaller"."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable
from difflib import SequenceMatcher
from typing import NamedTuple

from apd_viewer.language import tr

# Words of a wish that say nothing about the command, in lower case.
_EMPTY = frozenset(
    tr("a an and can do for get have how i in is it make me my of on or the to want with").split()
)
# Words that are about the mesh whatever the command; they count only where nothing else was typed.
_GENERAL = frozenset(tr("bottle mesh model object shape thing").split())
_TITLE, _ALSO, _TIP = 3.0, 3.0, 1.0
_WHOLE = 2.0  # more, if every word of the title is meant
_MESH = 1.5  # more, for what changes the whole mesh if the wish names the mesh
_LONG = 5  # letters from which a word may be misspelt
_PART = 4  # letters from which a word may be part of another
_ALIKE = 0.8


class SearchTexts(NamedTuple):
    """Words of a command.

    Parameters
    ----------
    title, tip : str
    synonyms : str
        Other words for the same.
    """

    title: str
    tip: str
    synonyms: str = ""


def normalized_words(text: str) -> list[str]:
    """Words of a text in lower case, without accents and signs."""
    flat = unicodedata.normalize("NFKD", text.casefold())
    return re.findall(r"[^\W_]+", "".join(letter for letter in flat if not unicodedata.combining(letter)))


class SearchQuery(NamedTuple):
    """Telling words of a wish, and whether it names the mesh as a whole."""

    words: tuple[str, ...]
    is_general: bool

    @classmethod
    def from_text(cls, text: str) -> SearchQuery:
        """Query as typed; without a telling word, all of them count."""
        words = normalized_words(text)
        telling = [word for word in words if word not in _EMPTY]
        special = [word for word in telling if word not in _GENERAL]
        return cls(tuple(special or telling or words), bool(special) and special != telling)


def match_score(query: SearchQuery, texts: SearchTexts) -> float:
    """Match of texts with a wish; 0 unless most of its words are found."""
    title, tip, also = (normalized_words(text) for text in texts)
    total, found = 0.0, 0
    for word in query.words:
        best = max(_TITLE * _best(word, title), _ALSO * _best(word, also), _TIP * _best(word, tip))
        total += best
        found += best > 0.0
    if not query.words or 2 * found <= len(query.words):
        return 0.0
    named = sum(max(_alike(word, other) for word in query.words) for other in title) / max(1, len(title))
    general = query.is_general and not _GENERAL.isdisjoint(also)
    return total / len(query.words) + _WHOLE * named + _MESH * general


def _best(word: str, others: Iterable[str]) -> float:
    return max((_alike(word, other) for other in others), default=0.0)


def _alike(word: str, other: str) -> float:
    """1 for the same word, less for its beginning, another ending or a slip."""
    if word == other:
        return 1.0
    if other.startswith(word):
        return 0.9
    if word in other and (len(word) >= _PART or not word.isascii()):
        return 0.7  # part of a compound
    if not word.isascii() and len(other) > 1 and other in word:
        return 0.7  # words without blanks between them
    shared = len(word) >= _LONG - 1 and word[: max(4, len(word) - 3)] == other[: max(4, len(word) - 3)]
    if shared and abs(len(word) - len(other)) <= 3:
        return 0.8
    if min(len(word), len(other)) >= _LONG and SequenceMatcher(None, word, other).ratio() >= _ALIKE:
        return 0.6
    return 0.0
