"""All goals of a solve, and the regions measured with them."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.goals.goal_projection import GOAL_TOLERANCE
from apd_viewer.geometry.goals.goals import (
    Goal,
    Region,
    RegionReading,
    filled_volume_goal,
    make_goals,
    region_patch,
)
from apd_viewer.geometry.goals.target_values import percentage
from apd_viewer.geometry.linalg.threads import cores_for
from apd_viewer.geometry.mesh.arrays import check_argument
from apd_viewer.geometry.solver.methods import Method
from apd_viewer.language import comma_separated, tr

_CALM_GAVE_WAY = tr("Calm parts give way in this pose: with their areas kept, the targets are out of reach.")


class GoalSet:
    """Goals of the area, the volume and of regions.

    Parameters
    ----------
    rest : RestMesh
    name : str
        Of the method.
    method : Method
    tolerance : float
        Relative error of the total area that "paper" accepts.
    levels : callable
        The levels of calmness, (k, n) float array.
    filled_volume : float, optional
        Volume to hold, cubic mesh units, in place of a percentage.

    Attributes
    ----------
    goals : tuple of Goal
    regions : tuple of Region
    """

    def __init__(
        self,
        rest: RestMesh,
        name: str,
        method: Method,
        tolerance: float,
        levels: Callable[[], np.ndarray],
        filled_volume: float | None = None,
    ) -> None:
        check_argument("tolerance", tolerance)
        self._rest, self._filled_volume = rest, filled_volume
        self._levels = cache(levels)
        self._name = name
        self._method = method
        self._tolerance = tolerance
        self.goals: tuple[Goal, ...] = ()
        self._dropped: tuple[Goal, ...] = ()
        self._retries = 1
        self.regions: tuple[Region, ...] = ()

    def set_targets(
        self, area: float | str | None, volume: float | str | None, regions: Sequence[Region], calm: bool
    ) -> None:
        """Replace all goals by percentages of the rest values.

        Parameters
        ----------
        area, volume, regions, calm
            See :class:`~apd_viewer.geometry.solver.deformation.Deformation`.

        Raises
        ------
        InputError
            If the method cannot keep them, a percentage is no target, or there is nothing to measure.
        """
        patches = [region_patch(self._rest, region) for region in regions]
        if area is None and self._method.keeps_total_area:
            area = 100.0
        filled = self._filled_volume
        if filled is not None and volume is not None:
            raise InputError(tr("A volume is given in percent and in cubic mesh units; omit one of them."))
        others = (
            filled is not None or volume is not None or any(region.area is not None for region in regions)
        )
        if others and self._method.keeps_only_total_area:
            raise InputError(
                tr(
                    "The method {method!r} keeps only the total area; "
                    "choose 'exact' for a volume or a region."
                ).format(method=self._name)
            )
        levels = self._levels() if calm and self._method.keeps_calm_parts else None
        goals = make_goals(self._rest, area, volume, regions, levels)
        if filled is not None:
            goals = *goals, filled_volume_goal(self._rest, filled, area)
        self.goals = self._with_tolerance(goals)
        self.regions, self._patches, self._dropped = tuple(regions), patches, ()

    @property
    def tolerance(self) -> float:
        """Relative error of the total area accepted by the "paper" method."""
        return self._tolerance

    @tolerance.setter
    def tolerance(self, tolerance: float) -> None:
        check_argument("tolerance", tolerance)
        self._tolerance = tolerance
        self.goals, self._dropped = self._with_tolerance(self.goals), self._with_tolerance(self._dropped)

    def _with_tolerance(self, goals: tuple[Goal, ...]) -> tuple[Goal, ...]:
        return tuple(replace(goal, tolerance=self._tolerance) for goal in goals)

    def region_areas(self, U: np.ndarray) -> tuple[float, ...]:
        """Areas of the regions at positions ``U`` (n, 3) of the solve mesh."""
        return tuple(patch.area(U) for patch in self._patches)

    def readings(self, areas: Sequence[float]) -> tuple[RegionReading, ...]:
        """Readings of the regions with the current ``areas``."""
        V = self._rest.solve_mesh.V
        with cores_for(len(V)):
            at_rest = self.region_areas(V)
        return tuple(
            RegionReading(region.name, rest, area, _target(region, rest))
            for region, rest, area in zip(self.regions, at_rest, areas, strict=True)
        )

    def target(self, name: str) -> float | None:
        """Target of "the area" or "the volume"; None without one."""
        return next((goal.target for goal in self.goals if goal.name == name), None)

    @property
    def has_calm_goals(self) -> bool:
        """True if areas of calm parts are among the goals."""
        return any(goal.is_smooth for goal in self.goals)

    @property
    def has_dropped_calm_goals(self) -> bool:
        """True if goals of calm parts are temporarily dropped."""
        return bool(self._dropped)

    def drop_calm_goals(self) -> None:
        """Drop the goals of calm parts until the next :meth:`restore_dropped_goals`."""
        self._dropped, self.goals = self.goals, tuple(goal for goal in self.goals if not goal.is_smooth)

    def restore_dropped_goals(self) -> bool:
        """Restore the dropped goals for another pose; False if none was dropped."""
        self._retries = 1
        if not self._dropped:
            return False
        self.goals, self._dropped = self._dropped, ()
        return True

    @property
    def may_retry_dropped_goals(self) -> bool:
        """True if the dropped goals have not been retried at the converged shape.

        On the way from a pose far away they may be missed although they can be kept.
        """
        return bool(self._dropped) and self._retries > 0

    def retry_dropped_goals(self) -> None:
        """Restore the dropped goals for one more attempt."""
        self.restore_dropped_goals()
        self._retries = 0

    def out_of_reach_sentence(self, values: np.ndarray | None) -> str | None:
        """Sentence about goals out of reach; ``values`` are those of abandoned goals."""
        missed = None if values is None else self.missed_goals_sentence(values)
        if missed is None:
            return _CALM_GAVE_WAY if self.has_dropped_calm_goals else None
        return tr(
            "Out of reach in this pose: {missed}. Move the handle less or choose another target."
        ).format(missed=missed)

    def missed_goals_sentence(self, values: np.ndarray) -> str | None:
        """Goals not met by their ``values``, as a sentence; None if all are met."""
        # Li & Hui's method approaches the target in rounds: a deviation in between is no failure.
        if self._method.has_tolerance:
            return None
        missed = [
            goal.shortfall_sentence(float(value))
            for goal, value in zip(self.goals, values, strict=True)
            if abs(goal.relative_deviation(float(value))) > GOAL_TOLERANCE and not goal.is_smooth
        ]
        return comma_separated(missed) or None


def _target(region: Region, rest: float) -> float | None:
    return None if region.area is None else rest * percentage(region.area, region.name) / 100.0
