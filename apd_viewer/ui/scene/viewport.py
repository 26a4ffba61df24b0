"""3D view: one VTK draw per paint, mouse tools, and a Qt layer on top."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from PySide6 import QtGui
from PySide6.QtCore import QEvent, QPointF, QRect, Qt, Signal
from PySide6.QtWidgets import QApplication, QWidget
from pyvistaqt import QtInteractor
from vtkmodules.vtkRenderingCore import vtkActor

from apd_viewer.ui.scene.camera_controller import CameraController
from apd_viewer.ui.scene.navigation import MouseTool, Navigation
from apd_viewer.ui.scene.pointing import Pointing
from apd_viewer.ui.scene.surface_shading import Antialiasing

_GL_NAMES = 0x1F00, 0x1F01, 0x1F02  # GL_VENDOR, GL_RENDERER, GL_VERSION


class Viewport(QtInteractor):
    """Widget to show a scene and dispatch mouse events to tools.

    See :mod:`apd_viewer.ui.scene.navigation` for the methods of a tool and the camera gestures.

    Attributes
    ----------
    tools : list
        First come, first served.
    pre_draw : list of callables
        Called before each VTK draw.
    draw_count : int
        VTK draws so far: one for each paint after ``update()``, none for a paint of the overlay.
    camera_controller : CameraController
        The camera.
    navigation : Navigation
        Moves the camera by what no tool wanted.
    pick_point : callable or None
        Function giving the visible surface point at a position in the widget, or None.
    box : callable or None
        The box around all that is drawn: least and largest x, then y, then z.
    backdrop : list of vtkActor
        Actors that belong to the background, absent in pictures without one.
    more_boxes : list of callables
        The same of what else is drawn; empty where nothing is.
    is_dark : bool
        Whether the background is dark.
    spares_mesh : bool
        Whether hints without room beside a framed mesh are dropped, as in the low view above a timeline.
    opengl_info : str
        Vendor, renderer and version, the driver's among them; empty before the first draw.
    opengl_found : Signal()
        ``opengl_info`` and the settings to suit it are known.
    clicked : Signal(QPointF)
        A press that no tool wanted and that moved nothing, at its position in the widget.
    is_stale : bool
        Whether the scene has changed since the last VTK draw.
    """

    resized = Signal()
    opengl_found = Signal()
    clicked = Signal(QPointF)

    _in_paint: bool  # base-class flag; while set, a draw is not copied to the screen

    def __init__(self, parent: QWidget | None = None) -> None:
        self.tools: list[MouseTool] = []
        self.pre_draw: list[Callable[[], None]] = []
        self.draw_count = 0
        self.pick_point: Callable[[QPointF], np.ndarray | None] | None = None
        self.box: Callable[[], tuple[float, ...]] | None = None
        self.backdrop: list[vtkActor] = []
        self.more_boxes: list[Callable[[], tuple[float, ...]]] = []
        self.is_dark = False
        self.opengl_info = ""
        self.spares_mesh = False
        self.is_stale = True  # the scene has changed since the last VTK draw
        super().__init__(parent, auto_update=False, multi_samples=0, lighting="none")
        self.setAcceptDrops(False)  # the base class would load dropped files into the scene
        self.ren_win.GetInteractor().EnableRenderOff()
        # Cullers would query the bounds of all actors in order to skip those out of view.
        self.renderer.GetCullers().RemoveAllItems()
        self.antialiasing = Antialiasing(self)
        self.tool_layer = ToolLayer(self, self.tools)
        self.camera_controller = CameraController(
            self, lambda position: self.pick_point(position) if self.pick_point is not None else None
        )
        self.navigation = Navigation(self.camera_controller, self.clicked.emit)
        self.mouse = MouseDispatcher(self, self.tools, self.navigation)
        self.pointing = Pointing(self, self.camera_controller, self.mouse.abandon, self.mouse.leave)
        self.set_theme("#f4f5f7")

    # Appearance

    def set_theme(self, background_top: str, background_bottom: str | None = None) -> None:
        """Set the background colour, or the two ends of a vertical gradient."""
        top, bottom = QtGui.QColor(background_top), QtGui.QColor(background_bottom or background_top)
        self.is_dark = bottom.lightnessF() < 0.5
        self.renderer.SetBackground(bottom.redF(), bottom.greenF(), bottom.blueF())
        self.renderer.SetBackground2(top.redF(), top.greenF(), top.blueF())
        self.renderer.SetGradientBackground(top != bottom)
        self.update()

    def screenshot(self, *args: Any, **kwargs: Any) -> Any:
        """Current picture of the scene without tools; see pyvista.Plotter.screenshot."""
        self._ensure_initialized()
        self.antialiasing.smooths_next_draw = self.antialiasing.is_software
        self._draw()
        return super().screenshot(*args, **kwargs)

    # Drawing

    @contextmanager
    def offscreen_window(self) -> Iterator[Any]:
        """Render window for off-screen drawing as a context; None without OpenGL."""
        self._ensure_initialized()
        window = self.ren_win
        if self._ctx is None or not window.GetReadyForRendering():
            yield None
            return
        size = window.GetSize()
        self.makeCurrent()
        self._in_paint = True
        try:
            yield window
        finally:
            self._in_paint = False
            window.GetInteractor().UpdateSize(*size)
            self.update()

    def update(self, *_: Any) -> None:
        """Schedule a repaint of scene and tool layer; repeated calls cause one draw."""
        if getattr(self, "_closed", False):
            return
        self.is_stale = True
        super().update()
        if hasattr(self, "tool_layer"):  # not set yet while the base class is initialized
            self.tool_layer.update()

    def render(self, *_: Any, **__: Any) -> None:
        """Schedule a repaint; called by pyvista after each change."""
        self._rendered = True
        self.update()

    _render = render

    def initializeGL(self) -> None:
        """Choose drawing settings to suit the OpenGL renderer."""
        super().initializeGL()
        functions = self.context().functions()
        vendor, renderer, version = (str(functions.glGetString(name)) for name in _GL_NAMES)
        self.opengl_info = f"{vendor}, {renderer}, {version}"
        self.antialiasing.choose_samples(renderer)
        if self.antialiasing.is_software:
            # Each blink of a text cursor would make the CPU compose the whole window: 4 % of a core.
            QApplication.setCursorFlashTime(0)
            # Blending in the order of the actors: without it a picture with obstacles takes a fifth more.
            self.renderer.SetUseOIT(False)
        self.is_stale = True
        self.opengl_found.emit()

    def resizeGL(self, width: int, height: int) -> None:
        """Resize the render window to the device pixels."""
        super().resizeGL(width, height)
        # Qt rounds halves up, Python to even: at a scale of 1.5 a line of pixels would stay black.
        ratio = self.devicePixelRatioF()
        self.ren_win.GetInteractor().UpdateSize(int(width * ratio + 0.5), int(height * ratio + 0.5))
        self.is_stale = True

    def _blit(self, target: int, _rect: object) -> None:
        super()._blit(target, QRect(0, 0, *self.ren_win.GetSize()))

    def paintGL(self) -> None:
        """Render the scene if it has changed, and copy the picture to the screen."""
        if self.is_stale and self._RenderWindow is not None and self._RenderWindow.GetReadyForRendering():
            self._draw()
        # With _in_paint set, the base class only copies the picture instead of drawing a second time.
        self._in_paint = True
        try:
            super().paintGL()
        finally:
            self._in_paint = False

    def prepare_scene(self) -> None:
        """Run the pre-draw callbacks and update the clipping range."""
        for prepare in self.pre_draw:
            prepare()
        boxes = [box for find in (self.box, *self.more_boxes) if find is not None and (box := find())]
        if boxes:
            ends = np.array(boxes).reshape(-1, 3, 2)
            low, high = ends[:, :, 0].min(axis=0), ends[:, :, 1].max(axis=0)
            self.renderer.ResetCameraClippingRange(np.column_stack([low, high]).ravel().tolist())

    def _draw(self) -> None:
        self.prepare_scene()
        self.antialiasing.begin_draw()
        self._in_paint = True
        try:
            self.ren_win.Render()  # unlike the interactor's Render, this one releases the GIL
        finally:
            self._in_paint = False
        self.draw_count += 1
        self.is_stale = False
        self.antialiasing.end_draw()

    # Events

    def mousePressEvent(self, event: QtGui.QMouseEvent) -> None:
        """Offer the press to the tools, then to the camera."""
        self.setFocus()  # otherwise keys would still go to the last text field
        self.mouse.press(event)

    def mouseDoubleClickEvent(self, event: QtGui.QMouseEvent) -> None:
        """Treat the second press of a double click as an ordinary press."""
        self.mouse.press(event)

    def mouseMoveEvent(self, event: QtGui.QMouseEvent) -> None:
        """Continue a drag or hover."""
        self.mouse.move(event)

    def mouseReleaseEvent(self, event: QtGui.QMouseEvent) -> None:
        """End a drag."""
        self.mouse.release(event)

    def wheelEvent(self, event: QtGui.QWheelEvent) -> None:
        """Offer the wheel to the tools, then zoom."""
        self.mouse.wheel(event)
        event.accept()

    def enterEvent(self, _event: QEvent) -> None:
        """Do nothing, to keep the event from VTK."""

    def leaveEvent(self, _event: QEvent) -> None:
        """Notify the tools of the cursor leaving the viewport."""
        self.mouse.leave()

    def keyPressEvent(self, event: QtGui.QKeyEvent) -> None:
        """Cancel on Esc and finish on Return, without VTK's one-key shortcuts."""
        key = event.key()
        done = key == Qt.Key.Key_Escape and self.mouse.cancel()
        if not done and key in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            done = self.mouse.finish()
        if not done:
            event.ignore()

    def keyReleaseEvent(self, event: QtGui.QKeyEvent) -> None:
        """Do nothing, to keep the event from VTK."""
        event.ignore()

    def event(self, event: QEvent) -> bool:
        """Handle what pens, fingers and trackpads do."""
        return (hasattr(self, "pointing") and self.pointing.take(event)) or super().event(event)

    def resizeEvent(self, event: QtGui.QResizeEvent) -> None:
        """Resize the tool layer, and reframe unless the camera was moved."""
        super().resizeEvent(event)
        self.tool_layer.setGeometry(self.rect())
        self.resized.emit()
        self.camera_controller.keep_framing()

    def showEvent(self, event: QtGui.QShowEvent) -> None:
        """Draw the changes made while hidden."""
        super().showEvent(event)
        self.update()

    def close(self) -> None:
        """Release the scene; the widget cannot be used afterwards."""
        if not getattr(self, "_closed", True):
            self.antialiasing.idle_timer.stop()
            self.pre_draw.clear()
            self.tools.clear()
            self.more_boxes.clear()
            self.camera_controller.close()
            self.pick_point = self.box = None
        super().close()
        # Qt frees context and surface itself and may reuse their addresses; Python would then look up these
        # stale wrappers for the new objects, with a wrong class or an already deleted object.
        self._ctx = self._surface = None


