"""Painted parts: the base, a handle or a region."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from apd_viewer.geometry.pose.constraints import FREE
from apd_viewer.session.model.document_parts import with_next_region

if TYPE_CHECKING:
    from apd_viewer.session.model.document import Document


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

    def become(self, document: Document, wanted: np.ndarray) -> Document:
        """The document with the ``wanted`` vertices, (n,) bool, and no others, in it."""
        if self.is_region and self.code > len(document.regions) and wanted.any():
            document = with_next_region(document)  # the part need not exist yet, as for a stroke
        paint = type(document).painted_region if self.is_region else type(document).painted
        cleared = paint(document, np.flatnonzero(self.of(document) & ~wanted), self.nothing)
        return paint(cleared, np.flatnonzero(wanted), self.code)
