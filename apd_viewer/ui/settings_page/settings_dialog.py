"""Settings: their dialog, and their effects on the window."""

import os
import sys
from collections.abc import Callable
from typing import Any

from PySide6.QtCore import QObject, QSize, Qt
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QDialog, QGridLayout, QHBoxLayout, QLabel, QPushButton, QScrollArea, QWidget

from apd_viewer.language import choose_language, tr
from apd_viewer.session.session import Session
from apd_viewer.ui.preferences.preference_values import Choice, NumberRange, Preference, PreferenceValues
from apd_viewer.ui.settings_page import preference_table
from apd_viewer.ui.tools.brush_tool import BrushSize
from apd_viewer.ui.tools.tool_choice import ToolChoice
from apd_viewer.ui.widgets.box_layouts import STRETCH, column_layout, resize_on_screen, row_layout
from apd_viewer.ui.widgets.fields import ComboBox, NumberField
from apd_viewer.ui.widgets.help_button import HelpButton

_WIDTH, _TITLES, _CONTROLS = 720, 120, 190  # px; dialog width, and smallest widths of titles and controls


class SettingsDialog(QDialog):
    """Dialog of grouped preferences, with buttons for shortcuts and defaults.

    Parameters
    ----------
    list_shortcuts : callable
        Shows the shortcuts, in the window behind.
    """

    def __init__(
        self, window: QWidget, values: PreferenceValues, list_shortcuts: Callable[[], object]
    ) -> None:
        super().__init__(window, objectName="study")
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.setWindowTitle(tr("Settings"))
        self._values, self._list_shortcuts = values, list_shortcuts
        page = QWidget(objectName="page")
        groups = [self._group(group) for group in preference_table.GROUPS]
        _align(groups)
        column_layout(*groups, STRETCH, spacing=20, parent=page)
        area = QScrollArea(widgetResizable=True, objectName="pages", focusPolicy=Qt.FocusPolicy.NoFocus)
        area.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        area.setWidget(page)
        column = column_layout((area, 1), self._buttons(), spacing=20, margins=(20, 16, 20, 16), parent=self)
        needed = page.sizeHint().height() + column.sizeHint().height() - area.sizeHint().height()
        resize_on_screen(self, QSize(_WIDTH, needed))

    def _group(self, group: preference_table.PreferenceGroup) -> QGridLayout:
        grid = QGridLayout(horizontalSpacing=16, verticalSpacing=8)
        grid.setColumnStretch(2, 1)
        grid.addWidget(QLabel(group.title, objectName="heading"), 0, 0, 1, 3)
        for line, preference in enumerate(group.rows, start=1):
            title, control = QLabel(preference.title), preference_control(preference, self._values)
            title.setBuddy(control)
            note = QLabel(preference.note, objectName="quiet", wordWrap=True)
            for column, part in enumerate((title, control, note)):
                grid.addWidget(part, line, column)
        return grid

    def _buttons(self) -> QHBoxLayout:
        self.shortcuts = QPushButton(tr("Keyboard shortcuts…"), autoDefault=False)
        self.restore = QPushButton(tr("Restore defaults"), autoDefault=False)
        # No default button: Enter in a field only ends its editing, and does not close the dialog.
        self.close_ = QPushButton(tr("Close"), objectName="primary", autoDefault=False, clicked=self.close)
        self.shortcuts.setToolTip(tr("View and change the keyboard shortcuts"))
        self.restore.setToolTip(tr("Return all settings of this page to their defaults"))
        self.shortcuts.clicked.connect(self._show_shortcuts)
        self.restore.clicked.connect(lambda: self._values.restore_defaults(preference_table.PREFERENCES))
        self._values.changed.connect(self._offer_restore)
        self._offer_restore()
        self.help = HelpButton()
        return row_layout(self.help, self.shortcuts, self.restore, STRETCH, self.close_)

    def _offer_restore(self) -> None:
        self.restore.setEnabled(any(self._values[row] != row.default for row in preference_table.PREFERENCES))

    def _show_shortcuts(self) -> None:
        self.close()
        self._list_shortcuts()


