"""What is drawn over a picture of a window: frame, cursor, trails and call-outs.

All lengths are logical pixels of the window; the pictures have twice as many.
"""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import (
    QBrush,
    QColor,
    QFont,
    QFontMetricsF,
    QImage,
    QLinearGradient,
    QPainter,
    QPainterPath,
    QPen,
    QPolygonF,
)

FONT = "DejaVu Sans"
ACCENT, INK, PAPER = QColor("#2f6fde"), QColor("#1d2129"), QColor("#ffffff")
BAR = 32.0  # height of the title bar
_ROUND = 9.0
_BUBBLE = 8.0  # from a text to the edge of its bubble, across; half of it above and below
_ARROW = [(0, 0), (0, 17), (4, 13.4), (6.8, 20), (9.5, 18.8), (6.7, 12.3), (12.2, 12.2)]
_CURSOR = 1.35  # of the usual size


def font(points: float, bold: bool = False) -> QFont:
    """The font of all pictures, which comes with Matplotlib."""
    found = QFont(FONT)
    found.setPointSizeF(points)
    found.setBold(bold)
    return found


def begun(image: QImage) -> QPainter:
    """Painter of an image in logical pixels, with smooth edges."""
    painter = QPainter(image)
    painter.setRenderHints(
        QPainter.RenderHint.Antialiasing
        | QPainter.RenderHint.TextAntialiasing
        | QPainter.RenderHint.SmoothPixmapTransform
    )
    return painter


def framed(image: QImage, title: str, dark: bool = False) -> QImage:
    """The picture of a window's inside with its title bar, on nothing outside of the round corners."""
    scale = image.devicePixelRatio()
    width, height = image.width() / scale, image.height() / scale
    bar = BAR if title else 0.0
    whole = blank(width, height + bar, scale)
    fill, line, text = ("#2c3038", "#14161a", "#cfd3db") if dark else ("#eceef1", "#c5cad2", "#3c434f")
    with begun(whole) as painter:
        outline = QPainterPath()
        outline.addRoundedRect(QRectF(0.5, 0.5, width - 1, height + bar - 1), _ROUND, _ROUND)
        painter.setClipPath(outline)
        painter.fillRect(QRectF(0, 0, width, bar), QColor(fill))
        painter.setFont(font(9.5))
        painter.setPen(QColor(text))
        painter.drawText(QRectF(0, 0, width, bar), Qt.AlignmentFlag.AlignCenter, title)
        if title:
            _close_sign(painter, QPointF(width - 20, bar / 2))
        painter.drawImage(QPointF(0, bar), image)
        painter.setClipping(False)
        painter.setPen(QPen(QColor(line), 1.0))
        painter.drawPath(outline)
    return whole


def _close_sign(painter: QPainter, at: QPointF) -> None:
    painter.setPen(QPen(painter.pen().color(), 1.4))
    for x in (-4.0, 4.0):
        painter.drawLine(at + QPointF(x, -4.0), at + QPointF(-x, 4.0))


def blank(width: float, height: float, scale: float) -> QImage:
    """A transparent image of logical pixels."""
    image = QImage(round(width * scale), round(height * scale), QImage.Format.Format_ARGB32_Premultiplied)
    image.setDevicePixelRatio(scale)
    image.fill(Qt.GlobalColor.transparent)
    return image


def draw_cursor(painter: QPainter, at: QPointF, pressed: bool = False) -> None:
    """The mouse, with a halo while its button is down."""
    if pressed:
        halo = QColor(ACCENT)
        halo.setAlphaF(0.28)
        painter.setPen(QPen(ACCENT, 1.5))
        painter.setBrush(halo)
        painter.drawEllipse(at, 15.0, 15.0)
    arrow = QPolygonF([at + _CURSOR * QPointF(x, y) for x, y in _ARROW])
    painter.setPen(QPen(QBrush(PAPER), 1.6, j=Qt.PenJoinStyle.RoundJoin))
    painter.setBrush(INK)
    painter.drawPolygon(arrow)


def draw_trail(painter: QPainter, points: Sequence[QPointF]) -> None:
    """The way of a drag, in dots, with a ring where it began."""
    path = QPainterPath(points[0])
    for point in points[1:]:
        path.lineTo(point)
    painter.setBrush(Qt.BrushStyle.NoBrush)
    for color, width in ((PAPER, 4.5), (ACCENT, 2.2)):
        pen = QPen(QBrush(color), width, Qt.PenStyle.CustomDashLine, Qt.PenCapStyle.RoundCap)
        pen.setDashPattern([0.01, 9.0 / width])
        painter.setPen(pen)
        painter.drawPath(path)
    painter.setPen(QPen(ACCENT, 2.0))
    painter.setBrush(PAPER)
    painter.drawEllipse(points[0], 4.5, 4.5)


