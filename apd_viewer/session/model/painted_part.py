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
    from apd_viewer.session.model.named_parts import Handle, NamedRegion, PartFlags


class Part(NamedTuple):
    """The base or a handle, by its label, or a region, by its number from 1."""

    code: int
    is_region: bool = False

    def codes(self, document: Document) -> np.ndarray:
        """The labels of all vertices, or the numbers of their regions, (n,) uint8."""
        return document.member if self.is_region else document.labels

    @property
    def nothing(self) -> int:
        """The code of unpainted vertices."""
        return 0 if self.is_region else FREE

    def of(self, document: Document) -> np.ndarray:
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

    def flagged(self, document: Document, flags: PartFlags) -> Document:
        """The document with other flags of the part."""
        if self.is_region:
            k = self.code - 1
            return document.with_region(k, replace(document.regions[k], flags=flags))
        if self.code == BASE:
            return replace(document, base=flags)
        k = self.code - HANDLE
        return document.with_handle(k, replace(document.handles[k], flags=flags))

    def exists(self, document: Document) -> bool:
        """True but for the region of a first stroke."""
        return not self.is_region or self.code <= len(document.regions)

    def _named(self, document: Document) -> Handle | NamedRegion | None:
        if self.is_region:
            return document.regions[self.code - 1]
        return None if self.code == BASE else document.handles[self.code - HANDLE]

    def become(self, document: Document, wanted: np.ndarray) -> Document:
        """The document with the ``wanted`` vertices, (n,) bool, and no others, in it."""
        if not self.exists(document) and wanted.any():
            document = with_next_region(document)  # the part need not exist yet, as for a stroke
        paint = type(document).painted_region if self.is_region else type(document).painted
        cleared = paint(document, np.flatnonzero(self.of(document) & ~wanted), self.nothing)
        return paint(cleared, np.flatnonzero(wanted), self.code)
