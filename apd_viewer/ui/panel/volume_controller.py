"""Controller of shape checks and walls in panel, findings and preferences."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from functools import partial
from weakref import WeakKeyDictionary

import numpy as np
from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QInputDialog

from apd_viewer.errors import InputError
from apd_viewer.files.samples import sample_of
from apd_viewer.files.storage.atomic_file import resolved_path
from apd_viewer.geometry.energy.wall_map import WallMap
from apd_viewer.geometry.mesh.arrays import diagonal
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.solver.methods import wall_material as thin_wall_material
from apd_viewer.geometry.solver.settings import DEFAULT_SETTINGS
from apd_viewer.language import tr
from apd_viewer.presentation.number_format import format_editable, format_significant
from apd_viewer.presentation.scales import Measure
from apd_viewer.session.model.document_parts import painted_parts
from apd_viewer.session.model.state import State
from apd_viewer.session.model.status_text import crossing_findings, exempt_zone_findings
from apd_viewer.session.model.view import View
from apd_viewer.session.quantities.newton_conversion import settings_pascals
from apd_viewer.session.quantities.wall import NO_WALL, WallText, parse_wall, with_part_thickness
from apd_viewer.session.quantities.wall_distribution import (
    ColorScaleError,
    WallDistribution,
    read_distribution,
)
from apd_viewer.session.quantities.wall_material import wall_material
from apd_viewer.session.session import Session
from apd_viewer.ui.filing import file_dialogs
from apd_viewer.ui.overlays.deviation_overlay import DeviationOverlay
from apd_viewer.ui.overlays.findings_controller import FindingsController
from apd_viewer.ui.panel.panel import Panel
from apd_viewer.ui.preferences.preferences import Preferences, user_file

_OF_WALL = "wall_thickness", "poisson", "yield_radius"


class VolumeController(QObject):
    """Synchronizes panel, findings and preferences with the shape checks.

    The wall of a mesh is remembered for its file; for samples, and for meshes without a file, only as long as
    the mesh is open.

    Parameters
    ----------
    overlay : DeviationOverlay
        Overlay restored from the view of a session.

    Attributes
    ----------
    failed : Signal(str)
        A wall distribution cannot be used, and why.
    """

    failed = Signal(str)

    def __init__(
        self,
        panel: Panel,
        findings: FindingsController,
        preferences: Preferences,
        overlay: DeviationOverlay,
        session: Session,
    ) -> None:
        super().__init__(panel)
        self._panel = panel
        self._health = findings
        self._memory = preferences
        self._heat = overlay
        self._session = session
        self._walls: WeakKeyDictionary[Mesh, WallText] = WeakKeyDictionary()
        self._mesh: Mesh | None = None
        self._texts: dict[float | None, str] = {}
        self._followed: set[tuple[str, float | None]] = {
            (name, getattr(DEFAULT_SETTINGS, name)) for name in _OF_WALL
        }
        panel.measures.wall_fields.entered.connect(self._type)
        panel.measures.wall_fields.entered.connect(self.update_wall_settings)
        panel.measures.wall_fields.from_file.triggered.connect(self._ask_for_distribution)
        panel.measures.wall_fields.places.menu().aboutToShow.connect(self._offer_parts)
        panel.method.contact_chosen.connect(self._set_contact)
        panel.method.wall_creases_chosen.connect(self._use_yield_radius)
        panel.volume.target.field.find_pascals = self.pascals_per_pressure
        panel.volume.crossings.clicked.connect(findings.open_at_last_finding)

    def show_check(self) -> None:
        """Show the latest check results of the displayed shape."""
        if (state := self._session.store.state) is None:
            return
        checks, mesh = self._session.shape_checks, state.document.mesh
        found = checks.shape_check
        self._panel.measures.show_check(found, checks.rest_check)
        self._panel.volume.show_check(state, found, checks.is_checking)
        self._panel.handles.show_check(state, found)
        exempt = (
            exempt_zone_findings(mesh, checks.rest_check.crossing)
            if state.is_contact_active and checks.rest_check
            else ()
        )
        crossing = crossing_findings(mesh, found.crossing) if found is not None else ()
        self._health.show_shape_findings((*exempt, *crossing))

    def show_mesh_wall(self, mesh: Mesh) -> None:
        """Show the remembered wall of an opened mesh."""
        if mesh not in self._walls:
            path, sample = user_file(mesh), sample_of(mesh.path)
            known = {} if path is None else self._memory.walls
            usual = WallText(material=wall_material(sample.material if sample else ""))
            remembered = usual if path is None else known.get(resolved_path(path), usual)
            self._walls[mesh] = self._carried_wall(mesh) or remembered
        self._mesh = mesh
        self._panel.measures.show_wall(self._walls[mesh])
        self._show_yield_radius()
        self._show_distribution()

    def _carried_wall(self, mesh: Mesh) -> WallText | None:
        """Wall distribution of another rest shape of the same mesh; None without."""
        before, wall = self._mesh, self._panel.measures.wall_fields.value
        if before is None or before.path != mesh.path or not np.array_equal(before.F, mesh.F):
            return None
        typed = wall.thickness
        return wall._replace(thickness=typed.on(mesh)) if isinstance(typed, WallDistribution) else None

    def follow_settings(self, old: State | None, new: State) -> None:
        """Update checks and wall fields after changes of contact or wall thickness."""
        if old is None or old.document.mesh is not new.document.mesh:
            return
        if (old.is_contact_active, old.is_safe_from_crossing) != (
            new.is_contact_active,
            new.is_safe_from_crossing,
        ):
            self.show_check()
        thickness, wall = new.document.settings.thickness, self._panel.measures.wall_fields.value
        is_typed = thickness == wall.contact_distance(self._session.store.unit)
        if new.document.settings.contact and thickness != old.document.settings.thickness and not is_typed:
            bare = "" if thickness is None else format_editable(thickness, 12)
            wall = wall._replace(thickness=self._texts.get(thickness, bare))
            self._panel.measures.show_wall(wall)
            self._type(wall)

    def restore_view(self, view: View) -> None:
        """Apply wall and overlay of a session's view; missing values have no effect."""
        if view.wall != NO_WALL:
            self._type(view.wall)
            self._panel.measures.show_wall(view.wall)
            self._show_yield_radius()
            self._show_distribution()
        # Sessions of later versions may name overlays unknown to this one.
        measure = next((measure for measure in Measure if measure.value == view.overlay), None)
        if measure is not self._heat.measure and (measure is not None or view.overlay == ""):
            self._heat.choose_measure(measure)

    def with_wall_and_overlay(self, view: View) -> View:
        """Copy of a view with the current wall and overlay added."""
        measure = self._heat.measure
        overlay = "" if measure is None else measure.value
        return replace(view, wall=self._panel.measures.wall_fields.value, overlay=overlay)

    def _type(self, wall: WallText) -> None:
        if (state := self._session.store.state) is None:
            return
        mesh = state.document.mesh
        self._walls[mesh] = wall
        path = user_file(mesh)
        if path is not None:
            # The memory of files holds texts only: a wall distribution is kept in sessions.
            is_mapped = isinstance(wall.thickness, WallDistribution)
            self._memory.remember_wall(path, wall._replace(thickness="") if is_mapped else wall)

    def _ask_for_distribution(self) -> None:
        """Ask for a file of a wall distribution, and colour the shape by it."""
        if (state := self._session.store.state) is None:
            return
        path = file_dialogs.ask_for_wall_distribution(self._panel, self._memory.last_folder)
        if path is None:
            return
        wall, mesh = self._panel.measures.wall_fields.value, state.document.mesh

        def distribution() -> WallText:
            unit, scale = self._session.store.unit, ""
            while True:
                try:
                    return wall._replace(thickness=read_distribution(path, mesh, unit, scale))
                except ColorScaleError:
                    scale, is_given = self._ask_for_scale()
                    if not is_given:
                        return wall

        self._use(mesh, distribution)

    def _ask_for_scale(self) -> tuple[str, bool]:
        """Thickness of black and white as typed, and False if cancelled."""
        label = tr("Thickness of black and of white, in proportion to the colours between them:")
        return QInputDialog.getText(self._panel, tr("Thickness by colours"), label, text="0.2mm..0.8mm")

    def _offer_parts(self) -> None:
        """Offer another thickness for each part that is painted."""
        menu = self._panel.measures.wall_fields.places.menu()
        for action in menu.actions()[1:]:
            menu.removeAction(action)
        if (state := self._session.store.state) is None:
            return
        for part, inside in painted_parts(state.document):
            title = tr("Thickness of “{part}”…").format(part=part.replace("&", "&&"))
            menu.addAction(title, partial(self._ask_for_part, part, inside))

    def _ask_for_part(self, part: str, inside: np.ndarray) -> None:
        """Ask for the thickness of a part, and colour the shape by it."""
        fields, mesh = self._panel.measures.wall_fields, self._session.store.required_state().document.mesh
        title, label = tr("Thickness of a part"), tr("Wall thickness of “{part}”, such as 0.1mm:")
        own, is_given = QInputDialog.getText(self._panel, title, label.format(part=part))
        if is_given:
            unit = self._session.store.unit
            self._use(mesh, lambda: with_part_thickness(fields.value, own, inside, mesh, unit))

    def _use(self, mesh: Mesh, distribution: Callable[[], WallText]) -> None:
        """Take a wall of a mesh, and colour the shape by it; tell why it cannot be used."""
        fields, store = self._panel.measures.wall_fields, self._session.store
        try:
            wall = distribution() if store.required_state().document.mesh is mesh else None
            if wall is None or store.required_state().document.mesh is not mesh:  # opened under a dialog
                raise InputError(tr("Another mesh was opened meanwhile; enter the thickness again."))
        except InputError as error:
            self.failed.emit(str(error))
            return
        self._panel.measures.show_wall(wall)
        fields.entered.emit(wall)
        if isinstance(wall.thickness, WallDistribution):
            self._heat.choose_measure(Measure.THICKNESS)

    def _show_distribution(self) -> None:
        """Offer the wall distribution as an overlay."""
        thickness = self._panel.measures.wall_fields.value.usable_thickness(self._session.store.unit)
        if not isinstance(thickness, WallMap):
            self._heat.set_thickness(None)
            return
        mesh = self._session.store.required_state().document.mesh
        self._heat.set_thickness(thickness.at_vertices(mesh.F, len(mesh.V)))

    def update_contact_distance(self) -> None:
        """Set the contact distance to the wall thickness, if contact is on."""
        state = self._session.store.state
        thickness = self._panel.measures.wall_fields.value.contact_distance(self._session.store.unit)
        if (
            state is not None
            and state.document.settings.contact
            and state.document.settings.thickness != thickness
        ):
            self._set_contact(True)

    def update_wall_settings(self) -> None:
        """Update the settings that are derived from the wall and the unit."""
        if (state := self._session.store.state) is None:
            return
        self._show_yield_radius()
        self._show_distribution()
        self.update_contact_distance()
        settings = state.document.settings
        names = ["yield_radius"] if settings.yield_radius is not None else []
        names += ["wall_thickness", "poisson"] if settings.traits.is_wall else []
        changes = self.wall_settings(*names) if names else {}
        pascals = self.pascals_per_pressure(changes.get("wall_thickness", settings.wall_thickness))
        changes |= self._panel.volume.target.field.renewed_pressure(settings, pascals)
        if changes:
            self._session.settings.change(**changes)
        self._panel.volume.show_settings(self._session.store.required_state())

    def pascals_per_pressure(self, thickness: float | None = None) -> float | None:
        """Pascals of a pressure of 1 in the settings; None without Young's modulus.

        Parameters
        ----------
        thickness : float, optional
            Of the wall, mesh units; by default that of the settings.
        """
        state = self._session.store.required_state()
        settings, size = state.document.settings, diagonal(state.document.mesh.V)
        settings = replace(settings, wall_thickness=thickness or settings.wall_thickness)
        fields = self._panel.measures.wall_fields
        return settings_pascals(settings, size, fields.value, self._session.store.unit)

    def wall_settings(self, *names: str) -> dict[str, float | None]:
        """Settings by name that are derived from the wall, unless typed elsewhere.

        Thickness and Poisson's ratio of the Wall method, and the yield radius; none if the wall is invalid or
        not thin.
        """
        state = self._session.store.required_state()
        try:
            wall = parse_wall(self._panel.measures.wall_fields.value, self._session.store.unit)
            thin_wall_material(diagonal(state.document.mesh.V), wall.thickness, wall.nu)
        except InputError:
            return {}
        known = dict(zip(_OF_WALL, (wall.thickness, wall.poisson, wall.yield_radius), strict=True))
        changes = {
            name: getattr(DEFAULT_SETTINGS, name) if known[name] is None else known[name]
            for name in names
            if (name, getattr(state.document.settings, name)) in self._followed
        }
        self._followed.update(changes.items())
        return changes

    @property
    def _yield_radius(self) -> float | None:
        """Yield radius of the wall in mesh units; None if unknown."""
        with suppress(InputError):
            return parse_wall(self._panel.measures.wall_fields.value, self._session.store.unit).yield_radius
        return None

    def _show_yield_radius(self) -> None:
        radius, unit = self._yield_radius, self._session.store.unit
        said = "" if radius is None else unit.format_length(format_significant(radius, 3))
        self._panel.method.show_wall_creases(said)

    def _use_yield_radius(self) -> None:
        """Set the yield radius to that of the wall; later it follows the wall."""
        if (radius := self._yield_radius) is not None:
            self._followed.add(("yield_radius", radius))
            self._session.settings.change(yield_radius=radius)

    def contact_distance(self) -> float | None:
        """Typed wall thickness in mesh units; None if there is none."""
        return self._panel.measures.wall_fields.value.contact_distance(self._session.store.unit)

    def _set_contact(self, on: bool) -> None:
        """Turn contact on or off; its distance is the wall thickness."""
        wall, unit = self._panel.measures.wall_fields.value, self._session.store.unit
        thickness = wall.contact_distance(unit)
        self._texts[thickness] = wall.thickness
        self._session.settings.set_contact(on, thickness)
        self._panel.method.show_settings(self._session.store.required_state().document)
