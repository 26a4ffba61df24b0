"""Text form of handle motions, such as ``twist 120deg; push 30%``.

Steps are separated by semicolons and made in order; each moves the handle last named by ``handle N:``,
initially the first one. The words are listed in :data:`MOTION_KINDS`. An axis follows the amount, as in
``turn 30deg about x``; the default axis of ``bend`` is the one most nearly perpendicular to the line from
the base to the handle. Amounts are expressions with the units of the window; ``move`` has three.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.language import tr
from apd_viewer.session.model.document import Document
from apd_viewer.session.posing.motion import MOTION_KINDS, Motion, MotionReference
from apd_viewer.session.posing.motion_path import MotionStep
from apd_viewer.session.quantities.units import Unit

MOST_STEPS = 100
ANY_LENGTHS = dict.fromkeys("XYZLD", 1.0)
_HANDLE = re.compile(r"handle\s+(\d{1,3})\s*:\s*(.*)", re.DOTALL | re.IGNORECASE)
_PREPOSITIONS = {kind.preposition for kind in MOTION_KINDS.values() if kind.preposition}
_AXES = "X", "Y", "Z"
_SHOWN = 40  # maximum number of characters quoted from invalid input


@dataclass(frozen=True)
class MotionTextStep:
    """One motion of one handle, as text.

    Attributes
    ----------
    handle : int
        Index of the handle, from 0.
    amounts : tuple of str
        One, or one for each axis.
    """

    handle: int
    motion: Motion
    amounts: tuple[str, ...]

    @property
    def text(self) -> str:
        """Canonical text of the step."""
        kind, axis = self.motion.kind, self.motion.axis.lower()
        words = [kind.word, *self.amounts, *([kind.preposition, axis] if axis else [])]
        return f"handle {self.handle + 1}: {' '.join(words)}"

    def parse_amounts(
        self, unit: Unit, names: Mapping[str, float] = ANY_LENGTHS, rest: MotionReference | None = None
    ) -> tuple[float, ...]:
        """Parse the amounts for one mesh or any mesh; raises InputError if invalid."""
        amount = self.motion.kind.amount
        found = tuple(amount.parse(each, unit, names, rest) for each in self.amounts)
        if amount.is_factor and not min(found) > 0.0:
            raise InputError(tr("A factor must be greater than 0; enter another one."))
        return found

    def resolved_on(self, document: Document, unit: Unit, names: Mapping[str, float]) -> MotionStep:
        """Motion step with its amounts resolved on a document, relative to rest."""
        k, kind, axis = self.handle, self.motion.kind, self.motion.axis
        if k >= len(document.handles):
            raise InputError(
                tr("There is no handle {number}; the mesh has {count}.").format(
                    number=k + 1, count=len(document.handles)
                )
            )
        rest = MotionReference(document, k).at_rest
        if kind.may_omit_axis and not axis:  # axis most nearly perpendicular to the line to the base
            axis = "XYZ"[int(np.argmin(np.abs(rest.base - rest.centre).round(12)))]
        return MotionStep(k, Motion(kind, axis), self.parse_amounts(unit, names, rest))


def motion_steps(document: Document, text: str, unit: Unit) -> tuple[MotionStep, ...]:
    """Parse a motion text into steps on a mesh; raises InputError."""
    document, names = document.relative_to_rest, document.mesh.named_lengths
    return tuple(step.resolved_on(document, unit, names) for step in parse_motion(text))


def parse_motion(text: str) -> tuple[MotionTextStep, ...]:
    """Parse a motion text into steps.

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
    word, rest = word.lower(), rest.strip()
    if word not in MOTION_KINDS:
        sentence = tr("“{word}” is not a motion; use {words}.")
        raise InputError(sentence.format(word=word[:_SHOWN], words=", ".join(MOTION_KINDS)))
    kind, axis, preposition = MOTION_KINDS[word], "", ""
    words = rest.rsplit(maxsplit=2)
    if len(words) == 3 and words[1].lower() in _PREPOSITIONS and words[2].upper() in _AXES:
        rest, preposition, axis = words[0], words[1].lower(), words[2].upper()
    if axis and not kind.preposition:
        sentence = tr("“{word}” has no axis; remove “{preposition}”.")
        raise InputError(sentence.format(word=word, preposition=preposition))
    is_other = preposition != kind.preposition if axis else _PREPOSITIONS & set(rest.lower().split())
    if kind.preposition and is_other:
        sentence = tr("“{word}” needs “{preposition}” before an axis of the mesh: x, y or z.")
        raise InputError(sentence.format(word=word, preposition=kind.preposition))
    if kind.needs_axis and not axis:
        sentence = tr("“{word}” needs an axis, as in “{word} {example} {preposition} x”.")
        raise InputError(sentence.format(word=word, example=kind.example, preposition=kind.preposition))
    amounts = tuple(rest.split()) if kind.has_all_axes else (rest,)
    if kind.has_all_axes and len(amounts) != 3:
        sentence = tr("“{word}” needs three lengths without spaces in them, as in “{word} 0 2cm 0”.")
        raise InputError(sentence.format(word=word))
    return MotionTextStep(handle, Motion(kind, axis), amounts)
