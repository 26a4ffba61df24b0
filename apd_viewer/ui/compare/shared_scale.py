"""Colour scale shared by several shapes."""

from __future__ import annotations

from dataclasses import replace

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QGridLayout, QLabel, QPushButton, QWidget

from apd_viewer.language import tr
from apd_viewer.presentation.scales import Scale
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.overlays.scale_bar import ScaleBar
from apd_viewer.ui.widgets.fields import NumberField

_WIDTH = 248


class SharedScale(QWidget):
    """A legend with its range.

    Parameters
    ----------
    scale : Scale
        Of ratios.

    Attributes
    ----------
    scale : Scale
    changed : Signal()
        The range is another one.
    span : tuple of float or None
        Least and largest value in sight.
    """

    changed = Signal()

    def __init__(self, scale: Scale) -> None:
        super().__init__()
        self.scale = scale
        self.span: tuple[float, float] | None = None
        self.setFixedWidth(_WIDTH)
        self._bar = ScaleBar()
        tip = tr("Change at the ends of the scale, where the colours are strongest")
        self.reach = NumberField(
            brief=True, accessibleName=tr("Range"), toolTip=tip, decimals=9, suffix="\u00a0%"
        )
        self.reach.setRange(1e-7, 1e9)
        self.reach.valueChanged.connect(lambda percent: self._rescale(percent / 100.0))
        tip = tr("Fit the scale to the largest change of all shapes")
        self.fit = QPushButton(tr("Fit"), toolTip=tip)
        self.fit.clicked.connect(self._fit)
        grid = QGridLayout(self, horizontalSpacing=8, verticalSpacing=6)
        grid.setContentsMargins(0, 0, 0, 0)
        title = QLabel(scale.measure.traits.title, objectName="title", toolTip=scale.measure.traits.tip)
        grid.addWidget(title, 0, 0, 1, 3)
        grid.addWidget(self._bar, 1, 0, 1, 3)
        grid.addWidget(QLabel(tr("Range"), objectName="quiet"), 2, 0)
        grid.addWidget(self.reach, 2, 1, Qt.AlignmentFlag.AlignRight)
        grid.addWidget(self.fit, 2, 2)
        grid.setColumnStretch(0, 1)
        grid.setRowStretch(3, 1)
        self._show()

    def show_span(self, span: tuple[float, float] | None) -> None:
        """Show the least and the largest value of all shapes; None shows none."""
        self.span = span
        self._bar.show_values(span, None)
        self.fit.setEnabled(span is not None)

    def _fit(self) -> None:
        if self.span is not None:
            self._rescale(self.scale.fitted_to(self.span).reach)

    def _rescale(self, reach: float) -> None:
        if reach != self.scale.reach:
            self.scale = replace(self.scale, reach=reach)
            self._show()
            self.changed.emit()

    def _show(self) -> None:
        self.reach.show_value(100.0 * self.scale.reach)
        self._bar.show_scale(self.scale, Unit.NONE)