def draw_box(painter: QPainter, box: QRectF) -> None:
    """A frame around what is meant."""
    painter.setBrush(Qt.BrushStyle.NoBrush)
    for color, width in ((PAPER, 5.0), (ACCENT, 2.5)):
        painter.setPen(QPen(color, width))
        painter.drawRoundedRect(box, 6.0, 6.0)


def draw_callout(painter: QPainter, text: str, target: QPointF, at: QPointF) -> None:
    """A text in a bubble around ``at``, with a line to a dot on the target."""
    painter.setFont(font(10.0, bold=True))
    box = _text_box(text, at)
    end = _nearest(box, target)
    for color, width in ((PAPER, 4.5), (INK, 1.8)):
        painter.setPen(QPen(QBrush(color), width, c=Qt.PenCapStyle.RoundCap))
        painter.drawLine(end, target)
    painter.setPen(QPen(PAPER, 1.6))
    painter.setBrush(INK)
    painter.drawEllipse(target, 4.5, 4.5)
    painter.drawRoundedRect(box, 7.0, 7.0)
    painter.setPen(PAPER)
    painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)


def _text_box(text: str, at: QPointF) -> QRectF:
    size = QFontMetricsF(font(10.0, bold=True)).boundingRect(
        QRectF(0, 0, 1000, 1000), Qt.AlignmentFlag.AlignCenter, text
    )
    box = QRectF(0, 0, size.width() + 2 * _BUBBLE + 4, size.height() + _BUBBLE + 2)
    box.moveCenter(at)
    return box


def _nearest(box: QRectF, target: QPointF) -> QPointF:
    """Point of a box that is nearest to a target outside."""
    x = min(max(target.x(), box.left()), box.right())
    y = min(max(target.y(), box.top()), box.bottom())
    return QPointF(x, y)


def draw_number(painter: QPainter, number: int, at: QPointF) -> None:
    """A number in a disc, for a list below the picture."""
    painter.setPen(QPen(PAPER, 2.0))
    painter.setBrush(ACCENT)
    painter.drawEllipse(at, 13.0, 13.0)
    painter.setFont(font(10.5, bold=True))
    painter.setPen(PAPER)
    painter.drawText(QRectF(at.x() - 13, at.y() - 13, 26, 26), Qt.AlignmentFlag.AlignCenter, str(number))


def draw_play_sign(painter: QPainter, at: QPointF) -> None:
    """A disc with a triangle: a film begins here."""
    disc = QColor(INK)
    disc.setAlphaF(0.72)
    painter.setPen(QPen(PAPER, 3.0))
    painter.setBrush(disc)
    painter.drawEllipse(at, 40.0, 40.0)
    painter.setBrush(PAPER)
    painter.drawPolygon(QPolygonF([at + QPointF(*corner) for corner in ((-12, -18), (-12, 18), (19, 0))]))


def carded(image: QImage, margin: float = 12.0) -> QImage:
    """A drawing on a light card with round corners, which is legible on dark pages too."""
    scale = image.devicePixelRatio()
    width, height = image.width() / scale + 2 * margin, image.height() / scale + 2 * margin
    whole = blank(width, height, scale)
    with begun(whole) as painter:
        fill = QLinearGradient(0.0, 0.0, 0.0, height)
        fill.setColorAt(0.0, QColor("#f7f8fa"))
        fill.setColorAt(1.0, QColor("#e9ecf0"))
        painter.setPen(QPen(QColor("#c5cad2"), 1.0))
        painter.setBrush(fill)
        painter.drawRoundedRect(QRectF(0.5, 0.5, width - 1, height - 1), _ROUND, _ROUND)
        painter.drawImage(QPointF(margin, margin), image)
    return whole


def centred(image: QImage, width: float, height: float, scale: float) -> QImage:
    """An image in the middle of a transparent one, ``scale`` pixels each of its logical ones."""
    image.setDevicePixelRatio(scale)
    whole = blank(width, height, scale)
    at = QPointF(width - image.width() / scale, height - image.height() / scale) / 2
    with begun(whole) as painter:
        painter.drawImage(at, image)
    return whole
