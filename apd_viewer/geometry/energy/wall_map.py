"""Wall that differs from place to place: its wall distribution."""

from __future__ import annotations

import hashlib

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.mesh.arrays import checked_floats, frozen, mesh_arrays
from apd_viewer.language import tr

_MOST = 1e100  # products of larger numbers overflow


class WallMap(float):
    """Mean thickness of a wall by area, which knows that of every triangle.

    It is a number wherever one is needed: times the area it is the volume of the wall. The maps of modulus
    and yield radius are of the same kind.

    Attributes
    ----------
    triangles : (m,) float array
        Thickness of every triangle, in the unit of the mean.
    young : WallMap or None
        Young's modulus, Pa, and its mean by volume of the wall: times the mean thickness it is the mean
        stiffness by area. None if it is the same everywhere.
    yield_radius : WallMap or None
        Yield radius in the unit of the thickness; None if the outer fibres of all triangles yield at the same
        strain.
    """

    triangles: np.ndarray
    young: WallMap | None
    yield_radius: WallMap | None

    def __new__(
        cls,
        mean: float,
        triangles: np.ndarray,
        young: WallMap | None = None,
        yield_radius: WallMap | None = None,
    ) -> WallMap:
        """Thickness from the mean and the thickness of every triangle."""
        made = super().__new__(cls, mean)
        made.triangles, made.young, made.yield_radius = triangles, young, yield_radius
        return made

    def __getnewargs__(self) -> tuple[float, np.ndarray, WallMap | None, WallMap | None]:  # type: ignore[override]
        """Arguments that make a copy."""
        return float(self), self.triangles, self.young, self.yield_radius

    @property
    def factors(self) -> np.ndarray:
        """Thickness of every triangle over the mean, (m,)."""
        return self.triangles / float(self)

    @property
    def digest(self) -> str:
        """Name of the map by its content, hexadecimal."""
        found = hashlib.sha256(np.float64(self).tobytes() + self.triangles.tobytes())
        for each in (self.young, self.yield_radius):
            found.update(each.digest.encode() if each is not None else b"none")
        return found.hexdigest()

    def scaled(self, factor: float) -> WallMap:
        """Thickness in another unit."""
        radius = None if self.yield_radius is None else self.yield_radius.scaled(factor)
        return WallMap(factor * float(self), factor * self.triangles, self.young, radius)

    def on(self, V: np.ndarray, F: np.ndarray, triangles: np.ndarray | None = None) -> WallMap:
        """Map on another rest shape, also with other thickness of the triangles."""
        beside = (None if each is None else each.triangles for each in (self.young, self.yield_radius))
        return triangle_wall(self.triangles if triangles is None else triangles, V, F, *beside)

    def at_vertices(self, F: np.ndarray, n: int) -> np.ndarray:
        """Mean (n,) of elements ``F`` (m, 3 or 6) at ``n`` vertices; NaN if none."""
        corners, sums = F.ravel(), np.repeat(self.triangles, F.shape[1])
        counts = np.bincount(corners, minlength=n)
        with np.errstate(invalid="ignore"):
            return np.bincount(corners, sums, minlength=n) / counts

    def __eq__(self, other: object) -> bool:
        """True for the same wall at every triangle."""
        if self is other:
            return True
        if not isinstance(other, WallMap) or not np.array_equal(self.triangles, other.triangles):
            return False
        return self.young == other.young and self.yield_radius == other.yield_radius

    def __ne__(self, other: object) -> bool:
        """True unless the wall is the same at every triangle."""
        return not self == other

    def __hash__(self) -> int:
        """Hash of the mean."""
        return float.__hash__(self)


