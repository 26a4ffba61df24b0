"""Controls of the preferences, by the kind of their values."""

from __future__ import annotations

from typing import Any

from apd_viewer.ui.preferences.preference import NumberRange, OneOf, Preference
from apd_viewer.ui.preferences.preference_values import PreferenceValues
from apd_viewer.ui.widgets.fields import ComboBox, NumberField

SETTING_PROPERTY = "settingName"  # property of a control, by which the manual knows it


def preference_control(preference: Preference[Any], values: PreferenceValues) -> ComboBox | NumberField:
    """Control showing a preference, now and after changes made elsewhere."""
    if isinstance(preference.allowed, NumberRange):
        control: ComboBox | NumberField = _NumberControl(preference, preference.allowed, values)
    else:
        control = _ChoiceControl(preference, preference.allowed, values)
    control.setObjectName(preference.name)
    control.setProperty(SETTING_PROPERTY, preference.name)
    control.setAccessibleName(preference.title)
    control.setAccessibleDescription(preference.note)
    control.setToolTip(preference.tip)
    return control


class _ChoiceControl(ComboBox):
    """List of the allowed values."""

    def __init__(self, preference: Preference[Any], allowed: OneOf[Any], values: PreferenceValues) -> None:
        super().__init__()
        self._preference, self._values = preference, values
        self._ordered = [option.value for option in allowed.options]
        self.addItems([option.title for option in allowed.options])
        self._show()
        self.activated.connect(lambda k: values.choose(preference, self._ordered[k]))
        values.changed.connect(self._show)

    def _show(self) -> None:
        self.setCurrentIndex(self._ordered.index(self._values[self._preference]))


class _NumberControl(NumberField):
    """Field for a number."""

    def __init__(self, preference: Preference[Any], allowed: NumberRange, values: PreferenceValues) -> None:
        super().__init__(minimum=allowed.least, maximum=allowed.most, decimals=0, suffix=allowed.suffix)
        self._preference, self._values = preference, values
        self._show()
        self.valueChanged.connect(lambda value: values.choose(preference, value))
        values.changed.connect(self._show)

    def _show(self) -> None:
        self.show_value(self._values[self._preference])
