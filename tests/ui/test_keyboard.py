"""All of the window by keys alone, and for those who hear it: reached by Tab, named, and seen."""

import itertools

import numpy as np
import pytest
from driving import idle, work_off
from PySide6.QtCore import QPoint, QRect, Qt
from PySide6.QtGui import QAccessible, QImage
from PySide6.QtWidgets import QAbstractButton, QWidget

from apd_viewer.presentation.scales import Measure
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.ui.tools.tool_modes import Tool

SCHEMES = Qt.ColorScheme.Light, Qt.ColorScheme.Dark
LEAST_CONTRAST = 2.9  # of what is drawn with the focus, against what is there without; 3 but for smoothing


def everything(window):
    """Open all that can be open side by side."""
    actions = window.actions_
    actions.display.measures[Measure.AREA].trigger()
    for name in ("cut", "compare"):
        actions.display.switches[name].trigger()
    for name in ("history", "plots"):
        window.docks[name].show()
    actions.pose.part_actions[0].trigger()
    actions.pose.part_actions[2].trigger()
    window.session.settings.set_region_area(0, 100.0)
    window.session.handles.move_by(MOTIONS["TWIST"], "20", 0)
    window.tools.choose_tool(Tool.HANDLE)
    window.panel.folded_sections = []
    window.notice.show_failure("Something went wrong; do something else.")


def sheet(window):
    window.actions_.help["shortcuts"].trigger()


def tour(window):
    window.actions_.help["tour"].trigger()
    window.help.tour.card.next.click()


def numbers(window):
    window.actions_.select.by_expression.trigger()


SCENES = {"everything": everything, "sheet": sheet, "tour": tour, "numbers": numbers}


@pytest.fixture
def active(qtbot, bottle):
    bottle.shell.resize(1280, 1000)
    bottle.shell.activateWindow()
    qtbot.waitUntil(bottle.shell.isActiveWindow)
    bottle.canvas.viewport.setFocus()
    return bottle


@pytest.fixture(params=SCENES)
def scene(qtbot, active, request):
    SCENES[request.param](active)
    idle(qtbot, active)
    work_off()
    active.canvas.viewport.setFocus()
    return active


def controls(window):
    """What takes the keys by Tab, in no order."""
    return [
        widget
        for widget in window.shell.findChildren(QWidget)
        if widget.focusPolicy() & Qt.FocusPolicy.TabFocus
        and widget.isVisible()
        and widget.isEnabled()
        and widget.focusProxy() is None
    ]


def walked(qtbot, window, key=Qt.Key.Key_Tab):
    """What has the keys after each Tab, until the first one has them again."""
    found = [window.shell.focusWidget()]
    for _ in range(300):
        qtbot.keyClick(window.shell.focusWidget(), key)
        if window.shell.focusWidget() is found[0]:
            return found
        found.append(window.shell.focusWidget())
    raise AssertionError("Tab comes to no end")


def name_of(widget):
    interface = QAccessible.queryAccessibleInterface(widget)
    return interface.text(QAccessible.Text.Name).strip() if interface else ""


def test_workbench_has_a_name_for_every_control_and_tab_comes_to_it(qtbot, scene):
    nameless = [widget for widget in controls(scene) if not name_of(widget)]
    assert not nameless
    way = walked(qtbot, scene)
    missed = [name_of(widget) for widget in controls(scene) if widget not in way]
    assert not missed
    assert walked(qtbot, scene, Qt.Key.Key_Backtab) == [way[0], *way[:0:-1]]


def test_workbench_has_tab_go_as_one_reads(qtbot, active):
    everything(active)
    idle(qtbot, active)
    work_off()
    active.canvas.viewport.setFocus()
    way = walked(qtbot, active)
    legend = active.display_options.legend
    for part in (
        active.panel.deform.widget(),
        legend,
        active.display_options.cutting_plane,
        active.display_options.before_after,
        active.plots,
    ):
        inside = [widget for widget in way if part.isAncestorOf(widget)]
        assert len(inside) > 1
        at = [way.index(widget) for widget in inside]
        assert at == list(range(at[0], at[0] + len(at))), "; ".join(
            f"{k} {name_of(w)}" for k, w in enumerate(way)
        )
        boxes = [QRect(widget.mapTo(part, QPoint()), widget.size()) for widget in inside]
        for k, (first, then) in enumerate(itertools.pairwise(boxes)):
            beside = first.top() < then.center().y() < first.bottom() or (
                then.top() < first.center().y() < then.bottom()
            )
            forward = first.left() < then.left() if beside else first.top() < then.top()
            assert forward or first.contains(then), (name_of(inside[k]), name_of(inside[k + 1]))


def luminance(image):
    image = image.convertToFormat(QImage.Format.Format_RGB888)
    lines = np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), image.bytesPerLine())
    colors = lines[:, : 3 * image.width()].reshape(image.height(), image.width(), 3) / 255.0
    linear = np.where(colors <= 0.04045, colors / 12.92, ((colors + 0.055) / 1.055) ** 2.4)
    return linear @ [0.2126, 0.7152, 0.0722]


@pytest.mark.parametrize(
    "scene", ["everything", pytest.param("sheet", marks=pytest.mark.night)], indirect=True
)
def test_theme_lets_what_has_the_keys_be_seen_in_light_and_dark(qtbot, scene):
    unseen = []
    for scheme in SCHEMES:
        scene.actions_.view.schemes[scheme].trigger()
        work_off()
        for widget in controls(scene):
            if widget is scene.canvas.viewport:  # all that is left over
                continue
            scene.canvas.viewport.setFocus()
            without = luminance(widget.grab().toImage())
            widget.setFocus(Qt.FocusReason.TabFocusReason)
            assert widget.hasFocus(), name_of(widget)
            focused = luminance(widget.grab().toImage())
            low, high = np.minimum(without, focused), np.maximum(without, focused)
            contrast = float(((high + 0.05) / (low + 0.05)).max())
            if contrast < LEAST_CONTRAST:
                unseen.append((scheme.name, name_of(widget), round(contrast, 2)))
    assert not unseen


@pytest.mark.parametrize("scheme", SCHEMES)
def test_docks_have_buttons_that_are_seen_in_light_and_dark(qtbot, kept_window, scheme):
    kept_window.actions_.view.schemes[scheme].trigger()
    work_off()
    buttons = kept_window.docks["readings"].findChildren(
        QAbstractButton, options=Qt.FindChildOption.FindDirectChildrenOnly
    )
    assert len(buttons) == 2
    for button in buttons:
        seen = luminance(button.grab().toImage())
        assert (seen.max() + 0.05) / (seen.min() + 0.05) > 4.5
