"""Goals: target values of areas and of the volume."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.energy.solve_mesh import SolveMesh
from apd_viewer.geometry.goals.target_values import GOAL_WORDS, check_fits_in_ball, percentage
from apd_viewer.geometry.mesh.arrays import check_argument, checked_integers, used_vertices
from apd_viewer.geometry.mesh.operators import volume
from apd_viewer.geometry.mesh.weighted_areas import Patch, WeightedAreas, triangle_weights
from apd_viewer.language import in_quotes, tr


@dataclass(frozen=True, eq=False)
class Region:
    """Named region of a mesh: the triangles with all corners among its vertices.

    Attributes
    ----------
    name : str
    vertices : int array
        Ids in the order of the file.
    area : float, str or None
        Target area in percent of the area at rest; None only measures it. Below 10 as text
        with its sign, such as ``"5%"``.

    Examples
    --------
    >>> import apd_viewer
    >>> import numpy as np
    >>> mesh = apd_viewer.open_mesh("bottle.obj")
    >>> label = apd_viewer.Region("label", np.flatnonzero(abs(mesh.V[:, 1] - 10) < 2), area=100)
    >>> len(label.vertices)
    1998
    """

    name: str
    vertices: np.ndarray
    area: float | str | None = None


@dataclass(frozen=True)
class RegionReading:
    """Rest area and current area of a region, and its target, if any."""

    name: str
    area_rest: float
    area: float
    area_target: float | None


@dataclass(frozen=True, eq=False)
class Goal:
    """Target value of an area or a volume.

    Attributes
    ----------
    name : str
        "the area", "the volume", the name of a region or of a level of calmness.
    patch : Patch
        All triangles, in vertices of the solve mesh.
    rest, target : float
        Value at rest, and the value asked for.
    weight : (n,) float array or None
        Fraction of the area around each vertex in the goal; None for all of it, or for the volume.
    is_smooth : bool
        A triangle has the mean of its corners' weights; without, the least, so that only those count that
        are wholly inside.
    is_volume : bool
    is_absolute : bool
        The target is a value in mesh units, and not a part of that at rest.
    tolerance : float
        Relative error that is accepted, where the goal is not met to the last digits.
    """

    name: str
    patch: Patch
    rest: float
    target: float
    weight: np.ndarray | None = None
    is_smooth: bool = False
    is_volume: bool = False
    is_absolute: bool = False
    tolerance: float = 0.0

    @property
    def triangle_fractions(self) -> np.ndarray:
        """Fraction of every triangle included in the goal, (m,) float32 array."""
        return triangle_weights(self.patch.F, self.weight, self.is_smooth)

    def relative_deviation(self, value: float) -> float:
        """Signed deviation of a value from its target, relative to the rest value."""
        return (value - self.target) / abs(self.rest)

    def shortfall_sentence(self, value: float) -> str:
        """Sentence about a value short of the target."""
        if self.is_absolute:
            return tr("{name} is at {reached:.4g} instead of {wanted:.4g} cubic mesh units").format(
                name=GOAL_WORDS.get(self.name, self.name), reached=value, wanted=self.target
            )
        reached, wanted = 100.0 * value / self.rest, 100.0 * self.target / self.rest
        # Enough digits to show the difference between value and target.
        digits = next((d for d in range(4, 17) if f"{reached:.{d}g}" != f"{wanted:.{d}g}"), 17)
        return tr("{name} is at {reached:.{digits}g} % instead of {wanted:.4g} %").format(
            name=GOAL_WORDS.get(self.name, self.name), reached=reached, digits=digits, wanted=wanted
        )


class GoalMeasures:
    """Values and gradients of goals, all areas in one pass.

    Parameters
    ----------
    goals : sequence of Goal
        Of one mesh; the volume, if it is one of them, comes last.

    Attributes
    ----------
    support : (n, g) bool array
        The vertices on which each goal depends; n is 0 without goals.
    """

    def __init__(self, goals: Sequence[Goal]) -> None:
        areas = [goal for goal in goals if not goal.is_volume]
        self._count = len(goals)
        self._areas = self._volume = None
        n = len(goals[0].patch.start) - 1 if goals else 0
        self.support = np.ones((n, len(goals)), dtype=bool)
        if areas:
            self._areas = WeightedAreas(
                areas[0].patch, np.column_stack([goal.triangle_fractions for goal in areas])
            )
            self.support[:, : len(areas)] = self._areas.support
        if len(areas) < len(goals):
            self._volume = goals[-1].patch

    def values(self, U: np.ndarray) -> np.ndarray:
        """Values (g,) at ``U`` (n, 3)."""
        values = np.empty(self._count)
        if self._areas is not None:
            values[: self._areas.count] = self._areas.values(U)
        if self._volume is not None:
            values[-1] = volume(U, self._volume.F)
        return values

    def force_stiffness(self, c: np.ndarray, edge: float) -> float:
        """Geometric stiffness of the goals' forces, relative to the Laplacian.

        Goals of areas pull at the same triangles, and may cancel there. The volume counts for its multiplier
        times the length ``edge``.
        """
        area = 0.0 if self._areas is None else self._areas.largest_tension(c[: self._areas.count])
        return area + (0.0 if self._volume is None else abs(float(c[-1])) * edge)

    def values_and_gradients(self, U: np.ndarray, g: np.ndarray) -> np.ndarray:
        """Values (g,) at ``U`` (n, 3); write their gradients into ``g`` (g, n, 3).

        Only the :attr:`support` of each is written.
        """
        values = np.empty(self._count)
        if self._areas is not None:
            count = self._areas.count
            values[:count] = self._areas.values_and_gradients(U, g[:count])
        if self._volume is not None:
            values[-1] = self._volume.volume_and_gradient(U, g[-1])
        return values


def region_patch(rest: RestMesh, region: Region) -> Patch:
    """Triangles of a region, indexed by the vertices of the solve mesh."""
    if not isinstance(region, Region) or not isinstance(region.name, str) or not region.name:
        raise InputError(tr("Regions must be a list of Region(name, vertices), each with a name."))
    vertices = checked_integers(
        region.vertices, tr("The vertices of the region “{name}”").format(name=region.name)
    ).ravel()
    if len(vertices) and not 0 <= vertices.min() <= vertices.max() < len(rest.V):
        raise InputError(
            tr("The region “{name}” has a vertex that does not exist; correct its IDs.").format(
                name=region.name
            )
        )
    inside = np.zeros(len(rest.weld.first), dtype=bool)
    inside[rest.weld.inverse[vertices]] = True
    return Patch(rest.solve_mesh.F[inside[rest.solve_mesh.F].all(axis=1)], len(inside))


def make_goals(
    rest: RestMesh,
    area: float | str | None,
    volume: float | str | None,
    regions: Sequence[Region],
    calm: np.ndarray | None = None,
) -> tuple[Goal, ...]:
    """Goals for percentages of the rest areas and the rest volume; None for no goal.

    Parameters
    ----------
    rest : RestMesh
    area, volume : float, str or None
        Of the total area and the volume.
    regions : sequence of Region
    calm : (k, n) float array, optional
        Levels of calmness of the vertices of the solve mesh, each with an area to keep as the total area is.

    Raises
    ------
    InputError
        If a percentage is not a positive number, or there is nothing to measure.
    """
    goals, shape = [], rest.solve_mesh
    outside = np.ones(len(shape.V))  # calm goals leave out regions with goals of their own
    if area is not None:
        goals.append(_goal("the area", shape, area, rest.area))
    for region in regions:
        if region.area is not None:
            corners = used_vertices(region_patch(rest, region).F)
            outside[corners] = 0.0
            goals.append(_region_goal(shape, region, corners))
    if area is not None and calm is not None:
        goals += _calm_goals(shape, area, calm * outside)
    if volume is not None:
        if rest.missing_volume_reason or not rest.volume:
            why = rest.missing_volume_reason or tr("the surface encloses no volume")
            raise InputError(tr("There is no volume to keep: {why}; leave the volume free.").format(why=why))
        goals.append(_goal("the volume", shape, volume, rest.volume, is_volume=True))
    return tuple(goals)


def filled_volume_goal(rest: RestMesh, volume: float, area: float | str | None) -> Goal:
    """Goal of a volume in cubic mesh units, also of a surface that is flat at rest.

    Parameters
    ----------
    rest : RestMesh
    volume : float
    area : float, str or None
        Target of the total area, in percent; None if it is free.

    Raises
    ------
    InputError
        If the surface is not closed, or a ball of its area holds less.
    """
    check_argument("filled_volume", volume)
    if rest.missing_volume_reason:
        raise InputError(
            tr("There is no volume to keep: {why}; leave the volume free.").format(
                why=rest.missing_volume_reason
            )
        )
    if area is not None:
        check_fits_in_ball(volume, rest.area * percentage(area, "the area") / 100.0)
    shape = rest.solve_mesh.all_triangles
    return Goal("the volume", shape, float(volume), float(volume), is_volume=True, is_absolute=True)


def _region_goal(solve_mesh: SolveMesh, region: Region, corners: np.ndarray) -> Goal:
    inside = np.zeros(len(solve_mesh.V))
    inside[corners] = 1.0
    assert region.area is not None
    goal = _goal(in_quotes(region.name), solve_mesh, region.area, weight=inside)
    if goal.rest <= 0.0:
        raise InputError(
            tr("The region “{name}” contains no complete triangle; make it larger.").format(name=region.name)
        )
    return goal


def _calm_goals(solve_mesh: SolveMesh, area: float | str, levels: np.ndarray) -> list[Goal]:
    goals = [
        _goal(f"calm parts {k}", solve_mesh, area, weight=levels[k], is_smooth=True)
        for k in range(len(levels))
    ]
    return [goal for goal in goals if goal.rest > 0.0]


def _goal(
    name: str, solve_mesh: SolveMesh, percent: float | str, value: float | None = None, **kind: Any
) -> Goal:
    """Goal at a percentage of its rest value, measured if ``value`` is None."""
    goal = Goal(name, solve_mesh.all_triangles, 1.0, percentage(percent, name) / 100.0, **kind)
    return goal_at_rest(goal, solve_mesh.V) if value is None else _rescaled_goal(goal, value)


def goal_at_rest(goal: Goal, V: np.ndarray) -> Goal:
    """Goal at the same percentage of its value for other rest positions ``V`` (n, 3)."""
    if goal.is_absolute:
        return goal
    return _rescaled_goal(goal, float(GoalMeasures((goal,)).values(V)[0]))


def _rescaled_goal(goal: Goal, rest: float) -> Goal:
    return replace(goal, rest=rest, target=rest * (goal.target / goal.rest))
