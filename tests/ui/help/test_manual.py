"""Help in place: each menu entry, setting and section has its place in the manual, and F1 opens it."""

import re
from pathlib import Path

import generated_pages
import pytest
import window_controls
import window_facts
import window_tour
from driving import LEFT, idle
from PySide6.QtCore import QPoint, Qt, QUrl
from PySide6.QtGui import QCursor, QDesktopServices
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractItemView,
    QAbstractSlider,
    QAbstractSpinBox,
    QApplication,
    QComboBox,
    QLabel,
    QLineEdit,
    QMessageBox,
    QScrollBar,
)

from apd_viewer.errors import InputError
from apd_viewer.ui.help import manual
from apd_viewer.ui.help.context_help import menu_entry_place, section_name, widget_place
from apd_viewer.ui.help.manual import ManualPlace, action_place, section_place, setting_place
from apd_viewer.ui.tools.tool_modes import Tool
from apd_viewer.ui.widgets.folding_section import Heading
from apd_viewer.ui.widgets.help_button import HelpButton


@pytest.fixture
def shown(qtbot, window):
    """A window with all that it can show."""
    wait = lambda done: qtbot.waitUntil(lambda: bool(done()), timeout=60_000)  # noqa: E731
    window_tour.show_all(window, wait)
    return window


@pytest.fixture
def anchors(shown, monkeypatch):
    """Pages and anchors of the reference, as they would be written for the site of this window."""
    found, facts = set(), {"entries": window_controls.listed(shown), "controls": window_controls.described()}
    monkeypatch.setattr(window_facts, "facts", lambda: facts)
    for page, name in (("keys", "keys"), ("settings", "settings"), ("window", "window")):
        text = generated_pages.WRITERS[name]()
        named = re.findall(r"\{#([\w-]+)\}|^\(([\w-]+)\)=$", text, re.MULTILINE)
        found |= {ManualPlace(f"reference/{page}", one or other) for one, other in named}
    return found


@pytest.fixture
def opened(monkeypatch):
    """Places at which the manual was opened."""
    found = []
    monkeypatch.setattr(manual, "open_manual", lambda place=manual.FIRST_PAGE: found.append(place))
    return found


@pytest.fixture
def active(qtbot, bottle):
    """The bottle in a window that has the keys, the mouse over the view."""
    bottle.shell.activateWindow()
    qtbot.waitUntil(bottle.shell.isActiveWindow)
    bottle.canvas.viewport.setFocus()
    point(qtbot, bottle.canvas.viewport)
    return bottle


def point(qtbot, widget):
    """Move the real mouse to the middle of a widget."""
    at = widget.mapToGlobal(widget.rect().center())
    QCursor.setPos(at + QPoint(1, 0))
    QCursor.setPos(at)
    qtbot.waitUntil(lambda: QCursor.pos() == at)


def test_widget_place_knows_everything_in_the_window(shown, anchors):
    """All actions, and all that takes input in the window and its dialogs, by a walk through them."""
    window = shown
    actions = [entry.action for entry in window.actions_.entries]
    assert len(actions) > 140
    assert [action.text() for action in actions if menu_entry_place(action) not in anchors] == []
    controls = [
        widget
        for widget in window_tour.widgets()
        if widget.window() in QApplication.topLevelWidgets() and is_for_the_user(widget)
    ]
    assert len(controls) > 300
    found = [(one, one.parentWidget(), widget_place(one)) for one in controls]
    assert [str(each) for each in found if each[-1] not in anchors] == []
    words = [each for each in window_tour.widgets() if window.panel.isAncestorOf(each)]
    assert {widget_place(each) for each in words} <= anchors | {None}
    named = {section_name(widget) for widget in controls}
    assert {type(section).__name__ for section in window.panel.sections} <= named
    assert named >= {"SweepDialog", "PressDialog", "PlanDialog", "PictureDialog", "ComparisonWindow"}


INPUTS = QAbstractButton, QAbstractItemView, QAbstractSlider, QAbstractSpinBox, QComboBox, QLineEdit


def is_for_the_user(widget):
    """Whether it takes input and is no part that Qt makes by itself: a scroll bar, the list of a choice."""
    qts = "qt_", "QComboBox", "QDockWidget", "QMenu", "QHeaderView", "QTabBar"
    owners = [owner for owner in (widget, widget.parentWidget()) if owner is not None]
    names = [name for owner in owners for name in (owner.objectName(), owner.metaObject().className())]
    made = any(name.startswith(qts) for name in names)
    return isinstance(widget, INPUTS) and not made and not isinstance(widget, QScrollBar)


def test_widget_place_a_heading_is_that_of_its_section(window):
    assert widget_place(window.panel.volume.heading) == section_place("VolumeSection")
    folded = window.panel.method.convergence.findChild(Heading)
    assert widget_place(folded) == section_place("MethodSection")


def test_widget_place_a_caption_or_a_gap_is_that_of_its_section(window):
    handles = window.panel.handles
    caption = next(label for label in handles.findChildren(QLabel) if label.text() == "Falloff")
    assert widget_place(caption) == section_place("HandleSection")
    assert widget_place(caption.parentWidget()) == section_place("HandleSection")
    assert widget_place(window.panel) is None


