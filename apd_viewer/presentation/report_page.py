"""Content of a report: measurements, settings, mesh and versions; no Qt."""

from __future__ import annotations

import math
import platform
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import datetime
from importlib import metadata
from typing import TYPE_CHECKING

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.html_page import Attached, Block, Command, Note, Page, PageSection, PictureRow, Table
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE
from apd_viewer.geometry.pose.transforms import decomposed
from apd_viewer.language import tr, trn
from apd_viewer.presentation import readings
from apd_viewer.presentation.number_format import short, significant
from apd_viewer.session.model.status_text import of_crossings
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.wall_mass import Wall, mass

if TYPE_CHECKING:
    from apd_viewer.files.fingerprint import Fingerprint
    from apd_viewer.files.html_page import Drawing
    from apd_viewer.geometry.analysis.area_change import LocalChange
    from apd_viewer.geometry.analysis.shape_check import Examination
    from apd_viewer.session.model.document import State

_LIBRARIES = (
    "numpy",
    "scipy",
    "numba",
    "cholespy",
    "trimesh",
    "fast-simplification",
    "ipctk",
    "pyvista",
    "vtk",
    "PySide6_Essentials",
)
_RIGID = 1e-9  # of the matrix of a motion: less of a scale is rounding
_DIGITS = 8  # of numbers by which something is done again
_ROUNDING = 1e-12  # of the size of a mesh


@dataclass(frozen=True, eq=False)
class Subject:
    """Subject of a report: state, view and measurements.

    Attributes
    ----------
    state : State
    unit : Unit
    wall : Wall
    found, at_rest : Examination or None
        Of the shape, and of the mesh at rest; None where nobody has looked yet.
    moment : datetime
        When it was asked for.
    """

    state: State
    unit: Unit
    wall: Wall
    found: Examination | None
    at_rest: Examination | None
    moment: datetime


@dataclass(frozen=True, eq=False)
class Evidence:
    """Measurements that take long.

    Attributes
    ----------
    change : LocalChange
    file : Fingerprint or None
        None where the mesh came from no file.
    session : bytes
        A session with all of it, as a file; empty where it is too long.
    """

    change: LocalChange
    file: Fingerprint | None
    session: bytes


def page_of(subject: Subject, evidence: Evidence, pictures: PictureRow, histogram: Drawing | None) -> Page:
    """Build the whole report."""
    state, unit = subject.state, subject.unit
    date = subject.moment.strftime("%Y-%m-%d %H:%M")
    parts = [
        PageSection(tr("Shape"), (*_warnings(state), pictures), wide=True),
        PageSection(tr("Area"), (Table(tuple(_area(state, unit))),)),
        PageSection(tr("Volume"), (Table(tuple(_volume(subject))),)),
        PageSection(tr("Size and mass"), tuple(_size(subject))),
        PageSection(tr("Settings and targets"), tuple(_asked(state))),
        PageSection(tr("Handles"), (Table(tuple(_handles(state, unit))),)),
        PageSection(tr("Regions"), tuple(_regions(state, unit))),
        PageSection(tr("Local area change"), tuple(_local_change(evidence.change, histogram)), wide=True),
        PageSection(tr("Mesh check"), tuple(_findings(subject)), wide=True),
        PageSection(tr("Mesh and file"), tuple(_mesh(state, unit, evidence.file))),
        PageSection(tr("Versions"), (Table(tuple(_versions())),)),
        PageSection(tr("How to reproduce it"), tuple(_again(state, evidence)), wide=True),
    ]
    name = state.document.mesh.name
    return Page(
        title=name,
        subtitle=tr("Report of a deformation, {date}").format(date=date),
        hero=(readings.area_percent(state), tr("area: {verdict}").format(verdict=readings.verdict(state))),
        parts=tuple(parts),
        foot=tr("Created with APD Viewer {version}.").format(version=_version("apd-viewer")),
    )


def _warnings(state: State) -> Iterator[Block]:
    if not state.frame.settled:
        yield Note(tr("The shape had not converged when this report was created."), warns=True)
    if state.frame.unreached:
        yield Note(state.frame.unreached, warns=True)


def _area(state: State, unit: Unit) -> Iterator[tuple[str, str, str]]:
    yield tr("Area"), readings.area_percent(state), readings.area(state, unit)
    yield tr("Change"), readings.verdict(state), ""
    yield tr("Largest local area change"), readings.local_change(state), ""


