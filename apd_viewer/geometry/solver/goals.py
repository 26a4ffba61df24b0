"""Goals: target values of areas and of the volume."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from numbers import Real

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.mesh.arrays import whole_numbers
from apd_viewer.geometry.mesh.measures import Patch
from apd_viewer.geometry.mesh.operators import volume
from apd_viewer.language import tr

# Targets beyond these are typing errors.
_LEAST, _MOST = 1.0, 1000.0
# Names of the goals; those of regions are the user's.
_WORDS = {"the area": tr("the area"), "the volume": tr("the volume")}


@dataclass(frozen=True, eq=False)
class Region:
    """A named part of a mesh: the triangles with all three corners among its vertices.

    Attributes
    ----------
    name : str
    vertices : int array
        Ids in the order of the file.
    area : float or None
        What its area should be, in percent of its area at rest; None only measures it.
    """

    name: str
    vertices: np.ndarray
    area: float | None = None


@dataclass(frozen=True)
class Reading:
    """Area of a region at rest, now, and its target, if any."""

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
        "the area", "the volume" or the name of a region.
    patch : Patch
        The triangles that are measured, in vertices of the solve.
    is_volume : bool
    rest, target : float
        Value at rest, and the value asked for.
    tolerance : float
        Relative error that is accepted, where the goal is not met to the last digits.
    """

    name: str
    patch: Patch
    is_volume: bool
    rest: float
    target: float
    tolerance: float = 0.0

    @property
    def measured(self) -> tuple[bool, int]:
        """Identity of the measured quantity, apart from name and target."""
        return self.is_volume, len(self.patch.F)

    def value(self, U: np.ndarray) -> float:
        """Value at ``U`` (n, 3)."""
        return volume(U, self.patch.F) if self.is_volume else self.patch.area(U)

    def value_and_gradient(self, U: np.ndarray, g: np.ndarray) -> float:
        """The same; its gradient is written into ``g`` (n, 3)."""
        measure = self.patch.volume_and_gradient if self.is_volume else self.patch.area_and_gradient
        return measure(U, g)

    def miss(self, value: float) -> float:
        """Signed distance of a value from the target, relative to the value at rest."""
        return (value - self.target) / abs(self.rest)

    def shortfall(self, value: float) -> str:
        """Sentence about a value short of the target."""
        reached, wanted = 100.0 * value / self.rest, 100.0 * self.target / self.rest
        # With enough digits to show the difference.
        digits = next((d for d in range(4, 17) if f"{reached:.{d}g}" != f"{wanted:.{d}g}"), 17)
        return tr("{name} is at {reached:.{digits}g} % instead of {wanted:.4g} %").format(
            name=_WORDS.get(self.name, self.name), reached=reached, digits=digits, wanted=wanted
        )


def patch_of(rest: RestMesh, region: Region) -> Patch:
    """Triangles of a region, in vertices of the solve."""
    if not isinstance(region, Region) or not region.name:
        raise InputError(tr("Regions must be a list of Region(name, vertices), each with a name."))
    vertices = whole_numbers(
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
    return Patch(rest.shape.F[inside[rest.shape.F].all(axis=1)], len(inside))


def make_goals(
    rest: RestMesh, area: float | None, inside: float | None, regions: Sequence[Region]
) -> tuple[Goal, ...]:
    """Goals for percentages of the area and the volume at rest; None is no goal.

    Raises
    ------
    InputError
        If a percentage is not a positive number, or there is nothing to measure.
    """
    goals = []
    if area is not None:
        goals.append(_goal("the area", rest.shape.whole, False, rest.area, area))
    if inside is not None:
        if rest.why_no_volume or not rest.volume:
            why = rest.why_no_volume or tr("the surface encloses no volume")
            raise InputError(tr("There is no volume to keep: {why}; leave the volume free.").format(why=why))
        goals.append(_goal("the volume", rest.shape.whole, True, rest.volume, inside))
    for region in regions:
        if region.area is not None:
            patch = patch_of(rest, region)
            at_rest = patch.area(rest.shape.V)
            if at_rest <= 0.0:
                raise InputError(
                    tr("The region “{name}” contains no complete triangle; make it larger.").format(
                        name=region.name
                    )
                )
            goals.append(_goal(f"“{region.name}”", patch, False, at_rest, region.area))
    return tuple(goals)


def _goal(name: str, patch: Patch, is_volume: bool, rest: float, percent: float) -> Goal:
    if not isinstance(percent, Real) or isinstance(percent, bool) or not _LEAST <= percent <= _MOST:
        raise InputError(
            tr("The target of {name} must be a percentage from {least:g} to {most:g}, such as 100.").format(
                name=_WORDS.get(name, name), least=_LEAST, most=_MOST
            )
        )
    return Goal(name, patch, is_volume, rest, rest * float(percent) / 100.0)
