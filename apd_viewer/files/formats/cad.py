"""CAD models as meshes, and even triangles, by the libraries of the extra ``cad``.

The libraries run in child processes: they may crash on damaged files.
"""

import io
import logging
import os
import subprocess
import sys
import threading
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

import numpy as np

from apd_viewer.errors import InputError, is_cancelled
from apd_viewer.files.formats.ply import ply_content, read_ply
from apd_viewer.files.formats.polygon_mesh import ParsedMesh, PartsOrigin, distinct_names, linear_to_srgb
from apd_viewer.files.gltf.gltf_file import GltfFile
from apd_viewer.files.gltf.gltf_reader import mesh_instances, read_gltf
from apd_viewer.files.gltf.scene import mesh_primitives, world_matrices
from apd_viewer.files.mesh_formats import CAD_FORMATS
from apd_viewer.files.selections.selection import MOST_REGIONS
from apd_viewer.geometry.mesh.arrays import diagonal, mesh_size, used_vertices
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.normals import vertex_normals
from apd_viewer.installation import missing_extra
from apd_viewer.language import comma_separated, tr

_log = logging.getLogger(__name__)

CHORD_TOLERANCE = 1 / 2000  # largest distance from the surface, relative to the diagonal
_DIVISION_SHARE = 0.25  # of it; the even triangles have the rest
EDGE_LENGTH = 1 / 60  # of even triangles, relative to the diagonal
TIME_LIMIT = 300.0  # seconds for a model
_PAUSE = 0.1  # seconds until it is asked again whether the work was cancelled
_MOST_TRIANGLES = 2_000_000
_GREY = 200  # of parts without a colour, beside others that have one
# Run with -c instead of -m, which would import from the current folder. Output of the libraries goes to
# standard error, never into the reply.
START_SCRIPT = """
import os, sys
replies, words = os.dup(1), int(sys.argv[1]) + 2
os.dup2(2, 1)
arguments, sys.path[:] = sys.argv[2:words], sys.argv[words:]
from apd_viewer.files.formats.cad import run_child
run_child(replies, *arguments)
"""
_FLAGS = getattr(subprocess, "CREATE_NO_WINDOW", 0)  # exists only on Windows
_LAST_WORDS = 500  # characters of the output of a failed process in the log


class CadDivision(NamedTuple):
    """Lengths in mm by which a CAD model is divided; None is relative to its diagonal.

    Attributes
    ----------
    chord : float or None
        Largest distance from its surface; None is 1/2,000.
    edge : float or None
        Edge length of the even triangles; 0 leaves those of the library, None is 1/60.
    """

    chord: float | None = None
    edge: float | None = None


BY_DEFAULT = CadDivision()


def read_cad(content: bytes, suffix: str, division: CadDivision = BY_DEFAULT) -> ParsedMesh:
    """Mesh in mm of a STEP or IGES file, with even triangles where mmgpy is installed.

    Parameters
    ----------
    suffix : str
        Of CAD_FORMATS.

    Raises
    ------
    InputError
        Without the extra.
    ValueError
        If no surface can be read.
    """
    kind = CAD_FORMATS[suffix].name
    _check_installed("cascadio", tr("{kind} files").format(kind=kind))
    relative, absolute = (CHORD_TOLERANCE, 0.0) if division.chord is None else (0.0, division.chord)
    shares = (_DIVISION_SHARE * relative, _DIVISION_SHARE * absolute)
    found = _run_job(content, "divide", kind.lower(), *map(str, shares))
    if found is None or not len(found["F"]):
        raise ValueError(tr("it is damaged, or has no surface"))
    size = mesh_size(found["V"], found["F"])
    chord, edge = relative * size + absolute, EDGE_LENGTH * size if division.edge is None else division.edge
    arrays = found["V"], found["F"], found["style"]
    even = _even(*arrays, edge, (1.0 - _DIVISION_SHARE) * chord) if edge and find_spec("mmgpy") else None
    if even is None:
        remark = tr(
            "The CAD model was divided within {chord:.3g} mm of its surface; its triangles may be needles."
        )
        return _with_parts(*arrays, found, remark.format(chord=chord))
    remark = tr(
        "The CAD model was divided within {chord:.3g} mm of its surface, into even triangles with edges of "
        "about {edge:.3g} mm."
    )
    return _with_parts(even["V"], even["F"], even["style"], found, remark.format(chord=chord, edge=edge))


def _even(
    V: np.ndarray, F: np.ndarray, style: np.ndarray, edge: float, chord: float
) -> dict[str, np.ndarray] | None:
    """Arrays of even triangles; None if the surface cannot be divided into them."""
    area = 0.5 * float(np.linalg.norm(_twice_areas(V, F), axis=1).sum())
    least = (area / _MOST_TRIANGLES) ** 0.5
    if edge < least:
        raise InputError(tr("Enter an edge length of at least {least:.2g}.").format(least=least))
    packed = io.BytesIO()
    np.savez(packed, V=V, F=F, style=style)
    found = _run_job(packed.getvalue(), "remesh", str(edge), str(chord))
    return found if found is not None and len(found["F"]) else None


