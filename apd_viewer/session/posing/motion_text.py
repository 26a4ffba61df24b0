"""Motions of the handles in words, such as ``twist 120deg; push 30%``.

Steps are separated by semicolons and follow each other; each moves the handle that ``handle N:`` named last,
at first the first one. Amounts are expressions with the units of the window.

======================  =====================================================================================
``twist ANGLE``         about the line from the centre of the base to that of the handle
``bend ANGLE [AXIS]``   about an axis through the centre of the base, ``about x``, y or z; without, the one
                        that is most nearly at right angles to that line
``turn ANGLE AXIS``     about an axis through the centre of the handle
``push AMOUNT``         along that line towards the base: a length, or ``30%`` of the distance of the centres
``move X Y Z``          three lengths, without spaces within them
``scale FACTOR``        about the centre of the handle
======================  =====================================================================================
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from apd_viewer.errors import InputError
from apd_viewer.language import tr

MOTION_WORDS = ("twist", "bend", "turn", "push", "move", "scale")
MOST_STEPS = 100
_HANDLE = re.compile(r"handle\s+(\d{1,3})\s*:\s*(.*)", re.DOTALL | re.IGNORECASE)
_ABOUT = re.compile(r"(.*?)\s+about\s+([xyz])", re.DOTALL | re.IGNORECASE)
_SHOWN = 40  # characters quoted from invalid input


@dataclass(frozen=True)
class MotionTextStep:
    """One motion of one handle, in words.

    Attributes
    ----------
    handle : int
        From 0.
    word : str
        One of WORDS.
    amounts : tuple of str
        Three of "move", else one.
    axis : str
        "X", "Y", "Z", or empty where there is none.
    """

    handle: int
    word: str
    amounts: tuple[str, ...]
    axis: str = ""

    @property
    def text(self) -> str:
        """The step in words, written in one way only."""
        about = f" about {self.axis.lower()}" if self.axis else ""
        return f"handle {self.handle + 1}: {self.word} {' '.join(self.amounts)}{about}"


def parse_motion(text: str) -> tuple[MotionTextStep, ...]:
    """Steps of a motion in words.

    Raises
    ------
    InputError
        If it is none; a sentence says why. Amounts are read later, when the mesh is known.
    """
    steps: list[MotionTextStep] = []
    handle = 0
    for part in filter(None, (part.strip() for part in text.split(";"))):
        named = _HANDLE.fullmatch(part)
        if named:
            handle, part = int(named[1]) - 1, named[2].strip()
            if handle < 0:
                raise InputError(tr("Handles are numbered from 1; enter another number."))
            if not part:
                continue
        steps.append(_step(handle, part))
    if not steps:
        raise InputError(tr("The motion is empty; enter one such as “twist 120deg; push 30%”."))
    if len(steps) > MOST_STEPS:
        raise InputError(tr("The motion has too many steps; enter at most {most}.").format(most=MOST_STEPS))
    return tuple(steps)


def _step(handle: int, text: str) -> MotionTextStep:
    word, _, rest = text.partition(" ")
    word, rest, axis = word.lower(), rest.strip(), ""
    if word not in MOTION_WORDS:
        raise InputError(
            tr("“{word}” is no motion; use {words}.").format(
                word=word[:_SHOWN], words=", ".join(MOTION_WORDS)
            )
        )
    if about := _ABOUT.fullmatch(rest):
        rest, axis = about[1], about[2].upper()
    if axis and word not in ("bend", "turn"):
        raise InputError(tr("“{word}” has no axis; remove “about”.").format(word=word))
    if not axis and word in ("bend", "turn") and "about" in rest.lower().split():
        raise InputError(tr("“{word}” is about an axis of the mesh: x, y or z.").format(word=word))
    if word == "turn" and not axis:
        raise InputError(tr("“turn” needs an axis, as in “turn 30deg about x”."))
    amounts = tuple(rest.split()) if word == "move" else (rest,)
    if word == "move" and len(amounts) != 3:
        raise InputError(tr("“move” needs three lengths without spaces in them, as in “move 0 2cm 0”."))
    return MotionTextStep(handle, word, amounts, axis)
