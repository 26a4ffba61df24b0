"""Drawing of polylines and polygons on the tool layer."""

import numpy as np
from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QColor, QPainter, QPen, QPolygonF

from apd_viewer.ui.scene.camera import Camera

_MARGIN = 0.06  # margin of a plane around the shape, as a fraction of its extent
_PLANE = 40 / 255  # opacity of a plane's fill


def draw_polyline(
    painter: QPainter, line: np.ndarray, colour: QColor, width: float, halo: str | None = None
) -> None:
    """Draw a polyline (k, 2), over a halo if its colour is given."""
    shape = to_polygon(line)
    painter.setBrush(Qt.BrushStyle.NoBrush)
    if halo is not None:
        painter.setPen(QPen(with_opacity(halo), width + 2.2, c=Qt.PenCapStyle.FlatCap))
        painter.drawPolyline(shape)
    painter.setPen(QPen(colour, width, c=Qt.PenCapStyle.FlatCap, j=Qt.PenJoinStyle.RoundJoin))
    painter.drawPolyline(shape)


def with_opacity(colour: str | QColor, alpha: float = 0.65) -> QColor:
    """Colour with a changed opacity."""
    clear = QColor(colour)
    clear.setAlphaF(alpha)
    return clear


def axis_rectangle(U: np.ndarray, axis: int, height: float) -> np.ndarray:
    """Corners (4, 3) of a rectangle around ``U`` (n, 3), normal to an axis."""
    low, high = U.min(axis=0), U.max(axis=0)
    pad = _MARGIN * float((high - low).max())
    low, high = low - pad, high + pad
    j, k = (i for i in range(3) if i != axis)
    corners = np.full((4, 3), height)
    corners[:, j] = low[j], high[j], high[j], low[j]
    corners[:, k] = low[k], low[k], high[k], high[k]
    return corners


def draw_plane(
    painter: QPainter,
    camera: Camera,
    corners: np.ndarray,
    colour: QColor,
    halo: QColor,
    style: Qt.PenStyle = Qt.PenStyle.SolidLine,
) -> None:
    """Draw a translucent polygon (k, 3) if it lies in front of the camera."""
    if (camera.depth(corners) <= 0.0).any():
        return
    shape = to_polygon(camera.project(corners))
    painter.setBrush(with_opacity(colour, _PLANE))
    painter.setPen(QPen(halo, 3.0))
    painter.drawPolygon(shape)
    painter.setPen(QPen(colour, 1.6, style))
    painter.drawPolygon(shape)


def to_polygon(points: np.ndarray) -> QPolygonF:
    """Qt polygon of points (k, 2)."""
    return QPolygonF([QPointF(x, y) for x, y in points])


def chosen_runs(points: np.ndarray, chosen: np.ndarray) -> list[np.ndarray]:
    """Runs of consecutive chosen points of a closed polyline.

    Parameters
    ----------
    points : (k, 2) float array
        The last is the first.
    chosen : (k,) bool array
    """
    if chosen.all():
        return [points]
    # Start at an unchosen point, so that no run is split where the polyline closes.
    first = int(np.argmin(chosen[:-1]))
    order = (np.arange(len(points)) + first) % (len(points) - 1)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], chosen[order], [False]]).astype(np.int8)))
    # Extend each run by one point at both ends, so that near and far parts join.
    return [points[order[max(a - 1, 0) : b + 1]] for a, b in zip(edges[::2], edges[1::2], strict=True)]


def convex_hull(points: np.ndarray) -> np.ndarray:
    """Ordered corners of the convex hull of points (k, 2)."""
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