def wall_map(
    V: np.ndarray,
    F: np.ndarray,
    thickness: float | np.ndarray,
    *,
    young: float | np.ndarray | None = None,
    yield_radius: float | np.ndarray | None = None,
) -> WallMap:
    """Wall of other thickness, modulus and yield radius from place to place.

    Each is a number, or one for each vertex or triangle. A triangle has the mean of its corners. If n is m,
    an array is of the vertices.

    Parameters
    ----------
    V, F : (n, 3) float array, (m, 3) int array
        Rest positions, and triangles.
    thickness : float, (n,) or (m,) array
        Mesh units.
    young : float, (n,) or (m,) array, optional
        Young's modulus; in a deformation only its ratios count.
    yield_radius : float, (n,) or (m,) array, optional
        Mesh units; in a deformation only its ratios count, beside the mean given there.

    Returns
    -------
    WallMap
        A number, the mean thickness by area, to give as ``wall_thickness``; it has ``young`` and
        ``yield_radius`` with their means.

    Raises
    ------
    InputError
        If there are too few or too many numbers, or one is not greater than 0.

    Examples
    --------
    >>> import apd_viewer
    >>> bottle = apd_viewer.open_mesh("bottle.obj")
    >>> height = bottle.V[:, 1] / bottle.V[:, 1].max()
    >>> wall = apd_viewer.wall_map(bottle.V, bottle.F, 0.02 + 0.02 * height, young=1.0 + height)
    >>> f"{wall:.4f}", f"{wall.young:.3f}"
    ('0.0286', '1.490')
    """
    V, F = mesh_arrays(V, F)
    modulus, radius = (
        None if values is None else _of_triangles(values, V, F, name)
        for values, name in ((young, tr("Young's modulus")), (yield_radius, tr("The yield radius")))
    )
    return triangle_wall(_of_triangles(thickness, V, F), V, F, modulus, radius)


def wall_map_of(given: object, V: np.ndarray, F: np.ndarray) -> float | None:
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
    if given is None or (np.ndim(given) == 0 and not isinstance(given, WallMap)):  # type: ignore[arg-type]
        return given  # type: ignore[return-value]
    if isinstance(given, WallMap):
        _of_triangles(given.triangles, V, F)
        return given
    return triangle_wall(_of_triangles(given, V, F), V, F)


def _of_triangles(given: object, V: np.ndarray, F: np.ndarray, name: str = "") -> np.ndarray:
    """Values (m,) from a number, or from one for each vertex or triangle."""
    name = name or tr("The wall thickness")
    values = checked_floats(given, name)
    if values.ndim == 0:
        values = np.full(len(F), values)
    if values.ndim != 1 or len(values) not in (len(V), len(F)):
        sentence = tr(
            "{what} has {count:,} values, but the mesh has {n:,} vertices and {m:,} triangles; "
            "give one for each."
        )
        raise InputError(sentence.format(what=name, count=values.size, n=len(V), m=len(F)))
    check_positive(values, name)
    return triangle_means(values, F) if len(values) == len(V) else values


def triangle_means(values: np.ndarray, F: np.ndarray) -> np.ndarray:
    """Means (m,) of the corners of triangles, exact where the three are alike."""
    a, b, c = values[F].T
    return a + ((b - a) + (c - a)) / 3.0


def triangle_wall(
    values: np.ndarray,
    V: np.ndarray,
    F: np.ndarray,
    young: np.ndarray | None = None,
    yield_radius: np.ndarray | None = None,
) -> WallMap:
    """Wall map from the thickness of every triangle, modulus and yield radius, (m,)."""
    areas = np.linalg.norm(np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]]), axis=1)
    modulus = None if young is None else _averaged(young, areas * values)
    radius = None if yield_radius is None else _averaged(yield_radius, areas)
    return _averaged(values, areas, modulus, radius)


def _averaged(values: np.ndarray, weights: np.ndarray, *beside: WallMap | None) -> WallMap:
    mean = np.average(values, weights=weights if weights.any() else None)
    # Of numbers that are all alike it is that number.
    mean = float(np.clip(mean, values.min(), values.max()))
    return WallMap(mean, frozen(values), *beside)


def check_positive(values: np.ndarray, name: str = "") -> None:
    """Raise InputError unless each of (k,) numbers is greater than 0, and finite.

    The ``name`` is that of the quantity, by default a thickness.
    """
    bad = np.flatnonzero(~((values > 0.0) & (values < _MOST)))
    if len(bad):
        sentence = tr("{what} must be greater than 0 everywhere; number {k:,} is {value:g}.")
        name = name or tr("The wall thickness")
        raise InputError(sentence.format(what=name, k=bad[0], value=values[bad[0]]))


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


def vertices_at(X: np.ndarray, V: np.ndarray, farthest: float) -> np.ndarray | None:
    """Nearest of ``V`` (k, 3) to each of ``X`` (n, 3); None if one is farther away."""
    # Imported here so that the first picture does not wait for scipy.
    from scipy.spatial import KDTree

    away, at = KDTree(V).query(X)
    return None if away.max() > farthest else np.asarray(at)
