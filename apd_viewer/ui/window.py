"""The main window: pushes what changed to the views, and what the user does to the session."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

from PySide6.QtCore import QEvent, QSettings, Qt, QTimer, Signal, Slot
from PySide6.QtGui import QCloseEvent, QDragEnterEvent, QDropEvent, QKeyEvent
from PySide6.QtWidgets import (
    QDockWidget,
    QMainWindow,
    QMessageBox,
    QPushButton,
    QWidget,
)

from apd_viewer.files.samples import SAMPLES, resource
from apd_viewer.geometry.mesh import Mesh
from apd_viewer.session.document import State
from apd_viewer.session.session import Activity, Listener, Session
from apd_viewer.ui import dialogs, theme
from apd_viewer.ui.actions import Actions
from apd_viewer.ui.canvas import Canvas
from apd_viewer.ui.guide import Guide
from apd_viewer.ui.icons import application_icon
from apd_viewer.ui.memory import Memory
from apd_viewer.ui.notice import Empty, Invitation, Notice
from apd_viewer.ui.panel import Panel
from apd_viewer.ui.parts import Parts
from apd_viewer.ui.statusbar import StatusBar
from apd_viewer.ui.toolbox import Tool

_WORDS = {
    Activity.IDLE: "ready",
    Activity.REFINING: "refining",
    Activity.SETTLED: "settled",
    Activity.UNREACHED: "not settled",
}


class Window(QMainWindow):
    """A canvas in the middle, tools at the left, readings at the right.

    Parameters
    ----------
    settings : QSettings
        Where recent files and the layout are remembered.
    """

    _woken = Signal()

    def __init__(self, settings: QSettings) -> None:
        super().__init__()
        self._memory = Memory(settings)
        self.setWindowTitle("APD Viewer")
        self.setWindowIcon(application_icon())
        self.setAcceptDrops(True)
        self.setMinimumSize(800, 640)
        self.setContextMenuPolicy(Qt.ContextMenuPolicy.NoContextMenu)  # it would hide the tools for good
        self.resize(1280, 800)
        self.session = Session(
            Listener(
                wake=self._woken.emit,
                changed=self._changed,
                status_changed=self._status_changed,
                told=lambda sentence: self.notice.tell(sentence),
                failed=lambda sentence: self.notice.fail(sentence),
            )
        )
        self._woken.connect(self._receive, Qt.ConnectionType.QueuedConnection)
        self._closed = False
        self.parts = Parts(self.session, self)
        self.parts.changed.connect(self._parts_changed)
        self.canvas = Canvas(self)
        self.setCentralWidget(self.canvas.viewport)
        self._make_overlays()
        self._make_panel()
        self.status = StatusBar()
        self.setStatusBar(self.status)
        self.status.cancel_asked.connect(self.session.cancel_errand)
        self.actions_ = Actions(self, self._verbs())
        self.actions_.add_panels([self._dock.toggleViewAction()])
        self._connect_canvas()
        self._connect_panel()
        self.actions_.fill_recent(self._memory.recent)
        self._memory.restore_layout(self)
        self._set_scheme(self._memory.scheme)
        self.take(Tool.MOVE)
        self._status_changed()
        self._invite()

    # Building

    def _make_overlays(self) -> None:
        view = self.canvas.viewport
        self.notice = Notice(view)
        self.invitation = Invitation(view)
        self._guide = Guide(self.invitation)
        buttons = [QPushButton("Open a mesh…", objectName="primary", clicked=self._ask_for_file)]
        for name, title in SAMPLES.items():
            buttons.append(QPushButton(title, clicked=partial(self.session.open_sample, name)))
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
            "open_sample": self.session.open_sample,
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
            "next_handle": self.parts.next_handle,
            "frame": self.canvas.frame_mesh,
            "look": view.look_along,
            "edges": partial(setattr, self.canvas.surface, "edges"),
            "smooth": partial(setattr, self.canvas.surface, "smooth"),
            "local": partial(setattr, self.canvas.gizmo, "local"),
            "scheme": self._set_scheme,
            "about": partial(dialogs.about, self),
        }

    def _connect_canvas(self) -> None:
        canvas, session = self.canvas, self.session
        canvas.stroke_began.connect(self._begin_stroke)
        canvas.painted.connect(session.paint)
        canvas.region_painted.connect(session.paint_region)
        canvas.stroke_ended.connect(self._end_stroke)
        canvas.drag_began.connect(session.begin_gesture)
        canvas.drag_began.connect(self._guide.moved)
        canvas.handle_moved.connect(lambda pose: session.move_handle(pose, self.parts.handle))
        canvas.drag_ended.connect(partial(session.end_gesture, "Move handle"))
        canvas.gesture_cancelled.connect(session.cancel_gesture)
        canvas.handle_chosen.connect(self.parts.choose_handle)
        canvas.painter.radius_changed.connect(
            lambda radius: self.status.showMessage(f"Brush {radius:.0f} px", 1500)
        )

    def _connect_panel(self) -> None:
        panel, session, parts = self.panel, self.session, self.parts
        panel.area.target.chosen.connect(session.set_area)
        panel.area.held.connect(session.hold_area)
        panel.volume.kept.connect(session.set_volume)
        panel.volume.target.chosen.connect(session.set_volume)
        panel.method.method_chosen.connect(session.set_method)
        panel.method.tolerance_chosen.connect(session.set_tolerance)
        panel.method.stiffness.chosen.connect(session.set_stiffness)
        panel.method.area_stiffness_chosen.connect(lambda x: session.set_material(area_stiffness=x))
        panel.method.shear_stiffness_chosen.connect(lambda x: session.set_material(shear_stiffness=x))
        for dial, gesture in zip(
            panel.dials, ("Change area", "Change volume", "Change stiffness"), strict=True
        ):
            dial.sweep_began.connect(session.begin_gesture)
            dial.sweep_ended.connect(partial(session.end_gesture, gesture))
            dial.sweep_given_up.connect(session.cancel_gesture)
        panel.handles.list.chosen.connect(parts.choose_handle)
        panel.handles.list.renamed.connect(session.rename_handle)
        panel.handles.list.removed.connect(parts.remove_handle)
        panel.handles.added.connect(self._add_handle)
        panel.handles.reset_asked.connect(self._reset)
        panel.regions.list.chosen.connect(parts.choose_region)
        panel.regions.list.renamed.connect(session.rename_region)
        panel.regions.list.removed.connect(parts.remove_region)
        panel.regions.added.connect(self._add_region)
        panel.regions.kept.connect(session.set_region_area)

    # The user's verbs that need a word with the user

    def open_path(self, path: str | Path) -> None:
        """Open a mesh file, in the background."""
        self.session.open(path)

    def show_mesh(self, mesh: Mesh) -> None:
        """Show a mesh that is in memory."""
        self.session.show(mesh)

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
        state = self.session.state
        if state is None:
            return
        path = dialogs.ask_for_target(self, self._memory.folder, state.document.mesh)
        if path is not None:
            self.session.export(path)

    def _begin_stroke(self) -> None:
        if self.session.state is not None:
            self.session.begin_gesture()
            self.invitation.say("")

    def _end_stroke(self, gesture: str) -> None:
        self.session.end_stroke(gesture)
        self._invite()

    def _add_handle(self) -> None:
        if self.session.state is not None:
            self.parts.add_handle()
            self.take(Tool.HANDLE)

    def _add_region(self) -> None:
        if self.session.state is not None:
            self.parts.add_region()
            self.take(Tool.REGION)

    def _undo(self) -> None:
        if self.session.state is not None and not self._give_up():
            self.session.undo()

    def _redo(self) -> None:
        if self.session.state is not None and not self._give_up():
            self.session.redo()

    def _give_up(self) -> bool:
        """In the middle of a drag it is the drag that is taken back, and no more."""
        return self.canvas.viewport.cancel() or self.panel.give_up_sweep()

    def _reset(self) -> None:
        if self.session.state is not None:
            self._give_up()
            self.session.reset_handle()

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
        self.panel.show_state(old, new, self.parts.handle, self.parts.region)
        if old is None or old.document.mesh is not document.mesh:
            self._welcome(new)
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
        if mesh.path is not None and resource("") not in mesh.path.parents:
            self._memory.remember(mesh.path)
            self.actions_.fill_recent(self._memory.recent)

    def _status_changed(self) -> None:
        session = self.session
        self.actions_.show_history(session.history.next_undo, session.history.next_redo)
        opened = session.state is not None
        self.actions_.export.setEnabled(opened)
        moved = session.state is not None and session.moved
        self.actions_.reset.setEnabled(moved)
        self.panel.handles.reset.setEnabled(moved)
        self.panel.setEnabled(opened)
        self._empty.setVisible(not opened and session.errand is None)
        self.panel.area.activity.setText(self._activity)
        self.status.show_session(session)

    @property
    def _activity(self) -> str:
        state = self.session.state
        if state is None:
            return ""
        ended = self.session.activity is Activity.UNREACHED
        return "out of reach" if ended and state.frame.unreached else _WORDS[self.session.activity]

    def _invite(self) -> None:
        state = self.session.state
        self._guide.say_next(None if state is None else state.document, self.canvas.tool, self.parts.handle)

    def _set_scheme(self, scheme: Qt.ColorScheme) -> None:
        self._memory.scheme = scheme
        for action in self.actions_.schemes.actions():
            action.setChecked(action.data() == scheme.value)
        self._dress()

    def _dress(self) -> None:
        colors = theme.theme_for(self._memory.scheme)
        theme.apply(colors)
        for part in (self.actions_, self.notice, self.panel, self.canvas):
            part.set_theme(colors)

    # Events

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Put the tool away on Esc, where nothing was under way that Esc could cancel."""
        if event.key() == Qt.Key.Key_Escape:
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
        self.session.close()
        self.canvas.viewport.close()
        super().closeEvent(event)

    def _worth_asking(self) -> bool:
        """Whether a shape would be lost; the samples are there to be played with."""
        return any(
            mesh.path is None or resource("") not in mesh.path.parents for mesh in self.session.unsaved
        )

    def _may_close(self) -> bool:
        answer = dialogs.ask_before_losing(self)
        if answer == QMessageBox.StandardButton.Save:
            self._ask_for_target()  # and stay: whoever sees the file written can close
        return answer == QMessageBox.StandardButton.Discard
