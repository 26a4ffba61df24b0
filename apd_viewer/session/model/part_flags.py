"""Flags of painted parts: locked and hidden."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from apd_viewer.geometry.pose.constraints import BASE, HANDLE


class PartFlags(NamedTuple):
    """Flags of a part.

    Attributes
    ----------
    locked : bool
        Its vertices are neither painted over nor added to.
    hidden : bool
        Its colour is not drawn; it holds all the same.
    """

    locked: bool = False
    hidden: bool = False


NO_FLAGS = PartFlags()


class CodeFlags(NamedTuple):
    """One of the flags by label, (256,) bool, and by region number, (256,) bool."""

    labels: np.ndarray
    regions: np.ndarray


class DocumentFlags(NamedTuple):
    """Flags of all parts of a document."""

    base: PartFlags
    handles: tuple[PartFlags, ...]
    regions: tuple[PartFlags, ...]

    @property
    def locked(self) -> CodeFlags:
        """Locked labels and region numbers."""
        return self._by_code("locked")

    @property
    def hidden(self) -> CodeFlags:
        """Hidden labels and region numbers."""
        return self._by_code("hidden")

    def _by_code(self, name: str) -> CodeFlags:
        found = CodeFlags(np.zeros(256, dtype=bool), np.zeros(256, dtype=bool))
        found.labels[BASE] = getattr(self.base, name)
        found.labels[HANDLE : HANDLE + len(self.handles)] = [getattr(each, name) for each in self.handles]
        found.regions[1 : 1 + len(self.regions)] = [getattr(each, name) for each in self.regions]
        return found
