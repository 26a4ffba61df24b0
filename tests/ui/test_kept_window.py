"""What a used window leaves to the next test: nothing, whatever was done with it."""

import gc
from contextlib import suppress

import numpy as np
import pytest
from driving import Mouse, arrow_grip, centre, drag, idle, on_screen, ring_grip, stroke
from finished_study import write_study
from kept_window import bottle_in
from meshes import box
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QWidget
from pytestqt.exceptions import TimeoutError as Waited
from whole_state import differences, whole_state

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.presentation.scales import Measure
from apd_viewer.session.model.up_axis import UpAxis
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.settings_page import preference_table
from apd_viewer.ui.tools.tool_modes import SelectionMode, Tool


def drags(qtbot, window, _):
    drag(qtbot, window, ring_grip(window, 1), (60, 0), steps=4)
    idle(qtbot, window)


def breaks_off_a_drag(qtbot, window, _):
    mouse = Mouse(window.canvas.viewport)
    mouse.move(arrow_grip(window, 1))
    mouse.press(arrow_grip(window, 1))
    mouse.move(np.add(arrow_grip(window, 1), (0, 30)))


def paints(qtbot, window, _):
    window.actions_.select.modes[SelectionMode.LASSO].trigger()
    window.actions_.select.modes[SelectionMode.BRUSH].trigger()
    window.actions_.tools[Tool.REGION].trigger()
    window.actions_.select.sizes[0].trigger()
    window.actions_.select.select_hidden.trigger()
    stroke(qtbot, window, centre(window.canvas.viewport).toTuple())


def pauses(qtbot, window, _):
    window.session.handles.move_by(MOTIONS["TWIST"], "40deg", 0)
    window.session.store.pause_or_resume()


def undoes(qtbot, window, _):
    window.session.handles.move_by(MOTIONS["TWIST"], "4deg", 0)
    window.actions_.undo.trigger()


def types_what_is_wrong(qtbot, window, _):
    field = window.panel.handles.motion
    field.choice.setCurrentIndex(2)
    field.amount.setText("many")
    field.amount.returnPressed.emit()
    window.panel.measures.wall_fields.thickness.setText("2")
    window.panel.measures.wall_fields.thickness.editingFinished.emit()


def types_on_cards(qtbot, window, _):
    typed = window.edits.text_entries
    typed.open_brush_entry()
    typed.open_entry(typed.vertices)


def shows_an_overlay(qtbot, window, _):
    looks = window.actions_.display
    looks.measures[Measure.AREA].trigger()
    qtbot.waitUntil(lambda: window.display_options.overlay.reading.values is not None, timeout=60_000)
    window.display_options.legend.scale_changed.emit(0.3, 0.1)
    looks.extremes[0].trigger()


def switches_all_on(qtbot, window, _):
    for switch in window.actions_.display.switches.values():
        switch.setChecked(True)


def cuts(qtbot, window, _):
    window.actions_.display.switches["cut"].trigger()
    cut = window.display_options.cutting_plane
    cut.axes[0].click()
    cut.flip.click()
    cut.slider.setValue(30)
    cut.measure.click()


def plots(qtbot, window, _):
    window.docks["plots"].show()
    for button in window.plots.choices.values():
        button.click()


def moves_docks(qtbot, window, _):
    window.docks["history"].show()
    window.docks["readings"].setFloating(True)
    window.shell.resize(900, 700)
    window.panel.folded_sections = ["Handles"]
    window.shell.history.setFocus()


def looks_from_elsewhere(qtbot, window, _):
    camera = window.actions_.view.camera
    camera.up_axes[UpAxis.PLUS_Z].trigger()
    camera.orthographic.trigger()
    camera.directions["top"].trigger()
    Mouse(window.canvas.viewport).wheel(centre(window.canvas.viewport), 3)


def chooses_preferences(qtbot, window, _):
    values = window.preferences.values
    values.choose(preference_table.COLOR_SCHEME, Qt.ColorScheme.Dark)
    values.choose(preference_table.UNIT, Unit.MILLIMETRE)
    values.choose(preference_table.SELECTION_MODE, SelectionMode.BOX)
    values.choose(preference_table.UNDO_MEMORY, 64 * 2**20)
    window.panel.area.unit.chosen.emit(Unit.CENTIMETRE)


def changes_shortcuts(qtbot, window, _):
    shortcuts = window.help.shortcuts
    shortcuts.assign_keys(next(entry for entry in shortcuts.entries if entry.name == "undo"), "Ctrl+K")


