"""Vertices, lengths and points typed by the user, evaluated on the open mesh."""

from __future__ import annotations

import numpy as np

from apd_viewer.session.quantities.ambiguous_numbers import unambiguous_text
from apd_viewer.session.quantities.expressions import parse_length
from apd_viewer.session.selecting.vertex_expression import parse_point, parse_vector, parse_vertices
from apd_viewer.session.state_store import StateStore


class TypedValues:
    """Parser of typed values on the open document; methods raise InputError.

    Parameters
    ----------
    store : StateStore
    """

    def __init__(self, store: StateStore) -> None:
        self._store = store

    def parse_vertices(self, text: str) -> np.ndarray:
        """The vertices named by ids or by conditions on their coordinates, ascending ids."""
        return parse_vertices(unambiguous_text(text), self._store.required_state(), self._store.unit)

    def parse_length(self, text: str) -> float:
        """A length, mesh units."""
        names = self._store.required_state().document.mesh.named_lengths
        return parse_length(unambiguous_text(text), self._store.unit, names)

    def parse_point(self, text: str) -> np.ndarray:
        """A point (3,) by its coordinates."""
        return parse_point(unambiguous_text(text), self._store.required_state(), self._store.unit)

    def parse_vector(self, text: str) -> np.ndarray:
        """A direction (3,) by three numbers, of any length."""
        return parse_vector(unambiguous_text(text), self._store.required_state())
