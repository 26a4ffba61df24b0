"""Panel sections folded by a click on their heading, and pages of them."""

from functools import partial

from PySide6.QtCore import QEvent, QRect, QSize, Qt, QTimer
from PySide6.QtGui import QFont, QFontMetrics, QPainter, QPaintEvent
from PySide6.QtWidgets import QAbstractButton, QFrame, QLabel, QScrollArea, QSizePolicy, QTabWidget, QWidget

from apd_viewer.language import tr
from apd_viewer.ui.widgets.box_layouts import STRETCH, column_layout
from apd_viewer.ui.widgets.theme import LIGHT, Theme, icon

CHEVRON = 16  # px


class Heading(QAbstractButton):
    """Clickable heading of a section: title, reading and chevron."""

    def __init__(self, title: str) -> None:
        super().__init__(checkable=True, checked=True, text=title, accessibleName=title)
        self.setToolTip(tr("Fold or unfold “{title}”").format(title=title))
        self.reading = ""
        self._only_folded = False
        self._theme = LIGHT

    def _title_font(self) -> QFont:
        # As the widget's own it would also be the font of the buttons in the heading.
        font = QFont(self.font())
        font.setWeight(QFont.Weight.DemiBold)
        return font

    def sizeHint(self) -> QSize:
        """Size of title, reading and chevron on one line."""
        metrics = QFontMetrics(self._title_font())
        width = metrics.horizontalAdvance(f"{self.text()}  {self.reading}") + CHEVRON + 8
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
        painter.setFont(self._title_font())
        painter.drawText(room, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter, self.text())
        chevron = QRect(room.right() + 1 - CHEVRON, (room.height() - CHEVRON) // 2, CHEVRON, CHEVRON)
        icon("unfolded" if self.isChecked() else "folded", theme).paint(painter, chevron)
        if not (self._only_folded and self.isChecked()):
            painter.setFont(self.font())
            painter.setPen(theme.ink if self.isEnabled() else theme.faint)
            painter.drawText(
                room.adjusted(0, 0, -CHEVRON - 8, 0),
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
        reveal_widget(self)

    def set_theme(self, theme: Theme) -> None:
        """Apply the theme to the parts not covered by the style sheet."""
        self.heading.set_theme(theme)


def reveal_widget(widget: QWidget) -> None:
    """Unfold the sections around a widget, choose their page and scroll to the widget."""
    node, area = widget.parentWidget(), None
    while node is not None:
        if isinstance(heading := getattr(node, "heading", None), Heading):
            heading.setChecked(True)
        elif isinstance(node, QScrollArea):
            area = node
            QTimer.singleShot(0, node, partial(node.ensureWidgetVisible, widget))  # after the layout
        elif isinstance(node, QTabWidget) and area is not None:
            node.setCurrentWidget(area)
        node = node.parentWidget()


class PanelPage(QScrollArea):
    """Scrolling column of sections, never narrower than its widest line."""

    def __init__(self, *sections: QWidget) -> None:
        super().__init__(focusPolicy=Qt.FocusPolicy.NoFocus)  # the scroll area follows the focused widget
        self.setWidgetResizable(True)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        body = QWidget(objectName="panel")
        column_layout(*sections, STRETCH, margins=(16, 0, 16, 12), parent=body)
        self.setWidget(body)

    def minimumSizeHint(self) -> QSize:
        """Width of the widest line, so that nothing is cut off."""
        body, edge = self.widget(), self.contentsMargins()
        bar = self.verticalScrollBar().sizeHint().width() + edge.left() + edge.right()
        lines = body.minimumSizeHint().width() + bar if body else 0
        return QSize(lines, super().minimumSizeHint().height())

    def sizeHint(self) -> QSize:
        """Preferred size, as narrow as the minimum."""
        return QSize(self.minimumSizeHint().width(), super().sizeHint().height())

    def changeEvent(self, event: QEvent) -> None:
        """Update the size hint after a change of font or style."""
        super().changeEvent(event)
        if event.type() in (QEvent.Type.FontChange, QEvent.Type.StyleChange):
            QTimer.singleShot(0, self, self.updateGeometry)


def name_label(name: str) -> QLabel:
    """Quiet label for names given by users; a long word is cut off."""
    label = quiet_label(name)
    policy = label.sizePolicy()
    policy.setHorizontalPolicy(QSizePolicy.Policy.Ignored)
    label.setSizePolicy(policy)
    return label


def quiet_label(name: str, text: str = "", style: str = "quiet", indent: int = -1) -> QLabel:
    """Wrapping label in a muted or given style, with an indent in px."""
    return QLabel(text, objectName=style, accessibleName=name, wordWrap=True, indent=indent)
