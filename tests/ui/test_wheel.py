"""The wheel over every control of the window and its dialogs: it scrolls, and changes nothing."""

import pytest
from driving import centre, document, idle, work_off
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import (
    QAbstractSlider,
    QAbstractSpinBox,
    QComboBox,
    QDialog,
    QLineEdit,
    QScrollBar,
    QTabBar,
)

from apd_viewer.presentation.report_page import ReportHeading
from apd_viewer.presentation.scales import Measure
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.ui.sharing.picture_dialog import PictureDialog, PictureSettings
from apd_viewer.ui.sharing.report_dialogs import ReportDialog
from apd_viewer.ui.tools.tool_modes import Tool
from apd_viewer.ui.widgets.folding_section import reveal_widget

CONTROLS = QAbstractSpinBox, QComboBox, QAbstractSlider, QTabBar, QLineEdit
NOTCH = QPoint(0, -120)


def turn(qtbot, widget, notches=2):
    """Turn the wheel over a widget, by events of the window system, which give the focus too."""
    window = widget.window()
    at = QPointF(widget.mapTo(window, centre(widget).toPoint()))
    for _ in range(notches):
        QTest.wheelEvent(window.windowHandle(), at, NOTCH)
        work_off()


def controls(window):
    """What shows a value that could be changed."""
    return [
        widget
        for widget in window.findChildren(CONTROLS[0])
        + [w for kind in CONTROLS[1:] for w in window.findChildren(kind)]
        if widget.isVisible() and widget.isEnabled() and not isinstance(widget, QScrollBar)
    ]


def value(widget):
    if isinstance(widget, QComboBox | QTabBar):
        return widget.currentIndex()
    return widget.text() if isinstance(widget, QLineEdit) else widget.value()


def in_use(widget):
    """The widget with the keys, once those are a control's as by a click into it."""
    widget.setFocus(Qt.FocusReason.MouseFocusReason)
    return widget.window().focusWidget()


def check(qtbot, window, unmoved=lambda: None, reveal=lambda _: None, used=False):
    """Turn the wheel over all controls of a window, one after the other, each in use or not."""
    found = controls(window)
    for widget in found:
        reveal(widget)
        keys = in_use(widget) if used else window.focusWidget()
        shown, before = value(widget), unmoved()
        turn(qtbot, widget)
        assert value(widget) == shown, widget
        assert window.focusWidget() is keys, widget
        assert unmoved() is before, widget
    return found


@pytest.fixture
def full(qtbot, bottle):
    """All cards open, the panels behind tabs, a region kept, and the canvas in use."""
    bottle.shell.resize(1280, 1000)
    actions = bottle.actions_
    actions.display.measures[Measure.AREA].trigger()
    for name in ("cut", "compare"):
        actions.display.switches[name].trigger()
    bottle.docks["history"].show()
    bottle.shell.tabifyDockWidget(bottle.docks["history"], bottle.docks["readings"])
    bottle.docks["readings"].raise_()
    actions.pose.part_actions[2].trigger()
    bottle.session.settings.set_region_area(0, 100.0)
    bottle.tools.choose_tool(Tool.MOVE)
    bottle.panel.folded_sections = []
    idle(qtbot, bottle)
    bottle.shell.activateWindow()
    qtbot.waitUntil(bottle.shell.isActiveWindow)
    work_off()
    bottle.canvas.viewport.setFocus()
    return bottle


@pytest.mark.parametrize("method", ["local", "paper"])
@pytest.mark.night
def test_wheel_changes_nothing_over_the_controls_of_the_window(qtbot, full, method):
    full.session.settings.change(method=method)
    full.session.settings.change(volume=100.0)
    idle(qtbot, full)

    def reveal(widget):
        if full.panel.isAncestorOf(widget):
            reveal_widget(widget)

    for used in (False, True):
        found = check(qtbot, full.shell, lambda: document(full), reveal, used)
    kinds = {kind for kind in CONTROLS for widget in found if isinstance(widget, kind)}
    assert kinds == set(CONTROLS), "the test is blind"
    assert len([w for w in found if full.panel.isAncestorOf(w)]) > 10


