"""Requested and held turns of handles, and warnings of self-penetration."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from apd_viewer.language import tr
from apd_viewer.notation import localized_number

if TYPE_CHECKING:
    from apd_viewer.geometry.pose.frame import Frame

# Radians: smaller requested turns are not measured, and smaller differences do not count.
LEAST_TURN = math.radians(5.0)
# Radians: largest difference to whole turns that counts as lost turns, since "paper" lets handles drift.
_WHOLE = math.radians(30.0)
# Fraction of the rest volume treated as rounding.
_LITTLE = 1e-6


class HeldTurn(NamedTuple):
    """Turn of a handle relative to the base, as requested and as held.

    Attributes
    ----------
    requested : float
        With whole turns, radians; positive about the line from the base to the handle, or else about the
        largest coordinate of its axis.
    held : float or None
        By how much the surface turns from the base to the handle. None if not measured: where less than 5
        degrees were asked, no surface leads to the handle, or handle or base is a line or a point.
    """

    requested: float
    held: float | None = None

    @property
    def lost_angle(self) -> float:
        """Difference of requested and held angle, radians; 0 if not measured."""
        return 0.0 if self.held is None else abs(self.requested - self.held)

    @property
    def degrees(self) -> tuple[float, float | None]:
        """Requested and achieved angles in degrees, free of rounding from radians."""
        asked, held = (None if angle is None else round(math.degrees(angle), 9) + 0.0 for angle in self)
        return asked or 0.0, held

    @property
    def has_lost_whole_turns(self) -> bool:
        """True if the requested and the held angle differ by whole turns.

        Only a surface passing through itself can lose whole turns.
        """
        turns = round(self.lost_angle / (2.0 * math.pi))
        return turns > 0 and abs(self.lost_angle - 2.0 * math.pi * turns) < _WHOLE


class HandleTurns(NamedTuple):
    """Initial positions, labels and handle paths, for measuring held turns.

    Attributes
    ----------
    V : (n, 3) float array
        Positions before.
    labels : (n,) int array of BASE, FREE, and HANDLE + k
    paths : tuple of tuples of (4, 4) float arrays
        Poses of each handle along its path.
    """

    V: np.ndarray
    labels: np.ndarray
    paths: tuple[tuple[np.ndarray, ...], ...]

    def has_equal_arrays(self, other: HandleTurns | None) -> bool:
        """True if all arrays are equal."""
        if other is None or len(self.paths) != len(other.paths):
            return False
        one, another = ((each.V, each.labels, *itertools.chain(*each.paths)) for each in (self, other))
        return len(one) == len(another) and all(
            a is b or np.array_equal(a, b) for a, b in zip(one, another, strict=True)
        )


def most_lost_turn(turns: Sequence[HeldTurn]) -> HeldTurn:
    """Turn with the largest lost angle; among equals, the largest turn."""
    return max(
        turns,
        key=lambda turn: (turn.lost_angle if turn.lost_angle >= LEAST_TURN else 0.0, abs(turn.requested)),
    )


def pass_through_warnings(
    turns: Sequence[HeldTurn],
    frame: Frame,
    volume_rest: float | None,
    contact: bool,
    may_touch: bool,
    names: Sequence[str] = (),
) -> tuple[str, ...]:
    """Warnings that the surface may have passed through itself.

    The signs are lost turns, unless contact has stopped a handle, and a negative volume of a closed surface.

    Parameters
    ----------
    turns : sequence of HeldTurn
    frame : Frame
    volume_rest : float or None
        Enclosed at rest.
    contact, may_touch : bool
        Whether contact was on, and whether the method supports it.
    names : sequence of str, optional
        Of the handles; without, they are numbered.
    """
    sentences = []
    for k, turn in enumerate(turns):
        if turn.lost_angle < LEAST_TURN or frame.share_reached < 1.0:
            continue
        asked, held = (localized_number(f"{round(angle or 0.0, 1) + 0.0:g}") for angle in turn.degrees)
        lost = tr("The surface holds {held} of the {asked} degrees asked").format(held=held, asked=asked)
        sentence = (
            _pass_through_sentence(lost, contact, may_touch) if turn.has_lost_whole_turns else f"{lost}."
        )
        if len(turns) > 1:
            name = names[k] if names else tr("Handle {n}").format(n=k + 1)
            sentence = tr("{name}: {sentence}").format(name=name, sentence=sentence)
        sentences.append(sentence)
    if frame.volume is not None and volume_rest and frame.volume / volume_rest < -_LITTLE:
        sentences.append(_pass_through_sentence(tr("The surface has turned inside out"), contact, may_touch))
    return tuple(sentences)


def _pass_through_sentence(what: str, contact: bool, may_touch: bool) -> str:
    sentence = tr("{what}: it passed through itself.")
    if not may_touch:
        sentence = tr("{what}: it passed through itself, as this method cannot use contact.")
    elif not contact:
        sentence = tr("{what}: without contact it passed through itself; turn contact on.")
    return sentence.format(what=what)
