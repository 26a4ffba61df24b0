"""Follower of a press by the method Wall, in the background."""

import time
from collections.abc import Callable

import numpy as np

from apd_viewer.language import tr
from apd_viewer.presentation.time_left import progress_text
from apd_viewer.session.model.plate_pair import plate_pair
from apd_viewer.session.model.state import State
from apd_viewer.session.model.timeline import Timeline
from apd_viewer.session.quantities.newton_conversion import NewtonConversion
from apd_viewer.session.session import Session
from apd_viewer.ui.simulate.known_wall import KnownWall


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
