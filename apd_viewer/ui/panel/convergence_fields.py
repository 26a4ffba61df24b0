"""Convergence of the method section: folded fields of the stop criteria."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QVBoxLayout, QWidget

from apd_viewer.geometry.solver.convergence import (
    DEFAULT_CONVERGENCE,
    LARGEST_TOLERANCE,
    MOST_ITERATIONS,
    Convergence,
)
from apd_viewer.language import tr
from apd_viewer.ui.panel.field_row import field_row
from apd_viewer.ui.widgets.fields import NumberField
from apd_viewer.ui.widgets.folding_section import Heading
from apd_viewer.ui.widgets.theme import Theme

if TYPE_CHECKING:
    from apd_viewer.session.model.document import Document

_LEAST = 1e-15  # of a tolerance: rounding


class ConvergenceFields(QWidget):
    """Heading, folded at first, and the fields that apply to the method.

    Attributes
    ----------
    chosen : Signal(Convergence)
    heading : Heading
    most_iterations, energy, step : NumberField
    """

    chosen = Signal(object)

    def __init__(self) -> None:
        super().__init__()
        self.heading = Heading(tr("Convergence"))
        self.most_iterations = NumberField(
            accessibleName=tr("Most iterations"),
            toolTip=tr("The solver stops after so many iterations, converged or not"),
            minimum=1.0,
            maximum=float(MOST_ITERATIONS),
            decimals=0,
        )
        self.energy = _tolerance(
            tr("Energy tolerance"),
            tr("Converged once ten iterations together reduce the energy by at most this part of it"),
        )
        self.step = _tolerance(
            tr("Step tolerance"),
            tr(
                "Converged once an iteration moves no vertex by more than this part of the diagonal of "
                "the bounding box, and those to come by at most 100 times that"
            ),
        )
        self._rows = {
            field: field_row(field.accessibleName(), field)
            for field in (self.most_iterations, self.energy, self.step)
        }
        self._lay_out()
        for field in self._rows:
            field.valueChanged.connect(lambda _: self._choose())

    def _lay_out(self) -> None:
        body = QWidget()
        rows = QVBoxLayout(body, spacing=4)
        rows.setContentsMargins(0, 0, 0, 0)
        for row in self._rows.values():
            rows.addWidget(row)
        column = QVBoxLayout(self, spacing=4)
        column.setContentsMargins(0, 4, 0, 0)
        column.addWidget(self.heading)
        column.addWidget(body)
        self.heading.toggled.connect(body.setVisible)
        self.heading.setChecked(False)

    def _choose(self) -> None:
        most, energy, step = (field.value() for field in self._rows)
        self.chosen.emit(Convergence(int(most), energy, step))

    def show_settings(self, document: Document) -> None:
        """Show the criteria that apply to the method."""
        shown, plain = document.settings.convergence, document.settings.traits.is_plain_only
        self._rows[self.energy].setVisible(not plain)
        self._rows[self.step].setVisible(plain)
        self.most_iterations.show_value(shown.most_iterations)
        self.energy.show_value(shown.energy_tolerance)
        self.step.show_value(shown.step_tolerance)
        self.heading.show_reading("" if shown == DEFAULT_CONVERGENCE else tr("changed"), only_folded=True)

    def set_theme(self, theme: Theme) -> None:
        """Recolour the heading."""
        self.heading.set_theme(theme)


def _tolerance(name: str, tip: str) -> NumberField:
    return NumberField(
        brief=True, accessibleName=name, toolTip=tip, minimum=_LEAST, maximum=LARGEST_TOLERANCE, decimals=18
    )
