"""Symmetric posing: handles moved together with their mirror images."""

from typing import NamedTuple

import numpy as np

from apd_viewer.geometry.mesh.arrays import diagonal
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.picking.vertex_sets import nearest_mirror_vertices
from apd_viewer.geometry.pose.constraints import HANDLE
from apd_viewer.geometry.pose.mirror import MirrorPlane
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.document_parts import with_handles_reset
from apd_viewer.session.model.handles_and_regions import Handle
from apd_viewer.session.model.memo import memoised

# Matching tolerance for mirror images of vertices, relative to the size of a handle. A mesh need not have
# mirrored vertices on both sides.
_NEAR = 0.1
# Matching tolerance for a handle of one vertex, relative to the diagonal of the mesh.
_NEAR_VERTEX = 0.002
# Minimum fraction of mirrored vertices of two partner handles, since brush strokes are inexact.
_LIKE = 0.5


class MirrorPartner(NamedTuple):
    """Handle at the mirror image of another handle, or of itself.

    Attributes
    ----------
    fraction : float
        Fraction of vertices of both that are mirror images of each other, 0 to 1.
    """

    number: int
    fraction: float


def mirror_plane(mesh: Mesh, axis: int) -> MirrorPlane:
    """Mirror plane through the middle of the bounding box of the rest shape.

    The rest shape is used because a bent mesh has no mirror plane.
    """
    low, high = _box(mesh.V, mesh.joined_F)
    return MirrorPlane(axis, float(low[axis] + high[axis]) / 2.0)


@memoised
def _used_vertices(V: np.ndarray, F: np.ndarray) -> np.ndarray:
    """Mask of the vertices used by triangles, (n,) bool array."""
    named = np.zeros(len(V), dtype=bool)
    named[F.ravel()] = True
    return named


@memoised
def _box(V: np.ndarray, F: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Lower and upper corner of the bounding box of the triangles."""
    named = V[_used_vertices(V, F)]
    return named.min(axis=0), named.max(axis=0)


@memoised
def _images(V: np.ndarray, F: np.ndarray, labels: np.ndarray, label: int, plane: MirrorPlane) -> np.ndarray:
    """Fractions (256,) of a label's mirror images that lie on each label."""
    named = _used_vertices(V, F)
    ids = np.flatnonzero((labels == label) & named)
    if not len(ids):
        return np.zeros(256)
    reach = max(_NEAR * diagonal(V[ids]), _NEAR_VERTEX * diagonal(V[named]))
    found = nearest_mirror_vertices(V, ids, named, plane, np.full(len(ids), reach))
    fractions: np.ndarray = np.bincount(labels[found[found >= 0]], minlength=256) / len(ids)
    return fractions


def mirror_partner(document: Document, k: int) -> MirrorPartner | None:
    """Mirror partner of handle ``k``; None without symmetry or a partner."""
    if document.mirror_axis is None:
        return None
    mesh, labels = document.mesh, document.labels
    plane = mirror_plane(mesh, document.mirror_axis)
    mine = _images(mesh.V, mesh.joined_F, labels, HANDLE + k, plane)
    likely = int(np.argmax(mine[HANDLE : HANDLE + len(document.handles)]))
    theirs = _images(mesh.V, mesh.joined_F, labels, HANDLE + likely, plane)
    fraction = float(min(mine[HANDLE + likely], theirs[HANDLE + k]))
    return MirrorPartner(likely, fraction) if fraction >= _LIKE else None


def with_pair_moved(document: Document, k: int, pose: np.ndarray) -> Document:
    """Document with handle ``k`` moved to ``pose`` (4, 4), and its partner mirrored.

    A handle that is its own mirror image moves only within the mirror plane.
    """
    partner, pivot = mirror_partner(document, k), document.pivot(k)
    if partner is not None and partner.number == k and pivot is not None:
        assert document.mirror_axis is not None
        pose = mirror_plane(document.mesh, document.mirror_axis).symmetric_motion(pose, pivot)
    return with_pair_placed(document, k, document.handles[k].moved_to(pose))


def with_pair_placed(document: Document, k: int, handle: Handle) -> Document:
    """Document with handle ``k`` replaced, and its partner mirrored."""
    partner = mirror_partner(document, k)
    document = document.with_handle(k, handle)
    if partner is None or partner.number == k:
        return document
    mirrored = mirrored_handle(document, handle, document.handles[partner.number])
    return document.with_handle(partner.number, mirrored)


def with_pair_reset(document: Document, k: int) -> Document:
    """Document with handle ``k`` and its partner reset."""
    partner = mirror_partner(document, k)
    return (
        with_handles_reset(document, k)
        if partner is None
        else with_handles_reset(document, k, partner.number)
    )


def mirrored_handle(document: Document, handle: Handle, other: Handle) -> Handle:
    """Copy of ``other`` with the mirrored pose and path of ``handle``."""
    assert document.mirror_axis is not None
    plane = mirror_plane(document.mesh, document.mirror_axis)
    whole = handle.relative_to_rest
    return other.with_pose_from_rest(
        plane.mirrored_pose(whole.pose), tuple(map(plane.mirrored_pose, whole.waypoints))
    )
