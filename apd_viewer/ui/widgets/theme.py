"""Light and dark: colours of the window, its style sheet and its icons."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from functools import cache

from PySide6.QtCore import QByteArray, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QGuiApplication, QIcon, QIconEngine, QPainter, QPalette, QPixmap
from PySide6.QtSvg import QSvgRenderer
from PySide6.QtWidgets import QApplication, QWidget

from apd_viewer.files.samples import resource_path
from apd_viewer.presentation.palette import BASE_COLOR, HANDLE_COLORS, REGION_COLORS


@dataclass(frozen=True)
class Theme:
    """Colours of the window as #rrggbb.

    ``warm`` is for warnings, ``accent`` for the selection; ``less`` and ``more`` are for shrinkage and
    growth.
    """

    canvas_top: str
    canvas_bottom: str
    panel: str
    raised: str
    line: str
    ink: str
    quiet: str
    faint: str
    accent: str
    accent_soft: str
    on_accent: str
    warm: str
    warm_soft: str
    good: str
    less: str
    more: str


LIGHT = Theme(
    canvas_top="#f7f8fa",
    canvas_bottom="#e4e7ec",
    panel="#fbfbfc",
    raised="#ffffff",
    line="#dcdfe4",
    ink="#1d2129",
    quiet="#5a6270",
    faint="#9aa1ad",
    accent="#2f6fde",
    accent_soft="#e3ecfb",
    on_accent="#ffffff",
    warm="#b45309",
    warm_soft="#fdf0df",
    good="#5a6270",
    less="#b7569e",
    more="#60923f",
)
DARK = Theme(
    canvas_top="#2b2f37",
    canvas_bottom="#1c1f25",
    panel="#22252b",
    raised="#2c3038",
    line="#3a3f49",
    ink="#eceef2",
    quiet="#a6adba",
    faint="#6e7684",
    accent="#6ea2ff",
    accent_soft="#2c3a55",
    on_accent="#10131a",
    warm="#f5a54a",
    warm_soft="#40311d",
    good="#a6adba",
    less="#d98fc5",
    more="#9fc378",
)


def theme_for(scheme: Qt.ColorScheme) -> Theme:
    """Theme for a chosen colour scheme, or the platform's if none is chosen."""
    hints = QGuiApplication.styleHints()
    hints.setColorScheme(scheme)  # applies to the platform's own widgets, such as the title bar
    asked = hints.colorScheme() if scheme is Qt.ColorScheme.Unknown else scheme
    return DARK if asked is Qt.ColorScheme.Dark else LIGHT


def apply_theme(theme: Theme) -> None:
    """Apply ``theme`` to the whole application."""
    application = QApplication.instance()
    assert isinstance(application, QApplication)
    sheet = resource_path("window.qss").read_text(encoding="utf-8")
    # Longest names first: a name may be a prefix of another.
    for name, color in sorted(asdict(theme).items(), key=lambda item: -len(item[0])):
        sheet = sheet.replace(f"@{name}", color)
    is_new = application.styleSheet() != sheet  # setting an equal style sheet again would take 70 ms
    if is_new:
        application.setStyle("Fusion")
    application.setPalette(_palette(theme))
    if is_new:
        application.setStyleSheet(sheet)


def set_style_property(widget: QWidget, name: str, value: object) -> None:
    """Set a widget's property and reapply the style sheet depending on it."""
    if widget.property(name) != value:
        widget.setProperty(name, value)
        widget.style().unpolish(widget)
        widget.style().polish(widget)


def _palette(theme: Theme) -> QPalette:
    palette = QPalette()
    roles = {
        QPalette.ColorRole.Window: theme.panel,
        QPalette.ColorRole.WindowText: theme.ink,
        QPalette.ColorRole.Base: theme.raised,
        QPalette.ColorRole.AlternateBase: theme.panel,
        QPalette.ColorRole.Text: theme.ink,
        QPalette.ColorRole.Button: theme.raised,
        QPalette.ColorRole.ButtonText: theme.ink,
        QPalette.ColorRole.ToolTipBase: theme.raised,
        QPalette.ColorRole.ToolTipText: theme.ink,
        QPalette.ColorRole.PlaceholderText: theme.faint,
        QPalette.ColorRole.Highlight: theme.accent,
        QPalette.ColorRole.HighlightedText: theme.on_accent,
        QPalette.ColorRole.Link: theme.accent,
        QPalette.ColorRole.Mid: theme.line,
    }
    for role, color in roles.items():
        palette.setColor(role, QColor(color))
    for role in (QPalette.ColorRole.WindowText, QPalette.ColorRole.Text, QPalette.ColorRole.ButtonText):
        palette.setColor(QPalette.ColorGroup.Disabled, role, QColor(theme.faint))
    return palette


ICON_SIZE = QSize(20, 20)
# Colour names used in the SVG icons besides ``currentColor``.
_PARTS = {"baseColor": BASE_COLOR, "handleColor": HANDLE_COLORS[0], "regionColor": REGION_COLORS[0]}


class _LineIcon(QIconEngine):
    """Icon engine for SVG, sharp at every scale factor, with cached pixmaps."""

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
            self._pictures[key] = self._rendered_pixmap(size, mode, state)
        return self._pictures[key]

    def _rendered_pixmap(self, size: QSize, mode: QIcon.Mode, state: QIcon.State) -> QPixmap:
        pixmap = QPixmap(size)
        if pixmap.isNull():  # null before the layout of the button
            return pixmap
        pixmap.fill(Qt.GlobalColor.transparent)
        painter = QPainter(pixmap)
        self.paint(painter, pixmap.rect(), mode, state)
        painter.end()
        return pixmap

    def clone(self) -> _LineIcon:
        return _LineIcon(self._svg, self._theme)


def icon(name: str, theme: Theme) -> QIcon:
    """Icon ``name`` of ``resources/icons`` in the colours of ``theme``."""
    return QIcon(_LineIcon(_svg_source(name), theme))


@cache
def _svg_source(name: str) -> str:
    return resource_path(f"icons/{name}.svg").read_text(encoding="utf-8")


def application_icon() -> QIcon:
    """Icon of the program, in its own colours."""
    return QIcon(str(resource_path("icons/apd-viewer.svg")))
