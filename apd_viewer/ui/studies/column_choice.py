"""Choice of a column of the results."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QSize, Qt, Signal

from apd_viewer.language import tr
from apd_viewer.ui.studies.result_columns import ResultColumn
from apd_viewer.ui.widgets.fields import ComboBox

_NARROWEST, _AROUND = 72, 44  # px, of a choice and around its title


class ColumnChoice(ComboBox):
    """Combo box of columns; it keeps its choice while there is such a column.

    Parameters
    ----------
    name : str
        For those who do not see it.
    may_be_none : bool
        Whether no column can be chosen too.

    Attributes
    ----------
    chosen : Signal()
    """

    chosen = Signal()

    def __init__(self, name: str, may_be_none: bool = False) -> None:
        super().__init__(accessibleName=name, toolTip=name)
        self._may_be_none = may_be_none
        self._own = False  # until somebody chooses, the columns so far tell what is shown
        self.activated.connect(self._choose)

    def _choose(self) -> None:
        self._own = True
        self.chosen.emit()
        self._tell()

    def _tell(self) -> None:
        """Tell the whole title where there is no room for it."""
        self.setToolTip(f"{self.accessibleName()}: {self.currentText()}")
        self.updateGeometry()

    @property
    def name(self) -> str:
        """Name of the column; empty for none."""
        return str(self.currentData() or "")

    def set_columns(self, columns: Sequence[ResultColumn], preferred: Sequence[ResultColumn]) -> None:
        """Offer other columns; the first of ``preferred`` until one is chosen."""
        names = [column.name for column in columns]
        before = self.currentData() if self._own else None
        offered = [self.itemData(k) for k in range(self.count())]
        if offered == [*([""] if self._may_be_none else []), *names]:
            return
        self.clear()
        if self._may_be_none:
            self.addItem(tr("none"), "")
        for column in columns:
            self.addItem(column.title, column.name)
            self.setItemData(self.count() - 1, column.tip, Qt.ItemDataRole.ToolTipRole)
        wanted = before if before in names or before == "" else preferred[0].name if preferred else ""
        self.setCurrentIndex(max(0, self.findData(wanted)))
        widest = self.view().sizeHintForColumn(0) if self.count() else 0
        self.view().setMinimumWidth(widest + 24)
        self._tell()

    def sizeHint(self) -> QSize:
        """Room for the chosen title, and not for the longest."""
        text = self.fontMetrics().horizontalAdvance(self.currentText())
        return QSize(max(_NARROWEST, text + _AROUND), super().sizeHint().height())

    def minimumSizeHint(self) -> QSize:
        """A few letters: the list shows the whole."""
        return QSize(_NARROWEST, self.sizeHint().height())
