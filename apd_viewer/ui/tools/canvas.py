"""Canvas: the mesh in a viewport, with its tools."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QObject, QPointF, Signal
from PySide6.QtGui import QColor
from PySide6.QtWidgets import QWidget

from apd_viewer.geometry.picking.preview_surface import Sketch
from apd_viewer.geometry.pose.constraints import HANDLE
from apd_viewer.language import tr
from apd_viewer.presentation.palette import BASE_COLOR, FREE_COLOR, REGION_COLORS, handle_color, label_colors
from apd_viewer.ui.scene.coloring import Coloring
from apd_viewer.ui.scene.surface import Surface
from apd_viewer.ui.scene.vertex_marks import Marks
from apd_viewer.ui.scene.viewport import Viewport
from apd_viewer.ui.tools.brush import Painter
from apd_viewer.ui.tools.click_tool import ClickSelector, Reach
from apd_viewer.ui.tools.gizmo import Gizmo
from apd_viewer.ui.tools.gizmo_drag import nice_step, translated
from apd_viewer.ui.tools.inactive_handles import Pivot, Pivots, movable
from apd_viewer.ui.tools.mesh_view import MeshView
from apd_viewer.ui.tools.outline_tool import OutlineKind, OutlineSelector
from apd_viewer.ui.tools.point_picker import PointPicker
from apd_viewer.ui.tools.selection_tool import Act, Selector
from apd_viewer.ui.tools.slab_tool import SlabSelector
from apd_viewer.ui.tools.strokes import Strokes
from apd_viewer.ui.tools.toolbox import Tool, Way
from apd_viewer.ui.widgets.theme import Theme

if TYPE_CHECKING:
    from collections.abc import Callable

    from apd_viewer.geometry.mesh.mesh import Mesh
    from apd_viewer.session.model.document import Document
    from apd_viewer.session.model.state import State
    from apd_viewer.session.model.up_axis import UpAxis
    from apd_viewer.ui.preferences.up_axes import UpAxes


_NUDGE = 5.0  # pixels, about


class Canvas(QObject):
    """Puts surface and tools into a viewport and follows the state.

    Parameters
    ----------
    parent : QWidget
    up_axes : UpAxes
        Of the meshes, as remembered.

    Attributes
    ----------
    viewport : Viewport
        The widget.
    strokes : Strokes
    view : MeshView
    drag_began, gesture_cancelled, drag_ended : Signal()
    handle_moved : Signal(object)
        The (4, 4) pose of the active handle while the gizmo is dragged.
    handle_chosen : Signal(int)
        Another handle was pressed.
    coloring : Coloring
    line : (2, 3) float array or None
        Two points on the line to bend about.
    covered : callable
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
        self.view = MeshView(self.viewport.look, self.surface)
        self.strokes = Strokes(self)
        self.painter = Painter(self.viewport, self.surface)
        self.ways = self._make_ways()
        self.gizmo = Gizmo(self.viewport)
        self.gizmo.grabs = self._grabs
        self.pivots = Pivots(self.viewport, self.gizmo, self._handle_at)
        self.marks = Marks(self.viewport, self.surface)
        self.coloring = Coloring(self.surface, self.marks)
        self.picker = PointPicker(self.viewport, self.surface)
        self.viewport.tools[:] = [self.picker, self.gizmo, self.pivots, *self.ways.values(), self.marks]
        self.tool, self.way = Tool.ORBIT, Way.BRUSH
        self._handle = self._region = 0
        self._document: Document | None = None
        self._sketched: np.ndarray | None = None
        self.line: np.ndarray | None = None
        self.covered: Callable[[QPointF], bool] = lambda _: False
        self._rests = False
        self._connect()

    def _make_ways(self) -> dict[Way, Selector]:
        stage = self.viewport, self.surface
        return {
            Way.BRUSH: self.painter,
            Way.BOX: OutlineSelector(*stage, OutlineKind.BOX),
            Way.LASSO: OutlineSelector(*stage, OutlineKind.LASSO),
            Way.POLYGON: OutlineSelector(*stage, OutlineKind.POLYGON),
            Way.FILL: ClickSelector(*stage, Reach.CREASE),
            Way.PIECE: ClickSelector(*stage, Reach.PIECE),
            Way.LOOP: ClickSelector(*stage, Reach.LOOP),
            Way.SLAB: SlabSelector(*stage),
        }

    def _connect(self) -> None:
        for selector in self.ways.values():
            self.strokes.follow(selector)
            selector.stroke_cancelled.connect(self.gesture_cancelled)
            selector.previewed.connect(self.preview)
        self.gizmo.began.connect(self.drag_began)
        self.gizmo.moved.connect(self.handle_moved)
        self.gizmo.ended.connect(self.drag_ended)
        self.gizmo.ended.connect(self._show_tool)
        self.gizmo.cancelled.connect(self.gesture_cancelled)
        self.pivots.chosen.connect(self.handle_chosen)

    def take(self, tool: Tool) -> None:
        """Use ``tool``."""
        self.tool = tool
        self._put_into_hand()

    def choose_way(self, way: Way) -> None:
        """Choose vertices in another way."""
        self.way = way
        self._put_into_hand()

    def select_through(self, on: bool) -> None:
        """Select hidden vertices too, or only visible ones."""
        for selector in self.ways.values():
            if isinstance(selector, OutlineSelector):
                selector.through = on

    def _put_into_hand(self) -> None:
        self._prepare_strokes()
        for way, selector in self.ways.items():
            selector.enabled = self.tool.words.is_brush and way is self.way
        self._show_tool()

    def _prepare_strokes(self) -> None:
        self.strokes.prepare(self.tool, self._handle, self._region, self._document)

    def choose(self, handle: int, region: int) -> None:
        """Work on another handle and region, by their numbers."""
        if handle != self._handle:
            self.gizmo.cancel()
        self._handle, self._region = handle, region
        self._prepare_strokes()
        self._show_tool()

    @property
    def handle_rests(self) -> bool:
        """True while something else is in the hand: all handles are dots."""
        return self._rests

    @handle_rests.setter
    def handle_rests(self, on: bool) -> None:
        if on != self._rests:
            self._rests = on
            self._show_tool()

    def set_theme(self, theme: Theme) -> None:
        """Recolour the background."""
        self.viewport.set_theme(theme.canvas_top, theme.canvas_bottom)

    def sketch(self, mesh: Mesh, labels: np.ndarray) -> None:
        """Draw a mesh still being opened, not yet editable."""
        self._sketched = mesh.V
        self.surface.set_mesh(Sketch(mesh.F), mesh.V, label_colors(labels))
        handle = mesh.V[labels == HANDLE]
        self.viewport.look.stand(self._up_axes.of(mesh))
        self.view.frame(handle.mean(axis=0) if len(handle) else None)

    def show_state(self, old: State | None, new: State, handle: int, region: int) -> None:
        """Show the differences between two states, and the active parts."""
        document, self._document = new.document, new.document
        self._handle, self._region = handle, region
        self._prepare_strokes()
        if old is None or old.document.mesh is not document.mesh:
            self._show_mesh(new)
            if old is None or old.document.mesh.F is not document.mesh.F:  # a baked mesh is where it was
                self._show_whole(document)
        else:
            if old.frame.U is not new.frame.U:
                self.surface.set_points(new.frame.U)
            self.coloring.follow(document)
        if old is not None and old.document.grip is not document.grip:
            self.gizmo.cancel()  # what it held is no longer what is there
        if old is None or old.document is not document:
            self._show_tool()

    def _show_mesh(self, state: State) -> None:
        self.viewport.mouse.cancel()
        self.surface.set_mesh(state.skin, state.frame.U, self.coloring.begin(state.document))

    def _show_whole(self, document: Document) -> None:
        self.painter.size.length = self.line = None  # they were of another mesh
        self.picker.shown = np.empty((0, 3))
        sketched, self._sketched = self._sketched, None
        if sketched is None or not np.array_equal(sketched, document.mesh.V):
            # Otherwise it has, and may have been turned since.
            self.viewport.look.stand(self._up_axes.of(document.mesh))
            self.frame_mesh()

    def preview(self, ids: np.ndarray | None) -> None:
        """Tint the vertices of a possible selection."""
        erases = self.ways[self.way].act is Act.REMOVE
        if ids is not None:
            ids = self.strokes.within_reach(ids, erases or self.tool is Tool.ERASE)
        paint = self.painter.color
        self.coloring.preview(ids, FREE_COLOR if erases else (paint.red(), paint.green(), paint.blue()))

    def nudged(self, step: tuple[int, int, int]) -> np.ndarray | None:
        """Pose of the active handle after a small step: right, up, to the viewer."""
        active, eye = _active(self._pivots, self._handle), self.viewport.look.eye
        if active is None:
            return None
        length = nice_step(_NUDGE * eye.world_per_pixel(active.centre))
        return translated(active.pose, length * (np.array(step) * [1, 1, -1]) @ eye.axes)

    def frame_mesh(self) -> None:
        """Show the whole mesh, and all of the gizmo."""
        active = _active(self._pivots, self._handle)
        self.view.frame(None if active is None else active.centre)

    def look_along(self, axis: str) -> None:
        """Show the whole mesh from 'front', 'side' or 'top', '-' for the opposite."""
        self.viewport.look.along(axis)
        self.frame_mesh()

    def stand(self, axis: UpAxis) -> None:
        """Show the mesh with another axis up, and remember it."""
        if self._document is not None:
            self._up_axes.choose(self._document.mesh, axis)
        self.viewport.look.stand(axis)
        self.frame_mesh()

    @property
    def _pivots(self) -> tuple[Pivot, ...]:
        return () if self._document is None else movable(self._document)

    def _show_tool(self) -> None:
        # While it paints nobody sees where the handles are, and every event moves their centres.
        pivots = self._pivots if self.tool is Tool.MOVE else ()
        active = None if self._rests else _active(pivots, self._handle)
        if active is not None:
            self.gizmo.place(active.pose, active.gripped)
        if (active is not None) != self.gizmo.visible:
            self.gizmo.visible = active is not None
        self.pivots.place([pivot for pivot in pivots if pivot is not active])
        colors = {
            Tool.BASE: BASE_COLOR,
            Tool.HANDLE: handle_color(self._handle),
            Tool.REGION: REGION_COLORS[self._region],
            Tool.ERASE: FREE_COLOR,
        }
        if self.tool in colors:
            for selector in self.ways.values():
                selector.color = QColor(*colors[self.tool])

    def _grabs(self, position: QPointF) -> bool:
        return self._handle_at(position) == self._handle

    def _handle_at(self, position: QPointF) -> int | None:
        """Number of the handle painted at a position in the viewport."""
        hit = self.surface.hit(position)
        if hit is None or self._document is None or self.surface.skin is None or self.covered(position):
            return None
        label = int(self._document.labels[self.surface.skin.F[hit.face]].max())
        return label - HANDLE if label >= HANDLE else None


def _active(pivots: tuple[Pivot, ...], handle: int) -> Pivot | None:
    """The pivot of the handle with a number, if it can be moved."""
    return next((pivot for pivot in pivots if pivot.number == handle), None)
