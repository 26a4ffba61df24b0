"""What is in a mesh, what is unusual about it, and what is done about that."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from apd_viewer.geometry.mesh import Mesh, counted, pieces
from apd_viewer.geometry.operators import area, face_areas, volume, why_no_volume


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
    dx, dy, dz = (float(extent) for extent in np.ptp(mesh.V, axis=0))
    return Inspection(
        vertices=len(mesh.V),
        faces=len(mesh.F),
        pieces=len(np.unique(pieces(F, len(first))[F])),
        area=area(mesh.V, mesh.F),
        volume=None if why else volume(mesh.V, mesh.F),
        why_no_volume=why,
        size=(dx, dy, dz),
        findings=tuple(_findings(mesh, F)),
    )


def _findings(mesh: Mesh, F: np.ndarray) -> list[str]:
    findings = []
    repeated = len(mesh.V) - len(mesh.weld.first)
    if repeated:
        findings.append(
            f"{counted(repeated, 'vertex repeats', 'vertices repeat')} the position of another; "
            "they move together."
        )
    unused = len(mesh.V) - len(np.unique(mesh.F))
    if unused:
        findings.append(
            f"{counted(unused, 'vertex belongs', 'vertices belong')} to no face; such a vertex does not move."
        )
    flat = int((face_areas(mesh.V, mesh.F) == 0.0).sum())
    if flat:
        findings.append(f"{counted(flat, 'face has', 'faces have')} no area and no stiffness.")
    count = len(np.unique(pieces(F, len(mesh.weld.first))[F]))
    if count > 1:
        findings.append(f"There are {count:,} separate pieces; each needs base or handle to move.")
    return findings
