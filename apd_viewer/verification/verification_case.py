"""Cases with exact answers: their quantities, bars and measurements."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np


class AnswerPair(NamedTuple):
    """Answer of the program beside the exact one."""

    exact: float
    ours: float

    @property
    def error(self) -> float:
        """Relative error; the absolute one where the exact answer is 0."""
        return float(self.ours / self.exact - 1.0 if self.exact else self.ours)


@dataclass(frozen=True)
class CaseQuantity:
    """Quantity with an exact value, and its bar.

    Attributes
    ----------
    title : str
    bar : float
        Largest error that passes, as :attr:`AnswerPair.error`.
    least_order : float or None
        Order of convergence that it must have, too.
    reason : str
        Sentence on why it misses its bar in this release; empty if it does not.
    """

    title: str
    bar: float
    least_order: float | None = None
    reason: str = ""


class Measured(NamedTuple):
    """Answers of one run.

    Attributes
    ----------
    answers : tuple of AnswerPair
        Of each quantity of the case.
    points : (k, 2) float array
        Places on the curve of the figure.
    """

    answers: tuple[AnswerPair, ...]
    points: np.ndarray


@dataclass(frozen=True)
class VerificationCase:
    """Case with an exact or published answer.

    Attributes
    ----------
    letter, title : str
    source : str
        Citation of the answer.
    quantities : tuple of CaseQuantity
    resolutions : tuple of int
        Numbers of edges along a side or around, ascending.
    measure : callable, optional
        ``measure(resolution, is_plain)`` runs the case, by plain ARAP if asked; None without resolutions.
    has_plain : bool
        Plain ARAP can be asked, too.
    axes : pair of str
        Titles of the figure's axes.
    curve : callable
        Exact curve of the figure, (l, 2) float array.
    reason : str
        Sentence on why it cannot be set up yet.
    """

    letter: str
    title: str
    source: str
    quantities: tuple[CaseQuantity, ...] = ()
    resolutions: tuple[int, ...] = ()
    measure: Callable[[int, bool], Measured] | None = None
    has_plain: bool = False
    axes: tuple[str, str] = ("", "")
    curve: Callable[[], np.ndarray] = lambda: np.empty((0, 2))
    reason: str = ""
