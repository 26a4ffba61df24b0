"""Context help: F1, and clicks in What's This mode."""

import re
from collections.abc import Callable
from typing import cast

from PySide6.QtCore import QEvent, QObject, QPoint, Qt
from PySide6.QtGui import QAction, QCursor, QHelpEvent, QKeyEvent, QKeySequence
from PySide6.QtWidgets import (
    QApplication,
    QMainWindow,
    QMenu,
    QMenuBar,
    QMessageBox,
    QToolButton,
    QWhatsThis,
    QWidget,
)

from apd_viewer.errors import InputError
from apd_viewer.language import tr
from apd_viewer.ui.help import manual
from apd_viewer.ui.help.manual import ManualPlace
from apd_viewer.ui.overlays.card_stack import CardStack
from apd_viewer.ui.overlays.notice import SECTION_PROPERTY
from apd_viewer.ui.panel.panel import Panel
from apd_viewer.ui.preferences.action_maker import NAME_PROPERTY
from apd_viewer.ui.scene.viewport import Viewport
from apd_viewer.ui.settings_page.settings_dialog import SETTING_PROPERTY
from apd_viewer.ui.tools.canvas import Canvas
from apd_viewer.ui.widgets.help_button import HelpButton

_WINDOW = ManualPlace("reference/window")
_AROUND = QMainWindow, Panel, Viewport, CardStack  # containers, documented section by section
_SHARED = "RunBar", "PartButtons"  # widgets shared by several sections


class ContextHelp(QObject):
    """Opens the manual at an action, a setting, or the section around a control.

    The target is the control under the mouse if the mouse has moved since the last change of focus, otherwise
    the one with the focus; if neither is documented, the active tool.

    Parameters
    ----------
    action : QAction
        Its key opens the manual at once; chosen from the menu, it waits for a click.
    marked_place : callable
        Place of what is marked in a list of places, if that has the focus.
    """

    def __init__(
        self,
        shell: QMainWindow,
        canvas: Canvas,
        action: QAction,
        marked_place: Callable[[], ManualPlace | None],
    ) -> None:
        super().__init__(shell)
        self._shell, self._canvas, self._action, self._marked = shell, canvas, action, marked_place
        self._mouse = QPoint()
        action.installEventFilter(self)
        for menu in shell.menuBar().findChildren(QMenu):
            menu.installEventFilter(self)
        running_application().focusChanged.connect(self._remember_mouse)
        HelpButton.explain_widget = staticmethod(explain_widget)

    def explain_target(self) -> None:
        """Open the manual at the control under the mouse or with the focus."""
        show_manual(self.target_place)

    @property
    def target_place(self) -> ManualPlace:
        """Place in the manual about the control under the mouse or with the focus."""
        if (marked := self._marked()) is not None:
            return marked
        mouse = QCursor.pos()
        under, focused = QApplication.widgetAt(mouse), self._shell.focusWidget()
        pointed = self._manual_place(under, mouse) if under is not None and mouse != self._mouse else None
        used = self._manual_place(focused, None) if focused is not None else None
        return pointed or used or self._tool

    def explain_next_click(self) -> None:
        """Explain the control at the next click."""
        running_application().installEventFilter(self)
        QWhatsThis.enterWhatsThisMode()

    def _remember_mouse(self, _: object, now: object) -> None:
        if now is not None:
            self._mouse = QCursor.pos()

    def _manual_place(self, widget: QWidget, at: QPoint | None) -> ManualPlace | None:
        """Location in the manual of a widget in this window; None for the viewport itself."""
        if widget.window() is not self._shell or isinstance(widget, Viewport):
            return None
        return widget_place(widget, at)

    @property
    def _tool(self) -> ManualPlace:
        return manual.action_place(f"take:{self._canvas.tool.name}")

    # Qt events

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Show the manual instead of acting, on the help key or a What's This click."""
        kind = event.type()
        if watched is self._action:
            return kind == QEvent.Type.Shortcut and self._run_and_accept(self.explain_target)
        if kind == QEvent.Type.KeyPress and isinstance(watched, QMenu):
            return self._explain_entry(watched, cast(QKeyEvent, event))
        if kind == QEvent.Type.LeaveWhatsThisMode:
            running_application().removeEventFilter(self)
        elif isinstance(watched, QWidget) and isinstance(event, QHelpEvent):
            if kind == QEvent.Type.QueryWhatsThis:
                event.accept()
                return True
            if kind == QEvent.Type.WhatsThis:
                at = event.globalPos()
                QWhatsThis.leaveWhatsThisMode()
                return self._run_and_accept(lambda: show_manual(self._clicked_place(watched, at)))
        return False

    def _clicked_place(self, widget: QWidget, at: QPoint) -> ManualPlace:
        return self._tool if isinstance(widget, Viewport) else widget_place(widget, at) or _WINDOW

    def _explain_entry(self, menu: QMenu, event: QKeyEvent) -> bool:
        """Open the manual at the highlighted menu entry on the help key."""
        keys = [QKeySequence(event.keyCombination())]
        if not any(key in self._action.shortcuts() for key in keys):
            return False
        action = menu.activeAction() or menu.actionAt(menu.mapFromGlobal(QCursor.pos()))
        place = menu_entry_place(action) if action is not None else None
        while (popup := QApplication.activePopupWidget()) is not None:
            popup.close()
        return self._run_and_accept(lambda: show_manual(place or ManualPlace("reference/keys")))

    @staticmethod
    def _run_and_accept(command: Callable[[], object]) -> bool:
        command()
        return True


