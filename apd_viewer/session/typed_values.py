"""Vertices, lengths and points typed by the user, evaluated on the open mesh."""

import re
from contextlib import suppress

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.language import tr
from apd_viewer.session.model.state import State
from apd_viewer.session.quantities.expressions import parse_length, parse_number, unambiguous_text
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.state_store import StateStore


class TypedValues:
    """Parser of typed values on the open document; methods raise InputError."""

    def __init__(self, store: StateStore) -> None:
        self._store = store

    def parse_vertices(self, text: str) -> np.ndarray:
        """Vertices selected by ids or conditions on coordinates, as ascending ids."""
        return parse_vertices(unambiguous_text(text), self._store.required_state(), self._store.unit)

    def parse_length(self, text: str) -> float:
        """Parse a length, in mesh units."""
        names = self._store.required_state().document.mesh.named_lengths
        return parse_length(unambiguous_text(text), self._store.unit, names)

    def parse_fraction_or_length(self, text: str, extent: float) -> float:
        """Parse a length, or a percentage of an extent, into mesh units."""
        text = unambiguous_text(text).strip()
        with suppress(InputError):
            return parse_number(text.removesuffix("%"), {}) / 100.0 * extent
        return self.parse_length(text)

    def parse_point(self, text: str) -> np.ndarray:
        """Parse a point (3,) from its coordinates."""
        return parse_point(unambiguous_text(text), self._store.required_state(), self._store.unit)

    def parse_vector(self, text: str) -> np.ndarray:
        """Parse a direction (3,) from three numbers, of any length."""
        return parse_vector(unambiguous_text(text), self._store.required_state())


_IDS = re.compile(r"[\d\s,;–-]+")
_ID = re.compile(r"(\d+)(?:\s*[–-]\s*(\d+))?")
_MOST_DIGITS = 18  # of an ID, leading zeros included
_COMPARED = re.compile(r"<=|>=|≤|≥|<|>")
_HOLDS = {"<": np.less, ">": np.greater, "<=": np.less_equal, ">=": np.greater_equal}
_HOLDS |= {"≤": np.less_equal, "≥": np.greater_equal}
_SHARE = re.compile(r"[-+−]?[0-9.,]+\s*%")
_AXES = "x", "y", "z"
_HOW = tr("enter IDs such as 3, 10-20, or conditions such as y > 80% and x < 0")


def parse_vertices(text: str, state: State, unit: Unit) -> np.ndarray:
    """Vertices selected by a text, as ascending ids.

    Either ids and ranges of ids, parted by commas or spaces, or conditions on the coordinates x, y, z of the
    shape on screen, joined by "and" and "or". A coordinate is compared with another one, with a length, which
    may be an expression with the names of :attr:`Mesh.named_lengths`, or with a percentage: that share of
    the way from its least to its greatest value.

    Raises
    ------
    InputError
        With a sentence that says what cannot be read.
    """
    text = text.strip()
    if not text:
        raise InputError(tr("Nothing was entered; {how}.").format(how=_HOW))
    if _IDS.fullmatch(text):
        return _vertices_by_ids(text, len(state.frame.U))
    found = np.zeros(len(state.frame.U), dtype=bool)
    for way in re.split(r"\bor\b|\|+", text):
        holds = np.ones(len(found), dtype=bool)
        for condition in re.split(r"\band\b|&+", way):
            holds &= _comparison_mask(condition, state, unit)
        found |= holds
    return np.flatnonzero(found)


def _vertices_by_ids(text: str, n: int) -> np.ndarray:
    found = np.zeros(n, dtype=bool)
    rest = _ID.sub("", text).strip(" \t\n,;")
    if re.search(r"[–-]", rest):
        raise InputError(tr("“{text}” has an incomplete range; {how}.").format(text=text, how=_HOW))
    for first, last in _ID.findall(text):
        if longest := next((word for word in (first, last) if len(word) > _MOST_DIGITS), ""):
            raise InputError(
                tr("{number}… is too long for the ID of a vertex.").format(number=longest[:_MOST_DIGITS])
            )
        low, high = int(first), int(last or first)
        if max(low, high) >= n:
            sentence = tr("There is no vertex {vertex:,}; IDs run from 0 to {last:,}.")
            raise InputError(sentence.format(vertex=max(low, high), last=n - 1))
        if low > high:
            sentence = tr("The range {first}-{last} runs backwards; enter the lower ID first.")
            raise InputError(sentence.format(first=first, last=last))
        found[low : high + 1] = True
    return np.flatnonzero(found)


def _comparison_mask(condition: str, state: State, unit: Unit) -> np.ndarray:
    """Mask of a comparison such as ``y > 3`` or ``-1 < x < 1``, (n,) bool."""
    signs, sides = _COMPARED.findall(condition), [side.strip() for side in _COMPARED.split(condition)]
    if not signs:
        raise InputError(tr("“{text}” is not a condition; {how}.").format(text=condition.strip(), how=_HOW))
    if not any(side in _AXES for side in sides):
        raise InputError(
            tr("“{text}” does not use x, y or z; {how}.").format(text=condition.strip(), how=_HOW)
        )
    holds = np.ones(len(state.frame.U), dtype=bool)
    for sign, left, right in zip(signs, sides, sides[1:], strict=False):
        holds &= _HOLDS[sign](_side(left, right, state, unit), _side(right, left, state, unit))
    return holds


def _side(text: str, other: str, state: State, unit: Unit) -> np.ndarray | float:
    """Value of one side of a comparison; percentages refer to the axis on the other."""
    if text in _AXES:
        return _coordinates(text, state)
    if not _SHARE.fullmatch(text):
        return parse_length(text, unit, state.document.mesh.named_lengths)
    if other not in _AXES:
        raise InputError(
            tr("{text} is a fraction of the mesh along an axis; compare it with x, y or z.").format(text=text)
        )
    along, part = _coordinates(other, state), parse_number(text, {})
    return float((1.0 - part) * along.min() + part * along.max())  # exact for 0 % and 100 %


def _coordinates(axis: str, state: State) -> np.ndarray:
    column: np.ndarray = state.frame.U[:, _AXES.index(axis)]
    return column


def parse_point(text: str, state: State, unit: Unit) -> np.ndarray:
    """Point (3,) from three expressions separated by semicolons or commas."""
    problem = tr("“{text}” is not a point; enter three coordinates such as 0, 0.5Y, 12mm.")
    names = state.document.mesh.named_lengths
    return np.array([parse_length(part, unit, names) for part in _three_parts(text, problem)])


def parse_vector(text: str, state: State) -> np.ndarray:
    """Vector (3,) from three numbers separated by semicolons or commas."""
    problem = tr("“{text}” is not a direction; enter three numbers such as 0, 1, 0.")
    names = state.document.mesh.named_lengths
    return np.array([parse_number(part, names) for part in _three_parts(text, problem)])


def _three_parts(text: str, problem: str) -> list[str]:
    parts = [part for part in text.split(";" if ";" in text else ",") if part.strip()]
    if len(parts) != 3:
        raise InputError(problem.format(text=text.strip()))
    return parts
