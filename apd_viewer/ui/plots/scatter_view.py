"""Scatter plot widget with clickable, optionally marked dots."""

from collections.abc import Callable, Mapping

import numpy as np
from PySide6.QtCore import QEvent, QPoint, QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QHelpEvent, QMouseEvent, QPainter, QPaintEvent, QPixmap
from PySide6.QtWidgets import QToolTip

from apd_viewer.language import tr
from apd_viewer.ui.plots.chart_drawing import Chart, draw_chart, draw_rings
from apd_viewer.ui.plots.plots import ChartTexts, ChartView

_NEAR = 10.0  # px: largest distance of a click from its dot
_LOWEST = QSize(200, 120)


class ScatterView(ChartView):
    """Chart widget with clickable dots.

    Parameters
    ----------
    dot_text : callable
        Words on a dot, by its number.

    Attributes
    ----------
    rings : mapping of int to str
        Marked dots, each by a ring of a colour.
    dot_picked : Signal(int, bool)
        The number of a dot, and whether it is added to what is chosen.
    """

    dot_picked = Signal(int, bool)

    def __init__(self, chart: Callable[[], Chart], dot_text: Callable[[int], str]) -> None:
        super().__init__(ChartTexts(tr("Scatter plot"), ""), chart)
        self._about = dot_text
        self.rings: Mapping[int, str] = {}
        self._drawn: tuple[tuple[object, ...], QPixmap] | None = None
        self.setMouseTracking(True)
        self.setMinimumSize(_LOWEST)

    def paintEvent(self, _: QPaintEvent) -> None:
        """Draw the rings over a cached pixmap of the chart."""
        chart, scale = self.chart(), self.devicePixelRatioF()
        made_of = chart, self.theme, self.size(), scale, self.font()
        if self._drawn is None or self._drawn[0] != made_of:
            self._drawn = made_of, self._picture(chart, scale)
        painter = QPainter(self)
        painter.drawPixmap(0, 0, self._drawn[1])
        if chart.dots is not None and self.chart_area is not None:
            draw_rings(painter, chart.dots, self.rings, self.chart_area.pixel_positions, self.theme)
        painter.end()

    def _picture(self, chart: Chart, scale: float) -> QPixmap:
        picture = QPixmap(self.size() * scale)
        picture.setDevicePixelRatio(scale)
        picture.fill(QColor(self.theme.panel))
        painter = QPainter(picture)
        self.chart_area = draw_chart(painter, QRectF(self.rect()), chart, self.theme, self.font())
        painter.end()
        return picture

    def dot_positions(self) -> np.ndarray:
        """Pixel positions (n, 2) of the dots; NaN for missing values."""
        dots = self.chart().dots
        if self.chart_area is None or dots is None:
            return np.empty((0, 2))
        return self.chart_area.pixel_positions(dots.x, dots.y)

    def dot_at(self, position: QPoint | QPointF) -> int | None:
        """Index of the dot nearest to a position; None beyond a few pixels."""
        places = self.dot_positions()
        away = np.hypot(*(places - [position.x(), position.y()]).T)
        if not np.isfinite(away).any():
            return None
        nearest = int(np.nanargmin(away))
        return nearest if away[nearest] < _NEAR else None

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Pick the dot under the cursor."""
        dot = self.dot_at(event.position())
        if dot is not None and event.button() is Qt.MouseButton.LeftButton:
            more = Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.ShiftModifier
            self.dot_picked.emit(dot, bool(event.modifiers() & more))

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Set the cursor shape over clickable dots."""
        near = self.dot_at(event.position()) is not None
        self.setCursor(Qt.CursorShape.PointingHandCursor if near else Qt.CursorShape.ArrowCursor)

    def event(self, event: QEvent) -> bool:
        """Show a tooltip for the dot under the cursor."""
        if isinstance(event, QHelpEvent) and event.type() is QEvent.Type.ToolTip:
            dot = self.dot_at(event.pos())
            QToolTip.showText(event.globalPos(), "" if dot is None else self._about(dot), self)
            return True
        return super().event(event)
