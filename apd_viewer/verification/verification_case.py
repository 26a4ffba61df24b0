"""Cases with exact solutions: quantities, error bounds and measurements."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from apd_viewer.geometry.mesh.operators import face_areas


class ResultPair(NamedTuple):
    """Result of the program and the exact value."""

    exact: float
    ours: float

    @property
    def error(self) -> float:
        """Relative error; the absolute one if the exact value is 0."""
        return float(self.ours / self.exact - 1.0 if self.exact else self.ours)


@dataclass(frozen=True)
class CaseQuantity:
    """Quantity with an exact value, and its error bound.

    Attributes
    ----------
    title : str
    bar : float
        Largest error that passes, as :attr:`ResultPair.error`.
    least_order : float or None
        Order of convergence that it must have, too.
    reason : str
        Sentence on why it misses its bar in this release; empty if it does not.
    is_chaotic : bool
        True if rounding decides between several folded shapes: a recorded error is no promise then.
    is_lower_bound : bool
        True if the published value is a lower bound, beyond which a result may be.
    """

    title: str
    bar: float
    least_order: float | None = None
    reason: str = ""
    is_chaotic: bool = False
    is_lower_bound: bool = False

    def shortfall(self, error: float) -> float:
        """Size of an error; negative beyond a lower bound."""
        return -error if self.is_lower_bound else abs(error)


class CaseResults(NamedTuple):
    """Results of one run.

    Attributes
    ----------
    answers : tuple of ResultPair
        Of each quantity of the case.
    points : (k, 2) float array
        Places on the curve of the figure.
    """

    answers: tuple[ResultPair, ...]
    points: np.ndarray


@dataclass(frozen=True)
class VerificationCase:
    """Case with an exact or published solution.

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
    measure: Callable[[int, bool], CaseResults] | None = None
    has_plain: bool = False
    axes: tuple[str, str] = ("", "")
    curve: Callable[[], np.ndarray] = lambda: np.empty((0, 2))
    reason: str = ""


def mean_area_change(V: np.ndarray, U: np.ndarray, F: np.ndarray) -> float:
    """Mean absolute change of the areas of triangles, relative to that at rest."""
    rest = face_areas(V, F)
    return float(np.abs(face_areas(U, F) - rest).sum() / rest.sum())
