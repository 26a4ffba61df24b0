"""Placement of obstacles touching a shape without intersecting it."""

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from apd_viewer.geometry.contact.mesh_contact import contact_thickness
from apd_viewer.geometry.contact.obstacle_pairs import clearance
from apd_viewer.geometry.mesh.arrays import checked_direction, diagonal, frozen, used_vertices
from apd_viewer.session.model import memo
from apd_viewer.session.model.document_parts import next_name
from apd_viewer.session.model.named_obstacle import NamedObstacle, ObstacleKind
from apd_viewer.session.model.state import State

# Sizes of new obstacles relative to the longest side of the mesh: about a thumb on a bottle.
_RADIUS = {ObstacleKind.PLATE: 0.0, ObstacleKind.SPHERE: 0.08, ObstacleKind.CYLINDER: 0.05}
_LENGTH = 0.3
# Steps out of a narrow fold: minimum length relative to the contact distance, and maximum number of steps.
_LEAST_STEP, _MOST_STEPS = 0.05, 500
# Rounding tolerance of a clear position, relative to the contact distance.
_ROUNDING = 1e-6


def contact_distance(state: State, thickness: float | None) -> float:
    """Contact distance of walls and obstacles, mesh units."""
    mesh = state.document.mesh
    return contact_thickness(diagonal(mesh.V[_used_vertices(mesh.F)]), thickness)


def obstacle_clearance(obstacle: NamedObstacle, state: State) -> float:
    """Distance of an obstacle's initial position from the shape; negative inside.

    Raises InputError if it has no extent or direction.
    """
    U, F = state.frame.U, state.document.mesh.F
    if obstacle.kind is ObstacleKind.PLATE:
        return float(((U[_used_vertices(F)] - obstacle.place) @ checked_direction(obstacle.axis)).min())
    return clearance(obstacle.to_obstacle(1.0), np.zeros(3), U, F)


@memo.memoised
def _used_vertices(F: np.ndarray) -> np.ndarray:
    """Sorted ids of the vertices used by triangles."""
    return frozen(used_vertices(F))


def is_obstacle_clear(obstacle: NamedObstacle, state: State, distance: float) -> bool:
    """True if an obstacle keeps at least ``distance`` from the shape."""
    return obstacle_clearance(obstacle, state) >= (1.0 - _ROUNDING) * distance


def obstacle_moved_clear(obstacle: NamedObstacle, state: State, distance: float) -> NamedObstacle:
    """Obstacle moved back along its axis to ``distance`` from the shape.

    Each step equals the missing clearance, so that no free position is skipped.
    """
    back, place = -checked_direction(obstacle.axis), np.array(obstacle.place, dtype=float)
    for _ in range(_MOST_STEPS):
        obstacle = replace(obstacle, place=frozen(place.copy()))
        missing = distance - obstacle_clearance(obstacle, state)
        if missing <= _ROUNDING * distance:
            break
        place += max(missing, _LEAST_STEP * distance) * back
    return obstacle


def proposed_obstacle(
    kind: ObstacleKind, point: np.ndarray, normal: np.ndarray, state: State, distance: float
) -> NamedObstacle:
    """New unnamed obstacle near a surface point, with its axis into the surface.

    Parameters
    ----------
    point, normal : (3,) float arrays
        Point on the surface, and its unit normal.
    distance : float
        Distance to the point, mesh units.
    """
    longest = float(max(state.inspection.size))
    radius, length = _RADIUS[kind] * longest, _LENGTH * longest if kind is ObstacleKind.CYLINDER else 0.0
    place = point + (distance + radius + 0.5 * length) * normal
    axis = -checked_direction(normal) + 0.0  # avoids negative zeros
    return NamedObstacle("", kind, frozen(place), frozen(axis), radius, length)


def reset_obstacles(state: State) -> tuple[NamedObstacle, ...]:
    """Obstacles at their initial positions, moved back out of the shape if needed."""
    apart, found = contact_distance(state, state.document.settings.thickness), []
    for obstacle in state.document.obstacles:
        obstacle = obstacle.with_shift_applied(np.zeros(3))
        clear = is_obstacle_clear(obstacle, state, apart)
        found.append(obstacle if clear else obstacle_moved_clear(obstacle, state, apart))
    return tuple(found)


def obstacles_outside_shape(state: State, thickness: float | None) -> tuple[NamedObstacle, ...]:
    """Obstacles of a state; those inside the current shape are moved back out of it.

    ``thickness`` is the contact distance, as in the settings.
    """
    apart, found = contact_distance(state, thickness), []
    for obstacle in state.document.obstacles:
        clear = is_obstacle_clear(obstacle, state, apart)
        found.append(
            obstacle
            if clear
            else obstacle_moved_clear(obstacle.with_shift_applied(np.zeros(3)), state, apart)
        )
    return tuple(found)


def touching_plate(name: str, axis: np.ndarray, state: State, distance: float) -> NamedObstacle:
    """Plate touching the shape from behind, with its normal along ``axis`` (3,)."""
    axis = checked_direction(axis)
    X = state.frame.U[_used_vertices(state.document.mesh.F)]
    middle = 0.5 * (X.min(axis=0) + X.max(axis=0))
    place = middle + (float((X @ axis).min()) - distance - float(middle @ axis)) * axis
    return NamedObstacle(name, ObstacleKind.PLATE, frozen(place), frozen(axis + 0.0))


def touching_finger(
    name: str, axis: np.ndarray, state: State, distance: float, radius: float
) -> NamedObstacle:
    """Sphere touching the shape from behind, along ``axis`` (3,) to its middle."""
    axis = checked_direction(axis)
    X = state.frame.U[_used_vertices(state.document.mesh.F)]
    middle = 0.5 * (X.min(axis=0) + X.max(axis=0))
    along = (X - middle) @ axis
    aside = np.linalg.norm(X - middle - along[:, None] * axis, axis=1)
    reach = radius + distance
    # Where a coarse mesh has no vertex beside the line, the foremost one is taken for it.
    near = aside < reach if (aside < reach).any() else aside <= aside.min()
    behind = float((along[near] - np.sqrt(np.maximum(reach**2 - aside[near] ** 2, 0.0))).min())
    return NamedObstacle(name, ObstacleKind.SPHERE, frozen(middle + behind * axis), radius=radius)


def obstacle_name(kind: ObstacleKind, taken: Collection[str]) -> str:
    """First unused name, such as Plate 1."""
    return next_name(kind.title, taken)
