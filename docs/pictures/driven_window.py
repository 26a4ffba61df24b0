"""A real window for a script to drive.

Every step waits until the shape has settled, nothing blinks, and the font comes with Matplotlib.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from functools import cached_property
from pathlib import Path
from unittest.mock import patch

import ink
import matplotlib as mpl
import numpy as np
from coarse import coarser
from PySide6.QtCore import QElapsedTimer, QEvent, QEventLoop, QPoint, QPointF, QSettings, QSize, Qt
from PySide6.QtGui import QFontDatabase, QMouseEvent, QWheelEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QWidget

from apd_viewer.files.meshes import open_mesh
from apd_viewer.files.samples import open_sample
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.solver.convergence import Convergence
from apd_viewer.session.file_jobs import sample_state
from apd_viewer.session.model.state import State, initial_state
from apd_viewer.session.state_store import Activity
from apd_viewer.ui.application import make_application
from apd_viewer.ui.filing import file_controller
from apd_viewer.ui.filing.file_controller import UnsavedAnswer
from apd_viewer.ui.settings_page.preference_table import COLOR_SCHEME
from apd_viewer.ui.shell import Shell
from apd_viewer.ui.tools.tool_modes import Tool
from apd_viewer.ui.workbench import Workbench

SIZE = (1120, 700)  # logical pixels; the pictures have twice as many
NONE, LEFT = Qt.KeyboardModifier.NoModifier, Qt.MouseButton.LeftButton
_PATIENCE = 600.0  # s, for a shape to settle
_QUICK = Convergence(12, 1e-3, 1e-3)
_QUICK_SIZE = 800, 640  # a software renderer needs its time for every pixel
_QUICK_VERTICES = 450

Point = QPointF | QPoint | Sequence[float] | np.ndarray


class DrivenWindow:
    """A window, its mouse and its keys.

    Parameters
    ----------
    folder : Path
        Empty; for settings and files.
    quick : bool
        Whether only the driving matters: meshes are coarse, and shapes get a few iterations only.
    smooth : bool, optional
        Whether to wait for smooth edges and for the check of the shape; not if it is to be quick.
    """

    def __init__(self, folder: Path, quick: bool = False, smooth: bool | None = None) -> None:
        self.folder, self.quick = folder, quick
        self.smooth = not quick if smooth is None else smooth
        self.size, self.dark = SIZE, False

    # The window

    @cached_property
    def window(self) -> Workbench:
        """The window, shown and drawn."""
        application = make_application(["apd-viewer"])
        prepare(application)
        settings = QSettings(str(self.folder / "settings.ini"), QSettings.Format.IniFormat)
        shell = Shell(settings)
        shell.preferences.has_seen_tour = True
        window = Workbench(shell)
        window.preferences.values.choose(
            COLOR_SCHEME, Qt.ColorScheme.Dark if self.dark else Qt.ColorScheme.Light
        )
        shell.resize(QSize(*(_QUICK_SIZE if self.quick else self.size)))
        shell.show()
        self.wait(lambda: window.canvas.viewport.draw_count > 0)
        return window

    @property
    def view(self) -> QWidget:
        """The view of the mesh."""
        return self.window.canvas.viewport

    @property
    def state(self) -> State:
        """Document and shape."""
        state = self.window.session.store.state
        assert state is not None
        return state

    def close(self) -> None:
        """Close the window, unless there is none."""
        if "window" in self.__dict__:
            with patch.object(file_controller, "ask_before_leaving", lambda *_: UnsavedAnswer.DISCARD):
                self.window.shell.close()
            self.window.shell.deleteLater()
            self.pause(10)

    # Opening

    def open_sample(self, name: str) -> None:
        """Open a sample, painted."""
        self.open(lambda: sample_state(name))

    def sample(self, name: str) -> tuple[Mesh, np.ndarray]:
        """A sample and its labels (n,), for a script without a window."""
        mesh, labels = open_sample(name)
        if not self.quick:
            return mesh, labels
        document = coarser(initial_state(mesh, labels), _QUICK_VERTICES).document
        return document.mesh, document.labels

    def open_mesh(self, mesh: Mesh | Path, labels: np.ndarray | None = None) -> None:
        """Open a mesh with labels (n,), or nothing painted."""
        found = open_mesh(mesh) if isinstance(mesh, Path) else mesh
        self.open(lambda: initial_state(found, labels))

    def open(self, work: Callable[[], State]) -> None:
        """Open what ``work`` returns, in few triangles if only the driving matters."""

        def state() -> State:
            found = work()
            if not self.quick:
                return found
            found = coarser(found, _QUICK_VERTICES)
            return found.updated(found.document.with_settings(convergence=_QUICK))

        self.window.session.files.open_result("mesh", state)
        self.settle()
        self.window.notice.hide()

    # Waiting

    def pause(self, milliseconds: int) -> None:
        """Let the window work for a while."""
        clock, events = QElapsedTimer(), QEventLoop.ProcessEventsFlag.AllEvents
        clock.start()
        while clock.elapsed() < milliseconds:
            QApplication.processEvents(events, 5)
            time.sleep(0.001)

    def wait(self, condition: Callable[[], bool], patience: float = _PATIENCE) -> None:
        """Let the window work until something is so; raises TimeoutError."""
        until = time.monotonic() + patience
        while not condition():
            if time.monotonic() > until:
                raise TimeoutError("The window did not come to what the script waits for.")
            self.pause(5)

    def settle(self) -> None:
        """Wait until the shape has settled, is checked, and is drawn with smooth edges."""
        session, view = self.window.session, self.window.canvas.viewport
        self.pause(20)
        self.wait(lambda: session.jobs.current is None and session.store.activity is not Activity.REFINING)
        if not self.quick:
            self.wait(
                lambda: not session.shape_checks.is_checking and session.measurement_readings._asked is None
            )
        if self.smooth:
            self.pause(250)  # the draw with smooth edges, and whatever follows a shape with a delay
        self.wait(lambda: not view.is_stale and not (self.smooth and view.antialiasing.idle_timer.isActive()))

    # Mouse and keys

    def at(self, vertex: int) -> QPointF:
        """Where a vertex is in the view."""
        x, y = self.window.canvas.viewport.camera_controller.camera.project(self.state.frame.U[[vertex]])[0]
        return QPointF(x, y)

    def near(self, point: Sequence[float]) -> int:
        """The vertex nearest to a point at rest."""
        return int(np.argmin(np.linalg.norm(self.state.document.mesh.V - np.array(point), axis=1)))

    def on_ring(self, axis: int) -> QPointF:
        """A point of the gizmo's ring about an axis, in front and apart from all else."""
        frame = self.window.canvas.gizmo.frame
        points, near = frame.ring(axis)
        name = ("rx", "ry", "rz")[axis]
        good = [p for p, n in zip(points, near, strict=True) if n and frame.handle_at(*p) == name]
        return QPointF(*good[len(good) // 2])

    def along_ring(self, axis: int, begin: float, end: float, count: int = 7) -> list[QPointF]:
        """Points of the gizmo's ring from one share of its front to another."""
        points, near = self.window.canvas.gizmo.frame.ring(axis)
        first = int(np.flatnonzero(near & ~np.roll(near[:], 1))[0])
        front = np.roll(points[:-1], -first, axis=0)[: int(near[:-1].sum())]
        places = np.linspace(begin, end, count) * (len(front) - 1)
        return [QPointF(*(np.interp(place, np.arange(len(front)), c) for c in front.T)) for place in places]

    def on_arrow(self, axis: int) -> QPointF:
        """The shaft's end of the gizmo's arrow along an axis."""
        return QPointF(*self.window.canvas.gizmo.frame.arrow(axis)[1])

    def move(self, to: Point, widget: QWidget | None = None, pressed: bool = False) -> None:
        """Move the mouse over a widget, the view by itself."""
        buttons = LEFT if pressed else Qt.MouseButton.NoButton
        self._send(QEvent.Type.MouseMove, to, Qt.MouseButton.NoButton, buttons, NONE, widget)

    def press(self, at: Point, modifiers: Qt.KeyboardModifier = NONE, widget: QWidget | None = None) -> None:
        """Press the left button over a widget, the view by itself."""
        self.move(at, widget)
        self._send(QEvent.Type.MouseButtonPress, at, LEFT, LEFT, modifiers, widget)

    def release(self, at: Point, widget: QWidget | None = None) -> None:
        """Release the left button over a widget, the view by itself."""
        self._send(QEvent.Type.MouseButtonRelease, at, LEFT, Qt.MouseButton.NoButton, NONE, widget)

    def click(self, at: Point) -> None:
        """Click in the view."""
        self.press(at)
        self.release(at)
        self.pause(30)

    def drag(self, way: Sequence[Point], let_go: bool = True, steps: bool = True) -> None:
        """Drag along points of the view; the shape settles at each, if it is to."""
        self.press(way[0])
        for point in way[1:]:
            self.move(point, pressed=True)
            if steps:
                self.settle()
        self.pause(20)
        if let_go:
            self.release(way[-1])
            self.settle()

    def wheel(self, at: Point, notches: int) -> None:
        """Turn the wheel in the view."""
        at, widget = as_point(at), self.view
        event = QWheelEvent(
            at,
            widget.mapToGlobal(at),
            QPoint(),
            QPoint(0, 120 * notches),
            Qt.MouseButton.NoButton,
            NONE,
            Qt.ScrollPhase.NoScrollPhase,
            False,
        )
        QApplication.sendEvent(widget, event)

    def key(self, key: Qt.Key, modifiers: Qt.KeyboardModifier = NONE) -> None:
        """Press a key in the view."""
        self.window.shell.activateWindow()
        self.view.setFocus()
        QTest.keyClick(self.view, key, modifiers)
        self.pause(30)

    def twist(self, text: str, motion: str = "TWIST") -> None:
        """Type a motion of the handle into its field, and wait for the shape."""
        self.type_motion(text, motion)
        amount = self.window.panel.handles.motion.amount
        QTest.keyClick(amount, Qt.Key.Key_Return)
        self.settle()
        amount.clear()
        self.window.panel.handles.motion.editing_ended.emit()  # it keeps the focus without a window manager
        self.view.setFocus()
        self.pause(50)

    def type_motion(self, text: str, motion: str = "TWIST") -> None:
        """Type a motion into its field, and leave it there."""
        field = self.window.panel.handles.motion
        self.key(Qt.Key.Key_M, Qt.KeyboardModifier.ControlModifier)
        field.choice.setCurrentIndex(field.choice.findData(motion))
        field.amount.clear()
        QTest.keyClicks(field.amount, text)
        self.pause(50)

    def take(self, tool: Tool) -> None:
        """Use a tool."""
        self.window.tools.choose_tool(tool)
        self.pause(20)

    def _send(
        self,
        kind: QEvent.Type,
        at: Point,
        button: Qt.MouseButton,
        buttons: Qt.MouseButton,
        modifiers: Qt.KeyboardModifier,
        widget: QWidget | None = None,
    ) -> None:
        widget, at = widget or self.view, as_point(at)
        event = QMouseEvent(kind, at, widget.mapToGlobal(at), button, buttons, modifiers)
        QApplication.sendEvent(widget, event)


def prepare(application: QApplication) -> None:
    """The font of the pictures, and nothing that blinks or fades."""
    for path in Path(mpl.get_data_path(), "fonts", "ttf").glob("DejaVuSans*.ttf"):
        QFontDatabase.addApplicationFont(str(path))
    application.setFont(ink.font(9.0))
    application.setCursorFlashTime(0)
    for effect in (Qt.UIEffect.UI_AnimateMenu, Qt.UIEffect.UI_AnimateCombo, Qt.UIEffect.UI_FadeTooltip):
        application.setEffectEnabled(effect, False)


def as_point(at: Point) -> QPointF:
    """Point of Qt, from any kind of point."""
    return QPointF(at) if isinstance(at, QPointF | QPoint) else QPointF(*map(float, at))
