"""Content of a report: measurements, settings, mesh and versions; no Qt."""

import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from datetime import datetime
from typing import NamedTuple

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.html_page import (
    Page,
    PageBlock,
    PageDrawing,
    PageGrid,
    PageNote,
    PagePictureRow,
    PageSection,
    PageTable,
    PageView,
)
from apd_viewer.geometry.analysis.area_change import LocalChange
from apd_viewer.geometry.analysis.shape_check import ShapeCheck
from apd_viewer.geometry.analysis.volume_readings import VolumeReadings
from apd_viewer.geometry.measuring.vessel import Vessel
from apd_viewer.geometry.solver.methods import METHODS
from apd_viewer.language import tr, trn
from apd_viewer.presentation import measurement_text, readings, report_blocks
from apd_viewer.presentation.number_format import format_length, format_short, format_significant
from apd_viewer.presentation.plate_readings import (
    has_given_way,
    main_plate_readings,
    step_reading_texts,
    step_verdict,
)
from apd_viewer.presentation.report_blocks import ReportReadings
from apd_viewer.presentation.volume_text import volume_rows
from apd_viewer.session.measurement_readings import MeasurementReading
from apd_viewer.session.model import status_text
from apd_viewer.session.model.obstacle_pair import obstacle_pair
from apd_viewer.session.model.state import State
from apd_viewer.session.model.up_axis import UpAxis
from apd_viewer.session.quantities.newton_conversion import NewtonConversion
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.wall import WallText, typed_mass


class ReportStep(NamedTuple):
    """Step of a motion: its number from 0, and the conversion of its loads."""

    number: int
    state: State
    newtons: NewtonConversion | None


class ReportHeading(NamedTuple):
    """Title and customer of a report; empty for the name of the mesh, and for none."""

    title: str = ""
    customer: str = ""


NO_HEADING = ReportHeading()


class ReportDrawings(NamedTuple):
    """View, pictures and steps of the shape, histogram, curves of a timeline."""

    view: PageView
    shape: PagePictureRow
    histogram: PageDrawing
    steps: PagePictureRow
    curves: tuple[PageDrawing, ...]


@dataclass(frozen=True, eq=False)
class ReportSubject:
    """Subject of a report: state, view and measurements.

    Attributes
    ----------
    shape_check, rest_check : ShapeCheck
        Of the shape, and of the mesh at rest.
    requested_at : datetime
        Time of the request.
    newtons : NewtonConversion or None
        Of the loads; None if newtons are unknown.
    pressed : tuple of PageBlock
        Results of the dialog of presses for this mesh.
    """

    state: State
    unit: Unit
    wall: WallText
    shape_check: ShapeCheck
    rest_check: ShapeCheck
    requested_at: datetime
    measurements: Sequence[MeasurementReading] = ()
    up_axis: UpAxis = UpAxis.PLUS_Y
    newtons: NewtonConversion | None = None
    steps: Sequence[ReportStep] = ()
    heading: ReportHeading = NO_HEADING
    pressed: tuple[PageBlock, ...] = ()


