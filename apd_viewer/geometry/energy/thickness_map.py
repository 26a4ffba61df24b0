"""Thickness of a wall that differs from place to place: its wall distribution."""

from __future__ import annotations

from typing import Self

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.language import tr


class ThicknessMap(float):
    """Mean thickness of a wall by area, which knows that of every triangle.

    It is a number wherever one is needed: times the area it is the volume of the wall.

    Attributes
    ----------
    triangles : (m,) float array
        Thickness of every triangle, in the unit of the mean.
    """

    triangles: np.ndarray

    def __new__(cls, mean: float, triangles: np.ndarray) -> Self:
        """Thickness from the mean and the thickness of every triangle."""
        made = super().__new__(cls, mean)
        made.triangles = triangles
        return made

    def __getnewargs__(self) -> tuple[float, np.ndarray]:  # type: ignore[override]
        """Arguments that make a copy."""
        return float(self), self.triangles

    @property
    def factors(self) -> np.ndarray:
        """Thickness of every triangle over the mean, (m,)."""
        return self.triangles / float(self)

    def scaled(self, factor: float) -> ThicknessMap:
        """Thickness in another unit."""
        return ThicknessMap(factor * float(self), factor * self.triangles)

    def at_vertices(self, F: np.ndarray, n: int) -> np.ndarray:
        """Mean (n,) of elements ``F`` (m, 3 or 6) at ``n`` vertices; NaN if none."""
        corners, sums = F.ravel(), np.repeat(self.triangles, F.shape[1])
        counts = np.bincount(corners, minlength=n)
        with np.errstate(invalid="ignore"):
            return np.bincount(corners, sums, minlength=n) / counts

    def __eq__(self, other: object) -> bool:
        """True for the same thickness of every triangle."""
        if self is other:
            return True
        return isinstance(other, ThicknessMap) and np.array_equal(self.triangles, other.triangles)

    def __ne__(self, other: object) -> bool:
        """True unless the thickness of every triangle is the same."""
        return not self == other

    def __hash__(self) -> int:
        """Hash of the mean."""
        return float.__hash__(self)


def mapped_thickness(given: object, V: np.ndarray, F: np.ndarray) -> float | None:
    """Thickness from a number, or from one for each vertex or triangle.

    Parameters
    ----------
    given : float, (n,) or (m,) array, or None
        A triangle has the mean of its corners. If n is m, an array is of the vertices.
    V, F : (n, 3) float array, (m, 3) int array

    Raises
    ------
    InputError
        If there are too few or too many numbers, or one is not greater than 0.
    """
    if given is None or (np.ndim(given) == 0 and not isinstance(given, ThicknessMap)):  # type: ignore[arg-type]
        return given  # type: ignore[return-value]
    told = given.triangles if isinstance(given, ThicknessMap) else given
    try:
        values = np.array(told, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError(tr("The wall thickness must be numbers, one for each vertex or triangle.")) from None
    if values.ndim != 1 or len(values) not in (len(V), len(F)):
        sentence = tr(
            "The wall thickness has {count:,} values, but the mesh has {n:,} vertices and {m:,} triangles; "
            "give one for each."
        )
        raise InputError(sentence.format(count=values.size, n=len(V), m=len(F)))
    check_positive(values)
    if isinstance(given, ThicknessMap):
        return given
    return triangle_thickness(triangle_means(values, F) if len(values) == len(V) else values, V, F)


def triangle_means(values: np.ndarray, F: np.ndarray) -> np.ndarray:
    """Means (m,) of the corners of triangles, exact where the three are alike."""
    a, b, c = values[F].T
    return a + ((b - a) + (c - a)) / 3.0


def triangle_thickness(values: np.ndarray, V: np.ndarray, F: np.ndarray) -> ThicknessMap:
    """Thickness map from that of every triangle, (m,)."""
    areas = np.linalg.norm(np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]]), axis=1)
    mean = np.average(values, weights=areas if areas.any() else None)
    mean = float(np.clip(mean, values.min(), values.max()))
    return ThicknessMap(mean, frozen(values))


def check_positive(values: np.ndarray) -> None:
    """Raise InputError unless each thickness (k,) is greater than 0, and finite."""
    bad = np.flatnonzero(~((values > 0.0) & (values < np.inf)))
    if len(bad):
        sentence = tr("The wall thickness must be greater than 0 everywhere; number {k:,} is {value:g}.")
        raise InputError(sentence.format(k=bad[0], value=values[bad[0]]))


def interpolated_values(points: np.ndarray, values: np.ndarray, X: np.ndarray, farthest: float) -> np.ndarray:
    """Values at ``X`` (n, 3), by inverse squares of distance from four points.

    Parameters
    ----------
    points, values : (k, 3), (k,) float arrays
    farthest : float
        Largest distance of a point from the nearest of ``X``.

    Raises
    ------
    InputError
        If a point is farther away, or no number.
    """
    # Imported here so that the first picture does not wait for scipy.
    from scipy.spatial import KDTree

    if not np.isfinite(points).all():
        raise InputError(tr("A measured point is not finite."))
    away = KDTree(X).query(points)[0]
    if away.max() > farthest:
        sentence = tr(
            "Point {k:,} is {away:.3g} from the nearest vertex: it is of another mesh, or in another unit."
        )
        raise InputError(sentence.format(k=int(away.argmax()) + 1, away=away.max()))
    distances, near = KDTree(points).query(X, k=min(4, len(points)))
    distances, near = distances.reshape(len(X), -1), near.reshape(len(X), -1)
    weights = 1.0 / np.maximum(distances, 1e-9 * farthest) ** 2
    return (weights * values[near]).sum(axis=1) / weights.sum(axis=1)
