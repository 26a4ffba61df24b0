"""Polylines and polygons drawn on the overlay."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QColor, QPainter, QPen, QPolygonF


def stroke(
    painter: QPainter, line: np.ndarray, colour: QColor, width: float, halo: str | None = None
) -> None:
    """Draw a polyline (k, 2), over a halo if its colour is given."""
    shape = polygon(line)
    painter.setBrush(Qt.BrushStyle.NoBrush)
    if halo is not None:
        painter.setPen(QPen(translucent(halo), width + 2.2, c=Qt.PenCapStyle.FlatCap))
        painter.drawPolyline(shape)
    painter.setPen(QPen(colour, width, c=Qt.PenCapStyle.FlatCap, j=Qt.PenJoinStyle.RoundJoin))
    painter.drawPolyline(shape)


def translucent(colour: str | QColor, alpha: float = 0.65) -> QColor:
    """The colour with another opacity."""
    clear = QColor(colour)
    clear.setAlphaF(alpha)
    return clear


def polygon(points: np.ndarray) -> QPolygonF:
    """Points (k, 2) for Qt."""
    return QPolygonF([QPointF(x, y) for x, y in points])


def runs(points: np.ndarray, chosen: np.ndarray) -> list[np.ndarray]:
    """Stretches of chosen points of a closed polyline.

    Parameters
    ----------
    points : (k, 2) float array
        The last is the first.
    chosen : (k,) bool array
    """
    if chosen.all():
        return [points]
    # Begin at a point that is not chosen, so that no stretch is cut by the seam.
    first = int(np.argmin(chosen[:-1]))
    order = (np.arange(len(points)) + first) % (len(points) - 1)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], chosen[order], [False]]).astype(np.int8)))
    # One point more at both ends, so that near and far parts meet.
    return [points[order[max(a - 1, 0) : b + 1]] for a, b in zip(edges[::2], edges[1::2], strict=True)]


def hull(points: np.ndarray) -> np.ndarray:
    """Corners of the convex hull of (k, 2) points, in order."""
    ordered = points[np.lexsort(points.T[::-1])]

    def chain(sequence: np.ndarray) -> list[np.ndarray]:
        corners: list[np.ndarray] = []
        for p in sequence:
            while len(corners) > 1 and _side(corners[-2], corners[-1], p) <= 0:
                corners.pop()
            corners.append(p)
        return corners[:-1]

    return np.array(chain(ordered) + chain(ordered[::-1]))


def _side(a: np.ndarray, b: np.ndarray, p: np.ndarray) -> float:
    return float((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]))
