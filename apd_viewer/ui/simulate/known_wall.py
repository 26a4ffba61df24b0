"""Wall of the open mesh as typed: newtons, and settings of its method."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from apd_viewer.errors import InputError
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.solver.methods import check_wall_size, wall_material
from apd_viewer.geometry.solver.settings import Settings
from apd_viewer.language import tr
from apd_viewer.presentation.number_format import format_short
from apd_viewer.session.model.state import State
from apd_viewer.session.quantities.newton_conversion import NewtonConversion, newton_conversion
from apd_viewer.session.quantities.wall import Wall, WallText, parse_wall
from apd_viewer.session.session import Session

_MILLIMETRES = 1e3  # in a metre


class KnownWall:
    """Wall of the open mesh, where thickness, elasticity and unit are known.

    Parameters
    ----------
    text : callable
        The wall as typed.
    """

    def __init__(self, session: Session, text: Callable[[], WallText]) -> None:
        self._session, self.text = session, text
        self._conversions: dict[tuple[Settings, Wall], NewtonConversion | None] = {}
        self._mesh: Mesh | None = None

    @property
    def value(self) -> Wall | None:
        """The wall as numbers; None where newtons are not known."""
        try:
            wall = parse_wall(self.text(), self._session.store.unit)
        except InputError:
            return None
        return None if wall.rigidity is None or wall.unit.metres is None else wall

    def newtons(self, state: State) -> NewtonConversion | None:
        """Conversion of the loads of a state into newtons; None where unknown."""
        wall = self.value
        return None if wall is None else self._conversion(state, wall)

    def newtons_as_pressed(self, state: State) -> NewtonConversion | None:
        """Conversion for a wall as thick as that of a state by the method Wall."""
        wall, settings = self.value, state.document.settings
        if wall is not None and settings.wall_thickness is not None:
            wall = replace(wall, thickness=settings.wall_thickness, poisson=settings.poisson)
        return None if wall is None else self._conversion(state, wall)

    def _conversion(self, state: State, wall: Wall) -> NewtonConversion | None:
        settings, mesh = state.document.settings.in_effect, state.document.mesh
        if self._mesh is not mesh:
            self._mesh, self._conversions = mesh, {}
        if (settings, wall) not in self._conversions:
            rest, material = RestMesh(mesh.V, mesh.F, mesh.weld), settings.material
            if settings.traits.is_wall:
                material = wall_material(rest.diagonal, settings.wall_thickness, settings.poisson)
            self._conversions[settings, wall] = newton_conversion(wall, material, rest)
        return self._conversions[settings, wall]

    def settings(self, state: State) -> dict[str, Any] | None:
        """Settings by name that make the document of a state one of the method Wall.

        None where the wall is not known or not thin, or the mesh too large.
        """
        wall, document = self.value, state.document
        if wall is None:
            return None
        changes: dict[str, Any] = {"method": "wall", "wall_thickness": wall.thickness, "poisson": wall.nu}
        own, gas = state.updated(document.with_settings(**changes)), document.settings.gas
        try:
            check_wall_size(len(document.mesh.weld.first))
            before, after = self.newtons(state), self._conversion(own, wall)
        except InputError:
            return None
        if gas is not None and before is not None and after is not None:  # the same pressure
            changes["gas"] = gas * before.newtons_per_load / after.newtons_per_load
        return changes

    def title(self, settings: Settings) -> str:
        """Title of a wall by the settings of its method, with its thickness."""
        thickness, metres = settings.wall_thickness, self._session.store.unit.metres
        if thickness is None or metres is None:
            return settings.traits.short_title
        return tr("Wall {thickness} mm").format(thickness=format_short(_MILLIMETRES * metres * thickness))
