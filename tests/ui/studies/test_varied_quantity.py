"""Quantities that a study can vary: motions of the table, with their ranges."""

import numpy as np
from meshes import box, ends
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

from apd_viewer.cases.plan_columns import SETTING_COLUMNS
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.solver.settings import SETTINGS
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.posing.motion import MOTION_KINDS
from apd_viewer.session.posing.motion_text import parse_motion
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.studies.study_run import document_with_values
from apd_viewer.ui.studies.varied_fields import VariedFields, quantity_range, varied_quantities


def painted_box():
    V, F = box(2, 2, 6)
    labels = np.ones(len(V), dtype=np.uint8)
    labels[ends(V)[0]], labels[ends(V)[1]] = 0, 2
    return initial_state(Mesh(V, F), labels)


def test_varied_quantities_offer_motions_with_ranges_that_a_plan_can_say():
    state = painted_box()
    offered = [each for each in varied_quantities(state) if each.is_motion]
    assert [each.name for each in offered] == [word for word, kind in MOTION_KINDS.items() if kind.study]
    for each in offered:
        span = quantity_range(each, each.low, each.high, state, Unit.NONE)
        assert (span.design_variable.low, span.design_variable.unit) == (0.0, each.unit)
        for end in span.low, span.high:
            parse_motion(f"{each.name} {end}")[0].parse_amounts(Unit.NONE)


def test_varied_fields_say_the_units_of_bare_numbers(qtbot):
    fields = VariedFields(painted_box(), Unit.MILLIMETRE)
    qtbot.addWidget(fields)
    units = {"twist": "°", "push": "mm", "stiffness": "", "area": "%"}
    for name, unit in units.items():
        row = fields.rows[name]
        row.check.setChecked(True)
        row.low.setFocus()
        row.low.selectAll()
        QTest.keyClicks(row.low, "60")
        assert row.low.shown_unit == unit
        QTest.keyClick(row.low, Qt.Key.Key_Return)
        assert row.low.text() == ("60 %" if unit == "%" else "60")
        row.check.setChecked(name == "area")
    (span,) = fields.ranges()
    assert span.low == "60%"


def test_document_with_values_has_each_setting_that_a_study_can_vary():
    state = painted_box()
    varied = [each for each in varied_quantities(state) if each.name in SETTINGS]
    assert len(varied) > 1
    for each in varied:
        settings = document_with_values(
            state, Unit.NONE, 0, {each.name: each.high, "twist": "20deg"}
        ).settings
        assert getattr(settings, each.name) == SETTING_COLUMNS[each.name].parse(each.high)