def _volume(subject: Subject) -> Iterator[tuple[str, str, str]]:
    said = readings.volume(subject.state, subject.unit)
    yield tr("Volume"), said.change, said.sizes
    for line in said.more:
        yield "", line, ""
    yield tr("Self-intersections"), _crossing(subject.found), ""


def _crossing(found: Examination | None) -> str:
    if found is None:
        return tr("not checked yet")
    if found.crossing is None:
        return tr("not checked: ipctk is missing")
    n = len(found.crossing)
    return trn("{n:,} triangle", "{n:,} triangles", n).format(n=n) if n else tr("none")


def _size(subject: Subject) -> Iterator[Block]:
    state, unit, found, rest = subject.state, subject.unit, subject.found, subject.at_rest
    extent = readings.extent(found, unit), ""
    box = readings.room(getattr(found, "box", None), getattr(rest, "box", None), unit)
    packed = readings.room(getattr(found, "packed", None), getattr(rest, "packed", None), unit)
    if found is None:  # on paper there is nothing to come
        extent = box = packed = tr("not measured yet"), ""
    try:
        grams, problem = mass(subject.wall, state.frame.area, unit), ""
    except InputError as error:
        grams, problem = None, str(error)
    wall = ", ".join(text.strip() for text in subject.wall if text.strip())
    yield Table(
        (
            (tr("Bounding box"), *extent),
            (tr("Bounding box volume"), *box),
            (tr("Smallest box volume"), *packed),
            (tr("Compactness"), *readings.compact(state)),
            (tr("Wall"), wall or readings.NOTHING, ""),
            (tr("Mass"), readings.weight(grams), problem),
        )
    )


def _asked(state: State) -> Iterator[Block]:
    document = state.document
    method = document.traits
    rows = [(tr("Method"), method.title, method.about)]
    area, volume, *_ = document.kept
    rows.append((tr("Area target"), tr("free") if area is None else f"{area:g} %", ""))
    rows.append((tr("Volume target"), tr("free") if volume is None else f"{volume:g} %", ""))
    if method.has_tolerance:
        rows.append((tr("Tolerance"), f"{short(100 * document.tolerance)} %", ""))
    if method.has_moduli:
        rows.append((tr("Area stiffness"), f"{document.area_stiffness:g}", ""))
        rows.append((tr("Shear stiffness"), f"{document.shear_stiffness:g}", ""))
    rows.append((tr("Stiffness"), f"{document.stiffness:g}", ""))
    yield Table(tuple(rows))


def _handles(state: State, unit: Unit) -> Iterator[tuple[str, str, str]]:
    document, size = state.document, max(state.inspection.size)
    for k, handle in enumerate(document.handles):
        count, centre = int(document.counts[HANDLE + k]), document.centre(k)
        if centre is None:
            yield handle.name, tr("not painted"), ""
            continue
        said = [trn("{n:,} vertex", "{n:,} vertices", count).format(n=count)]
        said += _motion(handle.pose, centre, unit, size)
        pivot = document.pivot(k)
        if handle.pivot is not None and pivot is not None:
            said.append(tr("pivot {point}").format(point=unit.length(_vector(pivot, size))))
        if handle.falloff:
            said.append(tr("falloff {length}").format(length=unit.length(significant(handle.falloff, 4))))
        yield handle.name, readings.motion(document, k, unit, size), "; ".join(said)
    yield tr("Drift"), readings.drift(state, unit), ""
    counts = document.counts
    painted = {tr("Base"): counts[BASE], tr("Free"): counts[FREE]}
    for name, n in painted.items():
        yield name, trn("{n:,} vertex", "{n:,} vertices", int(n)).format(n=int(n)), ""


def _motion(pose: np.ndarray, centre: np.ndarray, unit: Unit, size: float) -> Iterator[str]:
    """Reproducible motion: displacement of the centre, axis and angle, and scale."""
    if np.array_equal(pose, np.eye(4)):
        return
    left, scale, right = np.linalg.svd(pose[:3, :3])
    rigid = np.eye(4)
    rigid[:3, :3] = left @ np.diag([1.0, 1.0, np.linalg.det(left @ right)]) @ right
    turn = decomposed(rigid, centre)
    displacement = (pose[:3, :3] - np.eye(3)) @ centre + pose[:3, 3]
    yield tr("displacement {vector}").format(vector=unit.length(_vector(displacement, size)))
    if turn.angle > 0.0:
        angle = f"{math.degrees(turn.angle):.6f}".rstrip("0").rstrip(".")
        yield tr("axis {vector}, angle {angle}°").format(vector=_vector(turn.axis), angle=angle)
    if np.abs(scale - 1.0).max() > _RIGID:
        factors = scale[:1] if np.ptp(scale) <= _RIGID else scale
        yield tr("scaled by {factors}").format(factors=" × ".join(f"{factor:.6g}" for factor in factors))


