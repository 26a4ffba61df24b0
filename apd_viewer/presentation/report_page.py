"""Content of a report: measurements, settings, mesh and versions; no Qt."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import TYPE_CHECKING

from apd_viewer.errors import InputError
from apd_viewer.files.html_page import Block, Note, Page, PageSection, PictureRow, Table
from apd_viewer.language import tr, trn
from apd_viewer.presentation import measurement_words, readings, report_settings
from apd_viewer.presentation.number_format import length, short
from apd_viewer.presentation.report_origin import (
    Evidence,
    mesh_blocks,
    repeat_blocks,
    version_of,
    version_rows,
)
from apd_viewer.presentation.report_volumes import reduction_block
from apd_viewer.session.model.status_text import of_crossings, of_exempt, of_passing
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.wall_mass import Wall, mass

if TYPE_CHECKING:
    from apd_viewer.files.html_page import Drawing
    from apd_viewer.geometry.analysis.area_change import LocalChange
    from apd_viewer.geometry.analysis.shape_check import ShapeCheck
    from apd_viewer.session.measurement_readings import MeasurementReading
    from apd_viewer.session.model.state import State


@dataclass(frozen=True, eq=False)
class Subject:
    """Subject of a report: state, view and measurements.

    Attributes
    ----------
    state : State
    unit : Unit
    wall : Wall
    found, at_rest : ShapeCheck
        Of the shape, and of the mesh at rest.
    moment : datetime
        When it was asked for.
    measured : sequence of MeasurementReading
    """

    state: State
    unit: Unit
    wall: Wall
    found: ShapeCheck
    at_rest: ShapeCheck
    moment: datetime
    measured: Sequence[MeasurementReading] = ()


def page_of(subject: Subject, evidence: Evidence, pictures: PictureRow, histogram: Drawing | None) -> Page:
    """Build the whole report."""
    state, unit = subject.state, subject.unit
    checks = subject.at_rest, subject.found
    date = subject.moment.strftime("%Y-%m-%d %H:%M")
    parts = [
        PageSection(tr("Shape"), (*_warnings(state, subject.found), pictures), wide=True),
        PageSection(tr("Area"), (Table(tuple(_area(state, unit))),)),
        PageSection(tr("Volume"), (Table(tuple(_volume(subject))),)),
        PageSection(tr("Size and mass"), tuple(_size(subject))),
        *_target_shape(state, unit, evidence.apart),
        *_measurements(subject),
        PageSection(tr("Settings and targets"), tuple(report_settings.settings_blocks(state, unit))),
        PageSection(tr("Handles"), (Table(tuple(report_settings.handle_rows(state, unit, subject.found))),)),
        PageSection(tr("Obstacles"), tuple(report_settings.obstacle_blocks(state, unit))),
        PageSection(tr("Regions"), tuple(report_settings.region_blocks(state, unit))),
        PageSection(tr("Volume reduction"), (reduction_block(state, unit, subject.wall, checks),), wide=True),
        PageSection(tr("Local area change"), tuple(_local_change(evidence.change, histogram)), wide=True),
        PageSection(tr("Mesh check"), tuple(_findings(subject)), wide=True),
        PageSection(tr("Mesh and file"), tuple(mesh_blocks(state, unit, evidence.file))),
        PageSection(tr("Versions"), (Table(tuple(version_rows())),)),
        PageSection(tr("How to reproduce it"), tuple(repeat_blocks(state, evidence)), wide=True),
    ]
    name = state.document.mesh.name
    return Page(
        title=name,
        subtitle=tr("Report of a deformation, {date}").format(date=date),
        hero=(readings.area_percent(state), tr("area: {verdict}").format(verdict=readings.verdict(state))),
        parts=tuple(parts),
        foot=tr("Created with APD Viewer {version}.").format(version=version_of("apd-viewer")),
    )


def _warnings(state: State, found: ShapeCheck | None) -> Iterator[Block]:
    if not state.frame.settled:
        yield Note(tr("The shape had not converged when this report was created."), warns=True)
    if state.frame.unreached:
        yield Note(state.frame.unreached, warns=True)
    for sentence in of_passing(state, found):
        yield Note(sentence, warns=True)


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
    if subject.state.keeps_apart:
        touch = readings.contact(subject.state, subject.unit)
        yield tr("Pairs in contact"), touch.pairs, ""
        yield tr("Least gap"), touch.least_gap, ""
        yield tr("Share of the way"), touch.share, ""


def _crossing(found: ShapeCheck) -> str:
    if found.crossing is None:
        return tr("not checked: ipctk is missing")
    n = len(found.crossing)
    return trn("{n:,} triangle", "{n:,} triangles", n).format(n=n) if n else tr("none")


def _measurements(subject: Subject) -> Iterator[PageSection]:
    if subject.measured:
        rows = measurement_words.report_rows(subject.measured, subject.unit)
        yield PageSection(tr("Measurements"), (Table(rows),))


def _size(subject: Subject) -> Iterator[Block]:
    state, unit, found, rest = subject.state, subject.unit, subject.found, subject.at_rest
    extent = readings.extent(found, unit), ""
    box = readings.room(found.box, rest.box, unit)
    packed = readings.room(found.packed, rest.packed, unit)
    try:
        grams, problem = (
            mass(subject.wall, state.frame.area, unit, readings.material(state)),
            readings.two_walls(state, unit),
        )
    except InputError as error:
        grams, problem = None, str(error)
    yield Table(
        (
            (tr("Bounding box"), *extent),
            (tr("Bounding box volume"), *box),
            (tr("Smallest box volume"), *packed),
            (tr("Compactness"), *readings.compact(state)),
            (tr("Wall"), subject.wall.written(unit) or readings.NOTHING, ""),
            (tr("Mass"), readings.weight(grams, unit), problem),
        )
    )


def _target_shape(state: State, unit: Unit, apart: dict[str, float] | None) -> Iterator[PageSection]:
    """Section on the target shape, if there is one."""
    target, size = state.document.target, max(state.inspection.size)
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
                (title.format(what=what), unit.length(length(apart[f"{name}_distance{suffix}"], size)), "")
                for what, name in readings.DISTANCES
            ]
    yield PageSection(tr("Target shape"), (Table(tuple(rows)),))


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
    crossings = of_crossings(state.document.mesh, found.crossing)
    rest = subject.at_rest.crossing if state.keeps_apart else None
    findings = *state.inspection.findings, *of_exempt(state.document.mesh, rest), *crossings
    for finding in findings:
        yield Note(finding.sentence)
    if not findings:
        yield Note(tr("No issues"))