def report_page(subject: ReportSubject, evidence: ReportReadings, drawings: ReportDrawings) -> Page:
    """Build the report page."""
    state, unit = subject.state, subject.unit
    checks = subject.rest_check, subject.shape_check
    date = subject.requested_at.strftime("%Y-%m-%d %H:%M")
    parts = [
        PageSection(
            tr("Shape"),
            (*_warnings(state, subject.shape_check), drawings.view, drawings.shape),
            is_wide=True,
        ),
        PageSection(tr("Area"), (PageTable(tuple(_area(state, unit))),)),
        PageSection(tr("Volume"), (PageTable(tuple(_volume(subject))),)),
        PageSection(tr("Size and mass"), tuple(_size(subject))),
        *_steps(subject, drawings),
        *_pressed(subject),
        *_target_shape(state, unit, evidence.target_distances),
        *_measurements(subject),
        PageSection(
            tr("Settings and targets"), tuple(report_blocks.settings_blocks(state, unit, subject.wall))
        ),
        PageSection(
            tr("Handles"), (PageTable(tuple(report_blocks.handle_rows(state, unit, subject.shape_check))),)
        ),
        PageSection(tr("Obstacles"), tuple(report_blocks.obstacle_blocks(state, unit, subject.newtons))),
        PageSection(tr("Regions"), tuple(report_blocks.region_blocks(state, unit))),
        PageSection(
            tr("Volume reduction"),
            (volumes_block(state, unit, subject.wall, checks, subject.up_axis),),
            is_wide=True,
        ),
        PageSection(
            tr("Local area change"), tuple(_local_change(evidence.change, drawings.histogram)), is_wide=True
        ),
        PageSection(tr("Assumptions"), tuple(_assumptions(subject)), is_wide=True),
        PageSection(tr("Mesh check"), tuple(_findings(subject)), is_wide=True),
        PageSection(tr("Mesh and file"), tuple(report_blocks.mesh_blocks(state, unit, evidence.file))),
        PageSection(tr("Versions"), (PageTable(tuple(report_blocks.version_rows())),)),
        PageSection(
            tr("How to reproduce it"), tuple(report_blocks.reproduction_blocks(state, evidence)), is_wide=True
        ),
    ]
    name, (title, customer) = state.document.mesh.name, subject.heading
    lines = [
        tr("Prepared for {customer}").format(customer=customer) if customer else "",
        name if title else "",
        tr("Report of a deformation, {date}").format(date=date),
    ]
    return Page(
        title=title or name,
        subtitle=" · ".join(filter(None, lines)),
        hero=(
            readings.area_percent(state),
            tr("area: {verdict}").format(verdict=readings.area_verdict(state)),
        ),
        sections=tuple(parts),
        footer=tr("Created with APD Viewer {version}.").format(
            version=report_blocks.version_of("apd-viewer")
        ),
    )


def _warnings(state: State, found: ShapeCheck | None) -> Iterator[PageBlock]:
    if not state.frame.settled:
        yield PageNote(tr("The shape had not converged when this report was created."), is_warning=True)
    if state.frame.stable is False:
        yield PageNote(tr("The shape is not stable: it rests on a saddle of its energy."), is_warning=True)
    if state.frame.unreached:
        yield PageNote(state.frame.unreached, is_warning=True)
    for sentence in status_text.self_intersection_warnings(state, found):
        yield PageNote(sentence, is_warning=True)


def _area(state: State, unit: Unit) -> Iterator[tuple[str, str, str]]:
    yield tr("Area"), readings.area_percent(state), readings.area(state, unit)
    yield tr("Change"), readings.area_verdict(state), ""
    yield tr("Largest local area change"), readings.local_change(state), ""
    yield tr("Largest edge strain"), readings.largest_edge_strain(state), ""
    yield tr("Mean edge strain"), readings.mean_edge_strain(state), ""


def _volume(subject: ReportSubject) -> Iterator[tuple[str, str, str]]:
    reading = readings.volume(subject.state, subject.unit)
    yield tr("Volume"), reading.change, reading.volumes
    for line in reading.remarks:
        yield "", line, ""
    yield tr("Self-intersections"), _crossing_count(subject.shape_check), ""
    if subject.state.is_contact_active:
        touch = readings.contact(subject.state, subject.unit)
        yield tr("Pairs in contact"), touch.pairs, ""
        yield tr("Least gap"), touch.least_gap, ""
        yield tr("Fraction of the path"), touch.path_fraction, ""


def _crossing_count(found: ShapeCheck) -> str:
    if found.crossing is None:
        return tr("not checked")
    n = len(found.crossing)
    return trn("{n:,} triangle", "{n:,} triangles", n).format(n=n) if n else tr("none")


def _measurements(subject: ReportSubject) -> Iterator[PageSection]:
    if subject.measurements:
        rows = measurement_text.measurement_report_rows(subject.measurements, subject.unit)
        yield PageSection(tr("Measurements"), (PageTable(rows),))


