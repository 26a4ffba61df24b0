"""Fields for one number: what is typed into them, and what Enter makes of what they show."""

import pytest
from PySide6.QtCore import Qt

from apd_viewer.ui.widgets.fields import Number


@pytest.fixture
def field(qtbot):
    """A field for lengths, in a unit."""
    field = Number(brief=True, decimals=9, maximum=1e9, suffix="\u00a0mm")
    qtbot.addWidget(field)
    field.show()
    return field


def enter(qtbot, field, text):
    field.selectAll()
    qtbot.keyClick(field, Qt.Key.Key_Delete)
    qtbot.keyClicks(field, text)
    qtbot.keyClick(field, Qt.Key.Key_Return)


@pytest.mark.parametrize("value", [0.001, 1.2345, 999.6, 1234.5, 3000.0, 2_000_000.0, 2e-8])
def test_enter_leaves_the_number_that_is_shown(qtbot, field, value):
    field.setValue(value)
    qtbot.keyClick(field, Qt.Key.Key_Return)
    assert field.value() == value


@pytest.mark.parametrize("text", ["nothing", "", "-5", "1e400", "nan", "7\u00a0km"])
def test_what_is_no_number_in_the_range_leaves_the_one_that_was_there(qtbot, field, text):
    field.setValue(3000.0)
    enter(qtbot, field, text)
    assert field.value() == 3000.0


@pytest.mark.parametrize("text", ["5", "5 mm", "5mm", " 5\u00a0mm", "5,0", "0.5e1"])
def test_the_unit_may_be_typed_too(qtbot, field, text):
    enter(qtbot, field, text)
    assert field.value() == 5.0
