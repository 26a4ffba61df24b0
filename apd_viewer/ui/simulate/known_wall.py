"""Wall of the open mesh as typed: newtons, and the run of the Wall method."""

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
from apd_viewer.presentation.plate_readings import (
    FindConversion,
    ReadingText,
    has_given_way,
    plate_reading_texts,
    rest_verdict,
)
from apd_viewer.presentation.time_left import progress_text
from apd_viewer.session.model.state import State
from apd_viewer.session.model.timeline import Timeline
from apd_viewer.session.quantities.newton_conversion import NewtonConversion, newton_conversion
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.wall import Wall, WallText, parse_wall
from apd_viewer.session.session import Session

_MILLIMETRES = 1e3  # per metre


class KnownWall:
    """Wall of the open mesh, if thickness, elasticity and unit are known.

    Parameters
    ----------
    text : callable
        The wall as typed.
    """

    def __init__(self, session: Session, text: Callable[[], WallText]) -> None:
        self._session, self.text = session, text
        self._conversions: dict[tuple[Settings, Wall], NewtonConversion | None] = {}
        self._mesh: Mesh | None = None
        self._typed: tuple[WallText, Unit] | None = None
        self._value: Wall | None = None

    @property
    def value(self) -> Wall | None:
        """The wall as numbers; None if newtons are unknown."""
        typed = self.text(), self._session.store.unit
        if typed != self._typed:
            self._typed, self._value = typed, _known_wall(*typed)
        return self._value

    @property
    def yield_radius(self) -> float | None:
        """Radius below which the wall keeps a crease, mesh units; None where unknown."""
        return None if (wall := self.value) is None else wall.yield_radius

    def newtons(self, state: State) -> NewtonConversion | None:
        """Conversion of the loads of a state into newtons; None if unknown."""
        wall = self.value
        return None if wall is None else self._conversion(state, wall)

    def newtons_of_displayed(self, state: State) -> NewtonConversion | None:
        """Conversion for the displayed state, as pressed if it is of a run by Wall."""
        steps, k = self._session.player.timeline.steps, self._session.player.shown_step
        is_of_run = bool(steps) and k is not None and steps[k].wall_result is not None
        of_wall = is_of_run and state.document.settings.traits.is_wall
        return self.newtons_as_pressed(state) if of_wall else self.newtons(state)

    def newtons_as_pressed(self, state: State) -> NewtonConversion | None:
        """Conversion for the wall thickness of a state solved by the Wall method."""
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

    def wall_settings(self, state: State) -> dict[str, Any] | None:
        """Changes of settings, by name, for solving a state by the Wall method.

        None if the wall is unknown or not thin, or the mesh too large.
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
        if gas is not None and before is not None and after is not None:  # keeps the pressure of the gas
            changes["gas"] = gas * before.newtons_per_load / after.newtons_per_load
        return changes

    def title(self, settings: Settings) -> str:
        """Title of a wall with its thickness, from the settings of the Wall method."""
        thickness, metres = settings.wall_thickness, self._session.store.unit.metres
        if thickness is None or metres is None:
            return settings.traits.short_title
        return tr("Wall {thickness} mm").format(thickness=format_short(_MILLIMETRES * metres * thickness))


def _known_wall(text: WallText, unit: Unit) -> Wall | None:
    """Wall as typed for a mesh in ``unit``; None if its newtons are unknown."""
    try:
        wall = parse_wall(text, unit)
    except InputError:
        return None
    return None if wall.rigidity is None or wall.unit.metres is None else wall


class PressReadings:
    """Readings of the shape of a press, beside another solution of its step."""

    def __init__(self, session: Session, wall: KnownWall) -> None:
        self._session, self._wall = session, wall

    def of(
        self, state: State, timeline: Timeline
    ) -> tuple[tuple[ReadingText, ...], str, bool, tuple[str, ...]]:
        """Readings, verdict, whether that is calm, and names of both solutions.

        There are no names without another solution.
        """
        k, is_wall = timeline.index_of(state), state.document.settings.traits.is_wall
        step = None if k is None else timeline.steps[k]
        other = None if step is None else step.non_wall_state if is_wall else step.wall_result
        bend = state.document.settings.yield_radius or self._wall.yield_radius
        beside = None if other is None else (other, self._newtons(other))
        names = () if other is None else (self._name(state), self._name(other))
        newtons = (self._wall.newtons if other is None else self._newtons)(state)
        texts = plate_reading_texts(state, self._session.store.unit, newtons, beside, bend)
        return texts, *self._verdict(state, timeline, k), names

    def _verdict(self, state: State, timeline: Timeline, k: int | None) -> tuple[str, bool]:
        """Sentence on the displayed shape, and True if it is in equilibrium."""
        method = state.document.settings.traits
        if k is not None:
            wall, run = timeline.steps[k].wall_result, timeline.run_of(k)
            if wall is not None and not wall.frame.settled:
                if method.is_wall:
                    return tr("The wall did not come to rest here."), False
                said = tr("The wall did not come to rest here: this is {method}.")
                return said.format(method=method.short_title), False
            if wall is None and self._session.player.shows_wall and not method.is_wall and len(run) > 1:
                said = tr("The wall is not solved here: this is {method}.")
                return said.format(method=method.short_title), False
        said, is_calm = rest_verdict(state)
        if is_calm and k is not None:
            walls = [timeline.steps[i].wall_state for i in timeline.run_of(k) if i <= k]
            if walls[-1] is not None and has_given_way([each for each in walls if each is not None]):
                return tr("At rest. The wall has given way: small imperfections decide from there on."), True
        return said, is_calm

    def _newtons(self, state: State) -> NewtonConversion | None:
        """Conversion of loads into newtons, for a Wall result by its thickness."""
        is_wall = state.document.settings.traits.is_wall
        return (self._wall.newtons_as_pressed if is_wall else self._wall.newtons)(state)

    def _name(self, state: State) -> str:
        """Name of the method of a state, with the thickness of a wall."""
        settings = state.document.settings
        return self._wall.title(settings) if settings.traits.is_wall else settings.traits.short_title


class WallRunController:
    """Starts, stops and reports a run of the Wall method after a press.

    Parameters
    ----------
    timeline : callable
        Steps of the open mesh.

    Attributes
    ----------
    is_due : bool
        True to start the run once the current press has ended.
    """

    def __init__(self, session: Session, wall: KnownWall, timeline: Callable[[], Timeline]) -> None:
        self._session, self._wall, self._timeline = session, wall, timeline
        self.is_due, self._began = False, 0.0
        self._pressed: State | None = None

    def begin_or_stop(self) -> None:
        """Start solving the run of the displayed step by the Wall method, or stop it."""
        run = self._session.wall_run
        if run.is_running:
            run.stop()
        elif (k := self._number) is not None:
            self._begin(k)

    def _begin(self, k: int) -> None:
        pressed = self._timeline().steps[k].state
        settings = self._wall.wall_settings(pressed)
        if settings is not None:
            self._pressed, self._began = pressed, time.monotonic()
            self._session.wall_run.begin(k, settings)

    def update(self) -> None:
        """Start the run if it is due after a press; stop it if the wall has changed."""
        run, pressed, steps = self._session.wall_run, self._pressed, self._timeline().steps
        if run.is_running and pressed is not None and self._wall.wall_settings(pressed) != run.settings:
            run.stop(tr("The wall has changed: it is solved no further."))
        if self.is_due and not self._session.player.is_playing:
            self.is_due = False
            if steps and steps[-1].state is self._session.store.state:
                self._begin(len(steps) - 1)

    @property
    def may_begin(self) -> bool:
        """True if the Wall method can solve steps in the run of the displayed step."""
        k, timeline = self._number, self._timeline()
        is_busy = self._session.player.is_playing or self._session.wall_run.is_running
        if k is None or is_busy or len(timeline.run_of(k)) == 1:
            return False
        settings = self._wall.wall_settings(timeline.steps[k].state)
        # Steps are solved in order, so it suffices to check the last one.
        return settings is not None and timeline.steps[timeline.run_of(k)[-1]].lacks_wall_result(settings)

    @property
    def _number(self) -> int | None:
        """Number of the displayed step, else of the last one; None without steps."""
        steps, shown = self._timeline().steps, self._session.player.shown_step
        return None if not steps else len(steps) - 1 if shown is None else shown

    @property
    def progress(self) -> str:
        """Sentence about the progress of the run; empty if none is running."""
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
        """Newtons per load at each step, for its state and that by Wall; NaN if unknown."""
        first, own = self._wall.newtons, self._wall.newtons_as_pressed
        return [
            (_per_load(step.state, first), _per_load(step.wall_state, own)) for step in self._timeline().steps
        ]


def _per_load(state: State | None, newtons: FindConversion) -> float:
    found = None if state is None else newtons(state)
    return np.nan if found is None else found.newtons_per_load
