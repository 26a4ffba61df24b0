"""Field for a typed motion: it offers every motion of the table."""

import pytest
from motions import EVERY
from PySide6.QtCore import Qt

from apd_viewer.session.posing.motion import LINE, MOTIONS
from apd_viewer.ui.posing.pose_section import MotionField


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
