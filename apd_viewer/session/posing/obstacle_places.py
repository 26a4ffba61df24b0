"""Places of obstacles that touch a shape and do not stand in it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from apd_viewer.geometry.contact.clearance import clearance
from apd_viewer.geometry.contact.mesh_contact import thickness_of
from apd_viewer.geometry.mesh.arrays import diagonal, direction, frozen
from apd_viewer.session.model import memo
from apd_viewer.session.model.named_obstacle import NamedObstacle, ObstacleKind
from apd_viewer.session.model.names import next_name

if TYPE_CHECKING:
    from collections.abc import Collection

    from apd_viewer.session.model.state import State

# Of new ones, in longest sides of the mesh: about a thumb on a bottle.
_RADIUS = {ObstacleKind.PLATE: 0.0, ObstacleKind.SPHERE: 0.08, ObstacleKind.CYLINDER: 0.05}
_LENGTH = 0.3
# Out of a narrow fold it takes steps; each is at least so long, in distances that walls keep.
_LEAST_STEP, _MOST_STEPS = 0.05, 500
# Relative to the distance that walls keep: what was put there in floating point is still clear.
_ROUNDING = 1e-6


def apart_of(state: State, thickness: float | None) -> float:
    """Distance that walls and obstacles keep, mesh units."""
    mesh = state.document.mesh
    return thickness_of(diagonal(mesh.V[_corners(mesh.F)]), thickness)


def room(obstacle: NamedObstacle, state: State) -> float:
    """Distance of an obstacle, where it was put, from the shape; negative within it.

    Raises InputError if it has no extent or direction.
    """
    U, F = state.frame.U, state.document.mesh.F
    if obstacle.kind is ObstacleKind.PLATE:
        return float(((U[_corners(F)] - obstacle.place) @ direction(obstacle.axis)).min())
    return clearance(obstacle.solid(1.0), np.zeros(3), U, F)


@memo.once
def _corners(F: np.ndarray) -> np.ndarray:
    """Vertices of the triangles, ascending."""
    return frozen(np.unique(F))


def stands_clear(obstacle: NamedObstacle, state: State, apart: float) -> bool:
    """True if an obstacle keeps at least ``apart`` from the shape."""
    return room(obstacle, state) >= (1.0 - _ROUNDING) * apart


def pushed_back(obstacle: NamedObstacle, state: State, apart: float) -> NamedObstacle:
    """The obstacle, moved back against its axis until it is ``apart`` from the shape.

    No obstacle comes nearer faster than it moves, so that no place in between is passed over.
    """
    back, place = -direction(obstacle.axis), np.array(obstacle.place, dtype=float)
    for _ in range(_MOST_STEPS):
        obstacle = replace(obstacle, place=frozen(place.copy()))
        missing = apart - room(obstacle, state)
        if missing <= _ROUNDING * apart:
            break
        place += max(missing, _LEAST_STEP * apart) * back
    return obstacle


def proposed(
    kind: ObstacleKind, point: np.ndarray, outwards: np.ndarray, state: State, apart: float
) -> NamedObstacle:
    """New obstacle at a point of the surface, ready to be pushed in; without a name.

    Parameters
    ----------
    kind : ObstacleKind
    point, outwards : (3,) float arrays
        On the surface, and its unit normal there.
    state : State
    apart : float
        Distance to the point, mesh units.
    """
    longest = float(max(state.inspection.size))
    radius, length = _RADIUS[kind] * longest, _LENGTH * longest if kind is ObstacleKind.CYLINDER else 0.0
    place = point + (apart + radius + 0.5 * length) * outwards
    axis = -direction(outwards) + 0.0  # no negative zeros
    return NamedObstacle("", kind, frozen(place), frozen(axis), radius, length)


def back_in_place(state: State) -> tuple[NamedObstacle, ...]:
    """Obstacles of a state where they were put, moved back out of its shape."""
    apart, found = apart_of(state, state.document.thickness), []
    for obstacle in state.document.obstacles:
        obstacle = obstacle.settled(np.zeros(3))
        clear = stands_clear(obstacle, state, apart)
        found.append(obstacle if clear else pushed_back(obstacle, state, apart))
    return tuple(found)


def out_of_the_shape(state: State, thickness: float | None) -> tuple[NamedObstacle, ...]:
    """Obstacles of a state; those put where its shape is now are moved back out of it.

    ``thickness`` is the distance that they keep, as of a document.
    """
    apart, found = apart_of(state, thickness), []
    for obstacle in state.document.obstacles:
        clear = stands_clear(obstacle, state, apart)
        found.append(obstacle if clear else pushed_back(obstacle.settled(np.zeros(3)), state, apart))
    return tuple(found)


def touching_plate(name: str, axis: np.ndarray, state: State, apart: float) -> NamedObstacle:
    """Plate that touches the shape from behind, with its normal along ``axis`` (3,)."""
    axis = direction(axis)
    X = state.frame.U[_corners(state.document.mesh.F)]
    middle = 0.5 * (X.min(axis=0) + X.max(axis=0))
    place = middle + (float((X @ axis).min()) - apart - float(middle @ axis)) * axis
    return NamedObstacle(name, ObstacleKind.PLATE, frozen(place), frozen(axis + 0.0))


def name_of(kind: ObstacleKind, taken: Collection[str]) -> str:
    """The first free name, such as Plate 1."""
    return next_name(kind.title, taken)
