"""Measurements to and from the JSON of a session."""

from __future__ import annotations

from typing import Any

import numpy as np

from apd_viewer.files.storage.json_fields import JsonFields
from apd_viewer.geometry.measuring.measurement import Measurement, Plane
from apd_viewer.geometry.measuring.measurement_kind import MeasurementKind
from apd_viewer.geometry.measuring.surface_point import SurfacePoint
from apd_viewer.language import tr

MOST_MEASUREMENTS = 100
_ROUNDING = 1e-9


def measurements_to_json(measurements: tuple[Measurement, ...]) -> dict[str, Any]:
    """The measurements as a field of JSON; none where there are none."""
    return {"measurements": [_measurement_to_json(each) for each in measurements]} if measurements else {}


def _measurement_to_json(measurement: Measurement) -> dict[str, Any]:
    said: dict[str, Any] = {"name": measurement.name, "kind": measurement.kind.value}
    if measurement.plane is not None:
        return {
            **said,
            "plane": {"normal": list(measurement.plane.normal), "offset": measurement.plane.offset},
        }
    return {**said, "points": [{"face": p.face, "weights": list(p.weights)} for p in measurement.points]}


def measurements_from_json(fields: JsonFields, faces: int) -> tuple[Measurement, ...]:
    """The measurements of a mesh with so many faces; raises ValueError if damaged."""
    if not fields.has_value("measurements"):
        return ()
    return tuple(
        _measurement_from_json(part, faces) for part in fields.nested_list("measurements", MOST_MEASUREMENTS)
    )


def _measurement_from_json(fields: JsonFields, faces: int) -> Measurement:
    name, named = fields.text("name"), fields.text("kind")
    if named not in [each.value for each in MeasurementKind]:
        raise ValueError(tr("the “kind” of a measurement is unknown"))
    kind = MeasurementKind(named)
    if kind is MeasurementKind.SECTION:
        return Measurement(name, kind, plane=_plane(fields.nested_fields("plane")))
    points = tuple(_point(part, faces) for part in fields.nested_list("points", kind.points))
    if len(points) < kind.points:
        raise ValueError(tr("its “points” are damaged"))
    return Measurement(name, kind, points)


def _point(fields: JsonFields, faces: int) -> SurfacePoint:
    face, weights = fields.count("face"), fields.numbers("weights", 3)
    if face >= faces or weights.min() < 0.0 or abs(weights.sum() - 1.0) > _ROUNDING:
        raise ValueError(tr("its “points” are damaged"))
    a, b, c = weights.tolist()
    return SurfacePoint(face, (a, b, c))


def _plane(fields: JsonFields) -> Plane:
    normal = fields.numbers("normal", 3)
    if abs(np.linalg.norm(normal) - 1.0) > _ROUNDING:
        raise ValueError(tr("its “plane” is damaged"))
    x, y, z = normal.tolist()
    return Plane((x, y, z), fields.number("offset"))
