"""Editor of measurements, and readings of the rest shape and the displayed shape."""

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.measuring.measurement import Contents, Measurement, MeasurementResult, Plane, measure
from apd_viewer.geometry.measuring.measurement_kind import MeasurementKind
from apd_viewer.geometry.measuring.surface_point import CarriedPath, SurfacePoint
from apd_viewer.geometry.measuring.vessel import Vessel
from apd_viewer.language import tr
from apd_viewer.session.gestures import DocumentEditor, Gestures
from apd_viewer.session.model.document_parts import next_name, unique_name
from apd_viewer.session.model.state import State
from apd_viewer.session.processes.geodesic_finder import GeodesicFinder, GeodesicQuery, find_geodesic
from apd_viewer.session.state_store import Activity, Listener, StateStore
from apd_viewer.session.storage.part_json import MOST_MEASUREMENTS

EndPoints = tuple[SurfacePoint, ...]


class MeasurementReading(NamedTuple):
    """Measurement with its results for the rest and current shape."""

    measurement: Measurement
    rest: MeasurementResult
    now: MeasurementResult


def complete_readings(readings: Sequence[MeasurementReading], state: State) -> list[MeasurementReading]:
    """Readings of a state, computing all missing geodesics (slow)."""
    F, closed, found = state.document.mesh.joined_F, state.document.closed_openings, []

    def made(measurement: Measurement, known: MeasurementResult, U: np.ndarray) -> MeasurementResult:
        if None not in known.values:
            return known
        return measure(
            measurement, U, F, find_geodesic(GeodesicQuery(U, F, measurement.points)), closed=closed
        )

    for each, rest, now in readings:
        at_rest = made(each, rest, state.document.mesh.V)
        found.append(
            MeasurementReading(each, at_rest, at_rest if now is rest else made(each, now, state.frame.U))
        )
    return found


class MeasurementReadings:
    """Measurements of the displayed shape, with geodesics from a separate process.

    Parameters
    ----------
    listener : Listener
        Its ``measured`` is called when a geodesic becomes known.
    """

    def __init__(self, store: StateStore, gestures: Gestures, listener: Listener) -> None:
        self._store = store
        self._gestures = gestures
        self._listener = listener
        self._finder = GeodesicFinder(listener.wake)
        self._asked: GeodesicQuery | None = None
        self._mesh_V: np.ndarray | None = None
        self._joined_F: np.ndarray | None = None
        self._closed: tuple[int, ...] = ()
        self._rest: dict[Measurement, MeasurementResult] = {}
        self._rest_paths: dict[EndPoints, CarriedPath] = {}
        self._paths: dict[EndPoints, tuple[np.ndarray, CarriedPath]] = {}

    def readings(self, state: State) -> list[MeasurementReading]:
        """Readings of a state; values not yet known are None."""
        self._discard_outdated(state)
        return [
            MeasurementReading(each, self._rest_result(each, state), self._current_result(each, state))
            for each in state.document.measurements
        ]

    def follow_state(self) -> None:
        """Request the next unknown geodesic while the solver is idle; cancel otherwise."""
        state = self._store.state
        if state is None:
            return
        self._discard_outdated(state)
        rests = self._gestures.state_before is None and self._store.activity is not Activity.REFINING
        wanted = self._missing_geodesic(state) if rests else None
        if wanted is None:
            self._asked = None
            self._finder.cancel()
        elif (
            self._asked is None
            or wanted.U is not self._asked.U
            or wanted.end_points != self._asked.end_points
        ):
            self._asked = wanted
            self._finder.ask(wanted)

    def receive_geodesic(self) -> None:
        """Store a geodesic received from the process."""
        answer = self._finder.take()
        if answer is None:
            return
        course, path = answer
        if course.U is self._mesh_V:
            self._rest_paths[course.end_points] = path
            self._rest.clear()
        else:
            self._paths[course.end_points] = course.U, path
        self._asked = None
        self.follow_state()
        self._listener.measurements_changed()

    def close(self) -> None:
        """Stop the search for geodesics."""
        self._finder.close()

    def _discard_outdated(self, state: State) -> None:
        """Discard results of another mesh or rest shape."""
        mesh = state.document.mesh
        if self._mesh_V is not mesh.V or self._joined_F is not mesh.joined_F:  # others once seams are welded
            self._mesh_V, self._joined_F = mesh.V, mesh.joined_F
            self._rest, self._rest_paths, self._paths = {}, {}, {}
        if self._closed != state.document.closed_openings:
            self._closed = state.document.closed_openings
            self._rest = {}

    def _missing_geodesic(self, state: State) -> GeodesicQuery | None:
        F, shapes = state.document.mesh.joined_F, (state.document.mesh.V, state.frame.U)
        for each in state.document.measurements:
            for U in shapes if each.kind is MeasurementKind.GEODESIC else ():
                path, is_current = self._known_path(each.points, U)
                if path is None or not is_current:
                    return GeodesicQuery(U, F, each.points)
        return None

    def _known_path(self, end_points: EndPoints, U: np.ndarray) -> tuple[CarriedPath | None, bool]:
        """Latest known path between two points, and True if it is on the shape ``U``."""
        rest = self._rest_paths.get(end_points)
        if U is self._mesh_V:
            return rest, rest is not None
        known, path = self._paths.get(end_points, (None, rest))
        return path, known is U

    def _rest_result(self, measurement: Measurement, state: State) -> MeasurementResult:
        if measurement not in self._rest:
            self._rest[measurement] = self._measured_result(measurement, state, state.document.mesh.V)
        return self._rest[measurement]

    def _current_result(self, measurement: Measurement, state: State) -> MeasurementResult:
        if state.frame.U is state.document.mesh.V:
            return self._rest_result(measurement, state)
        return self._measured_result(measurement, state, state.frame.U)

    def _measured_result(self, measurement: Measurement, state: State, U: np.ndarray) -> MeasurementResult:
        path, is_current = self._known_path(measurement.points, U)
        F, closed = state.document.mesh.joined_F, state.document.closed_openings
        return measure(measurement, U, F, path, is_current, closed)