def _twice_areas(V: np.ndarray, F: np.ndarray) -> np.ndarray:
    """Vectors (m, 3) across the triangles, as long as twice their areas."""
    across: np.ndarray = np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]])
    return across


def _with_parts(
    V: np.ndarray, F: np.ndarray, style: np.ndarray, model: dict[str, np.ndarray], remark: str
) -> ParsedMesh:
    """Mesh in mm of triangles with styles (m,), with the colours and parts of a model."""
    names, part, colors = model["names"].tolist(), model["part"], model["colors"]
    if len(names) < 2 and (colors < 0).all():
        return ParsedMesh(V, F, None, (remark,), "mm")
    of_vertex = np.zeros(len(V), dtype=np.int64)
    of_vertex[F] = style[:, None]
    shown = None
    if (colors >= 0).any():
        shown = np.where(colors < 0, _GREY, colors).astype(np.uint8)[of_vertex]
    origin = read_ply(ply_content(V, F, shown)).origin
    assert origin is not None
    if len(names) < 2:
        return ParsedMesh(V, F, origin, (remark,), "mm")
    areas = np.bincount(part[style], np.linalg.norm(_twice_areas(V, F), axis=1), len(names))
    largest = np.sort(np.argsort(-areas, kind="stable")[:MOST_REGIONS])
    number = np.zeros(len(names), dtype=np.uint8)
    number[largest] = np.arange(1, len(largest) + 1)
    regions = distinct_names([names[k] for k in largest])
    said = tr("Its {n:,} parts are regions: {names}.")
    if len(names) > MOST_REGIONS:
        said = tr("Of its {n:,} parts the largest are regions: {names}.")
    remarks = remark, said.format(n=len(names), names=comma_separated(regions))
    return ParsedMesh(V, F, PartsOrigin(origin, tuple(regions), number[part[of_vertex]]), remarks, "mm")


def even_triangles(
    V: np.ndarray, F: np.ndarray, edge: float | None = None, chord: float | None = None
) -> tuple[np.ndarray, np.ndarray, float]:
    """Another mesh of the same surface with even triangles, and its edge length.

    Parameters
    ----------
    edge : float or None
        Edge length, mesh units; None is 1/60 of the diagonal.
    chord : float or None
        Largest distance from the surface, mesh units; None is 1/2,000 of the diagonal.

    Raises
    ------
    InputError
        Without the extra, or if the surface cannot be divided.
    """
    check_remeshing()
    size = mesh_size(V, F)
    edge = edge or EDGE_LENGTH * size
    found = _even(V, F, np.zeros(len(F), dtype=np.int64), edge, chord or CHORD_TOLERANCE * size)
    if found is None:
        raise InputError(
            tr("The surface cannot be divided into even triangles; check it with apd-viewer info.")
        )
    return found["V"], found["F"], edge


def check_remeshing() -> None:
    """Raise InputError unless the library for even triangles is installed."""
    _check_installed("mmgpy", tr("Even triangles"))


def _check_installed(library: str, what: str) -> None:
    if find_spec(library) is None:
        raise missing_extra(what, "cad")


def _run_job(content: bytes, *arguments: str) -> dict[str, np.ndarray] | None:
    """Arrays that a child process computes; None if it fails."""
    command = [sys.executable, "-c", START_SCRIPT, str(len(arguments)), *arguments, *sys.path]
    pipe, cancelled, done = subprocess.PIPE, is_cancelled.get(), threading.Event()
    process = subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=pipe, creationflags=_FLAGS)

    def watch() -> None:
        while not done.wait(_PAUSE):
            if cancelled():
                process.kill()

    watcher = threading.Thread(target=watch, daemon=True)
    watcher.start()
    try:
        output, words = process.communicate(content, timeout=TIME_LIMIT)
    except subprocess.TimeoutExpired:
        raise InputError(
            tr("The surface takes longer than {n:g} minutes to divide; use a simpler one.").format(
                n=TIME_LIMIT / 60
            )
        ) from None
    finally:
        done.set()
        watcher.join()
        process.kill()
        with process:  # closes its pipes
            pass
    if process.returncode:
        said = words.decode(errors="replace")[-_LAST_WORDS:]
        _log.info("The CAD process ended with exit code %s: %s", process.returncode, said)
        return None
    with np.load(io.BytesIO(output), allow_pickle=False) as arrays:
        return dict(arrays)


_ANGLE = 0.5  # largest angle in radians between a curve and its chord
_NO_LIMIT = 1e9  # mm; only the angle counts
# Per unit of what cascadio writes: metres of STEP, as GLB has them, but millimetres of IGES.
_MILLIMETRES = {"step": 1e3, "iges": 1.0}
_RIDGE = 40.0  # degrees; sharper edges are kept
_LONGEST, _SHORTEST, _GRADATION = 1.3, 0.1, 1.3  # relative to the edge length; ratio of neighbours


