"""Report blocks: settings, handles, regions, mesh file, versions, reproduction."""

import math
import platform
from collections.abc import Iterator
from dataclasses import dataclass
from importlib import metadata
from typing import Any

import numpy as np

from apd_viewer.files.html_page import PageAttachment, PageBlock, PageCommand, PageNote, PageTable
from apd_viewer.files.known_file import Fingerprint
from apd_viewer.geometry.analysis.area_change import LocalChange
from apd_viewer.geometry.analysis.shape_check import ShapeCheck
from apd_viewer.geometry.mesh.arrays import diagonal
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE
from apd_viewer.geometry.solver.settings import SETTINGS, Setting, SettingKind, Settings
from apd_viewer.language import tr, trn
from apd_viewer.notation import localized_number
from apd_viewer.presentation import obstacle_readings, readings
from apd_viewer.presentation.number_format import (
    format_exact,
    format_grouped,
    format_pressure,
    format_short,
    format_significant,
)
from apd_viewer.session.model.document_parts import goal_percentages
from apd_viewer.session.model.handles_and_regions import Handle
from apd_viewer.session.model.state import State
from apd_viewer.session.model.status_text import held_turn_phrase
from apd_viewer.session.quantities.newton_conversion import NewtonConversion, settings_pascals
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.wall import WallText

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
    file : Fingerprint or None
        Fingerprint of the mesh file, if there is one.
    session : bytes
        A session with all of it, as a file; empty where it is too long.
    target_distances : dict of str to float, or None
        Distances from the target shape: see :func:`apd_viewer.files.report.target_distance_fields`.
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
        (tr("Unit of length"), unit.title, tr("an unconfirmed guess") if unit.is_guess else ""),
    ]
    yield PageTable(tuple(rows))


def version_rows() -> Iterator[tuple[str, str, str]]:
    """Rows with the versions of the program, Python and libraries."""
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


_RIGID = 1e-9  # smaller deviations of a pose's scale from 1 are rounding


def settings_blocks(state: State, unit: Unit, wall: WallText) -> Iterator[PageBlock]:
    """Blocks on the method and all settings."""
    document, settings = state.document, state.document.settings
    area, volume, *_ = goal_percentages(document)
    values = {**vars(settings), "area": area, "volume": volume}
    pascals = settings_pascals(settings, diagonal(document.mesh.V), wall, unit)
    if settings.pressure is not None and pascals is not None:
        values["pressure"] = format_pressure(settings.pressure * pascals)
    rows = [
        row
        for name, setting in SETTINGS.items()
        if setting.applies(settings)
        for row in _setting_rows(setting, values[name], settings, unit)
    ]
    if document.loose_components:
        staying = sum(part.first in document.immobile_components for part in document.loose_components)
        sentence = tr("{going:,} go along, {staying:,} stay")
        going = len(document.loose_components) - staying
        rows.append((tr("Loose parts"), sentence.format(going=going, staying=staying), ""))
    yield PageTable(tuple(rows))


def _setting_rows(
    setting: Setting, value: Any, settings: Settings, unit: Unit
) -> Iterator[tuple[str, str, str]]:
    match setting.kind:
        case SettingKind.METHOD:
            yield setting.title, settings.traits.title, settings.traits.description
        case SettingKind.NUMBER:
            yield setting.title, format_exact(value), ""
        case SettingKind.TOLERANCE:
            yield setting.title, f"{format_short(100 * value)} %", ""
        case SettingKind.PERCENTAGE:
            yield setting.title, tr("free") if value is None else f"{format_exact(value)} %", ""
        case SettingKind.SWITCH:
            yield setting.title, tr("yes") if value else tr("no"), ""
        case SettingKind.AMOUNT | SettingKind.PRESSURE:
            if value is not None:
                yield setting.title, value if isinstance(value, str) else format_exact(value), ""
        case SettingKind.VOLUME:
            if value is not None:
                yield setting.title, unit.format_volume(format_significant(value, 4)), ""
        case SettingKind.LENGTH:
            if value is not None:
                yield setting.title, unit.format_length(format_significant(value, 4)), ""
        case SettingKind.CONVERGENCE:
            yield tr("Iteration limit"), format_grouped(value.most_iterations, 0), ""
            if settings.traits.is_plain_only:
                yield tr("Step tolerance"), format_short(value.step_tolerance), ""
            else:
                yield tr("Energy tolerance"), format_short(value.energy_tolerance), ""
                yield tr("Imperfection"), format_short(value.imperfection), ""
                if value.seed:
                    yield tr("Seed"), format_grouped(value.seed, 0), ""


