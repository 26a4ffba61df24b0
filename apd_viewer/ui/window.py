"""The main window: pushes what changed to the views, and what the user does to the session."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QEvent, QSettings, Qt, QTimer, Signal, Slot
from PySide6.QtGui import QCloseEvent, QDragEnterEvent, QDropEvent, QKeyEvent
from PySide6.QtWidgets import QDockWidget, QMainWindow, QMessageBox, QPushButton, QWidget

from apd_viewer.files.samples import SAMPLES
from apd_viewer.ui import dialogs, theme
from apd_viewer.ui.actions import Actions
from apd_viewer.ui.canvas import Canvas
from apd_viewer.ui.guide import Guide
from apd_viewer.ui.health import Health
from apd_viewer.ui.icons import application_icon
from apd_viewer.ui.memory import Memory, own_file
from apd_viewer.ui.notice import Empty, Invitation, Notice
from apd_viewer.ui.panel import Panel
from apd_viewer.ui.parts import Parts
from apd_viewer.ui.statusbar import StatusBar
from apd_viewer.ui.toolbox import Tool
from apd_viewer.ui.units import Units
from apd_viewer.ui.wiring import connect_hand, connect_parts, connect_settings

if TYPE_CHECKING:
    from apd_viewer.geometry.mesh import Mesh
    from apd_viewer.session.document import State
    from apd_viewer.session.session import Session
    from apd_viewer.session.units import Unit

# For the values of Activity.
_WORDS = {"idle": "ready", "refining": "refining", "settled": "settled", "not reached": "not settled"}


class Window(QMainWindow):
    """A canvas in the middle, tools at the left, readings at the right.

    It can be seen before all that it works with is loaded: :meth:`start` makes it work.

    Parameters
    ----------
    settings : QSettings
        Where recent files and the layout are remembered.

    Attributes
    ----------
    session : Session
    parts : Parts
        Both from the start on.
    """

    session: Session
    parts: Parts

    _woken = Signal()

    def __init__(self, settings: QSettings) -> None:
        super().__init__()
        self._memory = Memory(settings)
        self._units = Units(self._memory)
        self.setWindowTitle("APD Viewer")
        self.setWindowIcon(application_icon())
        self.setAcceptDrops(True)
        self.setMinimumSize(800, 640)
        self.setContextMenuPolicy(Qt.ContextMenuPolicy.NoContextMenu)  # it would hide the tools for good
        self.resize(1280, 800)
        self._started = self._closed = False
        self._wish: Callable[[], None] | None = None  # what to open as soon as there is a session
        self.canvas = Canvas(self)
        self.setCentralWidget(self.canvas.viewport)
        self._make_overlays()
        self._make_panel()
        self.status = StatusBar(self.health.badge)
        self.setStatusBar(self.status)
        self.actions_ = Actions(self, self._verbs())
        self.actions_.add_panels([self._dock.toggleViewAction()])
        self.actions_.show_history(None, None)
        self.actions_.fill_recent(self._memory.recent)
        self._memory.restore_layout(self)
        self._set_scheme(self._memory.scheme)
        self.take(Tool.MOVE)
        self._show_state(None)

    def start(self) -> None:
        """Begin to work, and open what was asked for in the meantime."""
        if self._closed:
            return
        # Here, because it takes longer to import than all that a first picture of the window needs.
        from apd_viewer.session.session import Listener, Session

        self.session = Session(
            Listener(
                wake=self._woken.emit,
                changed=self._changed,
                status_changed=self._status_changed,
                told=self.notice.tell,
                failed=self.notice.fail,
            )
        )
        self._woken.connect(self._receive, Qt.ConnectionType.QueuedConnection)
        self.parts = Parts(self.session, self)
        self.parts.changed.connect(self._parts_changed)
        self.status.cancel_asked.connect(self.session.cancel_errand)
        self._connect_canvas()
        self._connect_panel()
        self._started = True
        if self._wish is not None:
            self._wish()
        self._status_changed()

    # Building

    def _make_overlays(self) -> None:
        view = self.canvas.viewport
        self.notice = Notice(view)
        self.invitation = Invitation(view)
        self._guide = Guide(self.invitation)
        self.health = Health(self.canvas)
        buttons = [QPushButton("Open a mesh…", objectName="primary", clicked=self._ask_for_file)]
        for name, title in SAMPLES.items():
            buttons.append(QPushButton(title, clicked=partial(self.open_sample, name)))
        self._empty = Empty(view, buttons)

    def _make_panel(self) -> None:
        self.panel = Panel()
        self._dock = QDockWidget("Readings", self, objectName="readings")
        self._dock.setTitleBarWidget(QWidget())
        self._dock.setWidget(self.panel)
        self.addDockWidget(Qt.DockWidgetArea.RightDockWidgetArea, self._dock)
        self.panel.folded = self._memory.folded

    def _verbs(self) -> dict[str, Callable[..., object]]:
        view = self.canvas.viewport
        return {
            "open": self._ask_for_file,
            "open_path": self.open_path,
            "open_sample": self.open_sample,
            "export": self._ask_for_target,
            "quit": self.close,
            "undo": self._undo,
            "redo": self._redo,
            "reset": self._reset,
            "take": self.take,
            "larger": partial(self._scale_brush, 1.25),
            "smaller": partial(self._scale_brush, 0.8),
            "add_handle": self._add_handle,
            "add_region": self._add_region,
            "next_handle": self._next_handle,
            "frame": self.canvas.frame_mesh,
            "findings": self.health.open,
            "look": view.look_along,
            "edges": partial(setattr, self.canvas.surface, "edges"),
            "smooth": partial(setattr, self.canvas.surface, "smooth"),
            "local": partial(setattr, self.canvas.gizmo, "local"),
            "scheme": self._set_scheme,
            "about": partial(dialogs.about, self),
        }

    def _connect_canvas(self) -> None:
        canvas = self.canvas
        canvas.stroke_began.connect(self._begin_stroke)
        connect_hand(canvas, self.session, self.parts)
        canvas.stroke_ended.connect(self._end_stroke)
        canvas.drag_began.connect(self._guide.moved)
        canvas.painter.radius_changed.connect(
            lambda radius: self.status.showMessage(f"Brush {radius:.0f} px", 1500)
        )

    def _connect_panel(self) -> None:
        panel, session, parts = self.panel, self.session, self.parts
        connect_settings(panel, session)
        connect_parts(panel, session, parts)
        panel.handles.added.connect(self._add_handle)
        panel.handles.reset_asked.connect(self._reset)
        panel.regions.added.connect(self._add_region)
        panel.area.unit.chosen.connect(self._choose_unit)

    # The user's verbs that need a word with the user

    def open_path(self, path: str | Path) -> None:
        """Open a mesh file, in the background."""
        self._open(lambda: self.session.open(path))

    def open_sample(self, name: str) -> None:
        """Open a sample, in the background."""
        self._open(lambda: self.session.open_sample(name))

    def show_mesh(self, mesh: Mesh) -> None:
        """Show a mesh that is in memory."""
        self._open(lambda: self.session.show(mesh))

    def _open(self, wish: Callable[[], None]) -> None:
        if self._started:
            wish()
        else:
            self._wish = wish  # the latest wins

    @property
    def _state(self) -> State | None:
        return self.session.state if self._started else None

    def take(self, tool: Tool) -> None:
        """Put a tool into the hand."""
        self.canvas.take(tool)
        self.actions_.tools[tool].setChecked(True)
        self.status.hint(tool.words.hint)
        self._invite()

    def _ask_for_file(self) -> None:
        path = dialogs.ask_for_mesh(self, self._memory.folder)
        if path is not None:
            self.open_path(path)

    def _ask_for_target(self) -> None:
        state = self._state
        if state is None:
            return
        path = dialogs.ask_for_target(self, self._memory.folder, state.document.mesh)
        if path is not None:
            self.session.export(path)

    def _begin_stroke(self) -> None:
        if self._state is not None:
            self.session.begin_gesture()
            self.invitation.say("")

    def _end_stroke(self, gesture: str) -> None:
        self.session.end_stroke(gesture)
        self._invite()

    def _add_handle(self) -> None:
        if self._state is not None:
            self.parts.add_handle()
            self.take(Tool.HANDLE)

    def _next_handle(self) -> None:
        if self._state is not None:
            self.parts.next_handle()

    def _add_region(self) -> None:
        if self._state is not None:
            self.parts.add_region()
            self.take(Tool.REGION)

    def _undo(self) -> None:
        if self._state is not None and not self._give_up():
            self.session.undo()

    def _redo(self) -> None:
        if self._state is not None and not self._give_up():
            self.session.redo()

    def _give_up(self) -> bool:
        """In the middle of a drag it is the drag that is taken back, and no more."""
        return self.canvas.viewport.cancel() or self.panel.give_up_sweep()

    def _reset(self) -> None:
        if self._state is not None:
            self._give_up()
            self.session.reset_handle()

    def _choose_unit(self, unit: Unit) -> None:
        state = self._state
        if state is not None:
            self._units.choose(state.document.mesh, unit)
            self.session.unit = unit
            self.panel.measure_in(unit, state, self.parts.handle, self.parts.region)
            self.status.show_session(self.session)

    def _scale_brush(self, factor: float) -> None:
        self.canvas.painter.radius = self.canvas.painter.radius * factor

    # Showing

    @Slot()
    def _receive(self) -> None:
        # A call may still be on its way when the window is closed.
        if not self._closed:
            self.session.receive()

    def _changed(self, old: State | None, new: State) -> None:
        document = new.document
        self.parts.follow(None if old is None else old.document, document)
        self.canvas.show_state(old, new, self.parts.handle, self.parts.region)
        if old is None or old.document.mesh is not document.mesh:
            self._welcome(new)
        self.panel.show_state(old, new, self.parts.handle, self.parts.region)
        if old is None or old.document.labels is not document.labels:
            self._invite()

    def _parts_changed(self) -> None:
        self.canvas.choose(self.parts.handle, self.parts.region)
        if self.session.state is not None:
            self.panel.show_parts(self.session.state, self.parts.handle, self.parts.region)
        self._invite()

    def _welcome(self, state: State) -> None:
        mesh = state.document.mesh
        self.notice.hide()
        self.setWindowFilePath(str(mesh.path or ""))
        self.setWindowTitle(f"{mesh.name} – APD Viewer")
        self.take(Tool.BASE if state.document.problem else Tool.MOVE)
        self.health.show(state.inspection.findings)
        self.session.unit = self.panel.unit = self._units.of(mesh)
        if path := own_file(mesh):
            self._memory.remember(path)
            self.actions_.fill_recent(self._memory.recent)

    def _status_changed(self) -> None:
        session = self.session
        self.actions_.show_history(session.history.next_undo, session.history.next_redo)
        self._show_state(session.state)
        self._empty.setVisible(session.state is None and session.errand is None)
        self.status.show_session(session)

    def _show_state(self, state: State | None) -> None:
        """Offer what can be done with what is open, and say what the worker does about it."""
        moved = state is not None and self.session.moved
        self.actions_.export.setEnabled(state is not None)
        self.actions_.reset.setEnabled(moved)
        self.panel.handles.reset.setEnabled(moved)
        self.panel.setEnabled(state is not None)
        self.panel.area.activity.setText("" if state is None else self._activity(state))

    def _activity(self, state: State) -> str:
        if self.session.preparing:
            return "preparing"
        activity = self.session.activity.value
        return "out of reach" if activity == "not reached" and state.frame.unreached else _WORDS[activity]

    def _invite(self) -> None:
        state = self._state
        if state is not None:
            self._guide.say_next(state.document, self.canvas.tool, self.parts.handle)

    def _set_scheme(self, scheme: Qt.ColorScheme) -> None:
        self._memory.scheme = scheme
        for action in self.actions_.schemes.actions():
            action.setChecked(action.data() == scheme.value)
        self._dress()

    def _dress(self) -> None:
        colors = theme.theme_for(self._memory.scheme)
        theme.apply(colors)
        for part in (self.actions_, self.notice, self.panel, self.canvas, self.health):
            part.set_theme(colors)

    # Events

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Put the tool away on Esc, where nothing was under way that Esc could cancel or close."""
        if event.key() == Qt.Key.Key_Escape and not self.health.close():
            self.take(Tool.ORBIT)
        super().keyPressEvent(event)

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:
        """Take one file, whatever it is; opening says what is wrong with it."""
        if len(event.mimeData().urls()) == 1 and event.mimeData().urls()[0].isLocalFile():
            event.acceptProposedAction()

    def dropEvent(self, event: QDropEvent) -> None:
        """Open the file."""
        self.open_path(event.mimeData().urls()[0].toLocalFile())

    def changeEvent(self, event: QEvent) -> None:
        """Follow the platform from light to dark."""
        if event.type() == QEvent.Type.ThemeChange and self._memory.scheme is Qt.ColorScheme.Unknown:
            QTimer.singleShot(0, self, self._dress)
        super().changeEvent(event)

    def closeEvent(self, event: QCloseEvent) -> None:
        """Ask before a shape is lost; then end the worker, and the view before its window."""
        if self._worth_asking() and not self._may_close():
            event.ignore()
            return
        self._memory.keep_layout(self)
        self._memory.folded = self.panel.folded
        self._closed = True
        self.health.close()
        if self._started:
            self.session.close()
        self.canvas.viewport.close()
        super().closeEvent(event)

    def _worth_asking(self) -> bool:
        """Whether a shape would be lost; the samples are there to be played with."""
        return self._started and any(
            mesh.path is None or own_file(mesh) is not None for mesh in self.session.unsaved
        )

    def _may_close(self) -> bool:
        answer = dialogs.ask_before_losing(self)
        if answer == QMessageBox.StandardButton.Save:
            self._ask_for_target()  # and stay: whoever sees the file written can close
        return answer == QMessageBox.StandardButton.Discard
