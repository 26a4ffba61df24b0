"""CAD models as meshes, and even triangles, by the libraries of the extra ``cad``.

The libraries run in child processes: they may crash on damaged files.
"""

import io
import logging
import os
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.formats.polygon_mesh import ParsedMesh
from apd_viewer.files.gltf.gltf_file import GltfFile
from apd_viewer.files.gltf.gltf_reader import read_gltf
from apd_viewer.files.mesh_formats import CAD_FORMATS
from apd_viewer.geometry.mesh.arrays import diagonal, mesh_size
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.installation import missing_extra
from apd_viewer.language import tr

_log = logging.getLogger(__name__)

CHORD_TOLERANCE = 1 / 2000  # largest distance from the surface, relative to the diagonal
_DIVISION_SHARE = 0.25  # of it; the even triangles have the rest
EDGE_LENGTH = 1 / 60  # of even triangles, relative to the diagonal
TIME_LIMIT = 300.0  # seconds for a model
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


def read_cad(content: bytes, suffix: str) -> ParsedMesh:
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
    found = _run_job(content, "divide", kind.lower(), str(_DIVISION_SHARE * CHORD_TOLERANCE))
    if found is None or not len(found["F"]):
        raise ValueError(tr("it is damaged, or has no surface"))
    V, F, size = found["V"], found["F"], mesh_size(found["V"], found["F"])
    chord, edge = CHORD_TOLERANCE * size, EDGE_LENGTH * size
    even = (
        _run_job(_packed(V, F), "remesh", str(edge), str((1.0 - _DIVISION_SHARE) * chord))
        if find_spec("mmgpy")
        else None
    )
    if even is None or not len(even["F"]):
        remark = tr(
            "The CAD model was divided within {chord:.3g} mm of its surface; its triangles may be needles."
        )
        return ParsedMesh(V, F, None, (remark.format(chord=chord),), "mm")
    remark = tr(
        "The CAD model was divided within {chord:.3g} mm of its surface, into even triangles with edges of "
        "about {edge:.3g} mm."
    )
    return ParsedMesh(even["V"], even["F"], None, (remark.format(chord=chord, edge=edge),), "mm")


def even_triangles(
    V: np.ndarray, F: np.ndarray, edge: float | None = None
) -> tuple[np.ndarray, np.ndarray, float]:
    """Another mesh of the same surface with even triangles, and its edge length.

    Parameters
    ----------
    edge : float or None
        Edge length, mesh units; None is 1/60 of the diagonal.

    Raises
    ------
    InputError
        Without the extra, or if the surface cannot be divided.
    """
    check_remeshing()
    size = mesh_size(V, F)
    edge = edge or EDGE_LENGTH * size
    found = _run_job(_packed(V, F), "remesh", str(edge), str(CHORD_TOLERANCE * size))
    if found is None or not len(found["F"]):
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


def _packed(V: np.ndarray, F: np.ndarray) -> bytes:
    packed = io.BytesIO()
    np.savez(packed, V=V, F=F)
    return packed.getvalue()


def _run_job(content: bytes, *arguments: str) -> dict[str, np.ndarray] | None:
    """Arrays that a child process computes; None if it fails."""
    command = [sys.executable, "-c", START_SCRIPT, str(len(arguments)), *arguments, *sys.path]
    try:
        done = subprocess.run(
            command, input=content, capture_output=True, timeout=TIME_LIMIT, creationflags=_FLAGS, check=False
        )
    except subprocess.TimeoutExpired:
        raise InputError(
            tr("The surface takes longer than {n:g} minutes to divide; use a simpler one.").format(
                n=TIME_LIMIT / 60
            )
        ) from None
    if done.returncode:
        words = done.stderr.decode(errors="replace")[-_LAST_WORDS:]
        _log.info("The CAD process ended with exit code %s: %s", done.returncode, words)
        return None
    with np.load(io.BytesIO(done.stdout), allow_pickle=False) as arrays:
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
        arrays = _divided(content, arguments[0], float(arguments[1]))
    else:
        with np.load(io.BytesIO(content), allow_pickle=False) as given:
            arrays = _remeshed(given["V"], given["F"], *map(float, arguments))
    packed = io.BytesIO()
    np.savez(packed, allow_pickle=False, **arrays)
    with os.fdopen(replies, "wb") as stream:
        stream.write(packed.getvalue())


def _divided(content: bytes, kind: str, tolerance: float) -> dict[str, np.ndarray]:
    """Triangles of a CAD model in mm, each part welded by position.

    Parameters
    ----------
    kind : str
        Name of the format: step or iges.
    tolerance : float
        Chord tolerance relative to the diagonal.
    """
    # Imported here, in the child process: the extra may be missing, and a native library may crash.
    import cascadio

    def parts(chord: float) -> list[tuple[np.ndarray, np.ndarray]]:
        glb = cascadio.load(content, kind, tol_linear=chord, tol_angular=_ANGLE, use_parallel=False)
        if not glb:
            raise SystemExit(1)
        V, F, origin, *_ = read_gltf(glb, Path("model.glb"))
        assert isinstance(origin, GltfFile)
        starts = sorted(block.first_vertex for block in origin.blocks)
        part = np.searchsorted(starts, F[:, 0], side="right")
        return [(_MILLIMETRES[kind] * V, F[part == k + 1]) for k in range(len(starts))]

    coarse = parts(_NO_LIMIT)
    chord = tolerance * diagonal(np.vstack([V[np.unique(F)] for V, F in coarse]))
    welded = [_welded(V, F) for V, F in parts(chord) if len(F)]
    first = np.cumsum([0, *(len(V) for V, _ in welded)])
    return {
        "V": np.vstack([V for V, _ in welded]),
        "F": np.vstack([F + k for (_, F), k in zip(welded, first, strict=False)]),
    }


def _welded(V: np.ndarray, F: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Vertices merged by position, and triangles without collapsed ones."""
    used, F = np.unique(F, return_inverse=True)
    mesh = Mesh(V[used], F.reshape(-1, 3))
    F = mesh.joined_F
    F = F[(F[:, 0] != F[:, 1]) & (F[:, 1] != F[:, 2]) & (F[:, 2] != F[:, 0])]
    used, F = np.unique(F, return_inverse=True)
    return mesh.V[used], F.reshape(-1, 3)


def _remeshed(V: np.ndarray, F: np.ndarray, edge: float, chord: float) -> dict[str, np.ndarray]:
    """Even triangles within ``chord`` of a surface, with edges of about ``edge``."""
    import mmgpy  # imported here for the same reason

    V, F = _welded(V, F)
    surface = mmgpy.MmgMeshS(V, F.astype(np.int32))
    surface.remesh(
        hmax=_LONGEST * edge, hmin=_SHORTEST * edge, hausd=chord, ar=_RIDGE, hgrad=_GRADATION, verbose=-1
    )
    return {"V": np.array(surface.get_vertices()), "F": np.array(surface.get_triangles(), dtype=np.int64)}
