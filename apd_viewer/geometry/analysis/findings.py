"""Findings about a mesh at rest, a sentence each."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from apd_viewer.geometry.analysis.defects import defects
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.weld import TOLERANCE
from apd_viewer.language import tr, trn

# A needle's longest edge is so many times its height.
_NEEDLE = 100.0


# Sizes that are more likely a wrong unit than meant, in whatever unit.
_TINY, _HUGE = 1e-3, 1e6


# So many sizes away from the origin, single precision has lost three digits.
_FAR = 1e3


@dataclass(frozen=True, eq=False)
class Finding:
    """Something unusual about a mesh.

    Attributes
    ----------
    kind : str
        A name for scripts, always the same.
    sentence : str
        What it is, and what comes of it.
    vertices : (k,) int array
        Where: vertices of the file, ascending; empty where it is the whole mesh.
    """

    kind: str
    sentence: str
    vertices: np.ndarray


def _found(kind: str, sentence: str, vertices: np.ndarray | tuple[()] = ()) -> Finding:
    return Finding(kind, sentence, frozen(np.unique(np.asarray(vertices, dtype=np.int64))))


def of_vertices(mesh: Mesh) -> Iterator[Finding]:
    """Findings about coincident and unreferenced vertices, and cracks."""
    weld = mesh.weld
    repeats = np.bincount(weld.inverse, minlength=len(weld.first))[weld.inverse] > 1
    exact = np.ones(len(mesh.V), dtype=bool) if weld.offset is None else ~weld.offset.any(axis=1)
    repeated = int(exact.sum()) - len(weld.first)
    if repeated:
        said = trn(
            "{n:,} vertex repeats the position of another; they move together.",
            "{n:,} vertices repeat the position of another; they move together.",
            repeated,
        ).format(n=repeated)
        yield _found("repeated vertices", said, np.flatnonzero(repeats))
    if weld.offset is not None:
        near = np.flatnonzero(weld.offset.any(axis=1))
        said = trn(
            "{n:,} vertex lies within {part:g} of the mesh's size from another; they move together.",
            "{n:,} vertices lie within {part:g} of the mesh's size from another; they move together.",
            len(near),
        ).format(n=len(near), part=TOLERANCE)
        yield _found("cracks", said, near)
    used = np.zeros(len(mesh.V), dtype=bool)
    used[mesh.F.ravel()] = True
    unused = np.flatnonzero(~used)
    if len(unused):
        said = trn(
            "{n:,} vertex belongs to no face; it goes along with the nearest surface.",
            "{n:,} vertices belong to no face; they go along with the nearest surface.",
            len(unused),
        ).format(n=len(unused))
        yield _found("unreferenced vertices", said, unused)


def of_faces(mesh: Mesh, areas: np.ndarray) -> Iterator[Finding]:
    """Findings about degenerate and sliver triangles."""
    flat = areas == 0.0
    if n := int(flat.sum()):
        said = trn(
            "{n:,} face has no area and no stiffness.", "{n:,} faces have no area and no stiffness.", n
        ).format(n=n)
        yield _found("faces without area", said, mesh.F[flat])
    longest = np.zeros(len(mesh.F))
    for k in range(3):
        edge = mesh.V[mesh.F[:, k]] - mesh.V[mesh.F[:, k - 1]]
        np.maximum(longest, np.einsum("ij,ij->i", edge, edge), out=longest)
    needles = ~flat & (longest > _NEEDLE * 2.0 * areas)
    if n := int(needles.sum()):
        said = trn(
            "{n:,} face is a needle, over {times:g} times as long as high; it bends worse there.",
            "{n:,} faces are needles, over {times:g} times as long as high; it bends worse there.",
            n,
        ).format(n=n, times=_NEEDLE)
        yield _found("needles", said, mesh.F[needles])


def of_joints(mesh: Mesh, F: np.ndarray) -> Iterator[Finding]:
    """Findings about topology: edges, borders, orientation."""
    first = mesh.weld.first
    proper = np.flatnonzero((F[:, 0] != F[:, 1]) & (F[:, 1] != F[:, 2]) & (F[:, 2] != F[:, 0]))
    found = defects(F[proper], len(first))
    if n := len(found.doubled):
        said = trn(
            "{n:,} face repeats another; its area counts twice.",
            "{n:,} faces repeat another; its area counts twice.",
            n,
        ).format(n=n)
        yield _found("doubled faces", said, mesh.F[proper[found.doubled]])
    if n := len(found.crowded):
        said = trn(
            "{n:,} edge has more than two faces: the surface is not manifold there.",
            "{n:,} edges have more than two faces: the surface is not manifold there.",
            n,
        ).format(n=n)
        yield _found("crowded edges", said, first[found.crowded])
    if n := len(found.bow_ties):
        said = trn(
            "{n:,} vertex joins surfaces that meet nowhere else around it.",
            "{n:,} vertices join surfaces that meet nowhere else around it.",
            n,
        ).format(n=n)
        yield _found("bow ties", said, first[found.bow_ties])
    if n := len(found.flipped):
        said = trn(
            "{n:,} face looks the other way than the surface around: there is no volume.",
            "{n:,} faces look the other way than the surface around: there is no volume.",
            n,
        ).format(n=n)
        yield _found("flipped faces", said, mesh.F[proper[found.flipped]])
    if found.one_sided:
        yield _found("one side only", tr("The surface has one side only, like a Möbius strip."))
    if n := len(found.border):
        said = trn(
            "The surface is open: it has {n:,} border edge.",
            "The surface is open: it has {n:,} border edges.",
            n,
        ).format(n=n)
        yield _found("open borders", said, first[found.border])


def of_pieces(mesh: Mesh, F: np.ndarray, piece: np.ndarray) -> Iterator[Finding]:
    """Finding about separate pieces."""
    names, sizes = np.unique(piece[F[:, 0]], return_counts=True)
    if len(names) > 1:
        others = np.setdiff1d(names, names[np.argmax(sizes)])
        vertices = mesh.F[np.isin(piece[F[:, 0]], others)]
        said = tr("There are {n:,} separate pieces; one that is not held stays where it is.")
        yield _found("separate pieces", said.format(n=len(names)), vertices)


def of_size(mesh: Mesh) -> Iterator[Finding]:
    """Finding about extreme sizes and distances from the origin."""
    mask = np.zeros(len(mesh.V), dtype=bool)
    mask[mesh.F.ravel()] = True
    used = mesh.V[mask]
    size = float(np.linalg.norm(np.ptp(used, axis=0)))
    away = float(np.linalg.norm(used.mean(axis=0)))
    if size < _TINY:
        yield _found("tiny", tr("The mesh is only {size:.3g} across; check its unit.").format(size=size))
    if size > _HUGE:
        yield _found("huge", tr("The mesh is {size:.3g} across; check its unit.").format(size=size))
    if away > _FAR * size > 0.0:
        said = tr(
            "The mesh lies {away:.3g} from the origin, {times:,.0f} times its size; "
            "formats in single precision would round it."
        )
        yield _found("far away", said.format(away=away, times=away / size))
