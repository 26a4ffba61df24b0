"""Measurements of a shape: distances, angles, geodesics, sections and fill levels."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.measuring.measurement_kind import MeasurementKind
from apd_viewer.geometry.measuring.sections import section
from apd_viewer.geometry.measuring.surface_point import CarriedPath, SurfacePoint, point_positions
from apd_viewer.geometry.measuring.vessel import Vessel

_ARC = 0.4  # radius of an angle's arc, relative to its shorter side
_ARC_STEPS = 24


class Plane(NamedTuple):
    """The points x with ``normal @ x == offset``.

    Attributes
    ----------
    normal : tuple of 3 floats
        A unit vector.
    offset : float
        Mesh units.
    """

    normal: tuple[float, float, float]
    offset: float


class Contents(NamedTuple):
    """Liquid in a shape.

    Attributes
    ----------
    up : tuple of 3 floats
        A unit vector against gravity.
    volume : float
        Cubic mesh units.
    """

    up: tuple[float, float, float]
    volume: float


@dataclass(frozen=True)
class Measurement:
    """Definition of a measurement, applicable to any shape of a mesh.

    Attributes
    ----------
    name : str
    kind : MeasurementKind
    points : tuple of SurfacePoint
        They move with the surface. An angle is measured at the second one.
    plane : Plane or None
        Of a section: it stays in its place.
    contents : Contents or None
        Of a fill level: its volume stays, as far as the shape holds it.
    """

    name: str
    kind: MeasurementKind
    points: tuple[SurfacePoint, ...] = ()
    plane: Plane | None = None
    contents: Contents | None = None


class MeasurementResult(NamedTuple):
    """Measured values, with the lines and the label to draw for them.

    Attributes
    ----------
    values : tuple of float or None
        One for each of :attr:`MeasurementKind.powers`; NaN where there is none, None where it is not
        known yet.
    segments : (s, 2, 3) float array
        Lines to draw.
    normals : (s, 3) float array or None
        Of the surface along them; None for lines through space.
    label_position : (3,) float array or None
        Place of a label.
    label_away_from : (3,) float array or None
        Point of the drawing from which the label stands away; None where it stands beside a line.
    """

    values: tuple[float | None, ...]
    segments: np.ndarray
    normals: np.ndarray | None = None
    label_position: np.ndarray | None = None
    label_away_from: np.ndarray | None = None


def measure(
    measurement: Measurement,
    U: np.ndarray,
    F: np.ndarray,
    path: CarriedPath | None = None,
    is_current: bool = True,
    closed: Sequence[int] = (),
) -> MeasurementResult:
    """Measure the shape ``U`` (n, 3) of the triangles ``F`` (m, 3).

    Parameters
    ----------
    path : CarriedPath or None
        The geodesic, if it is known, of this shape or of an earlier one.
    is_current : bool
        Whether it is of this shape. Another one is carried along, and its length is not known.
    closed : sequence of int
        A vertex at the border of each opening that counts as closed.
    """
    if measurement.kind is MeasurementKind.SECTION and measurement.plane is not None:
        return _section(measurement.plane, U, F)
    if measurement.contents is not None:
        return _fill_level(measurement.contents, U, F, closed)
    points = point_positions(measurement.points, U, F)
    if measurement.kind is MeasurementKind.ANGLE:
        return _angle(points)
    if measurement.kind is MeasurementKind.GEODESIC:
        return _geodesic(U, path, is_current)
    line = points[None]
    return MeasurementResult((_length(line),), line, label_position=points.mean(axis=0))


def _length(segments: np.ndarray) -> float:
    return float(np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1).sum())


def _angle(points: np.ndarray) -> MeasurementResult:
    """Angle at the second of three points (3, 3), with its sides and arc."""
    sides = points[[0, 2]] - points[1]
    lengths = np.linalg.norm(sides, axis=1)
    legs = points[[[0, 1], [1, 2]]]
    if not lengths.all():
        return MeasurementResult((float("nan"),), legs, label_position=points[1])
    a, b = sides / lengths[:, None]
    aside = b - (a @ b) * a
    angle = float(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b))
    if not (away := float(np.linalg.norm(aside))):
        return MeasurementResult((angle,), legs, label_position=points[1])
    turns = np.linspace(0.0, angle, _ARC_STEPS + 1)[:, None]
    arc = points[1] + _ARC * lengths.min() * (np.cos(turns) * a + np.sin(turns) * aside / away)
    segments = np.vstack([legs, _polyline_segments(arc)])
    return MeasurementResult(
        (angle,), segments, label_position=points[1], label_away_from=arc[_ARC_STEPS // 2]
    )


def _geodesic(U: np.ndarray, path: CarriedPath | None, is_current: bool) -> MeasurementResult:
    if path is None or not len(path.corners):
        return MeasurementResult(
            (None if path is None or not is_current else float("nan"),), np.empty((0, 2, 3))
        )
    points = path.points_at(U)
    segments = _polyline_segments(points)
    A, B, C = U[path.corners[1:]].transpose(1, 0, 2)
    value = _length(segments) if is_current else None
    return MeasurementResult((value,), segments, np.cross(B - A, C - A), points[len(points) // 2])


def _fill_level(contents: Contents, U: np.ndarray, F: np.ndarray, closed: Sequence[int]) -> MeasurementResult:
    """Level of a liquid above the lowest point, its freeboard, and what is spilled."""
    up = np.array(contents.up)
    try:
        vessel = Vessel.from_welded_surface(U, F, up, closed)
        filling = vessel.filling(contents.volume)
    except InputError:
        return MeasurementResult((float("nan"),) * 3, np.empty((0, 2, 3)))
    surface = _section(Plane(contents.up, vessel.bottom + filling.level), vessel.V, vessel.F)
    return surface._replace(values=tuple(filling))


def _section(plane: Plane, U: np.ndarray, F: np.ndarray) -> MeasurementResult:
    normal = np.array(plane.normal)
    cut = section(U, F, plane.offset * normal, normal)
    if not len(cut.segments):
        return MeasurementResult((float("nan"),) * 3, cut.segments)
    A, B, C = U[F[cut.faces]].transpose(1, 0, 2)
    # Label far out in the plane: beside the shape, not in front of it.
    aside = 1.0 - normal.sum() * normal
    at = cut.segments[int(np.argmax(cut.segments[:, 0] @ aside))][0]
    within = cut.segments.mean(axis=(0, 1))
    values = cut.length, cut.area, cut.volume_below
    return MeasurementResult(values, cut.segments, np.cross(B - A, C - A), at, within)


def _polyline_segments(points: np.ndarray) -> np.ndarray:
    """Segments (k - 1, 2, 3) of a polyline (k, 3)."""
    return np.stack([points[:-1], points[1:]], axis=1)
