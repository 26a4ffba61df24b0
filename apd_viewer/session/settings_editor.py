"""Targets and solver settings; each change is an undo step or part of a gesture."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Any

from apd_viewer.errors import InputError
from apd_viewer.geometry.analysis.mesh_findings import UNEVEN
from apd_viewer.geometry.goals.target_values import check_fits_in_ball
from apd_viewer.geometry.solver.methods import method_named
from apd_viewer.geometry.solver.settings import SETTINGS
from apd_viewer.language import comma_separated, tr
from apd_viewer.session.gestures import DocumentEditor
from apd_viewer.session.model.document_parts import have_same_paint
from apd_viewer.session.model.state import State
from apd_viewer.session.posing.obstacle_placement import obstacles_outside_shape

_OF_VOLUME = "volume", "filled_volume", "pressure"


class SettingsEditor(DocumentEditor):
    """Editor of the settings of the document."""

    def change(self, **settings: Any) -> None:
        """Change settings by name as one gesture; refuse a target for a missing volume."""
        wanted = [name for name in _OF_VOLUME if settings.get(name) is not None]
        if settings.get("gas") is not None:  # it has a pressure of its own
            settings["pressure"] = None
        if settings.get("pressure") is not None:
            settings["gas"] = None
        if wanted:  # a volume is given in percent, in cubic mesh units or by a pressure
            settings = dict.fromkeys(_OF_VOLUME) | settings
            settings = {wanted[0]: settings.pop(wanted[0]), **settings}
        if problem := self._volume_problem(self._store.required_state(), wanted, settings):
            self._listener.failed(problem)
            return
        name, value = next(iter(settings.items()))
        switched_off = value is False and SETTINGS[name].off_gesture
        self._set(switched_off or SETTINGS[name].gesture, settings)
        if "method" in settings and method_named(settings["method"]).needs_even_triangles:
            found = self._store.required_state().inspection.findings
            for finding in (each for each in found if each.kind == UNEVEN):
                self._listener.message_sent(finding.sentence)

    @staticmethod
    def _volume_problem(state: State, wanted: Sequence[str], changes: Mapping[str, Any]) -> str:
        """Sentence on what cannot be held inside with changed settings; empty if it can."""
        found, settings = state.inspection, replace(state.document.settings, **changes)
        # A flat bag has no volume at rest, and can be filled to one.
        reasons = {"volume": found.missing_volume_phrase, "filled_volume": found.missing_volume_reason}
        if wanted and (why := reasons.get(wanted[0])):
            return tr("There is no volume to keep: {why}; leave the volume free.").format(why=why)
        if "pressure" in wanted and (settings.pressure or 0.0) < 0.0 and not settings.uses_contact:
            return tr("Reduced pressure needs contact; switch it on, or omit the pressure.")
        held = settings.filled_volume
        if "filled_volume" in wanted and (
            settings.traits.keeps_total_area or settings.effective_settings.hold_area
        ):
            try:
                check_fits_in_ball(held or 0.0, found.area * settings.area / 100.0)
            except InputError as error:
                return str(error)
        return ""

    def set_contact(self, on: bool, thickness: float | None = None) -> None:
        """Turn contact between walls and with obstacles on or off.

        Parameters
        ----------
        thickness : float, optional
            Distance to keep, mesh units; a thousandth of the size of the mesh without it.
        """
        state, thickness = self._store.required_state(), thickness if on else None
        try:
            # Without contact, obstacles and the shape may overlap.
            obstacles = obstacles_outside_shape(state, thickness) if on else state.document.obstacles
        except InputError as error:
            self._listener.failed(str(error))
            return
        on_already = on and state.document.settings.contact
        gesture = SETTINGS["thickness"].gesture if on_already else SETTINGS["contact"].gesture
        gesture = gesture if on else SETTINGS["contact"].off_gesture
        moved = [a.name for a, b in zip(state.document.obstacles, obstacles, strict=True) if a is not b]
        self._set(gesture, {"contact": on, "thickness": thickness}, obstacles=obstacles)
        if moved:
            names = comma_separated(moved)
            self._listener.message_sent(tr("Moved back out of the shape: {names}.").format(names=names))

    def set_falloff(self, k: int, falloff: float) -> None:
        """Set the falloff of handle ``k``, a distance along the surface; 0 is none."""
        document = self._store.required_state().document
        handle = document.handles[k]
        if falloff != handle.falloff:
            handles = document.with_handle(k, replace(handle, falloff=falloff)).handles
            self._set(tr("Change falloff"), handles=handles)

    def set_components_immobile(self, components: Sequence[int], on: bool) -> None:
        """Make loose parts immobile, or let them follow the nearest surface.

        Parameters
        ----------
        components : sequence of int
            The lowest vertex of each.
        """
        immobile = set(self._store.required_state().document.immobile_components)
        immobile = immobile.union(components) if on else immobile.difference(components)
        self._set(tr("Change loose parts"), immobile_components=tuple(sorted(immobile)))

    def set_region_area(self, k: int, percent: float | None) -> None:
        """Set the target area of region ``k``, percent of rest; None only measures it."""
        document = self._store.required_state().document
        region = document.regions[k]
        if percent != region.area:
            self._set(
                tr("Change region"), regions=document.with_region(k, replace(region, area=percent)).regions
            )

    def _set(self, gesture: str, settings: Mapping[str, Any] = MappingProxyType({}), **changes: Any) -> None:
        before = self._store.required_state().document
        document = replace(before.with_settings(**settings), **changes)
        names = "settings", *changes
        if all(getattr(document, name) == getattr(before, name) for name in names):
            return
        self._gestures.accept_shown_state()
        begun = self._gestures.state_before
        if begun is None or not have_same_paint(before, begun.document):
            # Vertices painted by an unfinished stroke are not attached to it yet, and would jump.
            state = self._gestures.state_without_gesture()
            self._gestures.record(gesture, state)
            document = replace(state.document.with_settings(**settings), **changes)
        self._store.solve(document)
