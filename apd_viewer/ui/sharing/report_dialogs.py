"""Dialogs for the heading of a report, and for the table of volumes."""

from collections.abc import Callable

from PySide6.QtCore import QEvent, QSize
from PySide6.QtWidgets import QDialog, QGridLayout, QLabel, QPushButton, QTextBrowser, QVBoxLayout, QWidget

from apd_viewer.files.html_page import PageBlock, block_html
from apd_viewer.language import tr
from apd_viewer.presentation.report_page import ReportHeading
from apd_viewer.ui.widgets.box_layouts import STRETCH, column_layout, resize_on_screen, row_layout
from apd_viewer.ui.widgets.fields import TextField
from apd_viewer.ui.widgets.help_button import HelpButton
from apd_viewer.ui.widgets.theme import DARK, LIGHT, Theme

_LONGEST, _WIDTH = 200, 320  # characters of a field, and px


class ReportDialog(QDialog):
    """Dialog for the heading of a report.

    Parameters
    ----------
    proposed : ReportHeading
        To begin with.
    default : str
        Title of a report without one of its own.
    """

    def __init__(self, parent: QWidget, proposed: ReportHeading, default: str) -> None:
        super().__init__(parent, objectName="report")
        self.setWindowTitle(tr("Save report"))
        self.report_title = TextField(accessibleName=tr("Title"), toolTip=tr("Title of the report"))
        self.customer = TextField(
            accessibleName=tr("Prepared for"), toolTip=tr("Customer or project below the title; may be empty")
        )
        self.report_title.setPlaceholderText(default)
        grid = QGridLayout(horizontalSpacing=16, verticalSpacing=8)
        for row, (field, text) in enumerate(zip((self.report_title, self.customer), proposed, strict=True)):
            field.setText(text)
            field.setMaxLength(_LONGEST)
            field.setMinimumWidth(_WIDTH)
            grid.addWidget(QLabel(field.accessibleName(), buddy=field), row, 0)
            grid.addWidget(field, row, 1)
        self.save = QPushButton(tr("Save…"), objectName="primary", default=True, clicked=self.accept)
        cancel = QPushButton(tr("Cancel"), clicked=self.reject)
        buttons = row_layout(HelpButton(), STRETCH, cancel, self.save)
        column = column_layout(grid, buttons, spacing=16, margins=(20, 16, 20, 16), parent=self)
        column.setSizeConstraint(QVBoxLayout.SizeConstraint.SetFixedSize)

    @property
    def heading(self) -> ReportHeading:
        """Title and customer as entered."""
        return ReportHeading(self.report_title.text().strip(), self.customer.text().strip())


_SIZE = QSize(980, 640)
_STYLE = """
th, td {{ padding: 6px 14px 6px 0; text-align: left; vertical-align: top; }}
th {{ font-weight: 600; }}
small {{ color: {quiet}; font-weight: 400; }}
"""


class VolumesDialog(QDialog):
    """Dialog with the volumes at rest and now, beside published values.

    Parameters
    ----------
    table : callable
        Returns the table of a report.
    """

    def __init__(self, window: QWidget, table: Callable[[], PageBlock]) -> None:
        super().__init__(window, objectName="study")
        self.setWindowTitle(tr("Volumes"))
        self._table = table
        self._shown: tuple[Theme, str] | None = None
        self.text = QTextBrowser(openLinks=False, accessibleName=tr("Volumes"), objectName="pages")
        self.text.document().setDocumentMargin(0)  # its text is aligned with the buttons
        self.copy = QPushButton(tr("Copy table"), autoDefault=False, clicked=self._copy)
        self.close_ = QPushButton(tr("Close"), objectName="primary", autoDefault=False, clicked=self.close)
        below = row_layout(self.copy, STRETCH, self.close_)
        column_layout((self.text, 1), below, spacing=16, margins=(20, 16, 20, 16), parent=self)
        self.refresh()
        resize_on_screen(self, _SIZE)

    def refresh(self) -> None:
        """Show the current volumes; the scroll position is kept."""
        theme = DARK if self.palette().window().color().lightnessF() < 0.5 else LIGHT
        shown = theme, block_html(self._table())
        if shown != self._shown:
            self._shown, place = shown, self.text.verticalScrollBar().value()
            self.text.document().setDefaultStyleSheet(_STYLE.format(quiet=theme.quiet))
            self.text.setHtml(shown[1])
            self.text.verticalScrollBar().setValue(place)

    def changeEvent(self, event: QEvent) -> None:
        """Show the text in the colours of the theme."""
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange and self._shown is not None:
            self.refresh()

    def _copy(self) -> None:
        self.text.selectAll()
        self.text.copy()
        self.text.moveCursor(self.text.textCursor().MoveOperation.Start)
