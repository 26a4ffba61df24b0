"""Method section: the method and its settings."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QLabel, QPushButton, QWidget

from apd_viewer.geometry.solver.convergence import (
    DEFAULT_CONVERGENCE,
    LARGEST_SEED,
    LARGEST_TOLERANCE,
    MOST_ITERATIONS,
    Convergence,
)
from apd_viewer.geometry.solver.methods import DEFAULT_METHOD, METHODS, Method
from apd_viewer.geometry.solver.settings import DEFAULT_SETTINGS, SETTINGS, Setting, SettingKind
from apd_viewer.language import tr, trc
from apd_viewer.ui.widgets.box_layouts import add_parts, column_layout
from apd_viewer.ui.widgets.fields import CheckBox, ComboBox, NumberField
from apd_viewer.ui.widgets.folding_section import Heading, Section, quiet_label
from apd_viewer.ui.widgets.quantity_fields import LengthField, field_row
from apd_viewer.ui.widgets.slider_field import DECADES, SliderField
from apd_viewer.ui.widgets.theme import Theme

if TYPE_CHECKING:
    from apd_viewer.session.model.document import Document
    from apd_viewer.session.quantities.units import Unit

_FIELDS = (SettingKind.NUMBER, SettingKind.LENGTH, SettingKind.AMOUNT)
# Settings without a field here: stiffness has a slider, and thickness follows the wall fields.
_ELSEWHERE = ("stiffness", "thickness")
# Words for 0 in the fields of unset settings.
_UNSET = {
    "wall_thickness": trc("wall thickness", "default"),
    "yield_radius": trc("yield radius", "none"),
    "gas": trc("enclosed gas", "none"),
}


class MethodSection(Section):
    """Choice of the method, targets of area and volume, and settings.

    Parameters
    ----------
    targets : sequence of QWidget
        Fields of what is kept.

    Attributes
    ----------
    changed : Signal(str, object)
        Name of a setting and its value, but for contact.
    wall_creases_chosen : Signal()
        The yield radius of the wall is to be used.
    numbers : dict of str to NumberField
        Of the other settings that are numbers, by their names; 0, shown as a word, is an unset one.
    """

    changed = Signal(str, object)
    contact_chosen = Signal(bool)
    wall_creases_chosen = Signal()

    def __init__(self, targets: Sequence[QWidget]) -> None:
        super().__init__(tr("Method"))
        self.method = ComboBox(accessibleName=tr("Method"), toolTip=tr("Deformation method"))
        for name, method in METHODS.items():
            self.method.addItem(method.title, name)
        self.method.activated.connect(lambda index: self.changed.emit("method", self.method.itemData(index)))
        self.column.addWidget(self.method)
        self._keeps = quiet_label(tr("What the method keeps"))
        self._gives_up = quiet_label(tr("What the method gives up"))
        add_parts(self.column, self._keeps, self._gives_up)
        self._describe(METHODS[DEFAULT_METHOD])
        add_parts(self.column, 4, *targets, 4)
        self._add_settings()

    def _add_settings(self) -> None:
        self._rows: dict[str, QWidget] = {}
        self.numbers: dict[str, NumberField] = {}
        self.calm = self._switch(
            "calm",
            tr("Keep calm parts"),
            tr("Keep the area of limbs and other parts that the gesture does not reach"),
        )
        self.calm.clicked.connect(partial(self.changed.emit, "calm"))
        self.contact = self._switch(
            "contact",
            tr("Contact"),
            tr("Keep walls from passing through each other; slower where they touch"),
        )
        self.contact.clicked.connect(self.contact_chosen)
        self.tension_field = self._switch(
            "tension_field",
            tr("Tension field"),
            tr("Let the wall wrinkle finer than the mesh, as film and cloth do: it resists no compression"),
        )
        self.tension_field.clicked.connect(partial(self.changed.emit, "tension_field"))
        self.tolerance = NumberField(
            accessibleName=tr("Area tolerance in percent"),
            toolTip=tr("Allowed deviation of the total area from its target"),
            minimum=0.001,
            maximum=10.0,
            decimals=3,
            suffix=" %",
        )
        self.tolerance.valueChanged.connect(lambda percent: self.changed.emit("tolerance", percent / 100.0))
        self._add_row("tolerance", field_row(SETTINGS["tolerance"].title, self.tolerance))
        tip = tr("Bending stiffness: how strongly the surface resists bending, from cloth to sheet metal")
        field = NumberField(brief=True, toolTip=tip, minimum=0.0, maximum=1.0, decimals=5, singleStep=0.001)
        label = QLabel(tr("Stiffness"), toolTip=tip)
        self.stiffness = SliderField(
            label, DECADES, field, tr("Stiffness"), ends=(tr("cloth"), tr("sheet metal"))
        )
        self._add_row("stiffness", self.stiffness)
        self.wall_creases = QPushButton(tr("From wall"), accessibleName=tr("Yield radius from the wall"))
        self.wall_creases.clicked.connect(lambda: self.wall_creases_chosen.emit())
        self.show_wall_creases("")
        for name, setting in SETTINGS.items():
            if setting.kind in _FIELDS and name not in _ELSEWHERE:
                self._add_number(name, setting)
        self.convergence = ConvergenceFields()
        self.column.addWidget(self.convergence)

    def _switch(self, name: str, title: str, tip: str) -> CheckBox:
        box = CheckBox(title, toolTip=tip)
        self._rows[name] = box
        self.column.addWidget(box)
        return box

    def _add_number(self, name: str, setting: Setting) -> None:
        tip = setting.help[0].upper() + setting.help[1:]
        kind = LengthField if setting.kind is SettingKind.LENGTH else NumberField
        field = kind(brief=True, accessibleName=setting.title, toolTip=tip, maximum=setting.most, decimals=18)
        field.setSpecialValueText(_UNSET.get(name, ""))
        field.setStepType(NumberField.StepType.AdaptiveDecimalStepType)
        default = getattr(DEFAULT_SETTINGS, name)
        field.valueChanged.connect(
            lambda value: self.changed.emit(name, value or None if default is None else value)
        )
        self.numbers[name] = field
        beside = (self.wall_creases,) if name == "yield_radius" else ()
        self._add_row(name, field_row(setting.title, field, *beside))

    def _add_row(self, name: str, row: QWidget) -> None:
        row.hide()  # shown once the chosen method uses it
        self._rows[name] = row
        self.column.addWidget(row)

    def show_settings(self, document: Document) -> None:
        """Show the method and its settings."""
        settings = document.settings
        self.method.setCurrentIndex(self.method.findData(settings.method))
        self._describe(settings.traits)
        for name, row in self._rows.items():
            row.setVisible(SETTINGS[name].applies(settings))
        for name, field in self.numbers.items():
            field.show_value(getattr(settings, name) or 0.0)
        self.calm.setChecked(settings.calm)
        self.contact.setChecked(settings.contact)
        self.tension_field.setChecked(settings.tension_field)
        self.tolerance.show_value(100.0 * settings.tolerance)
        self.stiffness.show_value(settings.stiffness)
        self.convergence.show_settings(document)

    def show_unit(self, unit: Unit) -> None:
        """Show the unit of the lengths."""
        for field in self.numbers.values():
            if isinstance(field, LengthField):
                field.show_unit(unit)

    def show_wall_creases(self, radius: str) -> None:
        """Offer the yield radius of the wall, as a text; empty if unknown."""
        self.wall_creases.setEnabled(bool(radius))
        offer = tr("Use the yield radius of the wall in Size and mass: {radius}").format(radius=radius)
        self.wall_creases.setToolTip(offer if radius else tr("The wall in Size and mass has no yield radius"))

    def _describe(self, method: Method) -> None:
        self.heading.show_reading(method.title, only_folded=True)
        self._keeps.setText(method.keeps_sentence)
        self._gives_up.setText(method.gives_up_sentence)

    def set_theme(self, theme: Theme) -> None:
        """Apply the theme to the parts not covered by the style sheet."""
        super().set_theme(theme)
        self.stiffness.set_theme(theme)
        self.convergence.set_theme(theme)


_LEAST = 1e-15  # smallest tolerance: about the rounding error


class ConvergenceFields(QWidget):
    """Collapsible section with the convergence criteria applicable to the method.

    Attributes
    ----------
    chosen : Signal(Convergence)
    """

    chosen = Signal(object)

    def __init__(self) -> None:
        super().__init__()
        self.heading = Heading(tr("Convergence"))
        self.most_iterations = NumberField(
            accessibleName=tr("Iteration limit"),
            toolTip=tr("The solver stops after this many iterations, converged or not"),
            minimum=1.0,
            maximum=float(MOST_ITERATIONS),
            decimals=0,
        )
        self.energy = _tolerance(
            tr("Energy tolerance"),
            tr("Converged once ten iterations together reduce the energy by at most this fraction"),
        )
        self.step = _tolerance(
            tr("Step tolerance"),
            tr(
                "Converged once an iteration moves no vertex by more than this fraction of the bounding box "
                "diagonal, and all later ones by at most 100 times that"
            ),
        )
        self.imperfection = NumberField(
            brief=True,
            accessibleName=tr("Imperfection"),
            toolTip=tr(
                "Displacement that disturbs a shape at rest on a saddle of its energy, as a fraction of the "
                "bounding box diagonal; 0 for none"
            ),
            maximum=LARGEST_TOLERANCE,
            decimals=18,
        )
        self.seed = NumberField(
            is_grouped=False,  # it is copied to the command line
            accessibleName=tr("Seed"),
            toolTip=tr(
                "Direction of the disturbance: 0 for the steepest descent, others at random, since "
                "several folds may compete"
            ),
            maximum=float(LARGEST_SEED),
            decimals=0,
        )
        self._rows = {
            field: field_row(field.accessibleName(), field)
            for field in (self.most_iterations, self.energy, self.step, self.imperfection, self.seed)
        }
        self._lay_out()
        for field in self._rows:
            field.valueChanged.connect(lambda _: self._choose())

    def _lay_out(self) -> None:
        body = QWidget()
        column_layout(*self._rows.values(), parent=body)
        column_layout(self.heading, body, margins=(0, 4, 0, 0), parent=self)
        self.heading.toggled.connect(body.setVisible)
        self.heading.setChecked(False)

    def _choose(self) -> None:
        most, energy, step, imperfection, seed = (field.value() for field in self._rows)
        self.chosen.emit(Convergence(int(most), energy, step, imperfection, int(seed)))

    def show_settings(self, document: Document) -> None:
        """Show the convergence criteria applicable to the method."""
        shown, plain = document.settings.convergence, document.settings.traits.is_plain_only
        for field in (self.energy, self.imperfection, self.seed):
            self._rows[field].setVisible(not plain)
        self._rows[self.step].setVisible(plain)
        self.most_iterations.show_value(shown.most_iterations)
        self.energy.show_value(shown.energy_tolerance)
        self.step.show_value(shown.step_tolerance)
        self.imperfection.show_value(shown.imperfection)
        self.seed.show_value(shown.seed)
        self.heading.show_reading("" if shown == DEFAULT_CONVERGENCE else tr("changed"), only_folded=True)

    def set_theme(self, theme: Theme) -> None:
        """Apply the theme to the heading."""
        self.heading.set_theme(theme)


def _tolerance(name: str, tip: str) -> NumberField:
    return NumberField(
        brief=True, accessibleName=name, toolTip=tip, minimum=_LEAST, maximum=LARGEST_TOLERANCE, decimals=18
    )