def opens_dialogs(qtbot, window, _):
    window.runs.open_press()
    window.runs.open_sweep()
    window.case_studies.design_study()
    window.settings_page.open()


def compares(qtbot, window, _):
    window.session.handles.move_by(MOTIONS["TWIST"], "4deg", 0)
    window.comparison.open()


def opens_a_study(qtbot, window, folder):
    write_study(folder / "study", 6)
    window.case_studies.open_study(folder / "study")
    qtbot.waitUntil(lambda: bool(window.case_studies.panel.model.rows))


def keeps_poses(qtbot, window, _):
    window.poses.keep_pose()
    window.session.handles.move_by(MOTIONS["TWIST"], "4deg", 0)
    window.poses.keep_pose()
    window.symmetry.set_symmetric(True)


def presses_on_a_floor(qtbot, window, _):
    window.obstacles.add_floor()
    window.parts.choose_obstacle(0)
    window.panel.obstacles.fields.along.setCurrentIndex(2)


def measures(qtbot, window, _):
    measure = window.actions_.measurements
    list(measure.kinds.values())[-1].trigger()
    Mouse(window.canvas.viewport).drag(on_screen(window, 0), on_screen(window, 0))


def asks_for_help(qtbot, window, _):
    window.help.toggle_search()
    window.help.search.search.setText("twist")
    window.help.toggle_sheet()


def hears_of_failures(qtbot, window, _):
    window.notice.show_failure("A failure.")
    window.status.showMessage("A message.")
    QApplication.clipboard().setText("copied")


def opens_a_bad_mesh(qtbot, window, _):
    V, F = box()
    window.session.files.open_mesh(Mesh(V, np.vstack([F, F[:1]])))
    idle(qtbot, window)
    window.findings.toggle_list()


USES = (
    drags,
    breaks_off_a_drag,
    paints,
    pauses,
    undoes,
    types_what_is_wrong,
    types_on_cards,
    shows_an_overlay,
    switches_all_on,
    cuts,
    plots,
    moves_docks,
    looks_from_elsewhere,
    chooses_preferences,
    changes_shortcuts,
    opens_dialogs,
    compares,
    opens_a_study,
    keeps_poses,
    presses_on_a_floor,
    measures,
    asks_for_help,
    hears_of_failures,
    opens_a_bad_mesh,
)
DAILY = {paints, switches_all_on, moves_docks, opens_dialogs}


@pytest.fixture(scope="module")
def at_first():
    """What is told of the window of this file on the bottle before it was used."""
    yield {}
    gc.unfreeze()


@pytest.fixture(scope="module")
def kept(unused):
    """What is found out at first is of a window as it was opened."""
    return unused


@pytest.fixture
def fresh(qtbot, kept, unasked, painted_bottle, at_first):
    """The window on the bottle: each test leaves it so to the next."""
    window = kept.opened(qtbot)
    if not at_first:
        at_first.update(whole_state(bottle_in(qtbot, window, painted_bottle)))
        gc.freeze()  # looking for garbage takes a tenth of a second where all is looked through
    return window


def left_behind(qtbot, window, at_first):
    """What differs from the first, also after a while."""
    left = []

    def is_as_it_was():
        left[:] = differences(at_first, whole_state(window))
        return not left

    with suppress(Waited):
        qtbot.waitUntil(is_as_it_was, timeout=2_000)
    return left


@pytest.mark.parametrize(
    "use",
    [pytest.param(use, marks=() if use in DAILY else pytest.mark.night, id=use.__name__) for use in USES],
)
def test_kept_window_is_as_it_was_opened_whatever_was_done_with_it(
    qtbot, kept, fresh, painted_bottle, at_first, tmp_path, use
):
    try:
        use(qtbot, fresh, tmp_path)
        assert differences(at_first, whole_state(fresh)), "it was not used"
    finally:
        kept.reset(qtbot)
        assert kept.opened(qtbot) is fresh
        bottle_in(qtbot, fresh, painted_bottle)
    left = left_behind(qtbot, fresh, at_first)
    assert not left, "\n".join(left)


def test_kept_window_takes_no_keys_between_two_tests(qtbot, kept):
    """Though it stays the active one, whose shortcuts Qt looks up first."""
    edges = kept.opened(qtbot).actions_.view.edges
    kept.reset(qtbot)
    own = QWidget()
    qtbot.addWidget(own)
    own.show()
    qtbot.waitExposed(own)
    QTest.keyClick(own, edges.shortcut().toString())
    assert not edges.isChecked()
