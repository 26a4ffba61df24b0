"""The report of a deformation as JSON."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import TYPE_CHECKING

from apd_viewer.files.replacing import replacing

if TYPE_CHECKING:
    from pathlib import Path

    from apd_viewer.geometry.deform import Result
    from apd_viewer.geometry.mesh import Mesh


def write_report(path: Path, mesh: Mesh, result: Result) -> None:
    """Write the readings of ``result``; raises InputError if the file cannot be written."""
    readings = asdict(result)
    del readings["U"]
    report = {"mesh": mesh.name, "vertices": len(mesh.V), "faces": len(mesh.F), **readings}
    with replacing(path) as scratch:
        scratch.write_text(json.dumps(report, indent=2) + "\n", encoding="utf-8")