def _size(subject: ReportSubject) -> Iterator[PageBlock]:
    state, unit, found, rest = subject.state, subject.unit, subject.shape_check, subject.rest_check
    extent = readings.extent(found, unit), ""
    box = readings.box_volume(found.box, rest.box, unit)
    packed = readings.box_volume(found.packed_box, rest.packed_box, unit)
    entered = subject.wall.text(unit)
    yield PageTable(
        (
            (tr("Bounding box"), *extent),
            (tr("Bounding box volume"), *box),
            (tr("Smallest box volume"), *packed),
            (tr("Compactness"), *_compactness(state)),
            (tr("Wall"), entered or readings.NO_VALUE, "" if entered else tr("not entered")),
            (tr("Mass"), *_mass(subject)),
        )
    )


def _mass(subject: ReportSubject) -> tuple[str, str]:
    """Mass with the material of a double wall, or the reason for a missing one."""
    state, unit = subject.state, subject.unit
    material, double = readings.material_volume(state), readings.double_wall(state, unit)
    try:
        grams = typed_mass(subject.wall, state.inspection.area, unit, material)
    except InputError as error:
        return readings.NO_VALUE, str(error)
    if grams is None:
        missing = tr("needs thickness and density") if material is None else tr("needs a density")
        return readings.NO_VALUE, "; ".join(filter(None, (missing, double)))
    return readings.mass(grams, unit), double


def _compactness(state: State) -> tuple[str, str]:
    """Compactness with its change, or the reason for a missing one."""
    value, change = readings.compactness_text(state)
    why = state.inspection.missing_volume_phrase
    if value == readings.NO_VALUE and why:
        return value, tr("There is no volume: {why}.").format(why=why)
    return value, change


def _assumptions(subject: ReportSubject) -> Iterator[PageBlock]:
    """Sentences about what the model assumes, and what it does not know."""
    settings, unit = subject.state.document.settings, subject.unit
    if subject.state.document.obstacles:
        yield PageNote(tr("Everything is moved slowly, without gravity and friction."))
        if subject.newtons is None:
            yield PageNote(tr("Loads are relative: unit, thickness or Young's modulus are unknown."))
    if settings.yield_radius is None:
        yield PageNote(tr("The wall springs back from every bend; no crease stays."))
    else:
        radius = unit.format_length(format_significant(settings.yield_radius, 3))
        sentence = tr(
            "Creases stay where the wall is bent to less than {radius}. Stretched, it never yields."
        )
        yield PageNote(sentence.format(radius=radius))
    if not subject.state.is_contact_active:
        yield PageNote(tr("Without contact, walls may pass through each other."))
    if has_given_way([step.state for step in subject.steps]):
        yield PageNote(
            tr("The load has fallen once: from there on imperfections of a real wall decide, not known here.")
        )


def _steps(subject: ReportSubject, drawings: ReportDrawings) -> Iterator[PageSection]:
    """Section on the steps of the motion that the shape belongs to, if there are any."""
    if len(subject.steps) < 2:
        return
    pressed = all(obstacle_pair(step.state.document) is not None for step in subject.steps)
    unit, rows = subject.unit, []
    for step in subject.steps:
        texts = (
            main_plate_readings(step.state, unit, step.newtons)
            if pressed
            else step_reading_texts(step.state, unit)
        )
        method = METHODS[step.state.document.settings.method].short_title
        cells = ((each.value, each.note) for each in texts)
        row = (str(step.number), method), *cells, (step_verdict(step.state)[0], "")
        rows.append(tuple((cell,) for cell in row))
    titles = tr("Step"), *(each.title for each in texts), tr("State")
    table = PageGrid(titles, tuple(rows))
    yield PageSection(tr("Steps"), (drawings.steps, *drawings.curves, table), is_wide=True)


def _pressed(subject: ReportSubject) -> Iterator[PageSection]:
    """Section on the results of the dialog of presses, if there are any."""
    if subject.pressed:
        yield PageSection(tr("Press between plates"), subject.pressed, is_wide=True)


