"""The colours of the vertices of a document: what they are painted as, and what handles draw along."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from apd_viewer.ui.palette import drawn_along, label_colors

if TYPE_CHECKING:
    from apd_viewer.session.document import Document


def colors_of(document: Document, ids: np.ndarray | None = None) -> np.ndarray:
    """RGBA of the vertices ``ids``, or of all, (k, 4) uint8 array."""
    some = slice(None) if ids is None else ids
    colors = label_colors(document.labels[some], document.member[some])
    soft = document.soft
    if len(soft.ids):
        where = np.full(len(document.labels), -1)
        where[soft.ids] = np.arange(len(soft.ids))
        places = where[some]
        drawn = places >= 0
        colors[drawn] = drawn_along(colors[drawn], soft.handle[places[drawn]], soft.strength[places[drawn]])
    return colors


def differing(old: Document, new: Document) -> np.ndarray:
    """The vertices of one mesh whose colours differ between two documents, ascending ids."""
    differ = (old.labels != new.labels) | (old.member != new.member)
    if old.soft is not new.soft:
        differ[old.soft.ids] = differ[new.soft.ids] = True
    return np.flatnonzero(differ)