def widget_place(widget: QWidget, mouse: QPoint | None = None) -> ManualPlace | None:
    """Location in the manual of a widget; None if it is in no documented section.

    Parameters
    ----------
    mouse : QPoint, optional
        Global position of the mouse, if that chooses a part of the widget.
    """
    action = _action_at(widget, mouse)
    if action is not None and (place := menu_entry_place(action)) is not None:
        return place
    if setting := widget.property(SETTING_PROPERTY):
        return manual.setting_place(str(setting))
    section = section_name(widget)
    return manual.section_place(section) if section else None


def section_name(widget: QWidget) -> str:
    """Class name of the section, card or dialog around a widget; empty without one."""
    name = ""
    node: QWidget | None = widget
    while node is not None and not isinstance(node, _AROUND) and name not in _SHARED:
        kind = type(node)
        if given := node.property(SECTION_PROPERTY):
            return str(given)
        if re.match(r"apd_viewer\.ui\.(?!widgets)", kind.__module__):
            name = kind.__name__
        node = node.parentWidget()
    return name


def menu_entry_place(action: QAction) -> ManualPlace | None:
    """Location in the manual of a menu entry; for a submenu, that of its first entry."""
    menu = action.menu()
    while isinstance(menu, QMenu) and menu.actions():
        action = menu.actions()[0]
        menu = action.menu()
    name = action.property(NAME_PROPERTY)
    return manual.action_place(str(name)) if name else None


def _action_at(widget: QWidget, at: QPoint | None) -> QAction | None:
    """Action of a menu entry or tool button; None for other widgets."""
    if isinstance(widget, QMenu | QMenuBar):
        under = widget.actionAt(widget.mapFromGlobal(at)) if at is not None else None
        return under or widget.activeAction()
    return widget.defaultAction() if isinstance(widget, QToolButton) else None


def explain_widget(widget: QWidget) -> None:
    """Open the manual at the section of a widget, or at the page on the window."""
    show_manual(widget_place(widget) or _WINDOW)


def show_manual(place: ManualPlace) -> None:
    """Open the manual at a location, or report that it is missing."""
    run_manual_command(lambda: manual.open_manual(place))


def look_up_in_manual(words: str) -> None:
    """Search the manual for words, or report that it is missing."""
    run_manual_command(lambda: manual.search_manual(words))


def run_manual_command(command: Callable[[], object]) -> None:
    """Run a command of the manual, or report its failure in a message box."""
    try:
        command()
    except InputError as error:
        shown = [window for window in QApplication.topLevelWidgets() if window.isVisible()]
        owner = QApplication.activeWindow() or shown[0]  # an owned box is not garbage-collected
        button = QMessageBox.StandardButton.Ok
        box = QMessageBox(QMessageBox.Icon.Information, tr("Manual"), str(error), button, owner)
        box.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        box.open()


def running_application() -> QApplication:
    """The running QApplication."""
    found = QApplication.instance()
    assert isinstance(found, QApplication)
    return found
