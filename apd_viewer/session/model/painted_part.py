"""Painted parts: the base, a handle or a region."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE
from apd_viewer.language import tr
from apd_viewer.session.model.document_parts import with_next_region

if TYPE_CHECKING:
    from apd_viewer.session.model.document import Document
    from apd_viewer.session.model.handles_and_regions import Handle, NamedRegion, PartFlags


class PaintedPart(NamedTuple):
    """The base or a handle, by its label, or a region, by its number from 1."""

    code: int
    is_region: bool = False

    def codes(self, document: Document) -> np.ndarray:
        """The labels of all vertices, or the numbers of their regions, (n,) uint8."""
        return document.member if self.is_region else document.labels

    @property
    def unpainted_code(self) -> int:
        """The code of unpainted vertices."""
        return 0 if self.is_region else FREE

    def mask(self, document: Document) -> np.ndarray:
        """Membership of the vertices, (n,) bool."""
        return np.asarray(self.codes(document) == self.code)

    def name(self, document: Document) -> str:
        """Name of the part."""
        named = self._named(document)
        return tr("Base") if named is None else named.name

    def flags(self, document: Document) -> PartFlags:
        """Flags of the part."""
        named = self._named(document)
        return document.base if named is None else named.flags

    def document_with_flags(self, document: Document, flags: PartFlags) -> Document:
        """The document with other flags of the part."""
        if self.is_region:
            k = self.code - 1
            return document.with_region(k, replace(document.regions[k], flags=flags))
        if self.code == BASE:
            return replace(document, base=flags)
        k = self.code - HANDLE
        return document.with_handle(k, replace(document.handles[k], flags=flags))

    def is_in(self, document: Document) -> bool:
        """True but for the region of a first stroke."""
        return not self.is_region or self.code <= len(document.regions)

    def _named(self, document: Document) -> Handle | NamedRegion | None:
        if self.is_region:
            return document.regions[self.code - 1]
        return None if self.code == BASE else document.handles[self.code - HANDLE]

    def document_with_members(self, document: Document, members: np.ndarray) -> Document:
        """The document with the ``members`` vertices, (n,) bool, and no others, in it."""
        if not self.is_in(document) and members.any():
            document = with_next_region(document)  # the part need not exist yet, as for a stroke
        paint = type(document).with_region_number if self.is_region else type(document).with_label
        cleared = paint(document, np.flatnonzero(self.mask(document) & ~members), self.unpainted_code)
        return paint(cleared, np.flatnonzero(members), self.code)
