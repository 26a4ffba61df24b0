"""The main window as it is first shown: frame, canvas, panels and menus."""

from functools import partial
from typing import cast

from PySide6 import QtWidgets
from PySide6.QtCore import QChildEvent, QEvent, QSettings, QSize, Qt, QTimer, Signal
from PySide6.QtGui import QAction, QCloseEvent, QDragEnterEvent, QDropEvent, QFont, QKeyEvent

from apd_viewer.language import tr
from apd_viewer.ui.actions.window_menus import WindowMenus
from apd_viewer.ui.filing.file_requests import FileRequests
from apd_viewer.ui.overlays.findings_badge import Badge
from apd_viewer.ui.panel.panel import Panel
from apd_viewer.ui.panel.status_bar import StatusBar
from apd_viewer.ui.preferences.preferences import Preferences, UpAxes
from apd_viewer.ui.settings_page.preference_table import COLOR_SCHEME, NAVIGATION, SELECTION_MODE, UP_AXIS
from apd_viewer.ui.tools.canvas import Canvas
from apd_viewer.ui.tools.tool_modes import FIRST_TOOL, Tool
from apd_viewer.ui.widgets import theme
from apd_viewer.ui.widgets.box_layouts import LayoutBoundary, resize_on_screen
from apd_viewer.ui.widgets.theme import Theme, application_icon, icon
from apd_viewer.ui.widgets.wheel import ignore_wheel


class Shell(QtWidgets.QMainWindow):
    """Main window: canvas in the middle, tools on the left, readings on the right.

    Without a session and its libraries, so that it can be shown at once. The camera can be moved and files
    can be requested; everything else needs a :class:`~apd_viewer.ui.workbench.Workbench`.

    Parameters
    ----------
    settings : QSettings
        Storage of recent files, layout and options.

    Attributes
    ----------
    closing : Signal(QCloseEvent)
        The window is about to be closed; a slot can ignore the event.
    activated : Signal()
        The user has come to the window, maybe from another program.
    escape_pressed : Signal()
        Esc was pressed, and no widget used it.
    theme_changed : Signal(Theme)
    """

    closing = Signal(object)
    closed = Signal()
    activated = Signal()
    escape_pressed = Signal()
    theme_changed = Signal(object)

    def __init__(self, settings: QSettings) -> None:
        super().__init__()
        self.preferences = Preferences(settings)
        self.requests = FileRequests(self, self.preferences)
        self.is_closed = False
        self._set_up_frame()
        values = self.preferences.values
        self.canvas = Canvas(self, UpAxes(self.preferences, lambda: values[UP_AXIS]))
        self.setCentralWidget(self.canvas.viewport)
        self.setFocusProxy(self.canvas.viewport)  # input fields return focus to the canvas
        self.panel = Panel()
        self.panel.folded_sections = self.preferences.folded_sections
        self.history = HistoryList()
        self.badge = Badge()
        self.status = StatusBar(self.badge)
        self.setStatusBar(self.status)
        self.docks = Docks(self)
        self._add_docks()
        toggles = self.docks.toggles
        self.menus = WindowMenus(self, self.requests, self._take, self.canvas.frame_mesh, toggles)
        self.preferences.restore_layout(self)
        for name in ("study", "timeline"):  # without contents until a study or a motion in steps
            self.docks[name].hide()
        values.apply_now_and_on_change(COLOR_SCHEME, lambda _: self._apply_theme())
        values.apply_now_and_on_change(
            NAVIGATION, partial(setattr, self.canvas.viewport.navigation, "preset")
        )
        self.canvas.choose_mode(values[SELECTION_MODE])
        self._take(FIRST_TOOL)
        self.panel.setEnabled(False)

    def _set_up_frame(self) -> None:
        self.setWindowTitle("APD Viewer")
        self.setWindowIcon(application_icon())
        self.setAcceptDrops(True)
        self.setMinimumSize(800, 640)
        # The context menu of QMainWindow would let users switch off the tool bar.
        self.setContextMenuPolicy(Qt.ContextMenuPolicy.NoContextMenu)
        resize_on_screen(self, QSize(1280, 800))

    def _add_docks(self) -> None:
        self.docks.add("readings", tr("Panel"), self.panel)
        self.docks.add("history", tr("History"), self.history, shown=False)
        below = Qt.DockWidgetArea.BottomDockWidgetArea
        # The workbench replaces these empty widgets with those that need the session.
        plots = self.docks.add("plots", tr("Plots"), QtWidgets.QWidget(), below, False)
        plots.toggleViewAction().setShortcut("Ctrl+P")
        self.docks.add("study", tr("Study results"), QtWidgets.QWidget(), below, False)
        self.docks.add("timeline", tr("Timeline"), QtWidgets.QWidget(), below, False)

    def _take(self, tool: Tool) -> None:
        self.canvas.choose_tool(tool)
        camera = self.canvas.viewport.navigation.preset.sentence
        self.status.show_hint(tool.hint(self.canvas.selection_mode, camera))

    # Colour theme

    @property
    def theme(self) -> theme.Theme:
        """Theme in use."""
        return theme.theme_for(self.preferences.values[COLOR_SCHEME])

    def _apply_theme(self) -> None:
        colors = self.theme
        theme.apply_theme(colors)
        for part in (self.menus.maker, self.panel, self.badge, self.canvas, self.docks):
            part.set_theme(colors)
        self.theme_changed.emit(colors)

    # Qt events

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Emit a signal for an Esc not handled elsewhere."""
        if event.key() == Qt.Key.Key_Escape:
            self.escape_pressed.emit()
        super().keyPressEvent(event)

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:
        """Accept a single local file; problems are reported on opening."""
        if len(event.mimeData().urls()) == 1 and event.mimeData().urls()[0].isLocalFile():
            event.acceptProposedAction()

    def dropEvent(self, event: QDropEvent) -> None:
        """Open the dropped file after the event, so that the source need not wait."""
        path = event.mimeData().urls()[0].toLocalFile()
        QTimer.singleShot(0, self, lambda: self.requests.open_path(path))

    def childEvent(self, event: QChildEvent) -> None:
        """Disable the wheel on dock tab bars, as Qt creates them."""
        super().childEvent(event)
        if event.type() is QEvent.Type.ChildPolished and isinstance(event.child(), QtWidgets.QTabBar):
            ignore_wheel(cast(QtWidgets.QTabBar, event.child()))

    def changeEvent(self, event: QEvent) -> None:
        """Follow the platform's colour scheme; emit a signal on activation."""
        follows = self.preferences.values[COLOR_SCHEME] is Qt.ColorScheme.Unknown
        if event.type() == QEvent.Type.ThemeChange and follows:
            QTimer.singleShot(0, self, self._apply_theme)
        if event.type() == QEvent.Type.ActivationChange and self.isActiveWindow():
            self.activated.emit()
        super().changeEvent(event)

    def closeEvent(self, event: QCloseEvent) -> None:
        """Close the viewport and the window, unless a slot of ``closing`` ignores it."""
        self.closing.emit(event)
        if event.isAccepted():
            self.preferences.save_layout(self)
            self.preferences.folded_sections = self.panel.folded_sections
            self.is_closed = True
            self.closed.emit()
            self.canvas.viewport.close()
            super().closeEvent(event)


