"""A guided surface that, once it has come to rest, is guided again from there, as long as that leads lower.

A surface that buckles has many shapes at rest, and the coarse one knows fewer of them: led by it from where
the fine one rests, folds open that the fine one cannot open by itself. That is tried out of sight: what is
shown is the best shape so far, until a better one is found.
"""

from __future__ import annotations

import numpy as np

from apd_viewer.geometry.solver.goals import Goal
from apd_viewer.geometry.solver.multilevel import Guided

# Another shape is worth moving to if it takes so much of the energy away.
_GAIN = 1e-3
# A try has ended where ten steps bring less than that of the energy, and it is not lower yet.
_HOPE = 1e-4
# The way down may lead over a shape or two that are higher.
_PATIENCE = 1
# A coarse surface that goes no farther than that of its size, led from there, has nothing else to show.
_ALIKE = 5e-3


class Cycled(Guided):
    """Iterations as of :class:`Guided`, several times over."""

    _tries = False

    @property
    def U(self) -> np.ndarray:
        """The shape to show, (n, 3) float array."""
        return self._best[1][0] if self._tries else super().U

    @property
    def energy(self) -> float | None:
        """The energy of ``U``; None if it is not known."""
        return self._best[0] if self._tries else super().energy

    @property
    def hides(self) -> bool:
        """Whether ``U`` is not the shape that is iterated."""
        return self._tries or super().hides

    @property
    def exhausted(self) -> bool:
        """Whether there is no lower shape to be found this way."""
        return self._done

    def keep(self, goals: tuple[Goal, ...]) -> None:
        """Meet these goals from now on."""
        self._leave_off()
        super().keep(goals)

    def aim(self, targets: np.ndarray) -> None:
        """Hold the fixed vertices at ``targets`` (k + s, 3) from now on, and draw the soft ones there."""
        self._leave_off()
        super().aim(targets)

    def _hope_again(self) -> None:
        self._best: tuple[float, list[np.ndarray], np.ndarray] = (np.inf, [], np.zeros(0))
        self._ends: list[float] = []
        self._tries = self._done = False
        super()._hope_again()

    def descend(self) -> None:
        """Go on as a guided surface does, and again from where that has ended."""
        super().descend()
        energy = self._elastic.energy if self._tries else np.inf
        # Once it is shown it stays: to and fro would flicker.
        self._tries = self._tries and not energy < (1.0 - _GAIN) * self._best[0]
        if self._tries and (self.stuck or self._agrees or self._fails(energy)):
            self._leave_off()
            self._done = True
        elif self.stuck:
            self._done = True
        elif super().exhausted or (self._tries and self._hopeless):
            self._try_again()

    @property
    def _agrees(self) -> bool:
        """Whether the coarse surface rests where the fine one does."""
        if not self._coarse.settled:
            return False
        before, now = self._led_from, self._coarse.shapes()[0]
        return float(np.abs(now - before).max()) <= _ALIKE * float(np.ptp(before, axis=0).max())

    @property
    def _hopeless(self) -> bool:
        return self._coarse.settled and self._gained_at_most(_HOPE)

    def _fails(self, energy: float) -> bool:
        """Whether a try has ended, and there is no point in another one."""
        if not (super().exhausted or self._hopeless):
            return False
        been_there = any(abs(energy - end) <= _GAIN * end for end in self._ends)
        return been_there or len(self._ends) - int(np.argmin(self._ends)) > _PATIENCE

    def _try_again(self) -> None:
        """Be guided from the shape that was arrived at; the best one is shown meanwhile."""
        energy, best, ends = self._elastic.energy, self._best, self._ends
        if energy < best[0]:
            best = energy, self.shapes(), self._mult
        self.restart(self._elastic.U)
        self._previews = False
        self._led_from = self._coarse.shapes()[0]
        self._best, self._ends, self._tries = best, [*ends, energy], True

    def _leave_off(self) -> None:
        """Go back to the best shape, if another one is being tried."""
        if self._tries:
            _, shapes, mult = self._best
            self.put_back(shapes)
            self._mult = mult
