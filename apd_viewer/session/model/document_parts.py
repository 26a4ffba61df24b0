"""Handles, regions and targets of a document: adding, removing and painting."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import replace
from itertools import count
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from apd_viewer.files.selections.selection import Selection, default_name
from apd_viewer.geometry.goals.target_values import percentage_text
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.weld import Weld
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE
from apd_viewer.language import tr
from apd_viewer.session.model.handles_and_regions import IDENTITY, Handle, NamedRegion, PartFlags

if TYPE_CHECKING:
    from apd_viewer.geometry.goals.goals import Region
    from apd_viewer.session.model.document import Document


def with_next_region(document: Document) -> Document:
    """Document with an additional region under a new name."""
    name = next_name(tr("Region"), [region.name for region in document.regions])
    return document.with_region(len(document.regions), NamedRegion(name))


def has_region_targets(document: Document) -> bool:
    """True if any region has a target area."""
    return any(region.area is not None for region in document.regions)


def have_same_paint(document: Document, other: Document) -> bool:
    """True if two documents share their arrays of labels and regions."""
    return document.labels is other.labels and document.member is other.member


def obstacle_shifts(document: Document) -> np.ndarray:
    """Displacement of each active obstacle, (o, 3)."""
    return np.array([each.shift for each in document.obstacles if document.has_active_obstacles]).reshape(
        -1, 3
    )


def with_handles_reset(document: Document, *numbers: int) -> Document:
    """Document with handles reset to rest; the others keep their poses."""
    document = document.relative_to_rest
    handles = list(document.handles)
    for k in numbers:
        handles[k] = replace(handles[k].with_pose(IDENTITY), former_twist_axis=None)
    initial = document.mesh.V
    if any(handle.is_moved for handle in handles):
        back = np.isin(document.labels, HANDLE + np.array(numbers))
        initial = frozen(np.where(back[:, None], initial, document.initial_positions))
    return replace(document, initial_positions=initial, handles=tuple(handles))


def without_paint(document: Document) -> Document:
    """Document with all paint removed except on locked parts."""
    every = np.arange(len(document.labels))
    return document.with_label(every, FREE).with_region_number(every, 0)


def without_base_and_handles(document: Document) -> Document:
    """Document without base and handles; regions stay."""
    handles = tuple(
        replace(handle.relative_to_rest.with_pose(IDENTITY), former_twist_axis=None)
        for handle in document.handles
    )
    labels = frozen(np.full_like(document.labels, FREE))
    return replace(document, labels=labels, initial_positions=document.mesh.V, handles=handles)


def without_handle(document: Document, k: int) -> Document:
    """Document without handle ``k``; its vertices become free."""
    left = document.handles[:k] + document.handles[k + 1 :]
    labels = _codes_without(document.labels, HANDLE + k, FREE)
    return replace(document, handles=left or (Handle(default_name(tr("Handle"), 1)),), labels=labels)


def without_region(document: Document, k: int) -> Document:
    """Document without region ``k``."""
    left = document.regions[:k] + document.regions[k + 1 :]
    return replace(document, regions=left, member=_codes_without(document.member, k + 1, 0))


def _codes_without(codes: np.ndarray, gone: int, instead: int) -> np.ndarray:
    """Codes with ``gone`` replaced by ``instead``, and higher codes decremented."""
    return frozen(np.where(codes == gone, instead, codes - (codes > gone)).astype(np.uint8))


def selection_of(document: Document) -> Selection:
    """Selection of a document: its labels and regions, with names."""
    names = [handle.name for handle in document.handles], [region.name for region in document.regions]
    areas = [region.area for region in document.regions]
    return Selection.with_default_names(document.labels, document.member, *names, areas)


def with_selection(document: Document, selection: Selection) -> Document:
    """Document painted with a selection."""
    regions = map(NamedRegion, selection.regions, selection.areas)
    weld, labels, member = document.mesh.weld, selection.labels, selection.member
    if len(weld.first) < len(weld.inverse):  # both sides of a seam are painted alike
        labels, member = shared_codes(labels, weld, FREE), shared_codes(member, weld, 0)
    return replace(
        document,
        labels=labels,
        member=member,
        handles=tuple(map(Handle, selection.handles)),
        regions=tuple(regions),
    )


def shared_codes(codes: np.ndarray, weld: Weld, none: int) -> np.ndarray:
    """Common codes for both sides of a seam; any code takes precedence over ``none``."""
    shared = np.full(len(weld.first), none, dtype=codes.dtype)
    said = np.flatnonzero(codes != none)[::-1]  # of several codes at a vertex, the first is used
    shared[weld.inverse[said]] = codes[said]
    return frozen(shared[weld.inverse])


def next_name(kind: str, taken: Collection[str], first: int = 1) -> str:
    """First unused name among "kind 1", "kind 2" and so on."""
    return next(name for k in count(first) if (name := default_name(kind, k)) not in taken)


def unique_name(requested: str, current: str, taken: Collection[str]) -> str:
    """Requested name; the ``current`` one if blank, numbered if taken."""
    requested, others = requested.strip(), set(taken) - {current}
    if requested in others:
        return next_name(requested, others, first=2)
    return requested or current


class PaintedPart(NamedTuple):
    """Base or handle given by its label, or region given by its number from 1."""

    code: int
    is_region: bool = False

    def codes(self, document: Document) -> np.ndarray:
        """Labels or region numbers of all vertices, (n,) uint8."""
        return document.member if self.is_region else document.labels

    @property
    def unpainted_code(self) -> int:
        """Code of unpainted vertices."""
        return 0 if self.is_region else FREE

    def mask(self, document: Document) -> np.ndarray:
        """Mask of the vertices in the part, (n,) bool."""
        return np.asarray(self.codes(document) == self.code)

    def name(self, document: Document) -> str:
        """Name of the part."""
        named = self._named_part(document)
        return tr("Base") if named is None else named.name

    def flags(self, document: Document) -> PartFlags:
        """Flags of the part."""
        named = self._named_part(document)
        return document.base if named is None else named.flags

    def document_with_flags(self, document: Document, flags: PartFlags) -> Document:
        """Document with other flags for the part."""
        if self.is_region:
            k = self.code - 1
            return document.with_region(k, replace(document.regions[k], flags=flags))
        if self.code == BASE:
            return replace(document, base=flags)
        k = self.code - HANDLE
        return document.with_handle(k, replace(document.handles[k], flags=flags))

    def exists_in(self, document: Document) -> bool:
        """True if the document has the part; False for a region not yet created."""
        return not self.is_region or self.code <= len(document.regions)

    def _named_part(self, document: Document) -> Handle | NamedRegion | None:
        if self.is_region:
            return document.regions[self.code - 1]
        return None if self.code == BASE else document.handles[self.code - HANDLE]

    def document_with_members(self, document: Document, members: np.ndarray) -> Document:
        """Document with exactly the vertices ``members`` (n,) bool in the part."""
        if not self.exists_in(document) and members.any():
            document = with_next_region(document)  # the region may be created by a stroke
        paint = type(document).with_region_number if self.is_region else type(document).with_label
        cleared = paint(document, np.flatnonzero(self.mask(document) & ~members), self.unpainted_code)
        return paint(cleared, np.flatnonzero(members), self.code)


def painted_parts(document: Document) -> Iterator[tuple[str, np.ndarray]]:
    """Names and vertices (n,) of base, handles and regions, unless empty."""
    parts = [PaintedPart(label) for label in (BASE, *range(HANDLE, HANDLE + len(document.handles)))]
    parts += [PaintedPart(k, is_region=True) for k in range(1, len(document.regions) + 1)]
    masks = ((part.name(document), part.mask(document)) for part in parts)
    return ((name, inside) for name, inside in masks if inside.any())


class Targets(NamedTuple):
    """Area and volume targets, as arguments of :meth:`Deformation.keep`."""

    area: float | str | None
    volume: float | str | None
    regions: tuple[Region, ...]


def goal_percentages(document: Document) -> tuple[float | None, ...]:
    """Percentages of the method's goals: area, volume, regions; None for no goal."""
    method = document.settings.traits
    keeps_area = method.keeps_total_area or (method.may_keep_total_area and document.settings.hold_area)
    only_area = method.keeps_only_total_area
    return (
        document.settings.area if keeps_area else None,
        None if only_area else document.settings.volume,
        *(
            part.area if at_rest > 0.0 and not only_area else None
            for part, at_rest in zip(document.regions, document.rest_areas, strict=True)
        ),
    )


def targets_of(document: Document) -> Targets:
    """Targets passed to the method, with the vertices of the regions."""
    # Imported here: it loads scipy and numba, and the panel of the first picture needs the percentages alone.
    from apd_viewer.geometry.goals.goals import Region

    area, volume, *areas = map(percentage_text, goal_percentages(document))
    regions = tuple(
        Region(part.name, np.flatnonzero(document.member == k), percent)
        for k, (part, percent) in enumerate(zip(document.regions, areas, strict=True), start=1)
    )
    return Targets(area, volume, regions)
