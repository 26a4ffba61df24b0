"""Scalars of a deformed mesh, per vertex and per triangle."""

from typing import NamedTuple

import numpy as np

from apd_viewer.geometry.analysis.deviation import Deviation
from apd_viewer.geometry.analysis.target_shape import TargetShape
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.normals import triangle_frames
from apd_viewer.geometry.mesh.operators import face_areas
from apd_viewer.geometry.pose.constraints import FREE

LABEL, REGION = "apd_label", "apd_region"


class Scalars(NamedTuple):
    """Named scalar columns for the vertices and for the triangles.

    Attributes
    ----------
    vertices : dict of str to (n,) array
        ``apd_label`` and ``apd_region``; ``area_change`` of the triangles around a vertex and
        ``edge_strain``, relative to rest; ``bending``, the change of the mean curvature; ``displacement`` and
        ``distance_to_rest``, mesh units; with a target shape ``target_distance`` from its closest point, and
        ``target_displacement`` from its vertex with the same ID if the triangles are the same.
    triangles : dict of str to (m,) array
        ``apd_label`` and ``apd_region``, where all corners agree; ``area_rest``, ``area`` and its relative
        ``area_change``; ``largest_stretch`` and ``smallest_stretch``, the singular values of the
        deformation gradient. NaN where a triangle has no area at rest.
    """

    vertices: dict[str, np.ndarray]
    triangles: dict[str, np.ndarray]


def shape_scalars(
    mesh: Mesh, U: np.ndarray, labels: np.ndarray, member: np.ndarray, target: TargetShape | None = None
) -> Scalars:
    """Scalars of the shape ``U`` (n, 3), per vertex and per triangle.

    Parameters
    ----------
    mesh : Mesh
    U : (n, 3) float array
    labels, member : (n,) int arrays
        Base, free or handle, and number of the region, of each vertex.
    target : TargetShape, optional
        Another mesh to compare with.
    """
    joined = mesh.weld.representative
    deviation = Deviation(mesh.V, mesh.joined_F, joined, target)
    vertices = {
        LABEL: labels,
        REGION: member,
        "area_change": np.expm1(deviation.area_change(U)),
        "edge_strain": np.expm1(deviation.edge_strain(U)),
        "bending": deviation.bending(U),
        "displacement": deviation.displacement(U),
        "distance_to_rest": deviation.rest_distance(U),
    }
    if target is not None:
        vertices["target_distance"] = deviation.target_distance(U)
        if target.has_same_triangles(mesh):
            vertices["target_displacement"] = deviation.target_displacement(U)
    rest, area = face_areas(mesh.V, mesh.F), face_areas(U, mesh.F)
    largest, smallest = triangle_stretches(mesh.V[mesh.F], U[mesh.F])
    triangles = {
        LABEL: _common_code(labels[mesh.F], FREE),
        REGION: _common_code(member[mesh.F], 0),
        "area_rest": rest,
        "area": area,
        "area_change": np.divide(area, rest, out=np.full(len(rest), np.nan), where=rest > 0.0) - 1.0,
        "largest_stretch": largest,
        "smallest_stretch": smallest,
    }
    return Scalars(vertices, triangles)


def _common_code(codes: np.ndarray, otherwise: int) -> np.ndarray:
    """Code common to all three corners (m, 3), or ``otherwise``, (m,)."""
    return np.where((codes == codes[:, :1]).all(axis=1), codes[:, 0], otherwise)


def triangle_stretches(before: np.ndarray, after: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Largest and smallest stretch of each triangle (m, 3, 3), both (m,)."""
    # In the plane of each triangle the first edge is (a, 0) and the second (b, c).
    (a, b, c), (p, q, r) = _edges(before), _edges(after)
    proper = (a > 0.0) & (c > 0.0)
    a, c = np.where(proper, a, 1.0), np.where(proper, c, 1.0)
    xx, yy, xy = p / a, r / c, (q - p * b / a) / c
    # Singular values of the triangular matrix ((xx, xy), (0, yy)).
    apart, together = np.hypot(xx - yy, xy), np.hypot(xx + yy, xy)
    largest, smallest = 0.5 * (together + apart), 0.5 * np.abs(together - apart)
    return np.where(proper, largest, np.nan), np.where(proper, smallest, np.nan)


def _edges(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Edges of each triangle in its plane: ``a, b, c`` for (a, 0) and (b, c)."""
    frames = triangle_frames(corners)
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    along, across = frames[:, 0], frames[:, 1]
    return (
        np.linalg.norm(first, axis=1),
        np.einsum("ij,ij->i", second, along),
        np.einsum("ij,ij->i", second, across),
    )
