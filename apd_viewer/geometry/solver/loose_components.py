"""Loose parts, carried along as rigid bodies by the nearest held surface.

They are subject to contact with everything but the surface that carries them: whether a button sunk into it
should be sunk cannot be decided.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numba import prange
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from apd_viewer.errors import InputError
from apd_viewer.geometry.analysis.surface_distance import nearest_triangles
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.linalg.rotations import horn, rotated_vector
from apd_viewer.geometry.linalg.threads import cores_for, parallel
from apd_viewer.geometry.mesh.operators import face_areas
from apd_viewer.geometry.solver.held_vertices import vertex_ids
from apd_viewer.language import tr, trn

GO, STAY = "go", "stay"
# Distance beyond a part's nearest point, in part sizes, at which its points have half weight: a spout moves
# along with the wall that it stands on, not with the one that it points at.
_REACH = 0.05
# Extra weight of each corner of a triangle in the fit: a nearest point at a corner alone determines no
# rotation. Small, since a point nearest to an edge is equally near to two triangles.
_AROUND = 0.01


class LooseComponents:
    """Connected parts without held vertices, including isolated vertices.

    Nothing says where such a part belongs, so the solver leaves it at rest. It is bound to the triangles of
    the held surface nearest to it at rest, and makes the rigid motion that takes a point between them along
    and fits their corners best. So it keeps its area, its volume and its distance from the surface.

    Parameters
    ----------
    rest : RestMesh
    held : (k,) int array
        Held vertices of the solve mesh.
    handle_of : (k,) int array
        For each the number of its handle, from 1; 0 is base.
    loose : "go", "stay" or int array
        All parts go along, all stay at rest, or those with these vertices of the file stay.
    contact : bool
        Whether contact keeps the held components apart.
    """

    def __init__(
        self,
        rest: RestMesh,
        held: np.ndarray,
        handle_of: np.ndarray,
        loose: str | Sequence[int] | np.ndarray,
        contact: bool = False,
    ) -> None:
        self._rest, self._contact = rest, contact
        piece = rest.solve_mesh.component
        self._without_base = _without_base(piece, held, handle_of)
        self._is_held = np.zeros(len(piece), dtype=bool)
        # If nothing is held, all parts deform.
        self._is_held[piece[held] if len(held) else slice(None)] = True
        self._vertices = np.flatnonzero(~self._is_held[piece])
        self._stays = self._stays_at_rest(loose)

    def set_loose_motion(self, loose: str | Sequence[int] | np.ndarray) -> None:
        """Choose which loose parts follow the nearest surface and which stay in place.

        Raises
        ------
        InputError
            If others would stay in contact: there might be no collision-free path to their positions.
        """
        stays = self._stays_at_rest(loose)
        if self._contact and not np.array_equal(stays[~self._is_held], self._stays[~self._is_held]):
            raise InputError(tr("In contact other loose parts cannot stay; make another Deformation."))
        self._stays = stays

    def _stays_at_rest(self, loose: str | Sequence[int] | np.ndarray) -> np.ndarray:
        """Mask of the components that stay in their rest positions."""
        if not isinstance(loose, str):
            return self._containing(loose)
        if loose in (GO, STAY):
            return np.full(len(self._is_held), loose == STAY)
        raise InputError(
            tr("Loose parts must 'go' or 'stay'; or give a list with a vertex of each that stays.")
        )

    def _containing(self, vertices: Sequence[int] | np.ndarray) -> np.ndarray:
        """Mask of the components containing any of ``vertices`` of the file."""
        weld, piece = self._rest.weld, self._rest.solve_mesh.component
        stays = np.zeros(len(piece), dtype=bool)
        stays[piece[weld.inverse[vertex_ids(vertices, len(weld.inverse), "loose")]]] = True
        return stays

    @property
    def warning(self) -> str | None:
        """Sentences about parts without a base; None if there are none."""
        shape = self._rest.solve_mesh
        loose = np.zeros(len(shape.component), dtype=bool)
        loose[shape.component[shape.F[:, 0]]] = True
        loose &= ~self._is_held
        stay = int((loose & self._stays).sum())
        said = [_sentence_on_going(int(loose.sum()) - stay), _sentence_on_staying(stay)]
        if self._contact and loose.sum() > stay:
            said.append(tr("Contact keeps them apart from all but the surface that they go along with."))
        said.append(_sentence_on_handles(self._without_base))
        return " ".join(filter(None, said)) or None

    def with_loose_parts_at_rest(self, U: np.ndarray) -> np.ndarray:
        """``U`` (n, 3) with all loose parts in their rest positions."""
        if len(self._vertices):
            U = U.copy()
            U[self._vertices] = self._rest.solve_mesh.V[self._vertices]
        return U

    def with_followers(self, U: np.ndarray) -> np.ndarray:
        """``U`` (n, 3) with loose parts moved along with their carriers."""
        if not len(self._vertices) or self._binding is None:
            return U
        out, piece = U.copy(), self._rest.solve_mesh.component
        with cores_for(len(U)):
            _write_carried_positions(
                U, self._rest.solve_mesh.V, *self._binding[:-1], self._stays[piece[self._vertices]], out
            )
        return out

    @property
    def exempt_groups(self) -> np.ndarray:
        """Contact exemption groups (1, n): carried parts; carriers as negative numbers.

        Parts with a common carrier are in one group. No row without such parts.
        """
        shape, n = self._rest.solve_mesh, len(self._rest.solve_mesh.V)
        binding = self._binding if len(self._vertices) else None
        if binding is None:
            return np.zeros((0, n), np.int64)
        group = np.zeros((1, n), np.int64)
        part, corner, _ = self._carriers(binding, binding.is_close)
        leader = binding.member[binding.member_start[:-1]]
        links = coo_array((np.ones(len(part)), (leader[part], corner)), shape=(n, n))
        number = 1 + connected_components(links, directed=False)[1].astype(np.int64)
        group[0, corner] = -number[corner]
        around = shape.F[(group[0][shape.F] < 0).any(axis=1)]
        np.minimum.at(group[0], around, group[0][around].min(axis=1, keepdims=True))
        of_part = np.zeros(len(leader), np.int64)
        of_part[part] = number[leader[part]]
        group[0, binding.member] = np.repeat(of_part, np.diff(binding.member_start))
        return group

    def transfer_gradient(self, g: np.ndarray) -> None:
        """Add the gradient (n, 3) of loose parts to their carriers, rotations ignored."""
        if len(self._vertices) and self._binding is not None:
            part, corner, point_weight = self._carriers(self._binding)
            force = np.add.reduceat(g[self._binding.member], self._binding.member_start[:-1])
            np.add.at(g, corner, point_weight[:, None] * force[part])

    def limit_step_fractions(self, fractions: np.ndarray) -> None:
        """Limit the step fractions (n,) of carriers to those of the carried parts."""
        if len(self._vertices) and self._binding is not None:
            part, corner, _ = self._carriers(self._binding)
            least = np.minimum.reduceat(fractions[self._binding.member], self._binding.member_start[:-1])
            np.minimum.at(fractions, corner, least[part])

    def _carriers(
        self, binding: LooseBinding, among: np.ndarray | bool = True
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Carried part (c,), triangle corner carrying it (c,) and its weight (c,)."""
        leader = binding.member[binding.member_start[:-1]]
        part = np.repeat(np.arange(len(leader)), np.diff(binding.start))
        goes = among & ~self._stays[self._rest.solve_mesh.component[leader]][part]
        return part[goes], binding.corner[goes], binding.point_weight[goes]

    @cached_property
    def _binding(self) -> LooseBinding | None:
        shape = self._rest.solve_mesh
        F = shape.F[self._is_held[shape.component[shape.F[:, 0]]]]
        F = F[face_areas(shape.V, F) > 0.0]
        return _bind_parts(shape.V, F, shape.component, self._vertices) if len(F) else None


