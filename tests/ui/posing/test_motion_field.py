"""Field for a typed motion: it offers every motion of the table."""

import pytest
from motions import EVERY
from PySide6.QtCore import Qt

from apd_viewer.session.posing.motion import LINE, MOTIONS
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.posing.motion_field import MotionField


@pytest.fixture
def field(qtbot):
    field = MotionField()
    qtbot.addWidget(field)
    return field


def test_motion_field_offers_the_motions_in_their_order(field):
    assert [field.choice.itemData(k) for k in range(field.choice.count())] == list(EVERY)
    assert [field.choice.itemText(k) for k in range(field.choice.count())] == [
        motion.title for motion in MOTIONS.values()
    ]


@pytest.mark.parametrize("name", EVERY)
def test_motion_field_enters_every_motion_with_its_example(qtbot, field, name):
    motion = MOTIONS[name]
    field.choice.setCurrentIndex(field.choice.findData(name))
    assert field.amount.placeholderText() == motion.kind.example
    assert (field.amount.toolTip() == motion.kind.tip) is not field.is_about_line
    assert field.is_about_line is (motion.axis == LINE)
    field.amount.setText(field.amount.placeholderText())
    with qtbot.waitSignal(field.motion_entered) as entered:
        qtbot.keyClick(field.amount, Qt.Key.Key_Return)
    assert entered.args == [motion, motion.kind.example, False]


def test_motion_field_says_the_unit_of_a_bare_amount(field):
    field.show_unit(Unit.CENTIMETRE)
    said = {}
    for name in MOTIONS:
        field.choice.setCurrentIndex(field.choice.findData(name))
        field.amount.setText("2")
        said[name] = field.amount.shown_unit
    assert {said["TWIST"], said["BEND_X"]} == {"°"}
    assert {said["PUSH"], said["MOVE_X"]} == {"cm"}
    assert said["SCALE"] == ""


def test_motion_field_keeps_an_amount_for_motions_that_take_such_alone(field):
    def take(name):
        field.choice.setCurrentIndex(field.choice.findData(name))

    take("TWIST")
    field.amount.setText("20deg")
    take("TURN_Y")
    assert field.amount.text() == "20deg"
    take("MOVE_X")
    assert field.amount.text() == ""