class ToolLayer(QWidget):
    """Transparent widget over the viewport, painted by the tools.

    QPainter draws smooth lines and letters even with a software OpenGL, and redrawing a tool alone needs no
    VTK draw.

    Parameters
    ----------
    tools : list
        Tools of the viewport, read at every paint.
    """

    def __init__(self, viewport: QWidget, tools: list[MouseTool]) -> None:
        super().__init__(viewport)
        self._tools = tools
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.setAttribute(Qt.WidgetAttribute.WA_NoSystemBackground)

    def paintEvent(self, _event: QtGui.QPaintEvent) -> None:
        """Paint the tools in reverse order, the first one on top."""
        with QtGui.QPainter(self) as painter:
            painter.setRenderHint(QtGui.QPainter.RenderHint.Antialiasing)
            for tool in reversed(self._tools):
                tool.paint(painter)


class MouseDispatcher:
    """Dispatches mouse events to the tools in order, then to the navigation.

    Parameters
    ----------
    tools : list
        Tools of the viewport, read at every event.
    """

    def __init__(self, viewport: QWidget, tools: list[MouseTool], navigation: Navigation) -> None:
        self._viewport = viewport
        self._tools = tools
        self._navigation = navigation
        self._holder: MouseTool | None = None
        self._button = Qt.MouseButton.NoButton

    def press(self, event: QtGui.QMouseEvent) -> None:
        """Offer a press; the accepting tool holds the mouse until the release."""
        if self._holder is not None:
            return
        self._button = event.button()
        alone = self._navigation.preset.precedes_tools(event.button(), event.modifiers())
        first = [self._navigation] if alone else []
        takers = (tool for tool in (*first, *self._all_tools()) if tool.press(event))
        self._holder = next(takers, None)

    def move(self, event: QtGui.QMouseEvent) -> None:
        """Send the move to the holding tool, or to all tools as a preview."""
        if self._holder is not None and not event.buttons() & self._button:
            self.release(event)  # another window received the release
        elif self._holder is not None:
            self._holder.move(event)
        elif event.buttons() == Qt.MouseButton.NoButton:
            self._hover(event)

    def release(self, event: QtGui.QMouseEvent) -> None:
        """End the drag on release of its button."""
        if self._holder is not None and not event.buttons() & self._button:
            holder, self._holder = self._holder, None
            holder.release(event)
        if event.type() == QEvent.Type.MouseButtonRelease and event.buttons() == Qt.MouseButton.NoButton:
            self._hover(event)

    def wheel(self, event: QtGui.QWheelEvent) -> None:
        """Offer a wheel event to the tools, then to the navigation."""
        any(tool.wheel(event) for tool in self._all_tools())

    def leave(self) -> None:
        """Notify the tools of the cursor leaving, except during a drag."""
        if self._holder is None:
            for tool in self._tools:
                tool.leave()

    def cancel(self) -> bool:
        """Cancel the operations of the tools; True if there were any."""
        done = any(tool.cancel() for tool in self._tools)
        if done:
            self._holder = None
        return done

    def abandon(self, event: QtGui.QMouseEvent) -> None:
        """Cancel the drag in progress; one of the camera ends where it is."""
        holder, self._holder = self._holder, None
        if holder is self._navigation:
            holder.release(event)
        elif holder is not None:
            self.cancel()

    def finish(self) -> bool:
        """Finish an outline of several clicks; True if there was one."""
        return any(tool.finish() for tool in self._tools)

    def _all_tools(self) -> tuple[MouseTool, ...]:
        return (*self._tools, self._navigation)

    def _hover(self, event: QtGui.QMouseEvent) -> None:
        """Offer a move; tools after the accepting one are notified of leaving."""
        taken = False
        for tool in self._tools:
            if taken:
                tool.leave()
            else:
                taken = tool.move(event)
        if not taken:
            self._viewport.unsetCursor()
