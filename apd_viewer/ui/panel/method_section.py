"""Method section: the method and its settings."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QLabel

from apd_viewer.geometry.solver.methods import DEFAULT_METHOD, METHODS, Method
from apd_viewer.language import tr
from apd_viewer.ui.panel.convergence_fields import ConvergenceFields
from apd_viewer.ui.panel.field_row import field_row
from apd_viewer.ui.widgets.fields import CheckBox, ComboBox, NumberField
from apd_viewer.ui.widgets.folding_section import Section, quiet_label
from apd_viewer.ui.widgets.slider import DECADES
from apd_viewer.ui.widgets.slider_field import SliderField
from apd_viewer.ui.widgets.theme import Theme

if TYPE_CHECKING:
    from apd_viewer.session.model.document import Document


class MethodSection(Section):
    """The picker and the settings.

    Attributes
    ----------
    method_chosen : Signal(str)
    calm_chosen, contact_chosen : Signal(bool)
    tolerance_chosen : Signal(float)
        Relative, so 0.001 where the field says 0.1 %.
    area_stiffness_chosen, shear_stiffness_chosen : Signal(float)
    stiffness : SliderField
    convergence : ConvergenceFields
    """

    method_chosen = Signal(str)
    calm_chosen = Signal(bool)
    contact_chosen = Signal(bool)
    tolerance_chosen = Signal(float)
    area_stiffness_chosen = Signal(float)
    shear_stiffness_chosen = Signal(float)

    def __init__(self) -> None:
        super().__init__(tr("Method"))
        self.method = ComboBox(accessibleName=tr("Method"), toolTip=tr("Deformation method"))
        for name, method in METHODS.items():
            self.method.addItem(method.title, name)
        self.method.activated.connect(lambda index: self.method_chosen.emit(self.method.itemData(index)))
        self.column.addWidget(self.method)
        self._keeps = quiet_label(tr("What the method keeps"))
        self._gives_up = quiet_label(tr("What the method gives up"))
        self.column.addWidget(self._keeps)
        self.column.addWidget(self._gives_up)
        self._describe(METHODS[DEFAULT_METHOD])
        self.column.addSpacing(4)
        self._add_settings()

    def _add_settings(self) -> None:
        self.calm = CheckBox(
            tr("Keep calm parts"),
            toolTip=tr("Keep the area of limbs and other parts that the gesture does not reach"),
        )
        self.calm.clicked.connect(self.calm_chosen)
        self.column.addWidget(self.calm)
        self.contact = CheckBox(
            tr("Contact"),
            toolTip=tr("Keep walls from passing through each other; slower where they touch"),
        )
        self.contact.clicked.connect(self.contact_chosen)
        self.column.addWidget(self.contact)
        self.tolerance = NumberField(
            accessibleName=tr("Area tolerance in percent"),
            toolTip=tr("Allowed deviation of the total area from its target"),
            minimum=0.001,
            maximum=10.0,
            decimals=3,
            suffix=" %",
        )
        self.area_stiffness = _modulus(
            tr("Area stiffness"),
            tr("How strongly each triangle keeps its area: the area modulus, relative to that of the whole"),
        )
        self.shear_stiffness = _modulus(
            tr("Shear stiffness"),
            tr(
                "How strongly each triangle keeps its angles: the shear modulus, relative to that of "
                "the whole"
            ),
        )
        self.tolerance.valueChanged.connect(lambda percent: self.tolerance_chosen.emit(percent / 100.0))
        self.area_stiffness.valueChanged.connect(self.area_stiffness_chosen)
        self.shear_stiffness.valueChanged.connect(self.shear_stiffness_chosen)
        self._tolerance = field_row(tr("Tolerance"), self.tolerance)
        self._moduli = (
            field_row(tr("Area stiffness"), self.area_stiffness),
            field_row(tr("Shear stiffness"), self.shear_stiffness),
        )
        for row in (self._tolerance, *self._moduli):
            row.hide()  # until a method uses it
            self.column.addWidget(row)
        tip = tr("How strongly the surface resists bending, from cloth to sheet metal: the bending stiffness")
        field = NumberField(brief=True, toolTip=tip, minimum=0.0, maximum=1.0, decimals=5, singleStep=0.001)
        label = QLabel(tr("Stiffness"), toolTip=tip)
        self.stiffness = SliderField(
            label, DECADES, field, tr("Stiffness"), ends=(tr("cloth"), tr("sheet metal"))
        )
        self.column.addWidget(self.stiffness)
        self.convergence = ConvergenceFields()
        self.column.addWidget(self.convergence)

    def show_settings(self, document: Document) -> None:
        """Show the method and its settings."""
        self.method.setCurrentIndex(self.method.findData(document.method))
        method = document.method_traits
        self._describe(method)
        self.calm.setVisible(method.keeps_calm_parts)
        self.calm.setChecked(document.calm)
        self.contact.setVisible(method.may_use_contact)
        self.contact.setChecked(document.contact)
        self._tolerance.setVisible(method.has_tolerance)
        for row in self._moduli:
            row.setVisible(method.has_moduli)
        self.tolerance.show_value(100.0 * document.tolerance)
        self.area_stiffness.show_value(document.area_stiffness)
        self.shear_stiffness.show_value(document.shear_stiffness)
        self.stiffness.show_value(document.stiffness)
        self.convergence.show_settings(document)

    def _describe(self, method: Method) -> None:
        self.heading.show_reading(method.title, only_folded=True)
        self._keeps.setText(method.keeps_sentence)
        self._gives_up.setText(method.gives_up_sentence)

    def set_theme(self, theme: Theme) -> None:
        """Recolour the parts beyond the style sheet's reach."""
        super().set_theme(theme)
        self.stiffness.set_theme(theme)
        self.convergence.set_theme(theme)


def _modulus(name: str, tip: str) -> NumberField:
    field = NumberField(
        brief=True,
        accessibleName=name,
        toolTip=tip,
        minimum=0.0,
        maximum=10_000.0,
        decimals=4,
    )
    field.setStepType(NumberField.StepType.AdaptiveDecimalStepType)
    return field
