"""Fields for one number: what is typed into them, and what Enter makes of what they show."""

import pytest
from driving import work_off
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QLineEdit, QWidget

from apd_viewer.notation import Notation, notation, use_notation
from apd_viewer.ui.widgets.box_layouts import column_layout
from apd_viewer.ui.widgets.fields import ComboBox, NumberField, percent_field


@pytest.fixture
def field(qtbot):
    """A field for lengths, in a unit."""
    field = NumberField(brief=True, decimals=9, maximum=1e9, suffix="\u00a0mm")
    qtbot.addWidget(field)
    field.show()
    return field


def enter(qtbot, field, text):
    field.selectAll()
    qtbot.keyClick(field, Qt.Key.Key_Delete)
    qtbot.keyClicks(field, text)
    qtbot.keyClick(field, Qt.Key.Key_Return)


@pytest.mark.parametrize("value", [0.001, 1.2345, 999.6, 1234.5, 3000.0, 2_000_000.0, 2e-8])
def test_number_field_keeps_the_value_that_is_shown_on_enter(qtbot, field, value):
    field.setValue(value)
    qtbot.keyClick(field, Qt.Key.Key_Return)
    assert field.value() == value


@pytest.mark.parametrize("text", ["nothing", "", "-5", "1e400", "nan", "7\u00a0km"])
def test_number_field_keeps_a_text_for_correction_that_is_no_number_in_its_range(qtbot, field, text):
    field.setValue(3000.0)
    enter(qtbot, field, text)
    assert field.value() == 3000.0
    assert field.lineEdit().text().startswith(text)
    qtbot.keyClick(field, Qt.Key.Key_Escape)
    assert field.text() == "3000\u00a0mm"


def test_number_field_is_typed_over_after_a_click_into_it(qtbot):
    window, field, other = QWidget(), NumberField(maximum=1e9, value=3000.0, decimals=0), QLineEdit()
    column_layout(other, field, parent=window)
    qtbot.addWidget(window)
    window.show()
    window.activateWindow()
    qtbot.waitUntil(window.isActiveWindow)
    other.setFocus()
    qtbot.mouseClick(field.lineEdit(), Qt.MouseButton.LeftButton)
    qtbot.waitUntil(lambda: field.lineEdit().selectedText() == "3,000")
    qtbot.keyClicks(field, "12")
    qtbot.mouseClick(field.lineEdit(), Qt.MouseButton.LeftButton)
    work_off()
    assert field.lineEdit().selectedText() == "", "the next click places the cursor"
    qtbot.keyClick(field, Qt.Key.Key_Return)
    assert field.value() == 12.0


REFUSED = {
    "5000": "“5000” is out of range; enter a number from 1 to 1,000 %.",
    "-1 %": "“-1” is out of range; enter a number from 1 to 1,000 %.",
    "abc": "“abc” is not a number; enter one from 1 to 1,000 %.",
    "": "Enter a number from 1 to 1,000 %.",
}


@pytest.mark.parametrize("text", REFUSED)
def test_percent_field_says_beneath_why_a_number_is_refused_and_what_is_allowed(qtbot, text):
    window, field = QWidget(), percent_field("Target", "")
    field.setParent(window)
    qtbot.addWidget(window)
    window.resize(400, 200)
    window.show()
    enter(qtbot, field, text)
    error = field.error
    assert error.text() == REFUSED[text]
    assert error.isVisible()
    assert error.geometry().top() > field.geometry().bottom()
    assert window.rect().contains(error.geometry())
    qtbot.keyClicks(field, "120")
    assert error.isHidden(), "once it is corrected"
    qtbot.keyClick(field, Qt.Key.Key_Return)
    assert field.value() == 120.0
    assert error.isHidden()


def test_percent_field_refuses_a_number_left_behind_too(qtbot):
    window, field, other = QWidget(), percent_field("Target", ""), QLineEdit()
    for part in (field, other):
        part.setParent(window)
    qtbot.addWidget(window)
    window.show()
    window.activateWindow()
    qtbot.waitUntil(window.isActiveWindow)
    field.setFocus()
    field.selectAll()
    qtbot.keyClicks(field, "5000")
    other.setFocus()
    assert field.text() == "100.00 %"
    assert field.error.isVisible()
    assert "5000" in field.error.text()
    window.hide()
    assert field.error.isHidden()


