"""Measurements of a session for the report of a command."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.measuring.carried_path import CarriedPath
from apd_viewer.geometry.measuring.geodesics import geodesic_path
from apd_viewer.geometry.measuring.measurement import Measurement, measure
from apd_viewer.geometry.measuring.measurement_kind import MeasurementKind
from apd_viewer.session.model.document import Document

_FIELDS = {0: "angle", 1: "length", 2: "area"}


def measurements_report(document: Document, U: np.ndarray) -> dict[str, list[dict[str, Any]]]:
    """Field of a report with the measurements at rest and at ``U`` (n, 3), if any.

    Lengths are in mesh units, angles in degrees; what cannot be measured is None.
    """
    shapes, F = (("_rest", document.mesh.V), ("", U)), document.mesh.joined_F
    measured = [
        {
            "name": each.name,
            "kind": each.kind.value,
            **{
                f"{_FIELDS[power]}{suffix}": _number(value, power)
                for suffix, X in shapes
                for value, power in zip(_values(each, X, F), each.kind.powers, strict=True)
            },
        }
        for each in document.measurements
    ]
    return {"measurements": measured} if measured else {}


def _values(measurement: Measurement, U: np.ndarray, F: np.ndarray) -> tuple[float | None, ...]:
    path = None
    if measurement.kind is MeasurementKind.GEODESIC:
        try:
            path = CarriedPath.from_polyline(geodesic_path(U, F, *measurement.points), U, F)
        except InputError:
            path = CarriedPath.empty()
    return measure(measurement, U, F, path).values


def _number(value: float | None, power: int) -> float | None:
    if value is None or math.isnan(value):
        return None
    return math.degrees(value) if power == 0 else value
