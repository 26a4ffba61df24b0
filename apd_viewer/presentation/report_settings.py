"""Report blocks: handles, regions and targets."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from apd_viewer.files.html_page import Block, Note, Table
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE
from apd_viewer.language import tr, trn
from apd_viewer.notation import written
from apd_viewer.presentation import obstacle_readings, readings
from apd_viewer.presentation.number_format import exact, grouped, short, significant
from apd_viewer.session.model.status_text import of_held_turn
from apd_viewer.session.model.targets import kept_percentages
from apd_viewer.session.quantities.units import Unit

if TYPE_CHECKING:
    from apd_viewer.geometry.analysis.shape_check import ShapeCheck
    from apd_viewer.session.model.named_parts import Handle
    from apd_viewer.session.model.state import State


_RIGID = 1e-9  # of a pose's matrix: a smaller scale is rounding


def settings_blocks(state: State, unit: Unit) -> Iterator[Block]:
    """Blocks on the method and all settings."""
    document = state.document
    method = document.traits
    rows = [(tr("Method"), method.title, method.about)]
    area, volume, *_ = kept_percentages(document)
    rows.append((tr("Area target"), tr("free") if area is None else f"{exact(area)} %", ""))
    rows.append((tr("Volume target"), tr("free") if volume is None else f"{exact(volume)} %", ""))
    if method.keeps_calm_parts:
        rows.append((tr("Calm parts"), tr("kept") if document.calm else tr("not kept"), ""))
    if method.may_touch:
        rows.append((tr("Contact"), tr("kept apart") if document.contact else tr("not regarded"), ""))
    if document.contact and document.thickness is not None and method.may_touch:
        rows.append((tr("Distance of walls"), unit.length(significant(document.thickness, 4)), ""))
    if method.has_tolerance:
        rows.append((tr("Tolerance"), f"{short(100 * document.tolerance)} %", ""))
    if method.has_moduli:
        rows.append((tr("Area stiffness"), exact(document.area_stiffness), ""))
        rows.append((tr("Shear stiffness"), exact(document.shear_stiffness), ""))
    rows.append((tr("Stiffness"), exact(document.stiffness), ""))
    criteria = document.convergence
    rows.append((tr("Most iterations"), grouped(criteria.most_iterations, 0), ""))
    if method.plain_only:
        rows.append((tr("Step tolerance"), short(criteria.step_tolerance), ""))
    else:
        rows.append((tr("Energy tolerance"), short(criteria.energy_tolerance), ""))
    if document.loose_parts:
        staying = sum(part.first in document.staying for part in document.loose_parts)
        said = tr("{going:,} go along, {staying:,} stay")
        going = len(document.loose_parts) - staying
        rows.append((tr("Loose parts"), said.format(going=going, staying=staying), ""))
    yield Table(tuple(rows))


def handle_rows(state: State, unit: Unit, found: ShapeCheck | None = None) -> Iterator[tuple[str, str, str]]:
    """Rows of the handles with their motions."""
    document, size = state.document.from_rest, max(state.inspection.size)
    for k, handle in enumerate(document.handles):
        count, centre = int(document.counts[HANDLE + k]), document.centre(k)
        if centre is None:
            yield handle.name, tr("not painted"), ""
            continue
        said = [trn("{n:,} vertex", "{n:,} vertices", count).format(n=count)]
        said += _motion(handle, centre, unit, size)
        if turned := of_held_turn(found, k):
            said.append(turned)
        pivot = document.pivot(k)
        if handle.pivot is not None and pivot is not None:
            said.append(tr("pivot {point}").format(point=unit.length(_vector(pivot, size))))
        if handle.falloff:
            said.append(tr("falloff {length}").format(length=unit.length(significant(handle.falloff, 4))))
        yield handle.name, readings.motion(state, k, unit), "; ".join(said)
    yield tr("Drift"), readings.drift(state, unit), ""
    counts = document.counts
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
    yield tr("displacement {vector}").format(vector=unit.length(_vector(displacement, size)))
    if turned > 0.0:
        angle = written(f"{math.degrees(turned):.6f}".rstrip("0").rstrip("."))
        yield tr("axis {vector}, angle {angle}°").format(vector=_vector(rotation / turned), angle=angle)
    if np.abs(scale - 1.0).max() > _RIGID:
        factors = scale[:1] if np.ptp(scale) <= _RIGID else scale
        yield tr("scaled by {factors}").format(factors=" × ".join(map(exact, factors)))


def _vector(x: np.ndarray, size: float = 1.0) -> str:
    """Coordinates with enough digits to reproduce them; rounding errors become zero."""
    return f"({obstacle_readings.coordinates(x, size)})".replace("-", "−")


def obstacle_blocks(state: State, unit: Unit) -> Iterator[Block]:
    """Blocks on the obstacles with their motions and loads."""
    if not state.document.obstacles:
        yield Note(tr("There are no obstacles."))
        return
    yield Table(tuple(obstacle_readings.report_rows(state, unit)))
    if why := obstacle_readings.why_idle(state):
        yield Note(why)


def region_blocks(state: State, unit: Unit) -> Iterator[Block]:
    """Blocks on the regions with their areas and targets."""
    regions = state.document.regions
    if not regions:
        yield Note(tr("There are no regions."))
        return
    rows = []
    for region, (area, sizes) in zip(regions, readings.regions(state, unit), strict=False):
        more = sizes
        if region.area is not None and not state.document.traits.keeps_only_total_area:
            more = tr("{sizes}; target {percent} %").format(sizes=sizes, percent=exact(region.area))
        rows.append((region.name, area, more))
    yield Table(tuple(rows))
