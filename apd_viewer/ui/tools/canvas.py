"""Canvas with the mesh in a viewport and the mouse tools."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QObject, QPointF, QRectF, Signal
from PySide6.QtGui import QColor
from PySide6.QtWidgets import QWidget

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.picking.preview_surface import PreviewSurface
from apd_viewer.geometry.pose.constraints import HANDLE
from apd_viewer.language import tr
from apd_viewer.presentation.palette import BASE_COLOR, FREE_COLOR, REGION_COLORS, handle_color, label_colors
from apd_viewer.session.model.up_axis import UpAxis, standing_axis
from apd_viewer.session.model.view import CameraPose, View
from apd_viewer.ui.preferences.preferences import UpAxes, user_file
from apd_viewer.ui.scene.camera import centring_shift, is_in_view, surrounding_box, unobstructed_camera
from apd_viewer.ui.scene.camera_controller import CameraController
from apd_viewer.ui.scene.coloring import Coloring, VertexMarks
from apd_viewer.ui.scene.surface import Surface
from apd_viewer.ui.scene.viewport import Viewport
from apd_viewer.ui.tools.brush_tool import BrushTool
from apd_viewer.ui.tools.click_tool import ClickExtent, ClickTool, PointPicker
from apd_viewer.ui.tools.gizmo import Gizmo, HandlePivot, InactiveHandles, movable_pivots
from apd_viewer.ui.tools.gizmo_drag import GIZMO_RADIUS, nice_step, translated_pose
from apd_viewer.ui.tools.orientation_axes import OrientationAxes
from apd_viewer.ui.tools.outline_tool import OutlineKind, OutlineTool, SlabTool
from apd_viewer.ui.tools.selection_tool import SelectionStrokes, SelectionTool, StrokeEffect
from apd_viewer.ui.tools.tool_modes import SelectionMode, Tool
from apd_viewer.ui.widgets.theme import Theme

if TYPE_CHECKING:
    from apd_viewer.session.model.document import Document
    from apd_viewer.session.model.state import State

_NUDGE = 5.0  # approximate pixels per arrow key press


class Canvas(QObject):
    """Viewport with surface and tools, updated to the session's state.

    Parameters
    ----------
    up_axes : UpAxes
        Of the meshes, as remembered.

    Attributes
    ----------
    viewport : Viewport
        The widget.
    handle_moved : Signal(object)
        The (4, 4) pose of the active handle while the gizmo is dragged.
    handle_chosen : Signal(int)
        Another handle was pressed.
    bend_line : (2, 3) float array or None
        Two points on the line to bend about.
    is_covered : callable
        Whether something else is in front of the surface at a position in the viewport.
    """

    drag_began = Signal()
    gesture_cancelled = Signal()
    handle_moved = Signal(object)
    drag_ended = Signal()
    handle_chosen = Signal(int)

    def __init__(self, parent: QWidget, up_axes: UpAxes) -> None:
        super().__init__(parent)
        self._up_axes = up_axes
        self.viewport = Viewport(parent)
        self.viewport.setAccessibleName(tr("3D view"))
        self.surface = Surface(self.viewport)
        self.view = MeshView(self.viewport.camera_controller, self.surface)
        self.strokes = SelectionStrokes(self)
        self.brush = BrushTool(self.viewport, self.surface)
        self.selectors = self._make_selectors()
        self.gizmo = Gizmo(self.viewport)
        self.gizmo.may_grab = self._may_grab
        self.inactive_handles = InactiveHandles(self.viewport, self.gizmo, self._handle_at)
        self.marks = VertexMarks(self.viewport, self.surface)
        self.coloring = Coloring(self.surface, self.marks)
        self.picker = PointPicker(self.viewport, self.surface)
        self.orientation = OrientationAxes(self.viewport)
        self.viewport.tools[:] = [
            self.orientation,
            self.picker,
            self.gizmo,
            self.inactive_handles,
            *self.selectors.values(),
            self.marks,
        ]
        self.tool, self.selection_mode = Tool.ORBIT, SelectionMode.BRUSH
        self._handle = self._region = 0
        self._document: Document | None = None
        self._sketched: np.ndarray | None = None
        self.bend_line: np.ndarray | None = None
        self.is_covered: Callable[[QPointF], bool] = lambda _: False
        self._rests = False
        self._connect()

    def _make_selectors(self) -> dict[SelectionMode, SelectionTool]:
        stage = self.viewport, self.surface
        return {
            SelectionMode.BRUSH: self.brush,
            SelectionMode.BOX: OutlineTool(*stage, OutlineKind.BOX),
            SelectionMode.LASSO: OutlineTool(*stage, OutlineKind.LASSO),
            SelectionMode.POLYGON: OutlineTool(*stage, OutlineKind.POLYGON),
            SelectionMode.FILL: ClickTool(*stage, ClickExtent.CREASE),
            SelectionMode.PIECE: ClickTool(*stage, ClickExtent.COMPONENT),
            SelectionMode.LOOP: ClickTool(*stage, ClickExtent.LOOP),
            SelectionMode.SLAB: SlabTool(*stage),
        }

    def _connect(self) -> None:
        for selector in self.selectors.values():
            self.strokes.connect_tool(selector)
            selector.stroke_cancelled.connect(self.gesture_cancelled)
            selector.previewed.connect(self.preview_selection)
        self.gizmo.began.connect(self.drag_began)
        self.gizmo.moved.connect(self.handle_moved)
        self.gizmo.ended.connect(self.drag_ended)
        self.gizmo.ended.connect(self._show_tool)
        self.gizmo.cancelled.connect(self.gesture_cancelled)
        self.inactive_handles.chosen.connect(self.handle_chosen)

    def choose_tool(self, tool: Tool) -> None:
        """Make ``tool`` the active tool."""
        self.tool = tool
        self._apply_tool()

    def choose_mode(self, mode: SelectionMode) -> None:
        """Set the selection mode of the painting tools."""
        self.selection_mode = mode
        self._apply_tool()

    def set_selects_hidden_vertices(self, on: bool) -> None:
        """Set whether outlines also select vertices behind other surfaces."""
        for selector in self.selectors.values():
            if isinstance(selector, OutlineTool):
                selector.selects_hidden_vertices = on

    def _apply_tool(self) -> None:
        self._prepare_strokes()
        for way, selector in self.selectors.items():
            selector.enabled = self.tool.traits.is_brush and way is self.selection_mode
        self._show_tool()

    def _prepare_strokes(self) -> None:
        self.strokes.prepare(self.tool, self._handle, self._region, self._document)

    def set_active_parts(self, handle: int, region: int) -> None:
        """Set the active handle and region by their numbers."""
        if handle != self._handle:
            self.gizmo.cancel()
        self._handle, self._region = handle, region
        self._prepare_strokes()
        self._show_tool()

    @property
    def is_handle_inactive(self) -> bool:
        """True while an obstacle is active instead; all handles are then drawn as dots."""
        return self._rests

    @is_handle_inactive.setter
    def is_handle_inactive(self, on: bool) -> None:
        if on != self._rests:
            self._rests = on
            self._show_tool()

    def set_theme(self, theme: Theme) -> None:
        """Recolour the background."""
        self.viewport.set_theme(theme.canvas_top, theme.canvas_bottom)

    def show_loading_mesh(self, mesh: Mesh, labels: np.ndarray) -> None:
        """Draw a mesh whose file is still loading, read-only."""
        self._sketched = mesh.V
        self.surface.set_mesh(PreviewSurface(mesh.F), mesh.V, label_colors(labels))
        handle = mesh.V[labels == HANDLE]
        self.viewport.camera_controller.set_up_axis(self._up_axes.up_axis_of(mesh))
        self.view.frame_mesh(handle.mean(axis=0) if len(handle) else None)

    def show_state(self, old: State | None, new: State, handle: int, region: int) -> None:
        """Update the view from one state to the next, with the active parts."""
        document, self._document = new.document, new.document
        self._handle, self._region = handle, region
        self._prepare_strokes()
        if old is None or old.document.mesh is not document.mesh:
            self._show_mesh(new)
            if old is None or old.document.mesh.F is not document.mesh.F:  # a baked mesh needs no framing
                self._show_whole(document)
        else:
            if old.frame.U is not new.frame.U:
                self.surface.set_points(new.frame.U)
            self.coloring.follow_document(document)
        if old is not None and old.document.initial_positions is not document.initial_positions:
            self.gizmo.cancel()  # the drag refers to the previous initial positions
        if old is None or old.document is not document:
            self._show_tool()

    def _show_mesh(self, state: State) -> None:
        self.viewport.mouse.cancel()
        self.surface.set_mesh(state.surface_index, state.frame.U, self.coloring.begin_mesh(state.document))

    def _show_whole(self, document: Document) -> None:
        self.brush.size.mesh_radius = self.bend_line = None  # both refer to the previous mesh
        self.picker.marked_points = np.empty((0, 3))
        sketched, self._sketched = self._sketched, None
        if sketched is None or not np.array_equal(sketched, document.mesh.V):
            # A mesh shown while opening is already framed, and the user may have moved the camera since.
            self.viewport.camera_controller.set_up_axis(self._up_axes.up_axis_of(document.mesh))
            self.frame_mesh()

    def preview_selection(self, ids: np.ndarray | None) -> None:
        """Tint the vertices of a selection preview; None removes the tint."""
        erases = self.selectors[self.selection_mode].effect is StrokeEffect.REMOVE
        if ids is not None:
            ids = self.strokes.changeable_vertices(ids, erases or self.tool is Tool.ERASE)
        paint = self.brush.color
        self.coloring.preview(ids, FREE_COLOR if erases else (paint.red(), paint.green(), paint.blue()))

    def nudged_pose(self, step: tuple[int, int, int]) -> np.ndarray | None:
        """Pose of the active handle after a small step right, up or to the viewer."""
        active, eye = _movable_pivot(self._pivots, self._handle), self.viewport.camera_controller.camera
        if active is None:
            return None
        length = nice_step(_NUDGE * eye.world_per_pixel(active.centre))
        return translated_pose(active.pose, length * (np.array(step) * [1, 1, -1]) @ eye.axes)

    def frame_mesh(self) -> None:
        """Frame the whole mesh and the gizmo."""
        active = _movable_pivot(self._pivots, self._handle)
        self.view.frame_mesh(None if active is None else active.centre)

    def show_standard_view(self, name: str) -> None:
        """Frame the mesh from 'front', 'side' or 'top'; prefix '-' gives the opposite."""
        self.viewport.camera_controller.show_standard_view(name)
        self.frame_mesh()

    @property
    def likely_up_axis(self) -> UpAxis | None:
        """Up axis for which the mesh would stand; None if one is chosen or already used."""
        document, eye = self._document, self.viewport.camera_controller.camera
        if document is None or user_file(document.mesh) is None:
            return None
        if self._up_axes.known_axis(document.mesh) is not None:
            return None
        axis = standing_axis(document.mesh)
        return None if axis is eye.up_axis else axis

    def set_up_axis(self, axis: UpAxis) -> None:
        """Set and store the up axis of the mesh, and frame it."""
        if self._document is not None:
            self._up_axes.set_up_axis(self._document.mesh, axis)
        self.viewport.camera_controller.set_up_axis(axis)
        self.frame_mesh()

    @property
    def _pivots(self) -> tuple[HandlePivot, ...]:
        return () if self._document is None else movable_pivots(self._document)

    def _show_tool(self) -> None:
        # Only the Move tool shows pivots; while painting, every event would move the handle centres.
        pivots = self._pivots if self.tool is Tool.MOVE else ()
        active = None if self._rests else _movable_pivot(pivots, self._handle)
        if active is not None:
            self.gizmo.place(active.pose, active.unposed_position)
        if (active is not None) != self.gizmo.visible:
            self.gizmo.visible = active is not None
        self.inactive_handles.set_pivots([pivot for pivot in pivots if pivot is not active])
        colors = {
            Tool.BASE: BASE_COLOR,
            Tool.HANDLE: handle_color(self._handle),
            Tool.REGION: REGION_COLORS[self._region],
            Tool.ERASE: FREE_COLOR,
        }
        if self.tool in colors:
            for selector in self.selectors.values():
                selector.color = QColor(*colors[self.tool])

    def _may_grab(self, position: QPointF) -> bool:
        return self._handle_at(position) == self._handle

    def _handle_at(self, position: QPointF) -> int | None:
        """Number of the painted handle at a position in the viewport, or None."""
        hit = self.surface.hit(position)
        if (
            hit is None
            or self._document is None
            or self.surface.surface_index is None
            or self.is_covered(position)
        ):
            return None
        label = int(self._document.labels[self.surface.surface_index.F[hit.face]].max())
        return label - HANDLE if label >= HANDLE else None


def _movable_pivot(pivots: tuple[HandlePivot, ...], handle: int) -> HandlePivot | None:
    """Pivot of the given handle, or None if it cannot be moved."""
    return next((pivot for pivot in pivots if pivot.number == handle), None)


class MeshView:
    """Camera moves to the mesh or to parts of it."""

    def __init__(self, camera_controller: CameraController, surface: Surface) -> None:
        self._look, self._surface = camera_controller, surface

    def frame_mesh(self, gizmo: np.ndarray | None) -> None:
        """Frame the whole mesh, and a gizmo centred at a point (3,)."""
        points, room = self._surface.U, np.zeros(len(self._surface.U))
        if gizmo is not None:
            points = np.vstack([points, gizmo])
            room = np.append(room, GIZMO_RADIUS)
        self._look.frame(points, overlays=room)

    def show_vertices(self, vertices: np.ndarray, covered: QRectF) -> None:
        """Show vertices with the smallest camera move; all vertices if none are given.

        ``covered`` is the hidden part of the viewport, at its lower right.
        """
        U, look = self._surface.U, self._look
        points = U[vertices] if len(vertices) else U
        low, high = U.min(axis=0), U.max(axis=0)
        if len(vertices):
            normals, size = self._surface.arrays.normals[vertices], float(np.linalg.norm(high - low))
            look.camera = unobstructed_camera(look.camera, points, normals, size, self._surface.distances)
        if not is_in_view(look.camera, points, covered):
            shift = centring_shift(look.camera, covered)
            look.frame(surrounding_box(points, low, high), padding=-sum(shift))
            look.camera = look.camera.panned(*shift)

    def saved_view(self, unit: str) -> View:
        """Camera, up axis and length unit as a view for a file."""
        eye = self._look.camera
        stand = CameraPose(_point(eye.position), _point(eye.focal), _point(eye.up), float(eye.angle))
        return View(stand, unit, up_axis=eye.up_axis)

    def restore(self, view: View) -> None:
        """Restore the camera and the up axis from a saved view, if present."""
        if view.up_axis is not None:
            self._look.camera = replace(self._look.camera, up_axis=view.up_axis)
        if view.camera is not None:
            at = view.camera
            position, focal, up = np.array(at.position), np.array(at.focal), np.array(at.up)
            self._look.camera = replace(
                self._look.camera, position=position, focal=focal, up=up, angle=at.angle
            )


def _point(x: np.ndarray) -> tuple[float, float, float]:
    return float(x[0]), float(x[1]), float(x[2])