class MeasurementEditor(DocumentEditor):
    """Editor of the measurements of the document."""

    def add(
        self, kind: MeasurementKind, points: tuple[SurfacePoint, ...] = (), plane: Plane | None = None
    ) -> None:
        """Add a measurement between points or in a plane."""
        there = self._store.required_state().document.measurements
        if len(there) >= MOST_MEASUREMENTS:
            self._listener.failed(
                tr("The limit is {most} measurements; remove one first.").format(most=MOST_MEASUREMENTS)
            )
            return
        name = next_name(kind.title, [each.name for each in there])
        made = Measurement(name, kind, points, plane)
        if kind is MeasurementKind.FILL_LEVEL and plane is not None:
            try:
                made = Measurement(name, kind, contents=self._contents_below(plane))
            except InputError as error:
                self._listener.failed(str(error))
                return
        self._set(tr("Add measurement"), (*there, made))

    def _contents_below(self, plane: Plane) -> Contents:
        """Contents of the displayed shape that rise to a plane."""
        state = self._store.required_state()
        F, closed = state.document.mesh.joined_F, state.document.closed_openings
        vessel = Vessel.from_welded_surface(state.frame.U, F, np.array(plane.normal), closed)
        volume = vessel.volume(plane.offset)
        legible = float(f"{volume:.4g}")
        return Contents(plane.normal, legible if legible <= vessel.brimful else volume)

    def fill(self, k: int, volume: float) -> None:
        """Set the contents of fill level ``k``, cubic mesh units."""
        there = self._store.required_state().document.measurements
        contents = there[k].contents
        if contents is not None:
            filled = replace(there[k], contents=contents._replace(volume=volume))
            self._set(tr("Change contents"), (*there[:k], filled, *there[k + 1 :]))

    def toggle_opening(self, border: np.ndarray) -> None:
        """Count the opening with the vertices ``border`` (k,) as closed, or as open again."""
        closed = self._gestures.state_without_gesture().document.closed_openings
        left = tuple(each for each in closed if each not in border)
        name = tr("Open opening") if left != closed else tr("Close opening")
        chosen = left if left != closed else (*closed, int(border.min()))
        self._replace(name, closed_openings=chosen)

    def remove(self, k: int) -> None:
        """Remove measurement ``k``."""
        there = self._store.required_state().document.measurements
        self._set(tr("Remove measurement"), (*there[:k], *there[k + 1 :]))

    def rename(self, k: int, name: str) -> None:
        """Rename measurement ``k``; a name in use gets a number."""
        there = self._store.required_state().document.measurements
        name = unique_name(name, there[k].name, [each.name for each in there])
        self._set(tr("Rename"), (*there[:k], replace(there[k], name=name), *there[k + 1 :]))

    def clear(self) -> None:
        """Remove all measurements."""
        self._set(tr("Remove all measurements"), ())

    def _set(self, gesture: str, measurements: tuple[Measurement, ...]) -> None:
        if measurements != self._gestures.state_without_gesture().document.measurements:
            self._replace(gesture, measurements=measurements)
