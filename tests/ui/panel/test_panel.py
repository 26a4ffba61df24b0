"""What the panel says and asks, in a real window."""

import re
from dataclasses import replace

import meshes
import numpy as np
import pytest
from driving import Mouse, document, drag, follow, idle, ring_grip, work_off
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QImage
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QLabel

from apd_viewer.geometry.analysis.deviation import Deviation
from apd_viewer.geometry.analysis.self_intersections import crossings
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, HANDLE
from apd_viewer.presentation.readings import NO_VALUE, area_verdict, box_volume
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.state_store import Activity
from apd_viewer.ui.widgets.slider_field import DECADES, PERCENT


def choose(window, method):
    """Take a method from the picker, as a hand does."""
    picker = window.panel.method.method
    picker.setCurrentIndex(picker.findData(method))
    picker.activated.emit(picker.currentIndex())


def knob(slider, step):
    """Where the knob is at a step."""
    return QPointF(slider.knob_position(step), slider.height() / 2)


def shown(window):
    """The settings of the method that are shown."""
    section = window.panel.method
    fields = {
        "tolerance": section.tolerance,
        "area": section.numbers["area_stiffness"],
        "shear": section.numbers["shear_stiffness"],
        "hold": window.panel.area.hold,
        "target": window.panel.area.target,
        "stiffness": section.stiffness,
    }
    return {name for name, field in fields.items() if field.isVisibleTo(window.shell)}


def test_panel_readings_are_those_of_the_frame(qtbot, bottle):
    details = bottle.panel.handles.list.rows[0].details
    assert details.text() == "at rest"
    drag(qtbot, bottle, ring_grip(bottle, 1), (70, 0))
    idle(qtbot, bottle)
    state, panel = bottle.session.store.state, bottle.panel
    assert panel.area.percent.text() == f"{100 * (1 + state.frame.area_error):.3f} %"
    assert panel.area.verdict.text() == "0.000 %, exact"
    assert f"{state.inspection.area:#.6g}" in panel.area.area.text()
    assert float(panel.strain.local_change.text().rstrip(" %")) == pytest.approx(
        100 * state.frame.local_change, rel=0.01
    )
    V, U, F = state.document.mesh.V, state.frame.U, state.document.mesh.joined_F
    strain = Deviation(V, F, np.empty(0, dtype=np.int32)).edge_strain(U)
    largest, mean = (
        float(label.text().replace("−", "-").rstrip(" %"))
        for label in (panel.strain.largest_strain, panel.strain.mean_strain)
    )
    assert largest == pytest.approx(100 * max(np.expm1(strain), key=abs), rel=0.01)
    assert 0.0 < mean < abs(largest)
    change = 100 * (state.frame.volume / state.inspection.volume - 1)
    assert panel.volume.change.replace("−", "-") in (f"{change:+.2f} %", "unchanged")
    assert panel.strain.drift.text() == "0"
    assert re.fullmatch(r"(twisted|rotated) [+−]\d+\.\d°", details.text()), "only that it has"
    held = state.document.label_counts[HANDLE]
    assert panel.handles.list.rows[0].reading.text() == f"{held:,} vertices"


def test_panel_shows_the_drift_of_the_handle_that_the_paper_allows(qtbot, bottle):
    choose(bottle, "paper")
    drag(qtbot, bottle, ring_grip(bottle, 1), (0, 12))
    idle(qtbot, bottle)
    state = bottle.session.store.state
    assert "within 0.1 %" in bottle.panel.area.verdict.text()
    assert float(bottle.panel.strain.drift.text()) == pytest.approx(state.frame.handle_drift, rel=1e-3)


def test_method_section_shows_the_settings_that_matter_for_each_method(bottle):
    always = {"stiffness"}
    for method, settings in (
        ("exact", {"target"}),
        ("local", {"area", "shear", "hold", "target"}),
        ("paper", {"tolerance", "target"}),
        ("arap", set()),
    ):
        choose(bottle, method)
        assert document(bottle).settings.method == method
        assert shown(bottle) == settings | always
        assert bottle.panel.method.stiffness.field.isEnabled()