# The style's own icons are black even on a dark panel.
_BUTTONS = {"qt_dockwidget_closebutton": "remove", "qt_dockwidget_floatbutton": "panel"}


class Docks:
    """Dock widgets of a window, in menu order."""

    def __init__(self, window: QtWidgets.QMainWindow) -> None:
        self._window = window
        self._docks: dict[str, QtWidgets.QDockWidget] = {}

    def add(
        self,
        name: str,
        title: str,
        content: QtWidgets.QWidget,
        area: Qt.DockWidgetArea = Qt.DockWidgetArea.RightDockWidgetArea,
        shown: bool = True,
    ) -> QtWidgets.QDockWidget:
        """Add a dock with ``content``; ``name`` identifies it in the saved layout."""
        dock = QtWidgets.QDockWidget(title, self._window, objectName=name)
        dock.setWidget(LayoutBoundary(content))
        self._window.addDockWidget(area, dock)
        dock.setVisible(shown)
        dock.toggleViewAction().setObjectName(name)  # key of its stored shortcut
        self._docks[name] = dock
        return dock

    def __getitem__(self, name: str) -> QtWidgets.QDockWidget:
        return self._docks[name]

    def set_theme(self, theme: Theme) -> None:
        """Redraw the buttons in the title bars."""
        for dock in self._docks.values():
            for name, image in _BUTTONS.items():
                button = dock.findChild(QtWidgets.QAbstractButton, name)
                if button is not None:
                    button.setIcon(icon(image, theme))

    @property
    def toggles(self) -> list[QAction]:
        """Actions to show and hide the docks."""
        return [dock.toggleViewAction() for dock in self._docks.values()]


class HistoryList(QtWidgets.QListWidget):
    """One row per step, oldest first; undone steps are greyed.

    Attributes
    ----------
    chosen : Signal(int)
        Number of steps to be done from then on, from 0.
    """

    chosen = Signal(int)

    def __init__(self) -> None:
        super().__init__(objectName="history", accessibleName=tr("History"))
        self.setToolTip(tr("Click a step to go back or forward to it"))
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self._shown: tuple[str, list[str], list[str]] = "", [], []
        self.itemClicked.connect(lambda item: self.chosen.emit(self.row(item)))
        self.itemActivated.connect(lambda item: self.chosen.emit(self.row(item)))

    def show_steps(self, name: str, done: list[str], undone: list[str]) -> None:
        """Show the opened mesh, the steps done, and the steps to redo, in order."""
        if (name, done, undone) == self._shown:
            return
        self._shown = name, list(done), list(undone)
        self.clear()
        start = tr("Open {name}").format(name=name)
        for k, step in enumerate([start, *done, *undone]):
            item = QtWidgets.QListWidgetItem(step)
            font = QFont(self.font())
            font.setBold(k == len(done))
            item.setFont(font)
            if k > len(done):
                item.setForeground(self.palette().placeholderText())
            self.addItem(item)
        self.setCurrentRow(len(done))
        self.scrollToItem(self.item(len(done)))