class LooseBinding(NamedTuple):
    """Loose parts, bound to the corners of their nearest triangles.

    Attributes
    ----------
    member_start : (p + 1,) int array
        Part k has the vertices ``member[member_start[k]:member_start[k + 1]]``.
    member : (l,) int array
    start : (p + 1,) int array
        Its corners are ``corner[start[k]:start[k + 1]]``.
    corner : (c,) int array
    point_weight : (c,) float array
        Weights of the point between the triangles, by part, with sum one.
    weight : (c,) float array
        Weights of the fit.
    is_close : (c,) bool array
        True on the surface carrying the part, False on an opposite one.
    """

    member_start: np.ndarray
    member: np.ndarray
    start: np.ndarray
    corner: np.ndarray
    point_weight: np.ndarray
    weight: np.ndarray
    is_close: np.ndarray


def _bind_parts(V: np.ndarray, F: np.ndarray, component: np.ndarray, vertices: np.ndarray) -> LooseBinding:
    """Binding of the loose parts of ``vertices`` (l,) to the triangles ``F`` (m, 3)."""
    vertices = vertices[np.argsort(component[vertices], kind="stable")]
    _, first, part = np.unique(component[vertices], return_index=True, return_inverse=True)
    away, T = nearest_triangles(V[vertices], V, F)
    reach = _reach(V[vertices], away, first)[part]
    near = _nearness(away, reach, part)
    point_weight = near[:, None] * _barycentric(V[T], V[vertices])
    weight = point_weight + _AROUND * near[:, None]
    key, which = np.unique((part[:, None] * len(V) + T).ravel(), return_inverse=True)
    part_of_corner, corner = np.divmod(key, len(V))
    start = np.searchsorted(part_of_corner, np.arange(len(first) + 1))
    return LooseBinding(
        np.append(first, len(vertices)),
        vertices,
        start,
        corner,
        np.bincount(which, point_weight.ravel()),
        np.bincount(which, weight.ravel()),
        np.bincount(which, np.repeat(away <= reach, 3)) > 0,
    )