def test_wheel_scrolls_the_panel_over_a_field(qtbot, full):
    full.shell.resize(1280, 700)
    bar = full.panel.deform.verticalScrollBar()
    for widget in controls(full.panel.deform):
        bar.setValue(0)
        full.panel.deform.ensureWidgetVisible(widget)
        bar.setValue(min(bar.value(), bar.maximum() - 1))
        before = bar.value()
        turn(qtbot, widget, 1)
        assert bar.value() > before, widget


def test_wheel_scrolls_the_panel_over_a_field_that_was_clicked_into(qtbot, full):
    full.shell.resize(1280, 700)
    field, bar = full.panel.area.target.field, full.panel.deform.verticalScrollBar()
    bar.setValue(0)
    full.panel.deform.ensureWidgetVisible(field)
    QTest.mouseClick(field.lineEdit(), Qt.MouseButton.LeftButton)
    before, shown = bar.value(), field.value()
    turn(qtbot, field, 1)
    assert (field.value(), bar.value() > before) == (shown, True)


def case_study(window):
    window.session.handles.move_by(MOTIONS["TWIST"], "20deg", 0)
    window.case_studies.design_study()
    return window.case_studies.dialog


def studied(name):
    def dialog(window):
        getattr(window.actions_.simulate, name).trigger()
        return window.runs.dialogs[name]

    return dialog


def settings(window):
    window.actions_.settings.trigger()
    return window.settings_page.dialog


def verification(window):
    window.runs.open_verification()
    return window.runs.dialogs["verify"]


def paper(window):
    window.runs.open_paper()
    return window.runs.dialogs["paper"]


def volumes(window):
    window.reports.open_volumes()
    return window.reports.volumes


def comparison(window):
    window.session.handles.move_by(MOTIONS["TWIST"], "20deg", 0)
    window.actions_.simulate.compare.trigger()
    return window.comparison.window


def animation(window):
    window.session.handles.move_by(MOTIONS["TWIST"], "20deg", 0)
    window.runs.open_animation()
    return window.runs.dialogs["animate"]


def report(window):
    dialog = ReportDialog(window.shell, ReportHeading("Bottle 500", "Aqua"), "bottle.obj")
    dialog.show()
    return dialog


def picture(window):
    pictures = window.reports.pictures
    dialog = PictureDialog(window.shell, pictures, PictureSettings(pictures.view_size))
    dialog.show()
    return dialog


DIALOGS = {
    "SweepDialog": studied("sweep"),
    "PressDialog": studied("press"),
    "SettingsDialog": settings,
    "PaperDialog": paper,
    "VerificationDialog": verification,
    "ComparisonWindow": comparison,
    "PlanDialog": case_study,
    "PictureDialog": picture,
    "ReportDialog": report,
    "AnimationDialog": animation,
    "VolumesDialog": volumes,
}
LONG = {"ComparisonWindow", "PlanDialog"}


def leaves(kind):
    """The classes below a class that have none below them."""
    below = kind.__subclasses__()
    return {leaf for each in below for leaf in leaves(each)} if below else {kind}


def test_wheel_tests_leave_no_dialog_out():
    own = {kind.__name__ for kind in leaves(QDialog) if kind.__module__.startswith("apd_viewer.ui.")}
    assert own == DIALOGS.keys() - {"ComparisonWindow"}


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=pytest.mark.night if name in LONG else ()) for name in DIALOGS],
)
def test_wheel_changes_nothing_over_the_controls_of_a_dialog(qtbot, bottle, name):
    dialog = DIALOGS[name](bottle)
    assert type(dialog).__name__ == name
    qtbot.waitExposed(dialog)
    dialog.setFocus()
    idle(qtbot, bottle)
    if name == "ComparisonWindow":
        dialog.legend.reach.setValue(20.0)  # one that is not chosen follows the shapes that come
    for used in (False, True):
        found = check(qtbot, dialog, lambda: document(bottle), used=used)
    blind = "PaperDialog", "ReportDialog", "VerificationDialog", "VolumesDialog"
    assert found or name in blind, "the test is blind"
    dialog.close()


def test_wheel_changes_nothing_over_the_results_of_a_study(qtbot, window):
    window.docks["study"].show()
    qtbot.waitUntil(window.case_studies.panel.isVisible)
    for used in (False, True):
        check(qtbot, window.shell, used=used)
