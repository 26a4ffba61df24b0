"""What is in a mesh, what is unusual about it, and what is done about that."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from apd_viewer.geometry.mesh import Mesh, counted
from apd_viewer.geometry.operators import face_areas, volume, why_no_volume
from apd_viewer.geometry.pieces import pieces


@dataclass(frozen=True)
class Inspection:
    """Counts and readings of a mesh at rest, and findings as sentences.

    Attributes
    ----------
    pieces : int
        Connected pieces of the surface, after vertices at the same position are joined.
    area, volume : float
        Square and cubic mesh units; volume is None where ``why_no_volume`` says why.
    size : tuple of float
        Extent along x, y and z.
    """

    vertices: int
    faces: int
    pieces: int
    area: float
    volume: float | None
    why_no_volume: str | None
    size: tuple[float, float, float]
    findings: tuple[str, ...]


def inspect(mesh: Mesh) -> Inspection:
    """Inspect the mesh as it came from its file."""
    first, inverse = mesh.weld.first, mesh.weld.inverse
    F = inverse[mesh.F]
    why = why_no_volume(F, len(first))
    areas = face_areas(mesh.V, mesh.F)
    count = len(np.unique(pieces(F, len(first))[F[:, 0]]))
    dx, dy, dz = (float(extent) for extent in np.ptp(mesh.V, axis=0))
    return Inspection(
        vertices=len(mesh.V),
        faces=len(mesh.F),
        pieces=count,
        area=float(areas.sum()),
        volume=None if why else volume(mesh.V, mesh.F),
        why_no_volume=why,
        size=(dx, dy, dz),
        findings=tuple(_findings(mesh, areas, count)),
    )


def _findings(mesh: Mesh, areas: np.ndarray, count: int) -> list[str]:
    findings = []
    repeated = len(mesh.V) - len(mesh.weld.first)
    if repeated:
        findings.append(
            f"{counted(repeated, 'vertex repeats', 'vertices repeat')} the position of another; "
            "they move together."
        )
    used = np.zeros(len(mesh.V), dtype=bool)
    used[mesh.F] = True
    unused = int((~used).sum())
    if unused:
        findings.append(
            f"{counted(unused, 'vertex belongs', 'vertices belong')} to no face; such a vertex does not move."
        )
    flat = int((areas == 0.0).sum())
    if flat:
        findings.append(f"{counted(flat, 'face has', 'faces have')} no area and no stiffness.")
    if count > 1:
        findings.append(f"There are {count:,} separate pieces; each needs base or handle to move.")
    return findings
