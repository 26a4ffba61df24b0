"""The report of a deformation as JSON."""

from __future__ import annotations

import json
from dataclasses import asdict
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from apd_viewer.files.storage.atomic_file import replacing
from apd_viewer.geometry.analysis.hull_readings import DENSEST, LOOSEST, HullReadings
from apd_viewer.geometry.analysis.shape_check import ShapeCheck, check_shape

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    import numpy as np

    from apd_viewer.geometry.analysis.target_shape import TargetShape
    from apd_viewer.geometry.mesh.mesh import Mesh
    from apd_viewer.geometry.solver.deform import Result


def write_report(
    path: Path,
    mesh: Mesh,
    result: Result,
    target: TargetShape | None = None,
    more: Mapping[str, object] = MappingProxyType({}),
) -> None:
    """Write the readings of ``result`` and more fields; raises InputError on failure.

    ``target`` is the target shape to compare with, if there is one.
    """
    readings = asdict(result)
    del readings["U"]
    readings["convergence"] = result.convergence._asdict()
    excess = readings.pop("load_excess")
    readings["load_excess_percent"] = None if excess is None else 100.0 * excess
    readings |= {"loads": result.loads.tolist(), "shifts": result.shifts.tolist()}
    report = {
        "mesh": mesh.name,
        "unit": mesh.unit or None,
        "vertices": len(mesh.V),
        "faces": len(mesh.F),
        **readings,
    }
    for U, suffix in ((mesh.V, "_rest"), (result.U, "")):
        room = room_of(check_shape(U, mesh.joined_F))
        report |= {f"{name}{suffix}": reading for name, reading in room.items()}
    if target is not None:
        report |= {"target_shape": target.mesh.name, **apart_of(target, mesh, result.U)}
    report |= more
    with replacing(path) as scratch:
        scratch.write_text(json.dumps(report, indent=2) + "\n", encoding="utf-8")


def apart_of(target: TargetShape, mesh: Mesh, U: np.ndarray) -> dict[str, float]:
    """Distances of the shape ``U`` (n, 3) of a mesh from a target shape, and back.

    Those of vertices from the same vertices only where the triangles are the same.
    """
    found = target.compared(mesh, U)
    assert found is not None
    summaries = {"": found.closest, "_back": target.back(mesh, U)}
    if found.vertex is not None:
        summaries["_by_vertex"] = found.vertex
    return {
        f"{name}_distance{suffix}": reading
        for suffix, summary in summaries.items()
        for name, reading in summary._asdict().items()
    }


def room_of(found: ShapeCheck) -> dict[str, Any]:
    """Readings of self-intersections, bounding boxes and the convex hull.

    The number of intersections is None where the library is missing that finds them.
    """
    return {
        "self_intersections": None if found.crossing is None else len(found.crossing),
        "box_volume": found.box,
        "packed_volume": found.packed,
        **hull_fields(found.hull),
    }


def hull_fields(hull: HullReadings) -> dict[str, Any]:
    """Fields of the convex hull, by name; mesh units."""
    return {
        "packed_sides": hull.sides,
        "hull_volume": hull.volume,
        "minimum_width": hull.width,
        "bulk_volume": hull.bulk(),
        "bulk_volume_range": (hull.bulk(DENSEST), hull.bulk(LOOSEST)),
    }