def handle_rows(state: State, unit: Unit, check: ShapeCheck | None = None) -> Iterator[tuple[str, str, str]]:
    """Report rows of the handles with their motions."""
    document, size = state.document.relative_to_rest, max(state.inspection.size)
    for k, handle in enumerate(document.handles):
        count, centre = int(document.label_counts[HANDLE + k]), document.centre(k)
        if centre is None:
            yield handle.name, tr("not painted"), ""
            continue
        parts = [trn("{n:,} vertex", "{n:,} vertices", count).format(n=count)]
        parts += _motion(handle, centre, unit, size)
        if turned := held_turn_phrase(check, k):
            parts.append(turned)
        pivot = document.pivot(k)
        if handle.pivot is not None and pivot is not None:
            parts.append(tr("pivot {point}").format(point=unit.format_length(_vector(pivot, size))))
        if handle.falloff:
            parts.append(
                tr("falloff {length}").format(
                    length=unit.format_length(format_significant(handle.falloff, 4))
                )
            )
        yield handle.name, readings.motion(state, k, unit), "; ".join(parts)
    yield tr("Drift"), readings.drift(state, unit), ""
    counts = document.label_counts
    painted = {tr("Base"): counts[BASE], tr("Free"): counts[FREE]}
    for name, n in painted.items():
        yield name, trn("{n:,} vertex", "{n:,} vertices", int(n)).format(n=int(n)), ""


def _motion(handle: Handle, centre: np.ndarray, unit: Unit, size: float) -> Iterator[str]:
    """Reproducible motion: displacement of the centre, axis and angle, and scale."""
    pose, rotation = handle.pose, handle.rotation
    if np.array_equal(pose, np.eye(4)) and not rotation.any():
        return
    scale, turned = np.linalg.svd(pose[:3, :3])[1], float(np.linalg.norm(rotation))
    displacement = (pose[:3, :3] - np.eye(3)) @ centre + pose[:3, 3]
    yield tr("displacement {vector}").format(vector=unit.format_length(_vector(displacement, size)))
    if turned > 0.0:
        angle = localized_number(f"{math.degrees(turned):.6f}".rstrip("0").rstrip("."))
        yield tr("axis {vector}, angle {angle}°").format(vector=_vector(rotation / turned), angle=angle)
    if np.abs(scale - 1.0).max() > _RIGID:
        factors = scale[:1] if np.ptp(scale) <= _RIGID else scale
        yield tr("scaled by {factors}").format(factors=" × ".join(map(format_exact, factors)))


def _vector(x: np.ndarray, size: float = 1.0) -> str:
    """Coordinates with enough digits to reproduce them; rounding errors become zero."""
    return f"({obstacle_readings.coordinates_text(x, size)})".replace("-", "−")


def obstacle_blocks(state: State, unit: Unit, newtons: NewtonConversion | None = None) -> Iterator[PageBlock]:
    """Blocks on the obstacles with their motions and loads."""
    if not state.document.obstacles:
        yield PageNote(tr("There are no obstacles."))
        return
    yield PageTable(tuple(obstacle_readings.obstacle_report_rows(state, unit, newtons)))
    if why := obstacle_readings.inactive_reason(state):
        yield PageNote(why)


def region_blocks(state: State, unit: Unit) -> Iterator[PageBlock]:
    """Blocks on the regions with their areas and targets."""
    regions = state.document.regions
    if not regions:
        yield PageNote(tr("There are no regions."))
        return
    rows = []
    for region, (area, sizes) in zip(regions, readings.regions(state, unit), strict=False):
        more = sizes
        if region.area is not None and not state.document.settings.traits.keeps_only_total_area:
            more = tr("{sizes}; target {percent} %").format(sizes=sizes, percent=format_exact(region.area))
        rows.append((region.name, area, more))
    yield PageTable(tuple(rows))