def _target_shape(state: State, unit: Unit, apart: dict[str, float] | None) -> Iterator[PageSection]:
    """Section on the target shape, if there is one."""
    target, size = state.document.target_shape, max(state.inspection.size)
    if target is None or apart is None:
        return
    rows = [(tr("File"), target.mesh.name, "")]
    for suffix, title in (
        ("", tr("{what}, closest point")),
        ("_by_vertex", tr("{what}, same vertex")),
        ("_back", tr("{what}, closest point of this shape")),
    ):
        if f"rms_distance{suffix}" in apart:
            rows += [
                (
                    title.format(what=what),
                    unit.format_length(format_length(apart[f"{name}_distance{suffix}"], size)),
                    "",
                )
                for what, name in readings.DISTANCE_COLUMNS
            ]
    yield PageSection(tr("Target shape"), (PageTable(tuple(rows)),))


def _local_change(change: LocalChange, histogram: PageDrawing) -> Iterator[PageBlock]:
    yield histogram
    rows = (
        (tr("Mean"), change.mean),
        (tr("99 % of the surface within"), change.p99),
        (tr("Largest"), change.largest),
    )
    yield PageTable(tuple((name, f"{format_short(100.0 * value)} %", "") for name, value in rows))


def _findings(subject: ReportSubject) -> Iterator[PageBlock]:
    state, found = subject.state, subject.shape_check
    crossings = status_text.crossing_findings(state.document.mesh, found.crossing)
    rest = subject.rest_check.crossing if state.is_contact_active else None
    findings = (
        *state.inspection.findings,
        *status_text.exempt_zone_findings(state.document.mesh, rest),
        *crossings,
    )
    for finding in findings:
        yield PageNote(finding.sentence)
    if not findings:
        yield PageNote(tr("No issues"))


def _brimful(found: VolumeReadings, U: np.ndarray, state: State, up_axis: UpAxis) -> float | None:
    """Volume of a shape up to its brim; None if it holds nothing, or has two walls."""
    if found.enclosed is None or found.capacity is not None:
        return None
    if not found.openings:
        return found.enclosed
    with suppress(InputError):
        F = state.document.mesh.joined_F
        return Vessel.from_welded_surface(U, F, up_axis.direction, state.document.closed_openings).brimful
    return None


def volumes_block(
    state: State, unit: Unit, wall: WallText, checks: tuple[ShapeCheck, ShapeCheck], up_axis: UpAxis
) -> PageBlock:
    """Table of rest and current volumes; ``checks`` of the rest and current shape."""
    at_rest, found = checks
    if math.isnan(found.packed_box) or math.isnan(at_rest.packed_box):  # the measuring process crashed
        return PageNote(tr("Not measured; create the report again."))
    now, then = readings.volumes(state.frame, state.inspection)
    wall_found = state.inspection.double_wall
    thickness, openings = wall.usable_thickness(unit), state.inspection.openings
    rest_area, area = state.inspection.area, state.frame.area
    before = VolumeReadings.from_hull(rest_area, then, openings, at_rest.hull, thickness, wall_found)
    after = VolumeReadings.from_hull(area, now, openings, found.hull, thickness, wall_found)
    before, after = (
        each._replace(brimful=_brimful(each, U, state, up_axis))
        for each, U in ((before, state.document.mesh.V), (after.of_rest(before), state.frame.U))
    )
    rows = volume_rows(before, after, unit, wall.usable_density(), up=up_axis.value)
    none = (("", tr("none found")),)
    head = tr("Quantity"), tr("At rest"), tr("Now"), tr("Change"), tr("Published")
    lines = [
        (
            ((row.title, row.definition),),
            (row.rest,),
            (row.now,),
            ((row.change, ""),) if row.change else (),
            tuple((each.words, each.source) for each in row.published) or none,
        )
        for row in rows
    ]
    return PageGrid(head, tuple(lines))