def test_method_section_offers_contact_where_it_can_and_keeps_the_wall_thickness(qtbot, bottle):
    box, thickness = bottle.panel.method.contact, bottle.panel.measures.wall_fields.thickness
    bottle.session.settings.set_contact(False)
    for method, may in (("paper", False), ("sr-arap", False), ("local", True), ("exact", True)):
        choose(bottle, method)
        assert box.isVisible() is may
    assert not box.isChecked()
    qtbot.mouseClick(box, Qt.MouseButton.LeftButton, pos=QPoint(10, box.height() // 2))
    assert (document(bottle).settings.contact, document(bottle).settings.thickness) == (True, None)
    assert bottle.session.gestures.history.next_undo_name == "Turn contact on"
    thickness.setText("0.02")
    thickness.editingFinished.emit()
    assert document(bottle).settings.thickness == 0.02
    bottle.actions_.undo.trigger()
    assert (document(bottle).settings.contact, document(bottle).settings.thickness) == (True, None)
    assert thickness.text() == ""
    bottle.actions_.redo.trigger()
    assert thickness.text() == "0.02"
    bottle.actions_.undo.trigger()
    bottle.actions_.undo.trigger()
    assert not document(bottle).settings.contact
    assert not box.isChecked()
    thickness.setText("0.02")
    thickness.editingFinished.emit()
    assert not document(bottle).settings.contact
    qtbot.mouseClick(box, Qt.MouseButton.LeftButton, pos=QPoint(10, box.height() // 2))
    assert document(bottle).settings.thickness == 0.02, "what was typed before is used as well"
    qtbot.mouseClick(box, Qt.MouseButton.LeftButton, pos=QPoint(10, box.height() // 2))
    assert (document(bottle).settings.contact, document(bottle).settings.thickness) == (False, None)


def test_set_contact_says_that_a_wall_is_too_thick_and_changes_nothing(qtbot, bottle):
    box, thickness = bottle.panel.method.contact, bottle.panel.measures.wall_fields.thickness
    bottle.session.settings.set_contact(True)
    before = document(bottle)
    qtbot.keyClicks(thickness, "3")
    qtbot.keyClick(thickness, Qt.Key.Key_Return)
    assert document(bottle) is before
    assert bottle.notice.text.startswith("The wall thickness must be at most ")
    assert thickness.text() == "3", "the mass is still of that wall"
    bottle.session.settings.set_contact(False)
    bottle.notice.hide()
    qtbot.mouseClick(box, Qt.MouseButton.LeftButton, pos=QPoint(10, box.height() // 2))
    assert bottle.notice.isVisible()
    assert not document(bottle).settings.contact
    assert not box.isChecked()


@pytest.mark.night
def test_set_contact_ends_a_twist_without_a_crossing(qtbot, bottle):
    found = []
    bottle.panel.pages.setCurrentWidget(bottle.panel.measurements)
    for on in (False, True):
        bottle.session.settings.set_contact(on)
        bottle.session.handles.move_by(MOTIONS["TWIST"], "150deg", 0)
        idle(qtbot, bottle)
        state = bottle.session.store.state
        found.append(len(crossings(state.frame.U, state.document.mesh.joined_F)))
        assert state.frame.share_reached == 1.0
        assert bottle.panel.volume.pairs.isVisible() is on
        assert not on or bottle.panel.volume.path_fraction.text() == "100 %"
        bottle.session.gestures.undo()
        idle(qtbot, bottle)
        assert not on or bottle.panel.volume.path_fraction.text() == NO_VALUE, "nothing has moved"
    assert found[0] > 0
    assert found[1] == 0


def test_size_section_counts_a_thickness_with_a_unit_once_that_of_the_mesh_is_known(bottle):
    thickness = bottle.panel.measures.wall_fields.thickness
    bottle.session.settings.set_contact(True)
    thickness.setText("0.3mm")
    thickness.editingFinished.emit()
    assert document(bottle).settings.thickness is None
    bottle.choose_unit(Unit.CENTIMETRE)
    assert document(bottle).settings.thickness == pytest.approx(0.03)
    bottle.choose_unit(Unit.MILLIMETRE)
    assert document(bottle).settings.thickness == pytest.approx(0.3)
    assert thickness.text() == "0.3mm"
    before = document(bottle)
    thickness.setText("0.3")
    thickness.editingFinished.emit()
    assert document(bottle) is before, "it is the same distance"


def test_volume_section_reads_contact_too(qtbot, bottle):
    volume = bottle.panel.volume
    bottle.session.settings.set_contact(True, 0.03)
    said = [label.text() for label in (volume.pairs, volume.least_gap, volume.path_fraction)]
    assert said == ["none", "–", "–"], "nothing has moved"
    bottle.session.handles.move_by(MOTIONS["TWIST"], "150deg", 0)
    idle(qtbot, bottle)
    frame = bottle.session.store.state.frame
    assert frame.contact.pairs == int(volume.pairs.text().replace(",", "")) > 0
    assert 0.0 < frame.contact.least_gap < 0.03
    assert float(volume.least_gap.text()) == pytest.approx(frame.contact.least_gap, rel=1e-3)
    bottle.session.handles.move_by(MOTIONS["TWIST"], "2deg", 0)
    qtbot.waitUntil(lambda: bottle.session.shape_checks.shape_check is None)
    assert volume.crossings.text() == "no self-intersections", "on the way too"
    idle(qtbot, bottle)


def test_set_contact_takes_crossings_out_of_a_shape_once_contact_is_turned_on(qtbot, bottle):
    volume, box = bottle.panel.volume, bottle.panel.method.contact
    bottle.session.settings.set_contact(False)
    bottle.session.handles.move_by(MOTIONS["TWIST"], "150deg", 0)
    idle(qtbot, bottle)
    state = bottle.session.store.state
    assert len(crossings(state.frame.U, state.document.mesh.joined_F))
    assert volume.crossings.text() != "no self-intersections"
    qtbot.mouseClick(box, Qt.MouseButton.LeftButton, pos=QPoint(10, box.height() // 2))
    qtbot.waitUntil(lambda: bottle.session.store.state.frame.contact is not None, timeout=30_000)
    assert bottle.session.store.activity is Activity.REFINING
    assert volume.crossings.text() == "no self-intersections", "while it solves"
    idle(qtbot, bottle)


def test_patch_ghost_shows_where_contact_has_not_let_the_handle_go(qtbot, bottle):
    drag(qtbot, bottle, ring_grip(bottle, 1), (0, 12))
    idle(qtbot, bottle)
    state, ghost = bottle.session.store.state, bottle.motion_preview.requested_ghost.patches
    assert len(ghost.vertices) == 0
    stopped = replace(state, frame=replace(state.frame, share_reached=0.6, settled=True))
    bottle.session.store.set_state(stopped)
    held = state.document.constraints()
    assert np.array_equal(ghost.vertices, held.targets[np.isin(held.fixed, held.handles[0])])
    bottle.session.store.set_state(replace(stopped, frame=replace(stopped.frame, settled=False)))
    assert len(ghost.vertices) == 0


def test_method_section_can_change_the_method_while_a_pose_is_held(qtbot, bottle):
    drag(qtbot, bottle, ring_grip(bottle, 1), (0, 12), steps=4)
    idle(qtbot, bottle)
    exact = bottle.session.store.state
    assert exact.document.handles[0].pose[0, 0] < 0.999
    choose(bottle, "arap")
    idle(qtbot, bottle)
    plain = bottle.session.store.state
    assert plain.document.handles is exact.document.handles
    assert abs(plain.frame.area_error) > abs(exact.frame.area_error)
    assert np.abs(plain.frame.U - exact.frame.U).max() > 0
    bottle.actions_.undo.trigger()
    assert bottle.session.store.state.frame is exact.frame
    choose(bottle, "paper")
    bottle.panel.method.tolerance.setValue(0.02)
    assert document(bottle).settings.tolerance == pytest.approx(0.0002)
    idle(qtbot, bottle)
    assert abs(bottle.session.store.state.frame.area_error) <= 0.0002


def test_area_section_asks_for_a_typed_target_and_it_is_met(qtbot, bottle):
    field = bottle.panel.area.target.field
    field.setFocus()
    field.selectAll()
    qtbot.keyClicks(field, "110")
    qtbot.keyClick(field, Qt.Key.Key_Return)
    assert document(bottle).settings.area == 110.0
    says = bottle.panel.area.verdict
    qtbot.waitUntil(lambda: says.text() == "+10.000 %, exactly on target")
    assert bottle.panel.area.target.slider.value() == PERCENT.step_of(110.0)
    assert bottle.session.gestures.history.next_undo_name == "Change area"
    bottle.panel.area.target.reset_button.click()
    assert document(bottle).settings.area == 100.0


def test_panel_begins_with_the_defaults_for_another_mesh(qtbot, bottle):
    panel, motion = bottle.panel, bottle.panel.handles.motion
    choose(bottle, "local")
    panel.method.stiffness.field.setValue(0.001)
    panel.area.hold.setChecked(True)
    motion.choice.setCurrentIndex(motion.choice.findData("SCALE"))
    motion.amount.setText("240deg")
    qtbot.keyClick(motion.amount, Qt.Key.Key_Return)
    assert motion.problem.isVisible()
    bottle.session.files.open_sample("duck")
    idle(qtbot, bottle)
    assert document(bottle).settings.method == panel.method.method.currentData() == "exact"
    assert document(bottle).settings.stiffness == panel.method.stiffness.value == 0.0
    assert not document(bottle).settings.hold_area
    assert (motion.motion, motion.amount.text()) == (MOTIONS["TWIST"], "")
    assert motion.problem.isHidden()
    bottle.actions_.undo.trigger()
    assert document(bottle).settings.method == panel.method.method.currentData() == "local"
    assert panel.method.stiffness.value == 0.001


@pytest.mark.parametrize(
    ("typed", "becomes"),
    [("-5", 100), ("1e9", 100), ("abc", 100), ("", 100), ("1.1e2", 110), ("99,5 %", 99.5)],
)
def test_percent_field_puts_back_by_escape_what_is_no_percentage(qtbot, bottle, typed, becomes):
    field = bottle.panel.area.target.field
    field.setFocus()
    field.selectAll()
    qtbot.keyClick(field, Qt.Key.Key_Delete)
    qtbot.keyClicks(field, typed)
    qtbot.keyClick(field, Qt.Key.Key_Return)
    qtbot.keyClick(field, Qt.Key.Key_Escape)
    assert document(bottle).settings.area == becomes
    assert field.value() == becomes
    assert field.text() == f"{becomes:.2f} %"


def test_slider_field_makes_a_sweep_of_the_slider_one_step_of_undo_and_the_mesh_follows(qtbot, bottle):
    slider, before = bottle.panel.area.target.slider, document(bottle)
    volumes = set()
    mouse = Mouse(slider)
    mouse.press(knob(slider, 100))
    for step in range(102, 122, 2):
        follow(qtbot, bottle, lambda step=step: mouse.move(knob(slider, step)))
        volumes.add(round(bottle.session.store.state.frame.volume, 6))
    mouse.release(knob(slider, 120))
    assert document(bottle).settings.area == pytest.approx(110.0, abs=0.6)
    assert len(volumes) > 2
    bottle.actions_.undo.trigger()
    assert document(bottle) is before
    assert bottle.session.gestures.history.next_undo_name is None
    assert slider.value() == 100


def test_slider_field_lets_a_sweep_be_given_up(qtbot, bottle):
    bottle.session.settings.change(tolerance=0.002)
    slider, before = bottle.panel.method.stiffness.slider, document(bottle)
    mouse = Mouse(slider)
    for give_up in (
        lambda: qtbot.keyClick(slider, Qt.Key.Key_Escape),
        lambda: bottle.actions_.undo.trigger(),
    ):
        mouse.press(knob(slider, 0))
        mouse.move(knob(slider, 50))
        assert document(bottle).settings.stiffness > 0.0
        give_up()
        mouse.release(knob(slider, 50))
        assert document(bottle) is before
        assert bottle.session.gestures.history.next_undo_name == "Change tolerance"


def test_slider_field_returns_to_100_percent_by_a_double_click(bottle):
    bottle.session.settings.change(area=130.0)
    slider = bottle.panel.area.target.slider
    at = knob(slider, slider.value())
    mouse = Mouse(slider)
    mouse.drag(at, at)
    mouse.double_click(at)
    assert document(bottle).settings.area == 100.0


def test_slider_scale_of_the_stiffness_goes_from_nothing_over_three_decades():
    assert DECADES.value_at(0) == 0.0
    assert DECADES.value_at(1) == 1e-4
    assert DECADES.value_at(DECADES.steps) == 0.1
    for step in range(DECADES.steps + 1):
        assert round(DECADES.step_of(DECADES.value_at(step))) == step


def test_slider_field_lets_the_stiffness_be_typed_or_stepped(qtbot, bottle):
    dial = bottle.panel.method.stiffness
    dial.field.setValue(0.0123)
    assert document(bottle).settings.stiffness == 0.0123
    assert dial.field.text() == "0.0123"
    qtbot.keyClick(dial.slider, Qt.Key.Key_Right)
    assert document(bottle).settings.stiffness > 0.0123


def test_area_section_says_what_is_out_of_reach(qtbot, bottle):
    session, panel = bottle.session, bottle.panel
    session.settings.set_contact(False)
    session.gestures.begin()
    pose = np.eye(4)
    pose[1, 3] = 14.0
    session.handles.drag(pose)
    session.gestures.end("Move handle")
    panel.area.target.field.setValue(20.0)
    qtbot.waitUntil(lambda: session.store.activity is Activity.UNREACHED, timeout=60_000)
    assert not panel.area.unreached.isHidden()
    assert "Out of reach" in panel.area.unreached.text()
    assert panel.area.activity.text() == "out of reach"
    assert "target −80 %" in panel.area.verdict.text()
    panel.area.target.reset_button.click()
    qtbot.waitUntil(panel.area.unreached.isHidden, timeout=30_000)


def test_area_section_says_at_once_that_contact_stops_a_handle(qtbot, bottle):
    """Until it has converged there the shape may take minutes."""
    area, state = bottle.panel.area, bottle.session.store.state
    goes_on = replace(state.frame, settled=False, share_reached=0.6)
    for said in (None, "Contact stops the handle at 60 % of the path."):
        state = replace(state, frame=replace(goes_on, unreached=said))
        area.show_readings(state, Unit.NONE, False)
        assert area.unreached.isHidden() == (said is None)
    assert area.unreached.text() == said


def test_area_section_lets_local_keep_the_total_too_where_that_is_asked(qtbot, bottle):
    choose(bottle, "local")
    area = bottle.panel.area
    assert not area.target.field.isEnabled()
    assert "exact" not in area_verdict(bottle.session.store.state)
    area.hold.click()
    assert document(bottle).settings.hold_area
    assert area.target.field.isEnabled()
    bottle.panel.method.numbers["area_stiffness"].setValue(30.0)
    bottle.panel.method.numbers["shear_stiffness"].setValue(0.2)
    settings = document(bottle).settings
    assert (settings.area_stiffness, settings.shear_stiffness) == (30.0, 0.2)


def test_method_section_has_hardening_for_creases_of_walls_alone(qtbot, bottle):
    section = bottle.panel.method
    choose(bottle, "wall")
    bottle.session.settings.set_contact(True, None)
    assert not section.numbers["hardening"].isVisibleTo(bottle.shell)
    section.numbers["yield_radius"].setValue(1.5)
    section.numbers["hardening"].setValue(0.25)
    assert section.numbers["hardening"].isVisibleTo(bottle.shell)
    assert document(bottle).settings.hardening == 0.25
    choose(bottle, "local")
    assert not section.numbers["hardening"].isVisibleTo(bottle.shell)


def test_method_section_has_creases_and_gas_in_contact_alone(qtbot, bottle):
    section = bottle.panel.method
    for on in (False, True):
        if section.contact.isChecked() != on:
            section.contact.click()
        assert section.numbers["gas"].isVisibleTo(bottle.shell) == on
        assert not section.numbers["yield_radius"].isVisibleTo(bottle.shell)
    section.stiffness.field.setValue(0.01)
    assert section.numbers["yield_radius"].isVisibleTo(bottle.shell)
    section.numbers["yield_radius"].setValue(1.5)
    section.numbers["gas"].setValue(0.25)
    assert (document(bottle).settings.yield_radius, document(bottle).settings.gas) == (1.5, 0.25)
    section.numbers["gas"].setValue(0.0)
    assert document(bottle).settings.gas is None
    bottle.session.gestures.undo()
    assert section.numbers["gas"].value() == 0.25


def test_volume_section_keeps_a_volume_or_says_the_reason_why_not(qtbot, bottle):
    volume = bottle.panel.volume
    volume.keep.click()
    assert document(bottle).settings.volume == 100.0
    volume.target.field.setValue(95.0)
    assert document(bottle).settings.volume == 95.0
    qtbot.waitUntil(lambda: volume.change == "−5.00 %")
    choose(bottle, "paper")
    assert not volume.keep.isEnabled()
    assert "Paper" in volume.disabled_note.text()
    choose(bottle, "exact")
    volume.keep.click()
    assert document(bottle).settings.volume is None


def test_volume_section_has_no_volume_to_keep_of_an_open_surface(qtbot, kept_window):
    V, F = meshes.sphere(2)
    kept_window.files.show_mesh(Mesh(V, F[3:]))
    idle(qtbot, kept_window)
    assert not kept_window.panel.volume.keep.isEnabled()
    assert "Only a closed surface" in kept_window.panel.volume.disabled_note.text()
    assert not kept_window.panel.volume.disabled_note.isHidden()


def test_panel_folds_sections_and_remembers_them(qtbot, bottle, settings):
    heading = bottle.panel.method.heading
    qtbot.mouseClick(heading, Qt.MouseButton.LeftButton)
    assert not bottle.panel.method.method.isVisible()
    assert bottle.panel.folded_sections == ["Method"]
    bottle.shell.close()
    assert settings.value("folded") in ("Method", ["Method"])


@pytest.mark.parametrize("method", ["exact", "local", "paper", "arap"])
def test_panel_cuts_off_nothing_at_the_side(qtbot, bottle, method):
    bottle.shell.resize(1280, 720)
    bottle.parts.add_region()
    bottle.parts.add_handle()
    choose(bottle, method)
    work_off()
    panel = bottle.panel
    for page in (panel.measurements, panel.deform):
        panel.pages.setCurrentWidget(page)
        work_off()
        assert page.widget().width() <= page.viewport().width()
        assert panel.area.percent.isVisible()
    assert {BASE, HANDLE} <= set(document(bottle).labels)


@pytest.mark.night
def test_panel_keeps_its_width_when_readings_get_longer(qtbot, sample):
    window, panel = sample, sample.panel
    window.shell.resize(1280, 720)
    work_off()
    width = panel.width()
    window.choose_unit(Unit.MILLIMETRE)
    window.parts.add_region()
    window.parts.add_handle()
    window.parts.choose_handle(0)
    field = panel.handles.motion
    field.choice.setCurrentIndex(field.choice.findData("TWIST"))
    QTest.keyClicks(field.amount, "10deg")
    qtbot.keyClick(field.amount, Qt.Key.Key_Return)
    idle(qtbot, window)
    window.actions_.simulate.obstacles.floor.trigger()
    idle(qtbot, window)
    assert panel.area.percent.isVisible()
    for page in (panel.measurements, panel.deform):
        panel.pages.setCurrentWidget(page)
        work_off()
        assert panel.width() == width
        assert page.widget().width() <= page.viewport().width()
    panel.pages.setCurrentWidget(panel.measurements)
    for unit in Unit:
        panel.measures.box.setText(box_volume(123_456_789_123.4, None, unit)[0])
        work_off()
        assert panel.width() == width


def test_panel_keeps_its_width_beside_a_long_name(qtbot, bottle):
    panel, width = bottle.panel, bottle.panel.width()
    labels = panel.target.name, panel.handles.symmetry.partner
    for page, label in zip((panel.measurements, panel.deform), labels, strict=True):
        panel.target.show()
        panel.pages.setCurrentWidget(page)
        label.setText("a_name_without_a_space_" * 5)
        label.show()
        work_off()
        assert label.width() > 200
        assert panel.width() == width
        label.setText("")
    panel.target.hide()
    panel.handles.symmetry.partner.hide()


def ink_height(label):
    """Rows from the first to the last with ink."""
    image = label.grab().toImage().convertToFormat(QImage.Format.Format_Grayscale8)
    rows = np.frombuffer(image.constBits(), dtype=np.uint8).reshape(image.height(), image.bytesPerLine())
    rows = rows[:, : image.width()].astype(int)
    inked = np.flatnonzero((np.abs(rows - rows[-1, -1]) > 24).any(axis=1))
    return int(inked[-1] - inked[0])


@pytest.mark.parametrize("name", ["heading", "title", "verdict"])
def test_label_in_the_panel_shows_the_dots_of_capital_umlauts(qtbot, bottle, name):
    label = QLabel("ÖÄÜgj", bottle.panel.parts, objectName=name)
    label.ensurePolished()
    label.resize(label.sizeHint())
    whole = ink_height(label)
    label.resize(label.width(), 3 * label.height())
    assert whole == ink_height(label)
    label.deleteLater()


def test_method_section_offers_sr_arap_which_deforms(qtbot, bottle):
    choose(bottle, "sr-arap")
    drag(qtbot, bottle, ring_grip(bottle, 1), (40, 0))
    idle(qtbot, bottle)
    assert document(bottle).settings.method == "sr-arap"
    assert bottle.session.store.activity is Activity.SETTLED
    assert shown(bottle) == {"stiffness"}


def test_convergence_fields_are_folded_and_show_what_applies(qtbot, bottle):
    fields, shell = bottle.panel.method.convergence, bottle.shell

    def seen():
        return [
            name
            for name in ("most_iterations", "energy", "step", "imperfection", "seed")
            if getattr(fields, name).isVisibleTo(shell)
        ]

    assert seen() == []
    qtbot.mouseClick(fields.heading, Qt.MouseButton.LeftButton)
    for method, names in (
        ("exact", ["most_iterations", "energy", "imperfection", "seed"]),
        ("sr-arap", ["most_iterations", "step"]),
        ("arap", ["most_iterations", "energy", "imperfection", "seed"]),
    ):
        choose(bottle, method)
        assert seen() == names
    before = document(bottle)
    for field, text in (
        (fields.most_iterations, "250"),
        (fields.energy, "1e-9"),
        (fields.imperfection, "0.002"),
        (fields.seed, "3"),
    ):
        field.setFocus()
        field.selectAll()
        qtbot.keyClicks(field, text)
        qtbot.keyClick(field, Qt.Key.Key_Return)
    assert document(bottle).settings.convergence == (250, 1e-9, 1e-5, 0.002, 3)
    assert bottle.session.gestures.history.next_undo_name == "Change convergence"
    assert fields.energy.text() == "1e-09"
    assert fields.heading.reading == "changed"
    for _ in range(4):
        bottle.actions_.undo.trigger()
    assert document(bottle) is before
    assert fields.heading.reading == ""
    assert fields.most_iterations.value() == 10_000
    fields.most_iterations.setFocus()  # what is refused is explained and changes nothing
    fields.most_iterations.lineEdit().setText("0")
    qtbot.keyClick(fields.most_iterations, Qt.Key.Key_Return)
    assert document(bottle) is before
    assert fields.most_iterations.error.isVisible()


def test_handle_section_is_seen_without_scrolling(qtbot, bottle):
    bottle.shell.resize(1280, 800)
    work_off()
    shown = bottle.panel.handles.motion.visibleRegion().boundingRect()
    assert shown == bottle.panel.handles.motion.rect()


@pytest.mark.parametrize("value", [1.2e-5, 2.5e-4, 1.0 / 3.0])
def test_method_section_shows_lengths_as_they_are(bottle, value):
    """Walls of micrometres in a mesh in metres, and numbers of scripts."""
    choose(bottle, "wall")
    bottle.session.settings.change(yield_radius=value)
    field = bottle.panel.method.numbers["yield_radius"]
    assert field.value() == pytest.approx(value, rel=1e-9)
    assert float(field.text().split()[0]) == pytest.approx(value, rel=1e-9)
