"""Switch of symmetric posing, its axis, and the partner of the active handle."""

from __future__ import annotations

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QHBoxLayout, QPushButton, QVBoxLayout, QWidget

from apd_viewer.language import tr
from apd_viewer.ui.widgets.fields import CheckBox, ComboBox
from apd_viewer.ui.widgets.folding_section import quiet_label

_TIP = tr("Move each handle together with its mirror image on the other side of the mesh")
_AXIS = tr("Axis to mirror along, through the middle of the mesh at rest")


class SymmetryRow(QWidget):
    """Switches symmetric posing, and says which handle moves along.

    Attributes
    ----------
    axis_chosen : Signal(object)
        The axis to mirror along, 0, 1 or 2, or None.
    paint_requested : Signal()
        The mirror image of the active handle is to be painted.
    """

    axis_chosen = Signal(object)
    paint_requested = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.box = CheckBox(tr("Symmetric"), toolTip=_TIP)
        self.axis = ComboBox(accessibleName=tr("Axis of symmetry"), toolTip=_AXIS)
        for number, letter in enumerate("xyz"):
            self.axis.addItem(tr("along {axis}").format(axis=letter), number)
        self.partner = quiet_label(tr("Mirror partner of the handle"))
        self.partner.hide()
        self.paint = QPushButton(
            tr("Paint mirror handle"),
            toolTip=tr("Add a handle on the free vertices at the mirror image of the active one"),
        )
        self.paint.hide()
        line = QHBoxLayout(spacing=8)
        line.addWidget(self.box, 1)
        line.addWidget(self.axis)
        column = QVBoxLayout(self, spacing=4)
        column.setContentsMargins(0, 0, 0, 4)
        column.addLayout(line)
        column.addWidget(self.partner)
        column.addWidget(self.paint)
        self.box.toggled.connect(self._choose)
        self.axis.currentIndexChanged.connect(self._choose)
        self.paint.clicked.connect(self.paint_requested)

    def show_settings(self, axis: int | None, sentence: str, may_paint: bool) -> None:
        """Show the axis, what is said of the partner, and the button to paint one."""
        for control in (self.box, self.axis):
            control.blockSignals(True)
        self.box.setChecked(axis is not None)
        if axis is not None:
            self.axis.setCurrentIndex(axis)
        for control in (self.box, self.axis):
            control.blockSignals(False)
        self.partner.setText(sentence)
        self.partner.setVisible(bool(sentence))
        self.paint.setVisible(may_paint)

    def _choose(self) -> None:
        self.axis_chosen.emit(self.axis.currentData() if self.box.isChecked() else None)
