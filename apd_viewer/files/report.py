"""The report of a deformation as JSON."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from apd_viewer.files.storage.atomic_file import replacing
from apd_viewer.geometry.analysis.shape_check import Examination, examined

if TYPE_CHECKING:
    from pathlib import Path

    from apd_viewer.geometry.mesh.mesh import Mesh
    from apd_viewer.geometry.solver.deform import Result


def write_report(path: Path, mesh: Mesh, result: Result) -> None:
    """Write the readings of ``result``; raises InputError on failure."""
    readings = asdict(result)
    del readings["U"]
    report = {"mesh": mesh.name, "vertices": len(mesh.V), "faces": len(mesh.F), **readings}
    for U, suffix in ((mesh.V, "_rest"), (result.U, "")):
        room = room_of(examined(U, mesh.joined_F))
        report |= {f"{name}{suffix}": reading for name, reading in room.items()}
    with replacing(path) as scratch:
        scratch.write_text(json.dumps(report, indent=2) + "\n", encoding="utf-8")


def room_of(found: Examination) -> dict[str, Any]:
    """Readings of bounding boxes and self-intersections.

    That number is None where the library is missing that finds them.
    """
    return {
        "self_intersections": None if found.crossing is None else len(found.crossing),
        "box_volume": found.box,
        "packed_volume": found.packed,
    }
