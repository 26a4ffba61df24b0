"""Path of held vertices and obstacles from their positions to their targets."""

from collections.abc import Callable

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.pose.constraints import transform
from apd_viewer.geometry.pose.screw_motion import screw_path
from apd_viewer.geometry.pose.transforms import fitted_motion

# Handles move along a screw if their motion is rigid up to this fraction of their displacement.
_RIGID = 1e-6
_NO_OBSTACLES = np.zeros((2, 0, 3))
# Number of iterations between two points of a path.
ITERATIONS_A_STEP = 4


class HeldPath:
    """Paths of handles (screws, or lines if they change shape) and obstacles (lines).

    Half a turn follows an arc in either sense; on a straight path the handle would collapse onto its axis.

    Parameters
    ----------
    X, Y : (k, 3) float arrays
        Positions at the start and at the end.
    handle_of : (k,) int array
        Vertices of one number move as one.
    shifts : (2, o, 3) float array, optional
        Displacement of each obstacle at the start and at the end of its straight path.

    Attributes
    ----------
    length : float
        Length of the longest path, mesh units.
    moves_held, moves_obstacles : bool
        Whether the held vertices and the obstacles move at all.
    """

    def __init__(
        self, X: np.ndarray, Y: np.ndarray, handle_of: np.ndarray, shifts: np.ndarray = _NO_OBSTACLES
    ) -> None:
        self._X, self._Y, self._shifts = X, Y, shifts
        moved = np.unique(handle_of[(X != Y).any(axis=1)])
        # Single vertices have no orientation: all of them move straight at once.
        is_point = np.bincount(handle_of)[moved] == 1
        self._parts = [_handle_path(X, Y, np.flatnonzero(handle_of == k)) for k in moved[~is_point]]
        if is_point.any():
            self._parts.append(_straight_paths(X, Y, np.flatnonzero(np.isin(handle_of, moved[is_point]))))
        lengths = [length for _, _, length in self._parts]
        self.moves_held = len(moved) > 0
        self.moves_obstacles = bool((shifts[0] != shifts[1]).any())
        self.length = max([*lengths, *np.linalg.norm(shifts[1] - shifts[0], axis=1)], default=0.0)

    def shifts_at(self, fraction: float) -> np.ndarray:
        """Displacements (o, 3) of the obstacles at a fraction of the path, 0 to 1."""
        start, end = self._shifts
        return end if fraction >= 1.0 else start + fraction * (end - start)

    def positions_at(self, fraction: float) -> np.ndarray:
        """Positions (k, 3) of the held vertices at a fraction of the path, 0 to 1."""
        if fraction >= 1.0:
            return self._Y
        at = self._X.copy()
        for rows, place, _ in self._parts:
            at[rows] = place(fraction)
        return at


_Part = tuple[np.ndarray, Callable[[float], np.ndarray], float]


def _straight_paths(X: np.ndarray, Y: np.ndarray, rows: np.ndarray) -> _Part:
    """Rows on straight paths, their positions by path fraction, and the longest path."""
    x, y = X[rows], Y[rows]
    return rows, lambda fraction: x + fraction * (y - x), float(np.linalg.norm(y - x, axis=1).max())


def _handle_path(X: np.ndarray, Y: np.ndarray, rows: np.ndarray) -> _Part:
    """Rows of a handle, its positions by path fraction, and the longest vertex path."""
    x, y, line = X[rows], Y[rows], _straight_paths(X, Y, rows)
    try:
        pose = fitted_motion(x, y)
        if np.abs(transform(pose, x) - y).max() > _RIGID * line[2]:
            return line
        path = screw_path(pose, x.mean(axis=0), allows_half_turn=True)
    except InputError:
        return line
    ways = np.linalg.norm(
        np.diff([transform(path.pose_at(s), x) for s in np.linspace(0, 1, 9)], axis=0), axis=2
    )
    return rows, lambda fraction: transform(path.pose_at(fraction), x), float(ways.sum(axis=0).max())
