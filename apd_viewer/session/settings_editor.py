"""Targets and solver settings; each change is a step of undo or part of a gesture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from apd_viewer.errors import InputError
from apd_viewer.geometry.solver.convergence import Convergence
from apd_viewer.language import comma_separated, tr
from apd_viewer.session.gestures import Gestures
from apd_viewer.session.listener import Listener
from apd_viewer.session.model.document_parts import have_same_paint
from apd_viewer.session.posing.obstacle_placement import obstacles_outside_shape
from apd_viewer.session.state_store import StateStore


class SettingsEditor:
    """Changes the settings of the document.

    Parameters
    ----------
    store : StateStore
    gestures : Gestures
    listener : Listener
    """

    def __init__(self, store: StateStore, gestures: Gestures, listener: Listener) -> None:
        self._store = store
        self._gestures = gestures
        self._listener = listener

    def set_area(self, percent: float) -> None:
        """Ask for another total area, in percent of the area at rest."""
        self._set(tr("Change area"), area=percent)

    def set_hold_area(self, on: bool) -> None:
        """Have the method "local" keep the total area too, or not."""
        self._set(tr("Change area"), hold_area=on)

    def set_volume(self, percent: float | None) -> None:
        """Ask for a volume, in percent of the volume at rest; None leaves it free."""
        why = self._store.required_state().inspection.missing_volume_phrase
        if percent is not None and why:
            self._listener.failed(
                tr("There is no volume to keep: {why}; leave the volume free.").format(why=why)
            )
        else:
            self._set(tr("Change volume"), volume=percent)

    def set_method(self, method: str) -> None:
        """Deform by another method, from the shape on screen."""
        self._set(tr("Change method"), method=method)

    def set_tolerance(self, tolerance: float) -> None:
        """Have "paper" accept another relative error of the area."""
        self._set(tr("Change tolerance"), tolerance=tolerance)

    def set_convergence(self, convergence: Convergence) -> None:
        """End the iterations by other criteria."""
        self._set(tr("Change convergence"), convergence=convergence)

    def set_stiffness(self, stiffness: float) -> None:
        """Resist bending by another weight."""
        self._set(tr("Change stiffness"), stiffness=stiffness)

    def set_calm(self, on: bool) -> None:
        """Keep the area of calm parts too, or the total alone."""
        self._set(tr("Keep calm parts") if on else tr("Let calm parts change"), calm=on)

    def set_contact(self, on: bool, thickness: float | None = None) -> None:
        """Keep walls from passing through each other, or let them.

        Parameters
        ----------
        on : bool
        thickness : float, optional
            Distance to keep, mesh units; a thousandth of the size of the mesh without it.
        """
        on_already = on and self._store.required_state().document.contact
        switch = tr("Turn contact on") if on else tr("Turn contact off")
        gesture = tr("Change distance of walls") if on_already else switch
        state, thickness = self._store.required_state(), thickness if on else None
        try:
            # Without contact obstacles and the shape pass through each other.
            obstacles = obstacles_outside_shape(state, thickness) if on else state.document.obstacles
        except InputError as error:
            self._listener.failed(str(error))
            return
        moved = [a.name for a, b in zip(state.document.obstacles, obstacles, strict=True) if a is not b]
        self._set(gesture, contact=on, thickness=thickness, obstacles=obstacles)
        if moved:
            names = comma_separated(moved)
            self._listener.message_sent(tr("Moved back out of the shape: {names}.").format(names=names))

    def set_local_stiffness(
        self, area_stiffness: float | None = None, shear_stiffness: float | None = None
    ) -> None:
        """Have the method "local" resist changes of areas and of shapes by other weights."""
        given = {"area_stiffness": area_stiffness, "shear_stiffness": shear_stiffness}
        self._set(tr("Change stiffness"), **{name: x for name, x in given.items() if x is not None})

    def set_falloff(self, k: int, falloff: float) -> None:
        """Set the falloff of handle ``k``, a distance along the surface; 0 is none."""
        document = self._store.required_state().document
        handle = document.handles[k]
        if falloff != handle.falloff:
            handles = document.with_handle(k, replace(handle, falloff=falloff)).handles
            self._set(tr("Change falloff"), handles=handles)

    def set_staying(self, components: Sequence[int], on: bool) -> None:
        """Have loose parts stay at rest, or go along with the nearest surface.

        Parameters
        ----------
        components : sequence of int
            The lowest vertex of each.
        on : bool
        """
        staying = set(self._store.required_state().document.staying_components)
        staying = staying.union(components) if on else staying.difference(components)
        self._set(tr("Change loose parts"), staying_components=tuple(sorted(staying)))

    def set_region_area(self, k: int, percent: float | None) -> None:
        """Set the target area of region ``k``, percent of rest; None only measures it."""
        document = self._store.required_state().document
        region = document.regions[k]
        if percent != region.area:
            self._set(
                tr("Change region"), regions=document.with_region(k, replace(region, area=percent)).regions
            )

    def _set(self, gesture: str, **changes: object) -> None:
        state = self._store.required_state()
        if all(getattr(state.document, name) == value for name, value in changes.items()):
            return
        before = self._gestures.state_before
        if before is None or not have_same_paint(state.document, before.document):
            # Vertices painted by an unfinished stroke are not gripped yet, and would jump.
            state = self._gestures.state_without_gesture()
            self._gestures.record(gesture, state)
        self._store.solve(replace(state.document, **changes))  # type: ignore[arg-type]
