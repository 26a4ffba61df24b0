"""What is in a mesh, what is unusual about it, and what is done about that."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from apd_viewer.geometry.defects import defects
from apd_viewer.geometry.mesh import TOLERANCE, Mesh, counted, frozen
from apd_viewer.geometry.operators import face_areas, volume, why_no_volume
from apd_viewer.geometry.pieces import pieces

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


@dataclass(frozen=True)
class Inspection:
    """Counts and readings of a mesh at rest, and what is unusual about it.

    Attributes
    ----------
    vertices, faces : int
        As the file has them.
    pieces : int
        Connected pieces of the surface, after vertices at the same position are joined.
    area, volume : float
        Square and cubic mesh units; volume is None where ``why_no_volume`` says why.
    size : tuple of float
        Extent along x, y and z.
    findings : tuple of Finding
    """

    vertices: int
    faces: int
    pieces: int
    area: float
    volume: float | None
    why_no_volume: str | None
    size: tuple[float, float, float]
    findings: tuple[Finding, ...]


def inspect(mesh: Mesh) -> Inspection:
    """Inspect the mesh as it came from its file."""
    first, inverse = mesh.weld.first, mesh.weld.inverse
    F = inverse[mesh.F]
    why = why_no_volume(F, len(first))
    areas = face_areas(mesh.V, mesh.F)
    piece = pieces(F, len(first))
    dx, dy, dz = (float(extent) for extent in np.ptp(mesh.V, axis=0))
    return Inspection(
        vertices=len(mesh.V),
        faces=len(mesh.F),
        pieces=len(np.unique(piece[F[:, 0]])),
        area=float(areas.sum()),
        volume=None if why else volume(mesh.V, mesh.F),
        why_no_volume=why,
        size=(dx, dy, dz),
        findings=(
            *_of_vertices(mesh),
            *_of_faces(mesh, areas),
            *_of_joints(mesh, F),
            *_of_pieces(mesh, F, piece),
            *_of_size(mesh),
        ),
    )


def _found(kind: str, sentence: str, vertices: np.ndarray | tuple[()] = ()) -> Finding:
    return Finding(kind, sentence, frozen(np.unique(np.asarray(vertices, dtype=np.int64))))


def _of_vertices(mesh: Mesh) -> Iterator[Finding]:
    weld = mesh.weld
    repeats = np.bincount(weld.inverse, minlength=len(weld.first))[weld.inverse] > 1
    exact = np.ones(len(mesh.V), dtype=bool) if weld.offset is None else ~weld.offset.any(axis=1)
    repeated = int(exact.sum()) - len(weld.first)
    if repeated:
        said = counted(repeated, "vertex repeats", "vertices repeat")
        yield _found(
            "repeated vertices",
            f"{said} the position of another; they move together.",
            np.flatnonzero(repeats),
        )
    if weld.offset is not None:
        near = np.flatnonzero(weld.offset.any(axis=1))
        said = counted(len(near), "vertex lies", "vertices lie")
        yield _found(
            "cracks",
            f"{said} within {TOLERANCE:g} of the mesh's size from another; they move together.",
            near,
        )
    used = np.zeros(len(mesh.V), dtype=bool)
    used[mesh.F.ravel()] = True
    unused = np.flatnonzero(~used)
    if len(unused):
        said = counted(len(unused), "vertex belongs", "vertices belong")
        goes = "it goes" if len(unused) == 1 else "they go"
        yield _found(
            "unreferenced vertices", f"{said} to no face; {goes} along with the nearest surface.", unused
        )


def _of_faces(mesh: Mesh, areas: np.ndarray) -> Iterator[Finding]:
    flat = areas == 0.0
    if flat.any():
        said = counted(int(flat.sum()), "face has", "faces have")
        yield _found("faces without area", f"{said} no area and no stiffness.", mesh.F[flat])
    longest = np.zeros(len(mesh.F))
    for k in range(3):
        edge = mesh.V[mesh.F[:, k]] - mesh.V[mesh.F[:, k - 1]]
        np.maximum(longest, np.einsum("ij,ij->i", edge, edge), out=longest)
    needles = ~flat & (longest > _NEEDLE * 2.0 * areas)
    if needles.any():
        said = counted(int(needles.sum()), "face is a needle", "faces are needles")
        yield _found(
            "needles",
            f"{said}, over {_NEEDLE:g} times as long as high; it bends worse there.",
            mesh.F[needles],
        )


def _of_joints(mesh: Mesh, F: np.ndarray) -> Iterator[Finding]:
    first = mesh.weld.first
    proper = np.flatnonzero((F[:, 0] != F[:, 1]) & (F[:, 1] != F[:, 2]) & (F[:, 2] != F[:, 0]))
    found = defects(F[proper], len(first))
    if len(found.doubled):
        said = counted(len(found.doubled), "face repeats", "faces repeat")
        yield _found(
            "doubled faces", f"{said} another; its area counts twice.", mesh.F[proper[found.doubled]]
        )
    if len(found.crowded):
        said = counted(len(found.crowded), "edge has", "edges have")
        yield _found(
            "crowded edges",
            f"{said} more than two faces: the surface is not manifold there.",
            first[found.crowded],
        )
    if len(found.bow_ties):
        said = counted(len(found.bow_ties), "vertex joins", "vertices join")
        yield _found("bow ties", f"{said} surfaces that meet nowhere else around it.", first[found.bow_ties])
    if len(found.flipped):
        said = counted(len(found.flipped), "face looks", "faces look")
        yield _found(
            "flipped faces",
            f"{said} the other way than the surface around: there is no volume.",
            mesh.F[proper[found.flipped]],
        )
    if found.one_sided:
        yield _found("one side only", "The surface has one side only, like a Möbius strip.")
    if len(found.border):
        said = counted(len(found.border), "border edge", "border edges")
        yield _found("open borders", f"The surface is open: it has {said}.", first[found.border])


def _of_pieces(mesh: Mesh, F: np.ndarray, piece: np.ndarray) -> Iterator[Finding]:
    names, sizes = np.unique(piece[F[:, 0]], return_counts=True)
    if len(names) > 1:
        others = np.setdiff1d(names, names[np.argmax(sizes)])
        vertices = mesh.F[np.isin(piece[F[:, 0]], others)]
        yield _found(
            "separate pieces",
            f"There are {len(names):,} separate pieces; one that is not held stays where it is.",
            vertices,
        )


def _of_size(mesh: Mesh) -> Iterator[Finding]:
    mask = np.zeros(len(mesh.V), dtype=bool)
    mask[mesh.F.ravel()] = True
    used = mesh.V[mask]
    size = float(np.linalg.norm(np.ptp(used, axis=0)))
    away = float(np.linalg.norm(used.mean(axis=0)))
    if size < _TINY:
        yield _found("tiny", f"The mesh is only {size:.3g} across; check its unit.")
    if size > _HUGE:
        yield _found("huge", f"The mesh is {size:.3g} across; check its unit.")
    if away > _FAR * size > 0.0:
        yield _found(
            "far away",
            f"The mesh lies {away:.3g} from the origin, {away / size:,.0f} times its size; "
            "formats in single precision would round it.",
        )
