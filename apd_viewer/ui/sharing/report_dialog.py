"""Dialog for the title of a report, and for whom it is."""

from PySide6.QtWidgets import QDialog, QGridLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from apd_viewer.language import tr
from apd_viewer.presentation.report_page import ReportHeading
from apd_viewer.ui.widgets.box_layouts import STRETCH, column_layout, row_layout
from apd_viewer.ui.widgets.fields import TextField
from apd_viewer.ui.widgets.help_button import HelpButton

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
