"""Panel section folded by a click on its heading."""

from PySide6.QtCore import QRect, QSize, Qt, QTimer
from PySide6.QtGui import QFont, QPainter, QPaintEvent
from PySide6.QtWidgets import QAbstractButton, QFrame, QLabel, QScrollArea, QWidget

from apd_viewer.language import tr
from apd_viewer.ui.widgets.box_layouts import column_layout
from apd_viewer.ui.widgets.theme import LIGHT, Theme, icon

_CHEVRON = 16


class Heading(QAbstractButton):
    """Clickable heading of a section: title, reading and chevron."""

    def __init__(self, title: str) -> None:
        super().__init__(checkable=True, checked=True, text=title, accessibleName=title)
        self.setToolTip(tr("Fold or unfold “{title}”").format(title=title))
        self.reading = ""
        self._only_folded = False
        self._theme = LIGHT
        font = QFont(self.font())
        font.setWeight(QFont.Weight.DemiBold)
        self.setFont(font)

    def sizeHint(self) -> QSize:
        """Size of title, reading and chevron on one line."""
        metrics = self.fontMetrics()
        width = metrics.horizontalAdvance(f"{self.text()}  {self.reading}") + _CHEVRON + 8
        return QSize(width, max(24, metrics.height() + 8))

    def show_reading(self, reading: str, only_folded: bool = False) -> None:
        """Show a reading on the right, always or only while folded."""
        self._only_folded = only_folded
        if reading != self.reading:
            self.reading = reading
            self.setAccessibleDescription(reading)
            self.update()

    def set_theme(self, theme: Theme) -> None:
        """Apply the colours of the theme."""
        self._theme = theme
        self.update()

    def paintEvent(self, _: QPaintEvent) -> None:
        """Draw title, chevron and reading."""
        theme, room = self._theme, self.rect()
        painter = QPainter(self)
        painter.setPen(theme.ink if self.underMouse() or self.hasFocus() else theme.quiet)
        painter.drawText(room, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter, self.text())
        chevron = QRect(room.right() + 1 - _CHEVRON, (room.height() - _CHEVRON) // 2, _CHEVRON, _CHEVRON)
        icon("unfolded" if self.isChecked() else "folded", theme).paint(painter, chevron)
        if not (self._only_folded and self.isChecked()):
            font = QFont(self.font())
            font.setWeight(QFont.Weight.Normal)
            painter.setFont(font)
            painter.setPen(theme.ink if self.isEnabled() else theme.faint)
            painter.drawText(
                room.adjusted(0, 0, -_CHEVRON - 8, 0),
                Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter,
                self.reading,
            )
        if self.hasFocus():
            painter.setPen(theme.accent)
            painter.drawLine(room.bottomLeft(), room.bottomRight())


class Section(QWidget):
    """Section of a panel: rule, heading and folding content.

    Attributes
    ----------
    column : QVBoxLayout
        Layout of the content.
    """

    def __init__(self, title: str) -> None:
        super().__init__()
        self.title = title
        self.heading = Heading(title)
        self._body = QWidget()
        self.column = column_layout(margins=(0, 4, 0, 4), parent=self._body)
        rule = QFrame(objectName="rule")
        rule.setFixedHeight(1)
        column_layout(rule, 8, self.heading, self._body, 4, spacing=0, parent=self)
        self.heading.toggled.connect(self._body.setVisible)

    @property
    def is_folded(self) -> bool:
        """True if only the heading is shown."""
        return not self.heading.isChecked()

    @is_folded.setter
    def is_folded(self, on: bool) -> None:
        self.heading.setChecked(not on)

    def reveal(self) -> None:
        """Unfold the section and scroll the panel to it."""
        self.is_folded = False
        QTimer.singleShot(0, self, self._scroll_into_view)  # after the layout of new rows

    def _scroll_into_view(self) -> None:
        area = self.parentWidget()
        while area is not None and not isinstance(area, QScrollArea):
            area = area.parentWidget()
        if area is not None:
            area.ensureWidgetVisible(self)

    def set_theme(self, theme: Theme) -> None:
        """Apply the theme to the parts not covered by the style sheet."""
        self.heading.set_theme(theme)


def quiet_label(name: str, text: str = "", style: str = "quiet", indent: int = -1) -> QLabel:
    """Wrapping label in a muted or given style, with an indent in px."""
    return QLabel(text, objectName=style, accessibleName=name, wordWrap=True, indent=indent)
