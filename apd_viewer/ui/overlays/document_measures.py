"""Overlays that follow the painting or the settings, measured on a thread."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from apd_viewer.geometry.contact.contact_pressure import ContactPressure
from apd_viewer.session.model.document import Document


class DocumentMeasures(NamedTuple):
    """Measures of a document, and the settings that they follow from.

    Attributes
    ----------
    settings : tuple
    calmness, pressure : callable
        See :class:`apd_viewer.geometry.analysis.deviation.Deviation`.
    """

    settings: tuple[object, ...]
    calmness: Callable[[], np.ndarray]
    pressure: Callable[[np.ndarray], np.ndarray]

    @classmethod
    def from_document(cls, document: Document, keeps_apart: bool) -> DocumentMeasures:
        """Measures of a document, with contact or without."""
        falloffs = (handle.falloff for handle in document.handles)
        given = *falloffs, keeps_apart, document.settings.thickness
        return cls(given, lambda: _calmness(document), _pressure(document, keeps_apart))


def _calmness(document: Document) -> np.ndarray:
    # Imported here: the window is shown before the solver is loaded.
    from apd_viewer.geometry.goals.calm_parts import calmness

    return calmness(document.mesh, document.labels, document.soft_constraints)


def _pressure(document: Document, keeps_apart: bool) -> Callable[[np.ndarray], np.ndarray]:
    """Pressure (n,) of contact on a shape (n, 3); NaN without contact."""
    made: list[ContactPressure] = []

    def pressure(U: np.ndarray) -> np.ndarray:
        # Imported here: the window is shown before the solver is loaded.
        from apd_viewer.geometry.contact.contact_pressure import ContactPressure

        if not keeps_apart or document.paint_problem:
            return np.full(len(U), np.nan)
        if not made:
            made.append(ContactPressure(document.mesh, document.labels, document.settings.thickness))
        return made[0].relative_pressure(U)

    return pressure
