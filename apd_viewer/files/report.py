"""JSON report of a deformation."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from apd_viewer.geometry.analysis.hull_readings import DENSEST, LOOSEST, HullReadings
from apd_viewer.geometry.analysis.shape_check import ShapeCheck, check_shape

if TYPE_CHECKING:
    import numpy as np

    from apd_viewer.geometry.analysis.target_shape import TargetShape
    from apd_viewer.geometry.mesh.mesh import Mesh
    from apd_viewer.geometry.solver.deformation_result import Result


def report_fields(mesh: Mesh, result: Result, target: TargetShape | None = None) -> dict[str, Any]:
    """Fields of a report, by name; with distances from a target shape, if any."""
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
        room = shape_check_fields(check_shape(U, mesh.joined_F))
        report |= {f"{name}{suffix}": reading for name, reading in room.items()}
    if target is not None:
        report |= {"target_shape": target.mesh.name, **target_distance_fields(target, mesh, result.U)}
    return report


def target_distance_fields(target: TargetShape, mesh: Mesh, U: np.ndarray) -> dict[str, float]:
    """Report fields of the distances between a shape ``U`` (n, 3) and a target shape.

    Distances between corresponding vertices are given only for equal triangles.
    """
    found = target.target_distance(mesh, U)
    assert found is not None
    summaries = {"": found.closest, "_back": target.reverse_distance(mesh, U)}
    if found.vertex is not None:
        summaries["_by_vertex"] = found.vertex
    return {
        f"{name}_distance{suffix}": reading
        for suffix, summary in summaries.items()
        for name, reading in summary._asdict().items()
    }


def shape_check_fields(check: ShapeCheck) -> dict[str, Any]:
    """Report fields of self-intersections, bounding boxes and the convex hull.

    The number of intersections is None if the library for finding them is not installed.
    """
    return {
        "self_intersections": None if check.crossing is None else len(check.crossing),
        "box_volume": check.box,
        "packed_volume": check.packed_box,
        **hull_fields(check.hull),
    }


def hull_fields(hull: HullReadings) -> dict[str, Any]:
    """Report fields of the convex hull, in mesh units."""
    return {
        "packed_sides": hull.sides,
        "hull_volume": hull.volume,
        "minimum_width": hull.width,
        "bulk_volume": hull.bulk(),
        "bulk_volume_range": (hull.bulk(DENSEST), hull.bulk(LOOSEST)),
    }
