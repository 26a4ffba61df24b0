"""Vertices, lengths and points typed by the user, evaluated on the open mesh."""

from __future__ import annotations

from typing import TYPE_CHECKING

from apd_viewer.session.posing.typed_motion import names_of
from apd_viewer.session.quantities.clear_numbers import as_typed
from apd_viewer.session.quantities.expressions import length
from apd_viewer.session.selecting.vertex_expression import chosen, place, vector

if TYPE_CHECKING:
    import numpy as np

    from apd_viewer.session.store import Store


class TypedValues:
    """Reads texts; each method raises InputError with a sentence.

    Parameters
    ----------
    store : Store
    """

    def __init__(self, store: Store) -> None:
        self._store = store

    def vertices(self, text: str) -> np.ndarray:
        """The vertices named by ids or by conditions on their coordinates, ascending ids."""
        return chosen(as_typed(text), self._store.required(), self._store.unit)

    def length(self, text: str) -> float:
        """A length, mesh units."""
        return length(as_typed(text), self._store.unit, names_of(self._store.required()))

    def point(self, text: str) -> np.ndarray:
        """A point (3,) by its coordinates."""
        return place(as_typed(text), self._store.required(), self._store.unit)

    def vector(self, text: str) -> np.ndarray:
        """A direction (3,) by three numbers, of any length."""
        return vector(as_typed(text), self._store.required())
