"""Labels that are elided to their width."""

import re

import pytest

from apd_viewer.ui.widgets.elided_label import ElidedLabel, elided_text


@pytest.mark.parametrize("text", ["iteration 1,305, 281.7 ms per iteration", "at 3 of 14"])
def test_elided_text_shows_no_part_of_a_number_as_a_number(qtbot, text):
    label = ElidedLabel()
    qtbot.addWidget(label)
    label.setText(text)
    drawn = [elided_text(text, label.fontMetrics(), width) for width in range(label.room_for(text))]
    assert drawn[-1] == text
    numbers = set(re.findall(r"\d[\d.,]*\d|\d", text))
    for each in drawn:
        assert each == text or each.endswith("…") or not each
        assert set(re.findall(r"\d[\d.,]*\d|\d", each)) <= numbers, each
    assert len(set(drawn)) > 2, "what is no number is cut as before"