@pytest.mark.parametrize(
    ("limits", "said"),
    [
        ((1e-30, 1e30), "greater than 0"),
        ((0.0, 1e30), "of at least 0 mm"),
        ((16.0, 32_768.0), "from 16 to 32,768 mm"),
        ((0.0, 0.5), "from 0 to 0.5 mm"),
    ],
)
def test_number_field_says_its_range_as_one_says_it(qtbot, field, limits, said):
    field.setDecimals(30)
    field.setSuffix(" mm")
    field.setRange(*limits)
    enter(qtbot, field, "abc")
    assert field.error.text() == f"“abc” is not a number; enter one {said}."


@pytest.mark.parametrize("text", ["5", "5 mm", "5mm", " 5\u00a0mm", "5,0", "0.5e1"])
def test_number_field_takes_the_unit_typed_too(qtbot, field, text):
    enter(qtbot, field, text)
    assert field.value() == 5.0


def test_combo_box_cuts_no_entry_off_where_it_is_smallest(qtbot):
    choice = ComboBox()
    qtbot.addWidget(choice)
    choice.addItems(["Bending", "Target: closest point"])
    choice.setCurrentIndex(1)
    words = choice.fontMetrics().horizontalAdvance(choice.currentText())
    choice.resize(choice.minimumSizeHint())
    picture = choice.grab().toImage()
    wide = ComboBox()
    qtbot.addWidget(wide)
    wide.addItems(["Target: closest point"])
    wide.resize(choice.width() + 50, choice.height())
    other = wide.grab().toImage()
    inner = range(6, 8 + words)
    rows = range(4, choice.height() - 4)
    assert [picture.pixel(x, y) for x in inner for y in rows] == [
        other.pixel(x, y) for x in inner for y in rows
    ]


def test_percent_field_asks_about_a_percentage_that_could_be_a_factor(qtbot):
    window, field = QWidget(), percent_field("Target", "")
    field.setParent(window)
    qtbot.addWidget(window)
    window.show()
    enter(qtbot, field, "1.1")
    assert field.value() == 100.0
    assert field.error.text() == "1.1 can mean 110 % or 1.1 %; write 110% or 1.1%."
    enter(qtbot, field, "1.1%")
    assert field.value() == 1.1
    qtbot.keyClick(field, Qt.Key.Key_Return)
    assert field.value() == 1.1, "what is shown can be entered again"
    assert field.error.isHidden()
    enter(qtbot, field, "110")
    assert field.value() == 110.0


@pytest.mark.parametrize(
    ("example", "shown", "typed"),
    [
        ("1,234.5", "10,000 %", ("10000", "10,000", "10 000", "10\u00a0000", "10,000 %", "1e4")),
        ("1.234,5", "10.000 %", ("10000", "10.000", "10 000", "10.000 %")),
        ("1 234,5", "10 000 %", ("10000", "10 000")),
    ],
)
def test_number_field_groups_the_digits_of_a_count_typed_with_or_without(qtbot, example, shown, typed):
    before = notation()
    use_notation(Notation.from_example(example))
    try:
        field = NumberField(decimals=0, maximum=1e6, suffix=" %")
        qtbot.addWidget(field)
        field.show()
        for text in typed:
            field.setValue(7.0)
            enter(qtbot, field, text)
            assert (field.value(), field.lineEdit().text()) == (10_000.0, shown)
            qtbot.keyClick(field, Qt.Key.Key_Return)
            assert field.value() == 10_000.0, "what is shown can be entered"
    finally:
        use_notation(before)


@pytest.mark.parametrize("text", ["10,00", "1,0000", "1,000,0", ",000", "0,001"])
def test_number_field_takes_no_misplaced_group_for_a_count(qtbot, text):
    field = NumberField(decimals=0, maximum=1e6, value=7.0)
    qtbot.addWidget(field)
    field.show()
    enter(qtbot, field, text)
    assert field.value() in (0.0, 1.0, 7.0, 10.0)


def test_number_field_leaves_numbers_with_decimals_ungrouped(qtbot):
    for field in (NumberField(maximum=1e6, value=10_000.0), NumberField(brief=True, maximum=1e6)):
        qtbot.addWidget(field)
        field.setValue(10_000.0)
        assert field.text() in ("10000.00", "10000")
    seed = NumberField(is_grouped=False, decimals=0, maximum=1e6, value=10_000.0)
    qtbot.addWidget(seed)
    assert seed.text() == "10000"