def test_context_help_explains_by_f1_what_is_under_the_mouse_in_use_or_in_the_hand(qtbot, active, opened):
    panel, view = active.panel, active.canvas.viewport
    qtbot.keyClick(view, Qt.Key.Key_F1)
    assert opened.pop() == action_place("take:MOVE")
    active.tools.choose_tool(Tool.ERASE)
    qtbot.keyClick(view, Qt.Key.Key_F1)
    assert opened.pop() == action_place("take:ERASE")
    point(qtbot, panel.handles.falloff.slider)
    qtbot.keyClick(view, Qt.Key.Key_F1)
    assert opened.pop() == section_place("HandleSection")
    panel.area.hold.setFocus() if panel.area.hold.isVisible() else panel.parts.add.setFocus()
    focused = widget_place(active.shell.focusWidget())
    qtbot.keyClick(active.shell.focusWidget(), Qt.Key.Key_F1)
    assert opened.pop() == focused != section_place("HandleSection")
    button = active.actions_.bar.widgetForAction(active.actions_.undo)
    point(qtbot, button)
    qtbot.keyClick(view, Qt.Key.Key_F1)
    assert opened.pop() == action_place("undo")
    assert opened == []


def test_context_help_explains_the_marked_entry_of_a_menu_by_f1_and_does_not_choose_it(qtbot, active, opened):
    menu = active.shell.menuBar().actions()[1].menu()
    menu.popup(active.shell.mapToGlobal(QPoint(200, 100)))
    qtbot.waitExposed(menu)
    menu.setActiveAction(active.actions_.settings)
    qtbot.keyClick(menu, Qt.Key.Key_F1)
    assert opened == [action_place("settings")]
    assert not menu.isVisible()
    assert active.settings_page.dialog is None


def test_context_help_explains_what_is_clicked_with_the_question_mark_and_does_nothing(qtbot, active, opened):
    count = len(active.session.store.state.document.poses)
    for widget, place in (
        (active.panel.poses.add, section_place("PoseSection")),
        (active.canvas.viewport, action_place("take:MOVE")),
    ):
        active.actions_.help["help"].trigger()
        qtbot.mouseClick(widget, LEFT)
        assert opened.pop() == place
    qtbot.mouseClick(active.panel.poses.add, LEFT)
    idle(qtbot, active)
    assert opened == []
    assert len(active.session.store.state.document.poses) == count + 1


def test_help_button_and_the_key_explain_dialogs(qtbot, active, opened):
    active.actions_.settings.trigger()
    dialog = active.settings_page.dialog
    qtbot.waitUntil(dialog.isActiveWindow)
    qtbot.mouseClick(dialog.findChild(HelpButton), LEFT)
    assert opened.pop() == section_place("SettingsDialog")
    field = dialog.findChild(object, "brush_radius")
    field.setFocus()
    qtbot.keyClick(field, Qt.Key.Key_F1)
    assert opened.pop() == setting_place("brush_radius")


# Opening


@pytest.fixture
def browser(monkeypatch):
    """What the browser was asked to show."""
    shown = []
    monkeypatch.setattr(QDesktopServices, "openUrl", lambda url: shown.append(url) or True)
    return shown


@pytest.fixture
def package(tmp_path, monkeypatch):
    """A package with a manual in it, in a folder with signs that links escape."""
    package = tmp_path / "ein Ordner #1 %20 ü" / "apd_viewer"
    (package / "manual" / "reference").mkdir(parents=True)
    for page in ("index", "reference/keys", "search"):
        (package / "manual" / f"{page}.html").write_text("<p>", encoding="utf-8")
    monkeypatch.setattr(manual, "manual_folder", lambda: package / "manual")
    return package


def test_open_manual_opens_the_first_page_as_it_is(browser, package):
    manual.open_manual()
    assert [url.toLocalFile() for url in browser] == [str(package / "manual" / "index.html")]


@pytest.mark.parametrize("words", [None, "volume of a bottle & more"])
def test_manual_opens_a_page_that_leads_on_to_the_anchor(browser, package, words):
    """What opens files drops what follows their names, so the browser gets a page without it."""
    if words is None:
        manual.open_manual(action_place("up:-X"))
    else:
        manual.search_manual(words)
    (url,) = browser
    assert not url.hasFragment()
    assert not url.hasQuery()
    text = Path(url.toLocalFile()).read_text(encoding="utf-8")
    (target,) = {link.replace("&amp;", "&") for link in re.findall(r'(?:url=|href=")([^"]+)"', text)}
    goal = QUrl(target, QUrl.ParsingMode.StrictMode)
    assert goal.isValid()
    page = "search" if words else "reference/keys"
    assert goal.toLocalFile() == str(package / "manual" / f"{page}.html")
    if words is None:
        assert goal.fragment() == "action-up-minus-x"
    else:
        assert "q=volume%20of%20a%20bottle%20%26%20more" in target


def test_manual_folder_finds_the_manual_in_package_or_build_or_says_what_is_missing(tmp_path):
    package = tmp_path / "apd_viewer"
    with pytest.raises(InputError, match="This installation has no manual"):
        manual.manual_folder(package)
    (tmp_path / "docs").mkdir()
    (tmp_path / "docs" / "conf.py").touch()
    with pytest.raises(InputError, match=re.escape(f"run “make docs” in {tmp_path}")):
        manual.manual_folder(package)
    for folder in (tmp_path / "build" / "docs", package / "manual"):
        folder.mkdir(parents=True)
        (folder / "index.html").touch()
        assert manual.manual_folder(package) == folder


def test_open_manual_has_the_window_say_why_there_is_none(qtbot, window, monkeypatch):
    def missing():
        raise InputError("This installation has no manual.")

    monkeypatch.setattr(manual, "manual_folder", missing)
    window.actions_.help["manual"].trigger()
    (box,) = [top for top in QApplication.topLevelWidgets() if isinstance(top, QMessageBox)]
    assert box.text() == "This installation has no manual."
    box.close()
