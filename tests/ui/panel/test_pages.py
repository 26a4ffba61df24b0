"""The two pages of the panel, by a real mouse: the room they take, and the list of all parts."""

import pytest
from driving import Mouse, idle, work_off
from PySide6.QtCore import QPoint, QRect, Qt

from apd_viewer.session.model.named_obstacle import ObstacleKind
from apd_viewer.ui.tools.tool_modes import Tool

LEFT = Qt.MouseButton.LeftButton


@pytest.fixture
def parts(qtbot, bottle):
    """The bottle with two handles, a region that is kept and a floor."""
    bottle.parts.add_handle()
    bottle.parts.add_region()
    bottle.session.settings.set_region_area(0, 100.0)
    bottle.obstacles.add_floor()
    idle(qtbot, bottle)
    work_off()
    return bottle


def is_in_sight(panel, widget):
    """True where nothing of a widget is scrolled away."""
    box = QRect(widget.mapTo(panel, QPoint()), widget.size())
    return widget.isVisible() and widget.visibleRegion().boundingRect().size() == box.size()


def turn_page(qtbot, window, number):
    """Click the tab of a page."""
    tabs = window.panel.pages.tabBar()
    qtbot.mouseClick(tabs, LEFT, pos=tabs.tabRect(number).center())
    work_off()


def tinted(window):
    """Names of the rows that are drawn as active."""
    panel = window.panel
    rows = [*panel.handles.list.rows, *panel.regions.list.rows, *panel.obstacles.list.rows]
    return [row.name.text() for row in rows if row.property("active") and not row.property("resting")]


def test_panel_takes_at_most_a_third_of_a_small_window_and_cuts_nothing(qtbot, parts):
    parts.shell.resize(1024, 700)
    for number, page in enumerate((parts.panel.deform, parts.panel.measurements)):
        turn_page(qtbot, parts, number)
        assert page.isVisible()
        assert page.widget().width() <= page.viewport().width()
        assert page.widget().minimumSizeHint().width() <= page.viewport().width()
    assert 3 * parts.panel.width() <= 1024


def test_panel_has_parts_motion_and_method_on_its_first_screen(qtbot, bottle):
    bottle.shell.resize(1366, 700)  # a screen of 768 lines, less a title bar and a task bar
    work_off()
    panel = bottle.panel
    for widget in (panel.area.percent, panel.parts.add, panel.handles.motion.amount, panel.method.method):
        assert is_in_sight(panel, widget), widget


def test_panel_shows_the_area_on_both_pages(qtbot, bottle):
    for number, section in enumerate((bottle.panel.parts, bottle.panel.volume)):
        turn_page(qtbot, bottle, number)
        assert section.isVisible()
        assert is_in_sight(bottle.panel, bottle.panel.area.percent)
        assert is_in_sight(bottle.panel, bottle.panel.area.unit)


def test_parts_section_adds_what_is_chosen_in_its_menu(qtbot, bottle):
    menu = bottle.panel.parts.add.menu()  # opened by a click it would run a loop of its own
    handle, region, *obstacles = [each for each in menu.actions() if not each.isSeparator()]
    handle.trigger()
    region.trigger()
    next(each for each in obstacles if "floor" in each.text().lower()).trigger()
    panel = bottle.panel
    names = [row.name.text() for row in (*panel.handles.list.rows, *panel.regions.list.rows)]
    assert names == ["Handle 1", "Handle 2", "Region 1"]
    assert [row.name.text() for row in panel.obstacles.list.rows] == ["Floor"]
    tops = [
        rows.mapTo(panel, QPoint()).y() for rows in (panel.handles.list, panel.regions, panel.obstacles.list)
    ]
    assert tops == sorted(tops)
    assert len(obstacles) == len(ObstacleKind) + 4


def test_parts_section_tints_the_part_in_the_hand_alone(qtbot, parts):
    panel = parts.panel
    assert tinted(parts) == ["Floor"]
    Mouse(panel.handles.list.rows[0]).press((60, 8))
    assert tinted(parts) == ["Handle 1"]
    parts.tools.choose_tool(Tool.REGION)
    assert tinted(parts) == ["Region 1"]
    Mouse(panel.obstacles.list.rows[0]).press((60, 8))
    assert tinted(parts) == ["Floor"]
    parts.tools.choose_tool(Tool.BASE)
    assert tinted(parts) == ["Handle 1"], "there is no row of the base to be tinted"


def test_section_reveals_its_page(qtbot, bottle):
    turn_page(qtbot, bottle, 1)
    bottle.actions_.pose.enter_motion.trigger()
    assert bottle.panel.pages.currentWidget() is bottle.panel.deform
    bottle.panel.focus_wall_fields()
    assert bottle.panel.pages.currentWidget() is bottle.panel.measurements