def _reach(points: np.ndarray, away: np.ndarray, first: np.ndarray) -> np.ndarray:
    """Distance (p,) from the surface at which a point of a part has half weight."""
    extent = np.maximum.reduceat(points, first) - np.minimum.reduceat(points, first)
    reach = np.minimum.reduceat(away, first) + _REACH * np.linalg.norm(extent, axis=1)
    reach[reach == 0.0] = 1.0  # the part is a single vertex lying on the surface
    return reach


def _nearness(away: np.ndarray, reach: np.ndarray, component: np.ndarray) -> np.ndarray:
    """Weights (l,) of the points by distance, with sum one for each part."""
    near = 1.0 / (1.0 + (away / reach) ** 2)
    return near / np.bincount(component, near)[component]


def _barycentric(corners: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Barycentric coordinates (l, 3) of points projected onto triangles, clamped."""
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    d, n = points - corners[:, 0], np.cross(a, b)
    squared = np.einsum("ij,ij->i", n, n)
    second = np.einsum("ij,ij->i", np.cross(d, b), n) / squared
    third = np.einsum("ij,ij->i", np.cross(a, d), n) / squared
    inside = np.maximum(np.column_stack([1.0 - second - third, second, third]), 0.0)
    return inside / inside.sum(axis=1, keepdims=True)


@parallel()
def _write_carried_positions(
    U: np.ndarray,
    V: np.ndarray,
    member_start: np.ndarray,
    member: np.ndarray,
    start: np.ndarray,
    corner: np.ndarray,
    point_weight: np.ndarray,
    weight: np.ndarray,
    stays: np.ndarray,
    out: np.ndarray,
) -> None:
    """Write positions of carried members (l,), unless ``stays`` (l,), into ``out``."""
    for p in prange(len(start) - 1):
        # A part keeps its positions to the last bit if its carriers have not moved.
        moved = False
        for e in range(start[p], start[p + 1]):
            i = corner[e]
            moved |= U[i, 0] != V[i, 0] or U[i, 1] != V[i, 1] or U[i, 2] != V[i, 2]
        if not moved or stays[member_start[p]]:
            continue
        before, after = np.zeros(3), np.zeros(3)
        for e in range(start[p], start[p + 1]):
            for axis in range(3):
                before[axis] += point_weight[e] * V[corner[e], axis]
                after[axis] += point_weight[e] * U[corner[e], axis]
        scratch, q = np.zeros((3, 4, 4)), np.zeros((1, 4))
        S, q[0, 0] = scratch[0], 1.0
        for e in range(start[p], start[p + 1]):
            for a in range(3):
                for b in range(3):
                    to, fro = U[corner[e], a] - after[a], V[corner[e], b] - before[b]
                    S[a, b] += weight[e] * to * fro
        if np.abs(S).sum() > 0.0:
            horn(S, q[0], scratch[1], scratch[2])
        for k in range(member_start[p], member_start[p + 1]):
            v = member[k]
            x, y, z = rotated_vector(q, 0, V[v, 0] - before[0], V[v, 1] - before[1], V[v, 2] - before[2])
            out[v, 0], out[v, 1], out[v, 2] = after[0] + x, after[1] + y, after[2] + z


def _without_base(component: np.ndarray, held: np.ndarray, handle_of: np.ndarray) -> int:
    """Number of parts with free vertices held by a single handle alone."""
    if (handle_of > 0).all():
        return 0
    size = np.bincount(component)
    least, most = np.full(len(size), handle_of.max() + 1), np.zeros(len(size), dtype=np.int64)
    np.minimum.at(least, component[held], handle_of)
    np.maximum.at(most, component[held], handle_of)
    is_free = np.bincount(component[held], minlength=len(size)) < size
    return int(((least == most) & (least > 0) & is_free).sum())


def _sentence_on_going(n: int) -> str:
    said = trn(
        "{n:,} connected part without base or handle; it goes along with the nearest surface.",
        "{n:,} connected parts without base or handle; they go along with the nearest surface.",
        n,
    )
    return said.format(n=n) if n else ""


def _sentence_on_staying(n: int) -> str:
    said = trn(
        "{n:,} connected part without base or handle; it stays where it is.",
        "{n:,} connected parts without base or handle; they stay where they are.",
        n,
    )
    return said.format(n=n) if n else ""


def _sentence_on_handles(n: int) -> str:
    said = trn(
        "{n:,} connected part with a handle but no base; it moves with its handle as a whole. "
        "Paint base on it to deform it.",
        "{n:,} connected parts with a handle but no base; they move with their handles as a whole. "
        "Paint base on them to deform them.",
        n,
    )
    return said.format(n=n) if n else ""
