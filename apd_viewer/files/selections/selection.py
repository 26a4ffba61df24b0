"""Selection on a mesh: base, handles and named regions, without motion."""

from __future__ import annotations

import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.pose.constraints import HANDLE, MOST_HANDLES
from apd_viewer.language import tr

MOST_REGIONS = 8
# Percent, as accepted by geometry.goals.goals.
LEAST_AREA, MOST_AREA = 1.0, 1000.0
# Control characters and lone surrogates.
_UNFIT = ("Cc", "Cs")


class _Refusals(NamedTuple):
    """Error sentences about names of handles or regions."""

    many: str
    nameless: str
    unfit: str
    twice: str


_HANDLES = _Refusals(
    tr("It has {n:,} handles, but the limit is {most}; remove some."),
    tr("One of its handles has no name; name all handles."),
    tr("The name of a handle has invalid characters; correct it."),
    tr("Two of its handles have the same name; rename one."),
)
_REGIONS = _Refusals(
    tr("It has {n:,} regions, but the limit is {most}; remove some."),
    tr("One of its regions has no name; name all regions."),
    tr("The name of a region has invalid characters; correct it."),
    tr("Two of its regions have the same name; rename one."),
)


def default_name(kind: str, number: int) -> str:
    """Default name of a part by its number."""
    return tr("{kind} {number}").format(kind=kind, number=number)


@dataclass(frozen=True, eq=False)
class Selection:
    """Labels and regions of the vertices of a mesh, with their names.

    Attributes
    ----------
    labels : (n,) uint8 array of BASE, FREE, and HANDLE + k for ``handles[k]``, read-only
    member : (n,) uint8 array, read-only
        k + 1 for the vertices of ``regions[k]``, 0 for those in none.
    handles : tuple of str, never empty
        Names; a handle may hold no vertex.
    regions : tuple of str
        Names; a region may hold no vertex.
    areas : tuple of float or None, one for each region
        What its area should be, in percent of its area at rest; None only measures it.
    same_mesh : bool
        False if its file says that it was made for other positions or triangles than those of the mesh that
        it was read for, although for as many: for another shape of the mesh, as a rule.
    """

    labels: np.ndarray
    member: np.ndarray
    handles: tuple[str, ...]
    regions: tuple[str, ...] = ()
    areas: tuple[float | None, ...] = ()
    same_mesh: bool = True

    def __post_init__(self) -> None:
        _check_names(_HANDLES, self.handles, MOST_HANDLES)
        _check_names(_REGIONS, self.regions, MOST_REGIONS)
        if len(self.areas) != len(self.regions) or not all(map(_is_area, self.areas)):
            raise InputError(
                tr("The area of a region is not a percentage from {least:g} to {most:g}; correct it.").format(
                    least=LEAST_AREA, most=MOST_AREA
                )
            )
        if not self.handles or _last(self.labels) >= HANDLE + len(self.handles):
            raise InputError(_HANDLES.nameless)
        if _last(self.member) > len(self.regions):
            raise InputError(_REGIONS.nameless)
        for name in ("labels", "member"):
            array = getattr(self, name)
            object.__setattr__(self, name, frozen(array.copy()) if array.flags.writeable else array)

    @classmethod
    def with_default_names(
        cls,
        labels: np.ndarray,
        member: np.ndarray | None = None,
        handles: Sequence[str] = (),
        regions: Sequence[str] = (),
        areas: Sequence[float | None] = (),
        same_mesh: bool = True,
    ) -> Selection:
        """Selection with default names for nameless parts."""
        if member is None:
            member = np.zeros(len(labels), dtype=np.uint8)
        count = max(1, _last(labels) - HANDLE + 1)
        handles = handles or [default_name(tr("Handle"), k + 1) for k in range(count)]
        regions = regions or [default_name(tr("Region"), k + 1) for k in range(_last(member))]
        areas = areas or [None] * len(regions)
        return cls(labels, member, tuple(handles), tuple(regions), tuple(areas), same_mesh)


def checked_labels(numbers: np.ndarray, n: int) -> np.ndarray:
    """Labels (n,) uint8 from a file's numbers; raises InputError on bad ones."""
    last = HANDLE + MOST_HANDLES - 1
    otherwise = tr("It has a label other than 0 (base), 1 (free) and 2 to {last} (handles); correct it.")
    return _codes(numbers, n, last, otherwise.format(last=last))


def checked_member(numbers: np.ndarray, n: int) -> np.ndarray:
    """Regions (n,) uint8 from a file's numbers; raises InputError on bad ones."""
    otherwise = tr("It has a region other than 0 (none) and 1 to {last}; correct it.")
    return _codes(numbers, n, MOST_REGIONS, otherwise.format(last=MOST_REGIONS))


def check_vertex_count(found: int, n: int) -> None:
    """Raise InputError unless a file for ``found`` vertices is one for ``n``."""
    if found != n:
        raise InputError(
            tr(
                "It is for a mesh of {found:,} vertices, but this mesh has {n:,}; choose the file made "
                "for this mesh."
            ).format(found=found, n=n)
        )


def _codes(numbers: np.ndarray, n: int, last: int, otherwise: str) -> np.ndarray:
    if numbers.ndim != 1 or numbers.dtype.kind not in "iuf":
        raise ValueError(tr("it does not have one number per vertex"))
    check_vertex_count(len(numbers), n)
    if not np.isin(numbers, np.arange(last + 1)).all():
        raise InputError(otherwise)
    return numbers.astype(np.uint8)


def _last(codes: np.ndarray) -> int:
    return int(codes.max(initial=0))


def _is_area(area: object) -> bool:
    if area is None:
        return True
    return isinstance(area, int | float) and not isinstance(area, bool) and LEAST_AREA <= area <= MOST_AREA


def _check_names(said: _Refusals, names: Sequence[str], most: int) -> None:
    if len(names) > most:
        raise InputError(said.many.format(n=len(names), most=most))
    for name in names:
        if not isinstance(name, str) or not name.strip():
            raise InputError(said.nameless)
        if any(unicodedata.category(sign) in _UNFIT for sign in name):
            raise InputError(said.unfit)
    if len(set(names)) < len(names):
        raise InputError(said.twice)
