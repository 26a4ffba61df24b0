"""Measurements to and from the JSON of a session."""

from __future__ import annotations

from typing import Any

import numpy as np

from apd_viewer.files.storage.json_fields import Fields
from apd_viewer.geometry.measuring.kinds import Kind
from apd_viewer.geometry.measuring.measurement import Measurement, Plane
from apd_viewer.geometry.measuring.surface_point import SurfacePoint
from apd_viewer.language import tr

MOST_MEASUREMENTS = 100
_ROUNDING = 1e-9


def measurements_said(measurements: tuple[Measurement, ...]) -> dict[str, Any]:
    """The measurements as a field of JSON; none where there are none."""
    return {"measurements": [_said(each) for each in measurements]} if measurements else {}


def _said(measurement: Measurement) -> dict[str, Any]:
    said: dict[str, Any] = {"name": measurement.name, "kind": measurement.kind.value}
    if measurement.plane is not None:
        return {
            **said,
            "plane": {"normal": list(measurement.plane.normal), "offset": measurement.plane.offset},
        }
    return {**said, "points": [{"face": p.face, "weights": list(p.weights)} for p in measurement.points]}


def measurements_of(said: Fields, faces: int) -> tuple[Measurement, ...]:
    """The measurements of a mesh with so many faces; raises ValueError if damaged."""
    if not said.says("measurements"):
        return ()
    return tuple(_measurement(part, faces) for part in said.parts("measurements", MOST_MEASUREMENTS))


def _measurement(said: Fields, faces: int) -> Measurement:
    name, named = said.text("name"), said.text("kind")
    if named not in [each.value for each in Kind]:
        raise ValueError(tr("the “kind” of a measurement is unknown"))
    kind = Kind(named)
    if kind is Kind.SECTION:
        return Measurement(name, kind, plane=_plane(said.part("plane")))
    points = tuple(_point(part, faces) for part in said.parts("points", kind.points))
    if len(points) < kind.points:
        raise ValueError(tr("its “points” are damaged"))
    return Measurement(name, kind, points)


def _point(said: Fields, faces: int) -> SurfacePoint:
    face, weights = said.count("face"), said.numbers("weights", 3)
    if face >= faces or weights.min() < 0.0 or abs(weights.sum() - 1.0) > _ROUNDING:
        raise ValueError(tr("its “points” are damaged"))
    a, b, c = weights.tolist()
    return SurfacePoint(face, (a, b, c))


def _plane(said: Fields) -> Plane:
    normal = said.numbers("normal", 3)
    if abs(np.linalg.norm(normal) - 1.0) > _ROUNDING:
        raise ValueError(tr("its “plane” is damaged"))
    x, y, z = normal.tolist()
    return Plane((x, y, z), said.number("offset"))
