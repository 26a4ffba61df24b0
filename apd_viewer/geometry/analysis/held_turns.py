"""Turns that a surface holds between its base and its handles.

Places of a handle do not tell a turn by 400 degrees from one by 40; the surface between tells them apart. One
that has passed through itself holds whole turns less than it was asked for.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from apd_viewer.geometry.analysis.surface_turns import SurfaceTurns, Way
from apd_viewer.geometry.pose.constraints import BASE, HANDLE
from apd_viewer.geometry.pose.fitted_motion import fitted_rotation
from apd_viewer.geometry.pose.winding import pose_of, signed_about
from apd_viewer.language import tr

# Radians: a handle that is asked for less is not looked at, nor is a smaller difference one.
LEAST_TURN = math.radians(5.0)
# Relative to the coordinates: between closer centres there is no line.
_APART = 1e-9


class HeldTurn(NamedTuple):
    """Turn of a handle against the base.

    Attributes
    ----------
    asked : float
        With whole turns, radians; positive about the line from the base to the handle, or else about the
        largest coordinate of its axis.
    held : float or None
        By how much the surface turns from the base to the handle. None where nobody looked: where less than 5
        degrees were asked, no surface leads to the handle, or handle or base is a line or a point.
    """

    asked: float
    held: float | None = None

    @property
    def lost(self) -> float:
        """What is held less or more than was asked, radians; 0 where nobody looked."""
        return 0.0 if self.held is None else abs(self.asked - self.held)

    @property
    def degrees(self) -> tuple[float, float | None]:
        """Asked and held in degrees, without the rounding of radians."""
        asked, held = (None if angle is None else round(math.degrees(angle), 9) + 0.0 for angle in self)
        return asked or 0.0, held

    @property
    def passed_through(self) -> bool:
        """True if whole turns are missing, which only a surface that passes through itself can lose."""
        return self.lost > math.pi


def held_turns(
    V: np.ndarray, U: np.ndarray, F: np.ndarray, labels: np.ndarray, ways: Sequence[Sequence[np.ndarray]]
) -> tuple[HeldTurn, ...]:
    """Turn of each handle in the shape ``U``.

    Where several arms of free surface lead to a handle, that counts which holds least of what was asked.

    Parameters
    ----------
    V, U : (n, 3) float array
        Positions before the turns, and the shape; of vertices at one place only one is named by ``F``.
    F : (m, 3) int array
    labels : (n,) int array of BASE, FREE, and HANDLE + k
    ways : sequence of sequences of (4, 4) float arrays
        Of each handle: its poses against the base, one after another, and from one to the next by the
        shortest rotation; none where it is not known.
    """
    asked = [Way.along(poses) for poses in ways]
    turned = any(way.angle >= LEAST_TURN for way in asked)
    looks = turned and (labels == BASE).any() and np.isfinite(U).all()
    surface = SurfaceTurns(V, U, F, labels) if looks else None
    said = []
    for k, way in enumerate(asked):
        held = surface.turn(k, way) if surface and way.angle >= LEAST_TURN else None
        sign = math.copysign(1.0, signed_about(way.axis, _line(V, labels, k))[0])
        said.append(HeldTurn(sign * way.angle, None if held is None else sign * held))
    return tuple(said)


def ways_of(X: np.ndarray, places: np.ndarray, labels: np.ndarray) -> list[list[np.ndarray]]:
    """Poses (4, 4) of each handle against the base, without their places; none where not told.

    Parameters
    ----------
    X : (k, 3) float array
        Places of what is held.
    places : (s, k, 3) float array
        Where it goes, one after another.
    labels : (k,) int array of BASE, and HANDLE + k
    """
    base = _rotations(X, places, labels == BASE)
    handles = [_rotations(X, places, labels == k) for k in range(HANDLE, labels.max(initial=BASE) + 1)]
    return [[pose_of(b.T @ h) for b, h in zip(base, rotations, strict=False)] for rotations in handles]


def _rotations(X: np.ndarray, places: np.ndarray, part: np.ndarray) -> list[np.ndarray]:
    """Rotation of a part at each place; none where its points do not tell any."""
    found = [fitted_rotation(X[part], there[part]) for there in places]
    return [R for R in found if R is not None]


def turn_warnings(
    turns: Sequence[HeldTurn], contact: bool, may_touch: bool = True, names: Sequence[str] = ()
) -> tuple[str, ...]:
    """A sentence for each handle whose turn the surface does not hold.

    Parameters
    ----------
    turns : sequence of HeldTurn
    contact, may_touch : bool
        Whether contact was on, and whether the method knows it.
    names : sequence of str, optional
        Of the handles; without, they are numbered.
    """
    said = []
    for k, turn in enumerate(turns):
        if turn.lost < LEAST_TURN:
            continue
        sentence = _sentence(turn, contact, may_touch)
        if len(turns) > 1:
            name = names[k] if names else tr("Handle {n}").format(n=k + 1)
            sentence = tr("{name}: {sentence}").format(name=name, sentence=sentence)
        said.append(sentence)
    return tuple(said)


def _sentence(turn: HeldTurn, contact: bool, may_touch: bool) -> str:
    said = tr("The surface holds {held} of the {asked} degrees asked.")
    if turn.passed_through and not may_touch:
        said = tr(
            "The surface holds {held} of the {asked} degrees asked: it passed through itself, "
            "as this method knows no contact."
        )
    elif turn.passed_through and not contact:
        said = tr(
            "The surface holds {held} of the {asked} degrees asked: without contact it passed through "
            "itself; turn contact on."
        )
    elif turn.passed_through:
        said = tr("The surface holds {held} of the {asked} degrees asked: it passed through itself.")
    asked, held = (f"{round(angle or 0.0, 1) + 0.0:g}" for angle in turn.degrees)
    return said.format(held=held, asked=asked)


def _line(V: np.ndarray, labels: np.ndarray, k: int) -> np.ndarray:
    """From the centre of the base to that of handle ``k``, (3,); zero without either."""
    base, handle = labels == BASE, labels == HANDLE + k
    if not (base.any() and handle.any()):
        return np.zeros(3)
    line: np.ndarray = V[handle].mean(axis=0) - V[base].mean(axis=0)
    return line if np.abs(line).max() > _APART * np.abs(V).max() else np.zeros(3)
