"""Shape checks too slow for every frame."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from apd_viewer.geometry.analysis.double_wall import DoubleWall
from apd_viewer.geometry.analysis.hull_readings import HullReadings, hull_readings
from apd_viewer.geometry.analysis.mesh_findings import Finding
from apd_viewer.geometry.analysis.self_intersections import crossings
from apd_viewer.geometry.mesh.arrays import extents, used_vertices
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.seams import Seams
from apd_viewer.geometry.pose.held_turn import HandleTurns, HeldTurn
from apd_viewer.language import tr


class ShapeCheck(NamedTuple):
    """Self-intersections, box, convex hull and held turns of a shape.

    Attributes
    ----------
    crossing : (k,) int array or None
        Triangles that pass through others; None where nobody could look.
    size : tuple of 3 floats
        Of the box along the axes.
    hull : HullReadings
    turns : tuple of HeldTurn
        Of the handles; empty where none has turned.
    """

    crossing: np.ndarray | None
    size: tuple[float, float, float]
    hull: HullReadings
    turns: tuple[HeldTurn, ...] = ()

    @property
    def box(self) -> float:
        """Volume of the axis-aligned bounding box."""
        dx, dy, dz = self.size
        return dx * dy * dz

    @property
    def packed_box(self) -> float:
        """Volume of the smallest oriented bounding box of the shape."""
        return self.hull.box


def check_shape(U: np.ndarray, F: np.ndarray, handle_turns: HandleTurns | None = None) -> ShapeCheck:
    """Check the shape ``U`` (n, 3) of the triangles ``F`` (m, 3) and its handle turns."""
    points = U[used_vertices(F)]
    dx, dy, dz = extents(points).tolist()
    turns: tuple[HeldTurn, ...] = ()
    if handle_turns is not None:
        from apd_viewer.geometry.pose.surface_turns import held_turns  # Imported here: it loads SciPy.

        turns = held_turns(handle_turns.V, U, F, handle_turns.labels, handle_turns.paths)
    return ShapeCheck(crossings(U, F), (dx, dy, dz), hull_readings(points), turns)


# Kind of the finding about weldable seams.
SEAMS = "open seams"


def seam_findings(mesh: Mesh) -> Iterator[Finding]:
    """Findings about weldable seams and about T-junctions."""
    found = Seams.from_mesh(mesh.V, mesh.F, mesh.weld, mesh.opposite_half_edges)
    if found.weldable_sentence:
        yield Finding.at_vertices(SEAMS, found.weldable_sentence, found.edges)
    if found.unweldable_sentence:
        yield Finding.at_vertices("T-junctions", found.unweldable_sentence, found.joints)


def double_wall_findings(wall: DoubleWall | None, is_unknown: bool = False) -> Iterator[Finding]:
    """Finding about a vessel with outer and inner surfaces, or one that may have them."""
    if is_unknown:
        said = tr(
            "The mesh has too many triangles to tell whether it is a vessel with two walls, whose volume "
            "would be that of its material; decimate it to find out."
        )
        yield Finding.at_vertices("double wall unknown", said)
    if wall is None:
        return
    sentence = tr(
        "A vessel with two walls, {thickness:.3g} apart: its volume, {material:,.6g}, is that of its "
        "material, and it holds {capacity:,.6g}; to deform it as one wall, export one of its surfaces."
    )
    yield Finding.at_vertices("double wall", sentence.format(**wall._asdict()))