def _vector(x: np.ndarray, size: float = 1.0) -> str:
    """Coordinates with enough digits to reproduce them; rounding errors become zero."""
    least = _ROUNDING * size
    return "(" + ", ".join(f"{c:.{_DIGITS}g}".replace("-", "−") if abs(c) > least else "0" for c in x) + ")"


def _regions(state: State, unit: Unit) -> Iterator[Block]:
    regions = state.document.regions
    if not regions:
        yield Note(tr("There are no regions."))
        return
    rows = []
    for region, (area, sizes) in zip(regions, readings.regions(state, unit), strict=False):
        more = sizes
        if region.area is not None and not state.document.traits.keeps_only_total_area:
            more = tr("{sizes}; target {percent} %").format(sizes=sizes, percent=f"{region.area:g}")
        rows.append((region.name, area, more))
    yield Table(tuple(rows))


def _local_change(change: LocalChange, histogram: Drawing | None) -> Iterator[Block]:
    if histogram is not None:
        yield histogram
    rows = (
        (tr("Mean"), change.mean),
        (tr("99 % of the surface within"), change.p99),
        (tr("Largest"), change.largest),
    )
    yield Table(tuple((name, f"{short(100.0 * value)} %", "") for name, value in rows))


def _findings(subject: Subject) -> Iterator[Block]:
    state, found = subject.state, subject.found
    crossings = of_crossings(state.document.mesh, None if found is None else found.crossing)
    findings = *state.inspection.findings, *crossings
    for finding in findings:
        yield Note(finding.sentence)
    if not findings:
        yield Note(tr("No issues"))


def _mesh(state: State, unit: Unit, file: Fingerprint | None) -> Iterator[Block]:
    mesh, found = state.document.mesh, state.inspection
    rows = [(tr("File"), tr("none: the mesh was in memory") if file is None else file.place, "")]
    if file is not None and file.size is None:
        rows.append(("", tr("It can no longer be read."), ""))
    elif file is not None:
        rows.append((tr("Size"), tr("{n:,} bytes").format(n=file.size), ""))
        rows.append((tr("SHA-256 of the file"), file.sha256, ""))
    rows += [
        (tr("Mesh digest"), mesh.digest, tr("SHA-256 of positions and triangles at rest")),
        (tr("Vertices"), f"{found.vertices:,}", ""),
        (tr("Faces"), f"{found.faces:,}", ""),
        (tr("Connected parts"), f"{found.pieces:,}", ""),
        (tr("Size at rest"), unit.length(" × ".join(short(side) for side in found.size)), ""),
        (tr("Unit of length"), unit.title, ""),
    ]
    yield Table(tuple(rows))


def _versions() -> Iterator[tuple[str, str, str]]:
    yield "APD Viewer", _version("apd-viewer"), ""
    yield "Python", platform.python_version(), platform.python_implementation()
    yield tr("Platform"), platform.platform(), ""
    libraries = [f"{name} {_version(name)}" for name in _LIBRARIES]
    yield tr("Libraries"), ", ".join(libraries), ""


def _version(name: str) -> str:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return readings.NOTHING


def _again(state: State, evidence: Evidence) -> Iterator[Block]:
    """Instructions to reproduce the shape from the session in the page."""
    mesh = state.document.mesh
    suffix = mesh.origin.suffix if mesh.origin is not None else ".obj"
    if evidence.session:
        size = tr("{n:,} bytes").format(n=len(evidence.session))
        yield Note(tr("This session contains the mesh, the settings and the shape; open it with APD Viewer."))
        yield Attached("report.apd", evidence.session, size)
    else:
        yield Note(tr("The session is too large for this page; save it as report.apd, including the mesh."))
    yield Note(
        tr(
            "This command repeats the deformation from the rest shape without a window; a large "
            "motion made in steps may end in another shape."
        )
    )
    yield Command(f"apd-viewer replay report.apd --from-rest -o deformed{suffix} --report deformed.json")
