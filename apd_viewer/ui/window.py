"""The main window: pushes what changed to the views, and what the user does to the session."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from importlib.metadata import version
from pathlib import Path

from PySide6.QtCore import QEvent, QSettings, Qt, QTimer, Signal, Slot
from PySide6.QtGui import QCloseEvent, QDragEnterEvent, QDropEvent
from PySide6.QtWidgets import (
    QDockWidget,
    QFileDialog,
    QLabel,
    QMainWindow,
    QMessageBox,
    QProgressBar,
    QPushButton,
    QToolButton,
    QWidget,
)

from apd_viewer.files.meshes import FORMATS
from apd_viewer.files.samples import SAMPLES, resource
from apd_viewer.geometry.constraints import BASE, HANDLE
from apd_viewer.geometry.mesh import Mesh
from apd_viewer.session.document import Document, State
from apd_viewer.session.session import Activity, Listener, Session
from apd_viewer.ui import theme
from apd_viewer.ui.actions import Actions
from apd_viewer.ui.canvas import Canvas
from apd_viewer.ui.icons import application_icon
from apd_viewer.ui.notice import Empty, Invitation, Notice
from apd_viewer.ui.panel import Panel
from apd_viewer.ui.toolbox import Tool

_RECENT = 8
_TWIST = "Take the ring around the handle and twist"
_FILTER = f"Meshes ({' '.join('*' + suffix for suffix in FORMATS)})"
_EXPORT_FILTER = ";;".join(f"{suffix[1:].upper()} (*{suffix})" for suffix in FORMATS)
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
        self._settings = settings
        self.setWindowTitle("APD Viewer")
        self.setWindowIcon(application_icon())
        self.setAcceptDrops(True)
        self.setMinimumSize(720, 480)
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
        self._invited = self._closed = False
        self.canvas = Canvas(self)
        self.setCentralWidget(self.canvas.viewport)
        self._make_overlays()
        self._make_panel()
        self._make_status_bar()
        self.actions_ = Actions(self, self._verbs())
        self.actions_.add_panels([self._dock.toggleViewAction()])
        self._connect_canvas()
        self._restore()
        self._set_scheme(Qt.ColorScheme(self._settings.value("scheme", 0, int)))
        self.take(Tool.MOVE)
        self._status_changed()
        self._invite()

    # Building

    def _make_overlays(self) -> None:
        view = self.canvas.viewport
        self.notice = Notice(view)
        self.invitation = Invitation(view)
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
        self.panel.method_chosen.connect(self.session.set_method)
        self.panel.tolerance_chosen.connect(self._set_tolerance)
        self.panel.reset_asked.connect(self._reset)

    def _make_status_bar(self) -> None:
        bar = self.statusBar()
        bar.setSizeGripEnabled(False)
        self._hint = QLabel()
        self._progress = QProgressBar(maximumWidth=120, textVisible=False)
        self._progress.setRange(0, 0)
        self._cancel = QToolButton(text="Cancel")
        self._cancel.clicked.connect(self.session.cancel_errand)
        self._errand, self._pace, self._counts = QLabel(), QLabel(), QLabel()
        bar.addWidget(self._hint, 1)
        for widget in (self._errand, self._progress, self._cancel, self._pace, self._counts):
            bar.addPermanentWidget(widget)

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
            "frame": self.canvas.frame_mesh,
            "look": view.look_along,
            "edges": partial(setattr, self.canvas.surface, "edges"),
            "smooth": partial(setattr, self.canvas.surface, "smooth"),
            "local": partial(setattr, self.canvas.gizmo, "local"),
            "scheme": self._set_scheme,
            "about": self._about,
        }

    def _connect_canvas(self) -> None:
        canvas, session = self.canvas, self.session
        canvas.gesture_began.connect(session.begin_gesture)
        canvas.gesture_began.connect(self._stop_inviting)
        canvas.gesture_cancelled.connect(session.cancel_gesture)
        canvas.painted.connect(session.paint)
        canvas.stroke_ended.connect(self._end_stroke)
        canvas.handle_moved.connect(session.move_handle)
        canvas.drag_ended.connect(partial(session.end_drag, "Move handle"))
        canvas.painter.radius_changed.connect(
            lambda radius: self.statusBar().showMessage(f"Brush {radius:.0f} px", 1500)
        )

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
        self._hint.setText(tool.words.hint)
        self._hint.setToolTip(tool.words.hint)
        self._invite()

    def _ask_for_file(self) -> None:
        path, _ = QFileDialog.getOpenFileName(self, "Open a mesh", str(self._folder()), _FILTER)
        if path:
            self.open_path(path)

    def _ask_for_target(self) -> None:
        state = self.session.state
        if state is None:
            self.notice.fail("There is no mesh to export; open one first.")
            return
        source = state.document.mesh.path
        suffix = source.suffix.lower() if source else ".obj"
        stem = source.stem if source else "mesh"
        path, chosen = QFileDialog.getSaveFileName(
            self,
            "Export the deformed mesh",
            str(self._folder() / f"{stem}-deformed{suffix}"),
            _EXPORT_FILTER,
            next(part for part in _EXPORT_FILTER.split(";;") if suffix in part),
        )
        if path:
            self.session.export(_with_suffix(path, chosen))

    def _end_stroke(self, gesture: str) -> None:
        self.session.end_stroke(gesture)
        self._invite()

    def _undo(self) -> None:
        if self.session.state is not None:
            self.canvas.viewport.cancel()
            self.session.undo()

    def _redo(self) -> None:
        if self.session.state is not None:
            self.canvas.viewport.cancel()
            self.session.redo()

    def _reset(self) -> None:
        if self.session.state is not None:
            self.canvas.viewport.cancel()
            self.session.reset_handle()

    def _set_tolerance(self, tolerance: float) -> None:
        if self.session.state is not None:
            self.session.set_tolerance(tolerance)

    def _scale_brush(self, factor: float) -> None:
        self.canvas.painter.radius = self.canvas.painter.radius * factor

    def _about(self) -> None:
        QMessageBox.about(
            self,
            "About APD Viewer",
            f"<h3>APD Viewer {version('apd-viewer')}</h3>"
            "<p>Area-preserving deformation of 3D objects, after the method of Li and Hui.</p>"
            "<p>Built on NumPy, SciPy, Numba, cholespy, trimesh, PyVista and Qt for Python. MIT licence.</p>",
        )

    # Showing

    @Slot()
    def _receive(self) -> None:
        # A call may still be on its way when the window is closed.
        if not self._closed:
            self.session.receive()

    def _changed(self, old: State | None, new: State) -> None:
        self.canvas.show_state(old, new)
        self.panel.show_state(old, new)
        document = new.document
        if old is None or old.document.mesh is not document.mesh:
            self._welcome(new)
        if old is None or old.document.labels is not document.labels:
            self._invite()

    def _welcome(self, state: State) -> None:
        mesh = state.document.mesh
        self._counts.setText(f"{state.inspection.vertices:,} vertices")
        self.notice.hide()
        self.setWindowFilePath(str(mesh.path or ""))
        self.setWindowTitle(f"{mesh.name} – APD Viewer")
        self.take(Tool.BASE if state.document.problem else Tool.MOVE)
        if mesh.path is not None and resource("") not in mesh.path.parents:
            self._remember(mesh.path)

    def _status_changed(self) -> None:
        session = self.session
        self.actions_.show_history(session.history.next_undo, session.history.next_redo)
        opened = session.state is not None
        self.actions_.export.setEnabled(opened)
        self.actions_.reset.setEnabled(opened)
        self.panel.setEnabled(opened)
        self._empty.setVisible(not opened and session.errand is None)
        errand = session.errand
        for widget in (self._errand, self._progress):
            widget.setVisible(errand is not None)
        self._cancel.setVisible(errand is not None and errand.can_be_cancelled)
        self._errand.setText(errand.title if errand else "")
        self.panel.activity.setText(_WORDS[session.activity] if opened else "")
        frame = session.state.frame if session.state else None
        pace = f"{1e3 * session.seconds_per_iteration:.1f} ms an iteration"
        self._pace.setText(f"iteration {frame.iteration:,}, {pace}" if frame and frame.iteration else "")
        for warning in session.warnings:
            if warning != self._warned:
                self._warned = warning
                self.notice.tell(warning)

    _warned = ""

    def _invite(self) -> None:
        """Say what to do next, until the handle has been dragged once."""
        state = self.session.state
        self.invitation.say("" if state is None else self._next_step(state.document))

    def _next_step(self, document: Document) -> str:
        if not (document.labels == BASE).any():
            return "Paint the part that stays in place: the base (B)"
        if not (document.labels == HANDLE).any():
            return "Now paint the part to be moved: the handle (H)"
        if document.problem:
            return document.problem
        if self._invited:
            return ""
        return _TWIST if self.canvas.tool is Tool.MOVE else "Now move the handle (M)"

    def _stop_inviting(self) -> None:
        if self.canvas.tool is Tool.MOVE:
            self._invited = True
        self.invitation.say("")

    def _set_scheme(self, scheme: Qt.ColorScheme) -> None:
        self._scheme = scheme
        self._settings.setValue("scheme", scheme.value)
        for action in self.actions_.schemes.actions():
            action.setChecked(action.data() == scheme.value)
        self._dress()

    def _dress(self) -> None:
        colors = theme.theme_for(self._scheme)
        theme.apply(colors)
        for part in (self.actions_, self.notice, self.panel, self.canvas):
            part.set_theme(colors)

    # Remembering

    def _remember(self, path: Path) -> None:
        path = path.resolve()
        recent = [str(path), *(other for other in self._recent() if other != str(path))][:_RECENT]
        self._settings.setValue("recent", recent)
        self._settings.setValue("folder", str(path.parent))
        self.actions_.fill_recent([Path(other) for other in recent])

    def _folder(self) -> Path:
        return Path(str(self._settings.value("folder", str(Path.home()))))

    def _recent(self) -> list[str]:
        value = self._settings.value("recent", [])
        return [value] if isinstance(value, str) else list(value or [])

    def _restore(self) -> None:
        self.actions_.fill_recent([Path(path) for path in self._recent()])
        geometry, layout = self._settings.value("geometry"), self._settings.value("layout")
        if geometry is not None:
            self.restoreGeometry(geometry)
        if layout is not None:
            self.restoreState(layout)

    # Events

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:
        """Take one file, whatever it is; opening says what is wrong with it."""
        if len(event.mimeData().urls()) == 1 and event.mimeData().urls()[0].isLocalFile():
            event.acceptProposedAction()

    def dropEvent(self, event: QDropEvent) -> None:
        """Open the file."""
        self.open_path(event.mimeData().urls()[0].toLocalFile())

    def changeEvent(self, event: QEvent) -> None:
        """Follow the platform from light to dark."""
        if event.type() == QEvent.Type.ThemeChange and self._scheme is Qt.ColorScheme.Unknown:
            QTimer.singleShot(0, self, self._dress)
        super().changeEvent(event)

    def closeEvent(self, event: QCloseEvent) -> None:
        """Ask before a shape is lost; then end the worker, and the view before its window."""
        if self._worth_asking() and not self._may_close():
            event.ignore()
            return
        self._settings.setValue("geometry", self.saveGeometry())
        self._settings.setValue("layout", self.saveState())
        self._closed = True
        self.session.close()
        self.canvas.viewport.close()
        super().closeEvent(event)

    def _worth_asking(self) -> bool:
        state = self.session.state
        path = state.document.mesh.path if state else None
        return self.session.unsaved and path is not None and resource("") not in path.parents

    def _may_close(self) -> bool:
        buttons = QMessageBox.StandardButton
        answer = QMessageBox.question(
            self,
            "Close without exporting?",
            "The deformed mesh has not been exported. Closing loses it.",
            buttons.Discard | buttons.Cancel,
            buttons.Cancel,
        )
        return answer == buttons.Discard


def _with_suffix(path: str, chosen_filter: str) -> Path:
    """The path that was typed, ended as the chosen format where it has no known ending."""
    if Path(path).suffix.lower() in FORMATS:
        return Path(path)
    return Path(path + chosen_filter[chosen_filter.index(".") : -1])
