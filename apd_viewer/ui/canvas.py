"""The view of the mesh with its brush and its gizmo: shows states, says what the hand does."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QObject, Signal
from PySide6.QtGui import QColor
from PySide6.QtWidgets import QWidget

from apd_viewer.geometry.constraints import HANDLE
from apd_viewer.session.document import State
from apd_viewer.ui.gizmo import Gizmo
from apd_viewer.ui.gizmo_geometry import SIZE
from apd_viewer.ui.painter import Painter
from apd_viewer.ui.palette import label_colors
from apd_viewer.ui.surface import Surface
from apd_viewer.ui.theme import Theme
from apd_viewer.ui.toolbox import Tool
from apd_viewer.ui.viewport import Viewport


class Canvas(QObject):
    """Puts surface, brush and gizmo into a viewport and keeps them in step with the state.

    Attributes
    ----------
    viewport : Viewport
        The widget.
    gesture_began, gesture_cancelled : Signal()
    painted : Signal(object, int)
        Vertices, and the label that they are painted with.
    stroke_ended : Signal(str)
        Name of the gesture.
    handle_moved : Signal(object)
        The (4, 4) pose while the gizmo is dragged.
    drag_ended : Signal()
    """

    gesture_began = Signal()
    gesture_cancelled = Signal()
    painted = Signal(object, int)
    stroke_ended = Signal(str)
    handle_moved = Signal(object)
    drag_ended = Signal()

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.viewport = Viewport(parent)
        self.surface = Surface(self.viewport)
        self.painter = Painter(self.viewport, self.surface)
        self.gizmo = Gizmo(self.viewport)
        self.viewport.tools[:] = [self.gizmo, self.painter]
        self.tool = Tool.ORBIT
        self._stroke = Tool.ORBIT
        self._movable = False
        self._connect()

    def _connect(self) -> None:
        self.painter.stroke_began.connect(self._begin_stroke)
        self.painter.painted.connect(lambda ids: self.painted.emit(ids, self._stroke.words.label))
        self.painter.stroke_ended.connect(lambda: self.stroke_ended.emit(self._stroke.words.title))
        self.painter.stroke_cancelled.connect(self.gesture_cancelled)
        self.gizmo.began.connect(self.gesture_began)
        self.gizmo.moved.connect(self.handle_moved)
        self.gizmo.ended.connect(self.drag_ended)
        self.gizmo.cancelled.connect(self.gesture_cancelled)

    def _begin_stroke(self, erase: bool) -> None:
        self._stroke = Tool.ERASE if erase else self.tool
        self.gesture_began.emit()

    def take(self, tool: Tool) -> None:
        """Put ``tool`` into the hand."""
        self.tool = tool
        self.painter.enabled = tool.words.label is not None
        if tool.words.color is not None:
            self.painter.color = QColor(*tool.words.color)
        self._show_gizmo()

    def set_theme(self, theme: Theme) -> None:
        """Recolour the background."""
        self.viewport.set_theme(theme.canvas_top, theme.canvas_bottom)

    def show_state(self, old: State | None, new: State) -> None:
        """Show what differs between two states."""
        document = new.document
        if old is None or old.document.mesh is not document.mesh:
            mesh = document.mesh
            self.surface.set_mesh(mesh.F, new.frame.U, label_colors(document.labels), mesh.joined_F)
            self.painter.set_topology(mesh.joined_F, len(mesh.V))
        else:
            if old.frame.U is not new.frame.U:
                self.surface.set_points(new.frame.U)
            if old.document.labels is not document.labels:
                self.surface.set_colors(label_colors(document.labels))
        if old is None or old.document is not document:
            self._place_gizmo(new)
        if old is None or old.document.mesh is not document.mesh:
            self.viewport.look_home()
            self.frame_mesh()

    def frame_mesh(self) -> None:
        """Show the whole mesh, and all of the gizmo."""
        points, room = self.surface.U, np.zeros(len(self.surface.U))
        if self._movable:
            points = np.vstack([points, self.gizmo.frame.centre])
            room = np.append(room, SIZE)
        self.viewport.frame(points, room)

    def _place_gizmo(self, state: State) -> None:
        document = state.document
        self._movable = document.problem is None
        if self._movable:
            self.gizmo.place(document.pose, document.grip[document.labels == HANDLE].mean(axis=0))
        self._show_gizmo()

    def _show_gizmo(self) -> None:
        visible = self.tool is Tool.MOVE and self._movable
        if visible != self.gizmo.visible:
            self.gizmo.visible = visible
