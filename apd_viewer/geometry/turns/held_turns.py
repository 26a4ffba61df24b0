"""Turns held by a surface between its base and its handles.

Places of a handle do not tell a turn by 400 degrees from one by 40; the surface between tells them apart. One
that has passed through itself holds whole turns less than it was asked for.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from apd_viewer.geometry.pose.constraints import BASE, HANDLE
from apd_viewer.geometry.pose.fitted_motion import fitted_rotation
from apd_viewer.geometry.pose.waypoint_path import rotation_pose, signed_angle_about
from apd_viewer.geometry.turns.held_turn import LEAST_TURN, HeldTurn
from apd_viewer.geometry.turns.surface_turns import RequestedTurn, SurfaceTurns

# Relative to the coordinates: between closer centres there is no line.
_APART = 1e-9


def held_turns(
    V: np.ndarray, U: np.ndarray, F: np.ndarray, labels: np.ndarray, paths: Sequence[Sequence[np.ndarray]]
) -> tuple[HeldTurn, ...]:
    """Turn of each handle in the shape ``U``.

    Where several arms of free surface lead to a handle, that counts which holds least of what was asked.

    Parameters
    ----------
    V, U : (n, 3) float array
        Positions before the turns, and the shape; of vertices at one place only one is named by ``F``.
    F : (m, 3) int array
    labels : (n,) int array of BASE, FREE, and HANDLE + k
    paths : sequence of sequences of (4, 4) float arrays
        Of each handle: its poses against the base, one after another, and from one to the next by the
        shortest rotation; none where it is not known.
    """
    asked = [RequestedTurn.from_poses(poses) for poses in paths]
    turned = any(way.angle >= LEAST_TURN for way in asked)
    looks = turned and (labels == BASE).any() and np.isfinite(U).all()
    surface = SurfaceTurns(V, U, F, labels) if looks else None
    said = []
    for k, way in enumerate(asked):
        held = surface.turn(k, way) if surface and way.angle >= LEAST_TURN else None
        sign = math.copysign(1.0, signed_angle_about(way.axis, _line(V, labels, k))[0])
        said.append(HeldTurn(sign * way.angle, None if held is None else sign * held))
    return tuple(said)


def relative_paths(X: np.ndarray, positions: np.ndarray, labels: np.ndarray) -> list[list[np.ndarray]]:
    """Rotations of each handle against the base, as poses (4, 4); none if not told.

    Parameters
    ----------
    X : (k, 3) float array
        Places of what is held.
    positions : (s, k, 3) float array
        Where it goes, one after another.
    labels : (k,) int array of BASE, and HANDLE + k
    """
    base = _rotations(X, positions, labels == BASE)
    handles = [_rotations(X, positions, labels == k) for k in range(HANDLE, labels.max(initial=BASE) + 1)]
    return [[rotation_pose(b.T @ h) for b, h in zip(base, rotations, strict=False)] for rotations in handles]


def _rotations(X: np.ndarray, positions: np.ndarray, mask: np.ndarray) -> list[np.ndarray]:
    """Rotation of a part at each place; none if its points tell none."""
    found = [fitted_rotation(X[mask], there[mask]) for there in positions]
    return [R for R in found if R is not None]


def _line(V: np.ndarray, labels: np.ndarray, k: int) -> np.ndarray:
    """Vector (3,) from the centre of the base to handle ``k``; zero without either."""
    base, handle = labels == BASE, labels == HANDLE + k
    if not (base.any() and handle.any()):
        return np.zeros(3)
    line: np.ndarray = V[handle].mean(axis=0) - V[base].mean(axis=0)
    return line if np.abs(line).max() > _APART * np.abs(V).max() else np.zeros(3)
