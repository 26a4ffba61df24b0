"""Adding, renaming and removing measurements; each is a step of undo."""

from __future__ import annotations

from dataclasses import replace

from apd_viewer.geometry.measuring.measurement import Measurement, Plane
from apd_viewer.geometry.measuring.measurement_kind import MeasurementKind
from apd_viewer.geometry.measuring.surface_point import SurfacePoint
from apd_viewer.language import tr
from apd_viewer.session.gestures import DocumentEditor
from apd_viewer.session.model.document_parts import next_name, unique_name
from apd_viewer.session.storage.part_json import MOST_MEASUREMENTS


class MeasurementEditor(DocumentEditor):
    """Changes the measurements of the document."""

    def add(
        self, kind: MeasurementKind, points: tuple[SurfacePoint, ...] = (), plane: Plane | None = None
    ) -> None:
        """Measure between points, or in a plane."""
        there = self._store.required_state().document.measurements
        if len(there) >= MOST_MEASUREMENTS:
            self._listener.failed(
                tr("The limit is {most} measurements; remove one first.").format(most=MOST_MEASUREMENTS)
            )
            return
        name = next_name(kind.title, [each.name for each in there])
        self._set(tr("Add measurement"), (*there, Measurement(name, kind, points, plane)))

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
