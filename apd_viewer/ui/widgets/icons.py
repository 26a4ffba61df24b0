"""The line icons, drawn in the colours of the theme at any size."""

from __future__ import annotations

from functools import cache

from PySide6.QtCore import QByteArray, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QIcon, QIconEngine, QPainter, QPixmap
from PySide6.QtSvg import QSvgRenderer

from apd_viewer.files.samples import resource_path
from apd_viewer.presentation.palette import BASE_COLOR, HANDLE_COLORS, REGION_COLORS
from apd_viewer.ui.widgets.theme import Theme

ICON_SIZE = QSize(20, 20)
# Colour names used in the SVG icons besides ``currentColor``.
_PARTS = {"baseColor": BASE_COLOR, "handleColor": HANDLE_COLORS[0], "regionColor": REGION_COLORS[0]}


class _LineIcon(QIconEngine):
    """SVG icon, sharp at every scale factor, of which pictures are kept."""

    def __init__(self, svg: str, theme: Theme) -> None:
        super().__init__()
        self._svg = svg
        self._theme = theme
        self._pictures: dict[tuple[int, int, QIcon.Mode, QIcon.State], QPixmap] = {}

    def paint(self, painter: QPainter, rect: object, mode: QIcon.Mode, state: QIcon.State) -> None:
        theme, svg = self._theme, self._svg
        quiet = mode == QIcon.Mode.Disabled or state == QIcon.State.On
        ink = theme.faint if mode == QIcon.Mode.Disabled else theme.on_accent if quiet else theme.ink
        for name, rgb in _PARTS.items():
            svg = svg.replace(name, ink if quiet else QColor(*rgb).name())
        renderer = QSvgRenderer(QByteArray(svg.replace("currentColor", ink).encode()))
        renderer.render(painter, QRectF(rect))

    def pixmap(self, size: QSize, mode: QIcon.Mode, state: QIcon.State) -> QPixmap:
        key = *size.toTuple(), mode, state
        if key not in self._pictures:
            self._pictures[key] = self._drawn(size, mode, state)
        return self._pictures[key]

    def _drawn(self, size: QSize, mode: QIcon.Mode, state: QIcon.State) -> QPixmap:
        pixmap = QPixmap(size)
        if pixmap.isNull():  # a button not laid out yet
            return pixmap
        pixmap.fill(Qt.GlobalColor.transparent)
        painter = QPainter(pixmap)
        self.paint(painter, pixmap.rect(), mode, state)
        painter.end()
        return pixmap

    def clone(self) -> _LineIcon:
        return _LineIcon(self._svg, self._theme)


def icon(name: str, theme: Theme) -> QIcon:
    """The icon ``name`` of ``resources/icons`` in the colours of ``theme``."""
    return QIcon(_LineIcon(_drawing(name), theme))


@cache
def _drawing(name: str) -> str:
    return resource_path(f"icons/{name}.svg").read_text(encoding="utf-8")


def application_icon() -> QIcon:
    """The icon of the program, in its own colours."""
    return QIcon(str(resource_path("icons/apd-viewer.svg")))