def run_child(replies: int, job: str, *arguments: str) -> None:
    """Run a job on the standard input, and write its arrays to ``replies``."""
    content = sys.stdin.buffer.read()
    if job == "divide":
        arrays = _divided(content, arguments[0], *map(float, arguments[1:]))
    else:
        with np.load(io.BytesIO(content), allow_pickle=False) as given:
            arrays = _remeshed(given["V"], given["F"], given["style"], *map(float, arguments))
    packed = io.BytesIO()
    np.savez(packed, allow_pickle=False, **arrays)
    with os.fdopen(replies, "wb") as stream:
        stream.write(packed.getvalue())


def _divided(content: bytes, kind: str, relative: float, absolute: float) -> dict[str, np.ndarray]:
    """Triangles of a CAD model in mm, each part welded by position.

    Each has a style: a part, and a colour of 0 to 255 in sRGB, or of -1 without one. The parts have names.

    Parameters
    ----------
    kind : str
        Name of the format: step or iges.
    relative, absolute : float
        Chord tolerance: its parts relative to the diagonal and in mm.
    """
    # Imported here, in the child process: the extra may be missing, and a native library may crash.
    import cascadio

    def scene_of(chord: float) -> tuple[np.ndarray, np.ndarray, GltfFile]:
        glb = cascadio.load(content, kind, tol_linear=chord, tol_angular=_ANGLE, use_parallel=False)
        if not glb:
            raise SystemExit(1)
        V, F, origin, *_ = read_gltf(glb, Path("model.glb"))
        assert isinstance(origin, GltfFile)
        return _MILLIMETRES[kind] * V, F, origin

    V, F, _ = scene_of(_NO_LIMIT)
    V, F, file = scene_of(relative * diagonal(V[used_vertices(F)]) + absolute)
    names, part, colors = _styles(file)
    style = np.repeat(np.arange(len(part)), [piece.triangle_count for piece in file.primitives])
    each = [_welded(V, F[own], style[own]) for own in (part[style] == k for k in range(len(names)))]
    first = np.cumsum([0, *(len(V) for V, *_ in each)])
    return {
        "V": np.vstack([V for V, *_ in each]),
        "F": np.vstack([F + k for (_, F, _), k in zip(each, first, strict=False)]),
        "style": np.concatenate([style for *_, style in each]),
        "names": np.array(names),
        "part": part,
        "colors": colors,
    }


def _styles(file: GltfFile) -> tuple[list[str], np.ndarray, np.ndarray]:
    """Names of the parts; part (s,) and colour (s, 3) of each primitive."""
    document, names, part, colors = file.document, list[str](), list[int](), list[np.ndarray]()
    materials = document.get("materials", [])
    for place in mesh_instances(document, file.buffers, world_matrices(document)):
        for primitive in mesh_primitives(document, place.mesh):
            part.append(len(names))
            look = materials[primitive["material"]] if "material" in primitive else {}
            linear = look.get("pbrMetallicRoughness", {}).get("baseColorFactor")
            colors.append(np.full(3, -1) if linear is None else linear_to_srgb(np.array(linear[:3])))
        names.append(str(document["meshes"][place.mesh].get("name", "")))
    return names, np.array(part, dtype=np.int64), np.array(colors, dtype=np.int64).reshape(-1, 3)


def _welded(V: np.ndarray, F: np.ndarray, style: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Vertices merged by position, and triangles without collapsed ones."""
    used, F = np.unique(F, return_inverse=True)
    mesh = Mesh(V[used], F.reshape(-1, 3))
    F = mesh.joined_F
    proper = (F[:, 0] != F[:, 1]) & (F[:, 1] != F[:, 2]) & (F[:, 2] != F[:, 0])
    used, F = np.unique(F[proper], return_inverse=True)
    return mesh.V[used], F.reshape(-1, 3), style[proper]


def _remeshed(
    V: np.ndarray, F: np.ndarray, style: np.ndarray, edge: float, chord: float
) -> dict[str, np.ndarray]:
    """Even triangles within ``chord`` of a surface, with edges of about ``edge``."""
    import mmgpy  # imported here for the same reason

    V, F, style = _welded(V, F, style)
    surface = mmgpy.MmgMeshS(V, F.astype(np.int32))
    surface.set_triangles(F.astype(np.int32), style.astype(np.int32))
    # Weighted by area, unlike its own, which lift flat faces off their place beside needles of a fillet.
    surface.set_normal_at_vertices(np.arange(len(V), dtype=np.int32), vertex_normals(V, F))
    surface.remesh(
        hmax=_LONGEST * edge, hmin=_SHORTEST * edge, hausd=chord, ar=_RIDGE, hgrad=_GRADATION, verbose=-1
    )
    found, style = surface.get_triangles_with_refs()
    return {
        "V": np.array(surface.get_vertices()),
        "F": found.astype(np.int64),
        "style": style.astype(np.int64),
    }