def _align(grids: list[QGridLayout]) -> None:
    """Align titles and controls of all groups, regardless of the lengths of texts."""
    for column, least in enumerate((_TITLES, _CONTROLS)):
        found = [grid.itemAtPosition(row, column) for grid in grids for row in range(1, grid.rowCount())]
        width = max([least, *(item.sizeHint().width() for item in found if item is not None)])
        for grid in grids:
            grid.setColumnMinimumWidth(column, width)


class SettingsDialogOpener(QObject):
    """Opens the settings dialog, one at a time."""

    def __init__(
        self, window: QWidget, values: PreferenceValues, list_shortcuts: Callable[[], object]
    ) -> None:
        super().__init__(window)
        self._window, self._values, self._list_shortcuts = window, values, list_shortcuts
        self.dialog: SettingsDialog | None = None

    def open_at(self, name: str) -> None:
        """Open the dialog and focus the preference ``name``."""
        self.open()
        control = self.dialog.findChild(QWidget, name) if self.dialog is not None else None
        if isinstance(control, QWidget):
            control.setFocus(Qt.FocusReason.TabFocusReason)

    def open(self) -> None:
        """Open the dialog or bring it to the front."""
        if self.dialog is None:
            self.dialog = SettingsDialog(self._window, self._values, self._list_shortcuts)
            self.dialog.finished.connect(self._forget)
            self.dialog.show()
        self.dialog.raise_()
        self.dialog.activateWindow()

    def close(self) -> None:
        """Close the dialog if it is open."""
        if self.dialog is not None:
            self.dialog.close()

    def _forget(self) -> None:
        self.dialog = None


SETTING_PROPERTY = "settingName"  # property of a control with its name in the manual


def preference_control(preference: Preference[Any], values: PreferenceValues) -> ComboBox | NumberField:
    """Control showing and changing a preference, also updated from elsewhere."""
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
    """Combo box for the value of a preference."""

    def __init__(self, preference: Preference[Any], allowed: Choice[Any], values: PreferenceValues) -> None:
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
    """Number field for the value of a preference."""

    def __init__(self, preference: Preference[Any], allowed: NumberRange, values: PreferenceValues) -> None:
        super().__init__(minimum=allowed.least, maximum=allowed.most, decimals=0, suffix=allowed.suffix)
        self._preference, self._values = preference, values
        self._show()
        self.valueChanged.connect(lambda value: values.choose(preference, value))
        values.changed.connect(self._show)

    def _show(self) -> None:
        self.show_value(self._values[self._preference])


def limit_threads(threads: int) -> None:
    """Limit the threads of parallel kernels here and in child processes; 0 for none.

    Effective only before numba is imported, which reads the number once; a number set in the environment
    takes precedence.
    """
    if threads and "numba" not in sys.modules:
        os.environ.setdefault("NUMBA_NUM_THREADS", str(threads))


def connect_preferences(
    values: PreferenceValues, session: Session, tools: ToolChoice, brush: BrushSize
) -> None:
    """Apply the preferences to session and tools, now and after changes."""
    values.apply_now_and_on_change(preference_table.UNDO_MEMORY, session.gestures.limit_memory)
    values.apply_now_and_on_change(preference_table.AUTOSAVE, session.autosave.set_interval)
    values.apply_now_and_on_change(preference_table.SELECTION_MODE, tools.set_mode)
    values.apply_now_and_on_change(preference_table.BRUSH_RADIUS, brush.set_radius)


def connect_menu(values: PreferenceValues, schemes: dict[Qt.ColorScheme, QAction]) -> None:
    """Keep the colour scheme checked in the menu."""
    values.apply_now_and_on_change(
        preference_table.COLOR_SCHEME, lambda scheme: schemes[scheme].setChecked(True)
    )


def connect_language(values: PreferenceValues, show_failure: Callable[[str], object]) -> None:
    """Store a chosen language for the next start, or report a failure."""

    def keep(name: str) -> None:
        try:
            choose_language(name)
        except OSError as error:
            reason = error.strerror or str(error)
            show_failure(tr("The language cannot be stored ({reason}).").format(reason=reason))

    values.on_change(preference_table.LANGUAGE, keep)
