"""Wall of the open mesh as typed: newtons, and its run behind a press."""

import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.solver.methods import check_wall_size, wall_material
from apd_viewer.geometry.solver.settings import Settings
from apd_viewer.language import tr
from apd_viewer.presentation.number_format import format_short
from apd_viewer.presentation.time_left import progress_text
from apd_viewer.session.model.plate_pair import plate_pair
from apd_viewer.session.model.state import State
from apd_viewer.session.model.timeline import Timeline
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

    @property
    def yield_radius(self) -> float | None:
        """Radius below which the wall keeps a crease, mesh units; None where unknown."""
        return None if (wall := self.value) is None else wall.yield_radius

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
        settings, mesh = state.document.settings.effective_settings, state.document.mesh
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


class WallFollower:
    """Begins, ends and tells the run of the wall behind a press.

    Parameters
    ----------
    timeline : callable
        Steps of the open mesh.

    Attributes
    ----------
    is_due : bool
        The wall follows once the press under way has ended.
    """

    def __init__(self, session: Session, wall: KnownWall, timeline: Callable[[], Timeline]) -> None:
        self._session, self._wall, self._timeline = session, wall, timeline
        self.is_due, self._began = False, 0.0
        self._pressed: State | None = None

    def begin_or_stop(self) -> None:
        """Solve the run of the step on screen by the method Wall, or stop doing so."""
        run = self._session.wall_run
        if run.is_running:
            run.stop()
        elif (k := self._number) is not None:
            self._begin(k)

    def _begin(self, k: int) -> None:
        pressed = self._timeline().steps[k].state
        settings = self._wall.settings(pressed)
        if settings is not None:
            self._pressed, self._began = pressed, time.monotonic()
            self._session.wall_run.begin(k, settings)

    def follow(self) -> None:
        """Begin behind a press that has ended; stop where the wall has become another one."""
        run, pressed, steps = self._session.wall_run, self._pressed, self._timeline().steps
        if run.is_running and pressed is not None and self._wall.settings(pressed) != run.settings:
            run.stop(tr("The wall has changed: it is solved no further."))
        if self.is_due and not self._session.player.is_playing:
            self.is_due = False
            if steps and steps[-1].state is self._session.store.state:
                self._begin(len(steps) - 1)

    @property
    def may_begin(self) -> bool:
        """True if the run of the step on screen has steps to be solved."""
        k, timeline = self._number, self._timeline()
        is_busy = self._session.player.is_playing or self._session.wall_run.is_running
        if k is None or is_busy or len(timeline.run_of(k)) == 1:
            return False
        settings = self._wall.settings(timeline.steps[k].state)
        # In order: the last step is the last to be answered.
        return settings is not None and timeline.steps[timeline.run_of(k)[-1]].lacks_answer(settings)

    @property
    def _number(self) -> int | None:
        """Number of the step on screen, or of the last one; None without steps."""
        steps, shown = self._timeline().steps, self._session.player.shown
        return None if not steps else len(steps) - 1 if shown is None else shown

    @property
    def progress(self) -> str:
        """Sentence on the run under way; empty without one."""
        run = self._session.wall_run
        if not run.is_running or self._pressed is None:
            return ""
        said = tr("{wall}: step {k} of {count}").format(
            wall=self._wall.title(self._pressed.document.with_settings(**run.settings).settings),
            k=run.done + 1,
            count=run.count,
        )
        return progress_text(said, time.monotonic() - self._began, run.done, run.count)

    # Readings

    def newtons_per_load(self) -> list[tuple[float, float]]:
        """Newtons of a load of 1 at each step, and of the wall there; NaN where unknown."""
        first, own = self._wall.newtons, self._wall.newtons_as_pressed
        return [(_per_load(step.state, first), _per_load(step.wall, own)) for step in self._timeline().steps]

    def force(self, answer: State | None) -> float | None:
        """Newtons between the plates in an answer of the wall; None where unknown."""
        pair = None if answer is None else plate_pair(answer.document)
        if answer is None or pair is None or not answer.frame.settled:
            return None
        force = pair.reading(answer).load * _per_load(answer, self._wall.newtons_as_pressed)
        return None if np.isnan(force) else max(0.0, force)


def _per_load(state: State | None, newtons: Callable[[State], NewtonConversion | None]) -> float:
    found = None if state is None else newtons(state)
    return np.nan if found is None else found.newtons_per_load
