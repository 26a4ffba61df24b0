"""Report blocks: mesh file, versions and the way to repeat it."""

from __future__ import annotations

import platform
from collections.abc import Iterator
from dataclasses import dataclass
from importlib import metadata

from apd_viewer.files.html_page import PageAttachment, PageBlock, PageCommand, PageNote, PageTable
from apd_viewer.files.known_file import Fingerprint
from apd_viewer.geometry.analysis.area_change import LocalChange
from apd_viewer.language import tr
from apd_viewer.presentation import readings
from apd_viewer.presentation.number_format import format_grouped, format_short
from apd_viewer.session.model.state import State
from apd_viewer.session.quantities.units import Unit

_LIBRARIES = (
    "numpy",
    "scipy",
    "numba",
    "cholespy",
    "trimesh",
    "fast-simplification",
    "ipctk",
    "potpourri3d",
    "pyvista",
    "vtk",
    "PySide6_Essentials",
)


@dataclass(frozen=True, eq=False)
class ReportReadings:
    """Slow measurements for a report.

    Attributes
    ----------
    change : LocalChange
    file : Fingerprint or None
        None where the mesh came from no file.
    session : bytes
        A session with all of it, as a file; empty where it is too long.
    target_distances : dict of str to float, or None
        Distances from the target shape: see :func:`apd_viewer.files.report.apart_of`.
    """

    change: LocalChange
    file: Fingerprint | None
    session: bytes
    target_distances: dict[str, float] | None


def mesh_blocks(state: State, unit: Unit, file: Fingerprint | None) -> Iterator[PageBlock]:
    """Blocks on the mesh file and its contents."""
    mesh, found = state.document.mesh, state.inspection
    rows = [(tr("File"), tr("none: the mesh was in memory") if file is None else file.place, "")]
    if file is not None and file.size is None:
        rows.append(("", tr("It can no longer be read."), ""))
    elif file is not None:
        rows.append((tr("Size"), tr("{n:,} bytes").format(n=file.size), ""))
        rows.append((tr("SHA-256 of the file"), file.sha256, ""))
    rows += [
        (tr("Mesh digest"), mesh.digest, tr("SHA-256 of positions and triangles at rest")),
        (tr("Vertices"), format_grouped(found.vertices, 0), ""),
        (tr("Faces"), format_grouped(found.faces, 0), ""),
        (tr("Connected parts"), format_grouped(found.components, 0), ""),
        (tr("Size at rest"), unit.format_length(" × ".join(format_short(side) for side in found.size)), ""),
        (tr("Unit of length"), unit.title, tr("a guess that nobody confirmed") if unit.is_guess else ""),
    ]
    yield PageTable(tuple(rows))


def version_rows() -> Iterator[tuple[str, str, str]]:
    """Rows of the program, Python and libraries with their versions."""
    yield "APD Viewer", version_of("apd-viewer"), ""
    yield "Python", platform.python_version(), platform.python_implementation()
    yield tr("Platform"), platform.platform(), ""
    libraries = [f"{name} {version_of(name)}" for name in _LIBRARIES]
    yield tr("Libraries"), ", ".join(libraries), ""


def version_of(name: str) -> str:
    """Version of an installed distribution, or a dash."""
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return readings.NO_VALUE


def reproduction_blocks(state: State, readings: ReportReadings) -> Iterator[PageBlock]:
    """Instructions to reproduce the shape from the session in the page."""
    mesh = state.document.mesh
    suffix = mesh.origin.suffix if mesh.origin is not None else ".obj"
    if readings.session:
        size = tr("{n:,} bytes").format(n=len(readings.session))
        yield PageNote(
            tr("This session contains the mesh, the settings and the shape; open it with APD Viewer.")
        )
        yield PageAttachment("report.apd", readings.session, size)
    else:
        yield PageNote(
            tr("The session is too large for this page; save it as report.apd, including the mesh.")
        )
    yield PageNote(
        tr(
            "This command repeats the deformation from the rest shape without a window; a large "
            "motion made in steps may end in another shape."
        )
    )
    yield PageCommand(f"apd-viewer replay report.apd --from-rest -o deformed{suffix} --report deformed.json")
