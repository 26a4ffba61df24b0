"""Findings about an undeformed mesh, one sentence each."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from apd_viewer.geometry.analysis.defects import defects
from apd_viewer.geometry.mesh.arrays import bounding_box, diagonal, frozen, used_vertices
from apd_viewer.geometry.mesh.edges_and_components import opposite_half_edges
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.operators import aspect_ratios, encloses_nothing, face_volumes
from apd_viewer.geometry.mesh.weld import SEAM_TOLERANCE, WELD_TOLERANCE
from apd_viewer.language import tr, trn

# Kinds of the findings about the file and about separate components.
_FILE, SEPARATE_COMPONENTS, UNEVEN = "file", "separate pieces", "uneven triangles"
# Aspect ratio of a sliver: longest edge to height.
_NEEDLE = 100.0

# Triangles of a larger aspect ratio hardly bend. On CAD models without vertices inside flat faces they cover
# a quarter of the surface and more, and the method Local kept its area 5 to 10 times worse.
_THIN, _THIN_SHARE = 10.0, 0.05

# Mesh sizes outside this range suggest a wrong unit, whatever the unit.
_TINY, _HUGE = 1e-3, 1e6

# Most parts, and triangles around one of them in sum, for which nesting is examined.
_MOST_PARTS, _MOST_WINDINGS = 2000, 20_000_000

# At this many mesh sizes from the origin, single precision has lost three digits.
_FAR = 1e3


@dataclass(frozen=True, eq=False)
class Finding:
    """Unusual property of a mesh: a sentence, and the vertices concerned.

    Attributes
    ----------
    kind : str
        A name for scripts, always the same.
    sentence : str
        Sentence on the property and its consequences.
    vertices : (k,) int array
        Where: vertices of the file, ascending; empty where it is the whole mesh.
    """

    kind: str
    sentence: str
    vertices: np.ndarray

    @classmethod
    def at_vertices(cls, kind: str, sentence: str, vertices: np.ndarray | tuple[()] = ()) -> Finding:
        """Finding about vertices, given in any order and possibly repeated."""
        return cls(kind, sentence, frozen(used_vertices(np.asarray(vertices, dtype=np.int64).ravel())))

    @property
    def is_about_file(self) -> bool:
        """True if the finding concerns the file, not the mesh in it."""
        return self.kind == _FILE


def file_findings(mesh: Mesh) -> Iterator[Finding]:
    """Findings about the file of the mesh."""
    for sentence in mesh.remarks:
        yield Finding.at_vertices(_FILE, sentence)


def vertex_findings(mesh: Mesh) -> Iterator[Finding]:
    """Findings about coincident and unreferenced vertices, and cracks."""
    weld = mesh.weld
    repeats = np.bincount(weld.inverse, minlength=len(weld.first))[weld.inverse] > 1
    exact = np.ones(len(mesh.V), dtype=bool) if weld.offset is None else ~weld.offset.any(axis=1)
    repeated = int(exact.sum()) - len(weld.first)
    if repeated:
        sentence = trn(
            "{n:,} vertex has the same position as another; they move together.",
            "{n:,} vertices have the same position as another; they move together.",
            repeated,
        ).format(n=repeated)
        yield Finding.at_vertices("repeated vertices", sentence, np.flatnonzero(repeats))
    if weld.offset is not None:
        near = np.flatnonzero(weld.offset.any(axis=1))
        sentence = trn(
            "{n:,} vertex is closer than {part:g} × the mesh size to another; they move together.",
            "{n:,} vertices are closer than {part:g} × the mesh size to another; they move together.",
            len(near),
        ).format(n=len(near), part=SEAM_TOLERANCE if mesh.has_welded_seams else WELD_TOLERANCE)
        yield Finding.at_vertices("cracks", sentence, near)
    used = np.zeros(len(mesh.V), dtype=bool)
    used[mesh.F.ravel()] = True
    unused = np.flatnonzero(~used)
    if len(unused):
        sentence = trn(
            "{n:,} loose vertex without a face; it follows the nearest surface.",
            "{n:,} loose vertices without a face; they follow the nearest surface.",
            len(unused),
        ).format(n=len(unused))
        yield Finding.at_vertices("unreferenced vertices", sentence, unused)


def face_findings(mesh: Mesh, areas: np.ndarray) -> Iterator[Finding]:
    """Findings about degenerate and sliver triangles."""
    flat = areas == 0.0
    if n := int(flat.sum()):
        sentence = trn(
            "{n:,} degenerate face without area or stiffness.",
            "{n:,} degenerate faces without area or stiffness.",
            n,
        ).format(n=n)
        yield Finding.at_vertices("faces without area", sentence, mesh.F[flat])
    aspects = aspect_ratios(mesh.V, mesh.F, areas)
    if sentence := uneven_sentence(aspects, areas):
        yield Finding.at_vertices(UNEVEN, sentence, mesh.F[aspects > _THIN])
    needles = aspects > _NEEDLE
    if n := int(needles.sum()):
        sentence = trn(
            "{n:,} sliver triangle (aspect ratio > {times:g}); Local and Wall may be poor there; remesh.",
            "{n:,} sliver triangles (aspect ratio > {times:g}); Local and Wall may be poor there; remesh.",
            n,
        ).format(n=n, times=_NEEDLE)
        yield Finding.at_vertices("needles", sentence, mesh.F[needles])


def uneven_sentence(aspects: np.ndarray, areas: np.ndarray) -> str:
    """Sentence on the cost of thin triangles, or empty; aspects and areas are (m,)."""
    whole = float(areas.sum())
    share = float(areas[aspects > _THIN].sum()) / whole if whole > 0.0 else 0.0
    if share <= _THIN_SHARE:
        return ""
    return tr(
        "Triangles over {times:g} times as long as high cover {percent:.0f} % of the surface and hardly "
        "bend: Local keeps areas up to 10 times worse and a wall is too stiff; remesh evenly first."
    ).format(times=_THIN, percent=100.0 * share)


def topology_findings(mesh: Mesh, F: np.ndarray) -> Iterator[Finding]:
    """Findings about topology: edges, borders, orientation."""
    first, n, opposite = mesh.weld.first, len(mesh.weld.first), mesh.opposite_half_edges
    proper = np.flatnonzero((F[:, 0] != F[:, 1]) & (F[:, 1] != F[:, 2]) & (F[:, 2] != F[:, 0]))
    if len(proper) < len(F):
        F = F[proper]
        opposite = frozen(opposite_half_edges(F, n))
    found = defects(F, opposite)
    if n := len(found.duplicate_faces):
        sentence = trn(
            "{n:,} duplicate face; its area counts twice.",
            "{n:,} duplicate faces; their area counts twice.",
            n,
        ).format(n=n)
        yield Finding.at_vertices("doubled faces", sentence, mesh.F[proper[found.duplicate_faces]])
    if n := len(found.non_manifold_edges):
        sentence = trn(
            "{n:,} non-manifold edge with more than two faces.",
            "{n:,} non-manifold edges with more than two faces.",
            n,
        ).format(n=n)
        yield Finding.at_vertices("crowded edges", sentence, first[found.non_manifold_edges])
    if n := len(found.non_manifold_vertices):
        sentence = trn(
            "{n:,} non-manifold vertex; the surfaces there meet only at a point.",
            "{n:,} non-manifold vertices; the surfaces there meet only at a point.",
            n,
        ).format(n=n)
        yield Finding.at_vertices("bow ties", sentence, first[found.non_manifold_vertices])
    if n := len(found.flipped_faces):
        sentence = trn(
            "{n:,} flipped face; there is no volume.",
            "{n:,} flipped faces; there is no volume.",
            n,
        ).format(n=n)
        yield Finding.at_vertices("flipped faces", sentence, mesh.F[proper[found.flipped_faces]])
    if found.is_non_orientable:
        yield Finding.at_vertices("one side only", tr("The surface is not orientable, like a Möbius strip."))
    if n := len(found.boundary_edges):
        sentence = trn(
            "The surface is open: it has {n:,} boundary edge.",
            "The surface is open: it has {n:,} boundary edges.",
            n,
        ).format(n=n)
        yield Finding.at_vertices("open borders", sentence, first[found.boundary_edges])


def orientation_findings(signed_volume: float | None, area: float) -> Iterator[Finding]:
    """Finding about a negative ``signed_volume``, unless it is within rounding."""
    if signed_volume is not None and signed_volume < 0.0 and not encloses_nothing(signed_volume, area):
        sentence = tr("The surface is inside out: its faces point inwards, and its volume is negative.")
        yield Finding.at_vertices("inside out", sentence)


def nesting_findings(
    mesh: Mesh, F: np.ndarray, component: np.ndarray, areas: np.ndarray
) -> Iterator[Finding]:
    """Findings about closed parts whose volumes are added with the wrong sign.

    A part inside an even number of others should face as the largest one does, and any other as a cavity.

    Parameters
    ----------
    F : (m, 3) int array
        Welded triangles.
    component : (m,) int array
        Connected component of each triangle.
    areas : (m,) float array
        Of the triangles.
    """
    first = mesh.weld.first
    V, size = mesh.V[first], np.bincount(component, areas)
    inside = np.bincount(component, face_volumes(V, F))
    solid = np.flatnonzero([not encloses_nothing(*each) for each in zip(inside, size, strict=True)])
    if not 1 < len(solid) <= _MOST_PARTS:
        return
    order = np.argsort(component, kind="stable")
    every = np.split(F[order], np.cumsum(np.bincount(component))[:-1])
    parts = [every[each] for each in solid]
    depth = _nesting_depths(V, parts)
    if depth is None:
        return
    signs = np.sign(inside[solid])
    largest = int(np.abs(inside[solid]).argmax())
    wrong = signs * (-1.0) ** depth != signs[largest] * (-1.0) ** depth[largest]
    outer, nested = (np.flatnonzero(wrong & (depth % 2 == odd)) for odd in (0, 1))
    if n := len(outer):
        sentence = trn(
            "{n:,} closed part is inside out: its volume is subtracted.",
            "{n:,} closed parts are inside out: their volume is subtracted.",
            n,
        ).format(n=n)
        yield Finding.at_vertices("parts inside out", sentence, mesh.F[np.isin(component, solid[outer])])
    if n := len(nested):
        sentence = trn(
            "{n:,} closed part lies inside another and faces the same way: its volume counts twice.",
            "{n:,} closed parts lie inside others and face the same way: their volume counts twice.",
            n,
        ).format(n=n)
        yield Finding.at_vertices("parts counted twice", sentence, mesh.F[np.isin(component, solid[nested])])


def _nesting_depths(V: np.ndarray, parts: list[np.ndarray]) -> np.ndarray | None:
    """Number of other closed parts around each; None if that takes too long."""
    low, high = np.array([bounding_box(V[part.ravel()]) for part in parts]).transpose(1, 0, 2)
    is_around = np.ones((len(parts), len(parts)), dtype=bool)
    for axis in range(3):
        is_around &= (low[:, None, axis] >= low[:, axis]) & (high[:, None, axis] <= high[:, axis])
    np.fill_diagonal(is_around, False)
    sizes = np.array([len(part) for part in parts])
    if (is_around @ sizes).sum() > _MOST_WINDINGS:
        return None
    depth = np.zeros(len(parts), dtype=np.int64)
    for k, other in np.argwhere(is_around).tolist():
        depth[k] += abs(_winding_number(V, parts[other], V[parts[k][0, 0]])) > 0.5
    return depth


def _winding_number(V: np.ndarray, F: np.ndarray, point: np.ndarray) -> float:
    """Winding number of a closed surface about a point [Van Oosterom & Strackee 1983]."""
    a, b, c = (V[F] - point).transpose(1, 0, 2)
    x, y, z = (np.linalg.norm(each, axis=1) for each in (a, b, c))
    ab, bc, ca = (np.einsum("ij,ij->i", p, q) for p, q in ((a, b), (b, c), (c, a)))
    triple = np.einsum("ij,ij->i", a, np.cross(b, c))
    return float(np.arctan2(triple, x * y * z + ab * z + bc * x + ca * y).sum()) / (2.0 * np.pi)


def component_findings(mesh: Mesh, F: np.ndarray, component: np.ndarray) -> Iterator[Finding]:
    """Finding about separate connected components."""
    of_face = component[F[:, 0]]
    sizes = np.bincount(of_face)
    if (count := np.count_nonzero(sizes)) > 1:
        vertices = mesh.F[of_face != np.argmax(sizes)]
        sentence = tr(
            "{n:,} connected parts; those without base or handle go along with the nearest surface."
        )
        yield Finding.at_vertices(SEPARATE_COMPONENTS, sentence.format(n=count), vertices)


def size_findings(mesh: Mesh) -> Iterator[Finding]:
    """Finding about extreme sizes and distances from the origin."""
    used = mesh.V[used_vertices(mesh.F)]
    size = diagonal(used)
    away = float(np.linalg.norm([x.mean() for x in used.T]))
    if size < _TINY:
        yield Finding.at_vertices(
            "tiny", tr("The mesh is only {size:.3g} across; check its unit.").format(size=size)
        )
    if size > _HUGE:
        yield Finding.at_vertices(
            "huge", tr("The mesh is {size:.3g} across; check its unit.").format(size=size)
        )
    if away > _FAR * size > 0.0:
        sentence = tr(
            "The mesh is {away:.3g} from the origin, {times:,.0f} times its size; single-precision "
            "formats would round it."
        )
        yield Finding.at_vertices("far away", sentence.format(away=away, times=away / size))
