"""The field for what is held inside: percent, a volume or a pressure."""

import numpy as np
import pytest
from driving import document, idle

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.wall import NO_WALL
from apd_viewer.ui.tools.tool_modes import Tool
from apd_viewer.verification.case_meshes import disc, sewn_sheets


def enter(field, text):
    field.setText(text)
    field.editingFinished.emit()


def choose(window, method):
    box = window.panel.method.method
    box.setCurrentIndex(box.findData(method))
    box.activated.emit(box.currentIndex())


def has_wall(window, **texts):
    fields = window.panel.measures.wall_fields
    fields.show_wall(NO_WALL._replace(**texts), window.session.store.unit)
    fields.entered.emit(fields.value)


def test_volume_target_field_takes_percent_a_volume_or_a_pressure(bottle):
    """Each replaces the others, as one step to undo."""
    bottle.choose_unit(Unit.CENTIMETRE)
    volume = bottle.panel.volume
    field, slider = volume.target.field, volume.target.slider
    volume.keep.click()
    assert (field.text(), slider.isVisibleTo(bottle.shell)) == ("100 %", True)
    enter(field, "0.5l")
    assert document(bottle).settings.filled_volume == pytest.approx(500.0)
    assert document(bottle).settings.volume is None
    assert (field.text(), slider.isVisibleTo(bottle.shell)) == ("0.5l", False)
    enter(field, "30mbar")
    assert "method Wall" in field.error.text()
    assert field.text() == "0.5l"
    bottle.session.gestures.undo()
    assert field.text() == "100 %"
    enter(field, "95%")
    assert document(bottle).settings.volume == 95.0
    volume.keep.click()
    assert document(bottle).settings.volume is None


def test_volume_target_field_holds_a_pressure_of_the_wall(bottle):
    """The wall of the settings has Young's modulus times thickness 4; another one has the same pressure."""
    bottle.choose_unit(Unit.CENTIMETRE)
    volume = bottle.panel.volume
    field = volume.target.field
    choose(bottle, "wall")
    volume.keep.click()
    enter(field, "30mbar")
    assert "Young's modulus" in field.error.text()
    for thickness in (0.3, 0.6):
        has_wall(bottle, thickness=f"{thickness}mm", young="2.8GPa")
        if thickness == 0.3:
            enter(field, "30mbar")
        settings = document(bottle).settings
        assert settings.pressure == pytest.approx(3000.0 * 4.0 / (2.8e9 * 0.1 * thickness))
        assert settings.volume is None
        assert field.text() == "30mbar"
    bottle.session.settings.set_contact(False)
    enter(field, "-50mbar")
    assert document(bottle).settings.pressure > 0.0, "a vacuum needs contact"
    assert field.text() == "30mbar"
    volume.keep.click()
    assert document(bottle).settings.pressure is None


def test_volume_target_field_fills_a_flat_bag_and_refuses_more_than_a_ball(qtbot, kept_window):
    V, F = sewn_sheets(*disc(3), 1e-3)
    kept_window.files.show_mesh(Mesh(5.0 * V, F, unit="cm"))
    idle(qtbot, kept_window)
    volume = kept_window.panel.volume
    field = volume.target.field
    assert "enter a volume such as 250ml" in volume.disabled_note.text()
    assert field.isVisibleTo(kept_window.shell)
    assert not volume.target.slider.isVisibleTo(kept_window.shell)
    kept_window.session.gestures.begin()
    kept_window.session.painting.paint(np.array([0]), BASE)
    kept_window.session.painting.end_stroke("Paint")
    enter(field, "1l")
    idle(qtbot, kept_window)
    assert "at most 179.5 cubic mesh units, as a ball" in kept_window.notice.text
    assert "Now paint the part to move" in kept_window.invitation.text()
    enter(field, "50ml")
    assert document(kept_window).settings.filled_volume == pytest.approx(50.0)
    assert "The base is enough" in kept_window.invitation.text()
    kept_window.tools.choose_tool(Tool.HANDLE)
    assert "Paint the part to move" in kept_window.invitation.text(), "one may be painted, too"
    kept_window.tools.choose_tool(Tool.ORBIT)
    assert kept_window.invitation.text() == ""
    idle(qtbot, kept_window)
    assert kept_window.session.store.state.frame.volume == pytest.approx(50.0, rel=1e-6)
    choose(kept_window, "wall")
    kept_window.session.settings.change(tension_field=True)
    has_wall(kept_window, thickness="0.1mm", young="1GPa")
    amounts = []
    for text in ("10mbar", "0.1bar"):
        enter(field, text)
        idle(qtbot, kept_window)
        assert field.text() == text
        amounts.append(kept_window.session.store.state.frame.volume)
    # Two discs of radius 5 sewn together hold 1.2185 of its cube, if they are smooth.
    assert 0.85 * 1.2185 * 125.0 < amounts[0] < amounts[1]
