"""The view of the mesh with its brush and its gizmo: shows states, says what the hand does."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QObject, QPointF, QRectF, Signal
from PySide6.QtGui import QColor
from PySide6.QtWidgets import QWidget

from apd_viewer.geometry.picking.preview_surface import Sketch
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE
from apd_viewer.language import tr
from apd_viewer.presentation.palette import BASE_COLOR, FREE_COLOR, REGION_COLORS, handle_color, label_colors
from apd_viewer.session.model.painted_part import Part
from apd_viewer.session.model.view import Standpoint, View
from apd_viewer.ui.scene.coloring import Coloring
from apd_viewer.ui.scene.framing import aside, facing, in_view, surroundings
from apd_viewer.ui.scene.surface import Surface
from apd_viewer.ui.scene.vertex_marks import Marks
from apd_viewer.ui.scene.viewport import Viewport
from apd_viewer.ui.tools.brush import Painter
from apd_viewer.ui.tools.click_tool import ClickSelector, Reach
from apd_viewer.ui.tools.gizmo import Gizmo
from apd_viewer.ui.tools.gizmo_drag import nice_step, translated
from apd_viewer.ui.tools.gizmo_layout import SIZE
from apd_viewer.ui.tools.inactive_handles import Pivot, Pivots
from apd_viewer.ui.tools.outline_tool import OutlineKind, OutlineSelector
from apd_viewer.ui.tools.point_picker import PointPicker
from apd_viewer.ui.tools.selection_tool import Act, Selector
from apd_viewer.ui.tools.slab_tool import SlabSelector
from apd_viewer.ui.tools.toolbox import Tool, Way
from apd_viewer.ui.widgets.theme import Theme

if TYPE_CHECKING:
    from apd_viewer.geometry.mesh.mesh import Mesh
    from apd_viewer.session.model.document import Document
    from apd_viewer.session.model.state import State


_NUDGE = 5.0  # pixels, about


class Canvas(QObject):
    """Puts surface, brush and gizmo into a viewport and keeps them in step with the state.

    Attributes
    ----------
    viewport : Viewport
        The widget.
    stroke_began : Signal()
    painted : Signal(object, int)
        Vertices, and the label that they are painted with.
    region_painted : Signal(object, int)
        Vertices, and the number of the region, from 1; 0 erases.
    stroke_ended : Signal(str)
        Name of the gesture.
    drag_began, gesture_cancelled, drag_ended : Signal()
    handle_moved : Signal(object)
        The (4, 4) pose of the active handle while the gizmo is dragged.
    handle_chosen : Signal(int)
        Another handle was pressed.
    coloring : Coloring
    line : (2, 3) float array or None
        Two points on the line to bend about.
    """

    stroke_began = Signal()
    painted = Signal(object, int)
    region_painted = Signal(object, int)
    stroke_ended = Signal(str)
    drag_began = Signal()
    gesture_cancelled = Signal()
    handle_moved = Signal(object)
    drag_ended = Signal()
    handle_chosen = Signal(int)

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.viewport = Viewport(parent)
        self.viewport.setAccessibleName(tr("3D view"))
        self.surface = Surface(self.viewport)
        self.painter = Painter(self.viewport, self.surface)
        self.ways = self._make_ways()
        self.gizmo = Gizmo(self.viewport)
        self.gizmo.grabs = self._grabs
        self.pivots = Pivots(self.viewport, self._handle_at)
        self.marks = Marks(self.viewport, self.surface)
        self.coloring = Coloring(self.surface, self.marks)
        self.picker = PointPicker(self.viewport, self.surface)
        self.viewport.tools[:] = [self.picker, self.gizmo, self.pivots, *self.ways.values(), self.marks]
        self.tool, self.way = Tool.ORBIT, Way.BRUSH
        self._handle = self._region = 0
        self._act = Act.ADD
        self._document: Document | None = None
        self._sketched: np.ndarray | None = None
        self.line: np.ndarray | None = None
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
            selector.stroke_began.connect(self._begin_stroke)
            selector.painted.connect(self._paint)
            selector.stroke_ended.connect(self._end_stroke)
            selector.stroke_cancelled.connect(self.gesture_cancelled)
            selector.previewed.connect(self.preview)
        self.gizmo.began.connect(self.drag_began)
        self.gizmo.moved.connect(self.handle_moved)
        self.gizmo.ended.connect(self.drag_ended)
        self.gizmo.ended.connect(self._show_tool)
        self.gizmo.cancelled.connect(self.gesture_cancelled)
        self.pivots.chosen.connect(self.handle_chosen)

    # Painting

    @property
    def part(self) -> Part:
        """What the tool in hand paints; the active handle where it paints nothing."""
        if self.tool is Tool.REGION:
            return Part(self._region + 1, is_region=True)
        return Part(BASE if self.tool is Tool.BASE else HANDLE + self._handle)

    def _begin_stroke(self, act: Act) -> None:
        self._act = act
        self.stroke_began.emit()
        if act is Act.REPLACE and self.tool is not Tool.ERASE and self._document is not None:
            self._emit(np.flatnonzero(self.part.of(self._document)), self.part.nothing)

    def choose_vertices(self, ids: np.ndarray, act: Act) -> None:
        """Paint vertices at once, as a stroke of the tool in hand would."""
        self.preview(None)
        self._begin_stroke(act)
        self._paint(ids)
        self._end_stroke()

    def _paint(self, ids: np.ndarray) -> None:
        erases = self._act is Act.REMOVE or self.tool is Tool.ERASE
        if erases and not self.part.is_region:
            self._erase(ids)
        else:
            self._emit(ids, self.part.nothing if erases else self.part.code)

    def _emit(self, ids: np.ndarray, code: int) -> None:
        (self.region_painted if self.part.is_region else self.painted).emit(ids, code)

    def _end_stroke(self) -> None:
        erased = self._act is Act.REMOVE
        self.stroke_ended.emit((Tool.ERASE if erased else self.tool).words.title)

    def _erase(self, ids: np.ndarray) -> None:
        """Base and handle go first; where there is neither, and the tool is no other brush, the region."""
        if self._document is None:
            return
        held = self._document.labels[ids] != FREE
        if held.any():
            self.painted.emit(ids[held], FREE)
        if self.tool is Tool.ERASE and not held.all():
            self.region_painted.emit(ids[~held], 0)

    # Showing

    def take(self, tool: Tool) -> None:
        """Put ``tool`` into the hand."""
        self.tool = tool
        self._put_into_hand()

    def choose_way(self, way: Way) -> None:
        """Choose vertices in another way."""
        self.way = way
        self._put_into_hand()

    def select_through(self, on: bool) -> None:
        """Choose what the surface hides too, or only what is seen."""
        for selector in self.ways.values():
            if isinstance(selector, OutlineSelector):
                selector.through = on

    def _put_into_hand(self) -> None:
        for way, selector in self.ways.items():
            selector.enabled = self.tool.words.is_brush and way is self.way
        self._show_tool()

    def choose(self, handle: int, region: int) -> None:
        """Work on another handle and region, by their numbers."""
        if handle != self._handle:
            self.gizmo.cancel()
        self._handle, self._region = handle, region
        self._show_tool()

    def set_theme(self, theme: Theme) -> None:
        """Recolour the background."""
        self.viewport.set_theme(theme.canvas_top, theme.canvas_bottom)

    def sketch(self, mesh: Mesh, labels: np.ndarray) -> None:
        """Draw a mesh that is about to be opened; nothing of it can be touched yet."""
        self._sketched = mesh.V
        self.surface.set_mesh(Sketch(mesh.F), mesh.V, label_colors(labels))
        handle = mesh.V[labels == HANDLE]
        self.viewport.look.home()
        self._frame(handle.mean(axis=0) if len(handle) else None)

    def show_state(self, old: State | None, new: State, handle: int, region: int) -> None:
        """Show what differs between two states, with the active handle and region."""
        document, self._document = new.document, new.document
        self._handle, self._region = handle, region
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
            self.viewport.look.home()  # otherwise it has, and may have been turned since
            self.frame_mesh()

    def preview(self, ids: np.ndarray | None) -> None:
        """Tint what a press or a release would choose."""
        erases = self.ways[self.way].act is Act.REMOVE
        paint = self.painter.color
        self.coloring.preview(ids, FREE_COLOR if erases else (paint.red(), paint.green(), paint.blue()))

    def bring_into_view(self, vertices: np.ndarray, covered: QRectF) -> None:
        """Move the camera, no more than it takes, so that vertices are seen, all where none are named.

        ``covered`` is what cannot be seen of the viewport, at its lower right.
        """
        U, view = self.surface.U, self.viewport
        points = U[vertices] if len(vertices) else U
        low, high = U.min(axis=0), U.max(axis=0)
        if len(vertices):
            normals, size = self.surface.normals[vertices], float(np.linalg.norm(high - low))
            view.look.eye = facing(view.look.eye, points, normals, size, self.surface.distances)
        if not in_view(view.look.eye, points, covered):
            shift = aside(view.look.eye, covered)
            view.look.frame(surroundings(points, low, high), room=-sum(shift))
            view.look.eye = view.look.eye.panned(*shift)

    def nudged(self, step: tuple[int, int, int]) -> np.ndarray | None:
        """The pose of the active handle after a small step in the picture: right, up, to the viewer."""
        active, eye = _active(self._pivots, self._handle), self.viewport.look.eye
        if active is None:
            return None
        length = nice_step(_NUDGE * eye.world_per_pixel(active.centre))
        return translated(active.pose, length * (np.array(step) * [1, 1, -1]) @ eye.axes)

    def view(self, unit: str) -> View:
        """How the mesh is looked at, for a file."""
        eye = self.viewport.look.eye
        return View(
            Standpoint(_point(eye.position), _point(eye.focal), _point(eye.up), float(eye.angle)), unit
        )

    def look_as(self, view: View) -> None:
        """Look at the mesh as a file says."""
        if view.camera is not None:
            at = view.camera
            position, focal, up = np.array(at.position), np.array(at.focal), np.array(at.up)
            self.viewport.look.eye = replace(
                self.viewport.look.eye, position=position, focal=focal, up=up, angle=at.angle
            )

    def frame_mesh(self) -> None:
        """Show the whole mesh, and all of the gizmo."""
        active = _active(self._pivots, self._handle)
        self._frame(None if active is None else active.centre)

    def _frame(self, gizmo: np.ndarray | None) -> None:
        """Show the mesh, and all of a gizmo that stands at a point."""
        points, room = self.surface.U, np.zeros(len(self.surface.U))
        if gizmo is not None:
            points = np.vstack([points, gizmo])
            room = np.append(room, SIZE)
        self.viewport.look.frame(points, room)

    @property
    def _pivots(self) -> tuple[Pivot, ...]:
        return () if self._document is None else _pivots(self._document)

    def _show_tool(self) -> None:
        # While it paints nobody sees where the handles are, and every event moves their centres.
        pivots = self._pivots if self.tool is Tool.MOVE else ()
        active = _active(pivots, self._handle)
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
        """Number of the handle that is painted at a position in the viewport."""
        hit = self.surface.hit(position)
        if hit is None or self._document is None or self.surface.skin is None:
            return None
        label = int(self._document.labels[self.surface.skin.F[hit.face]].max())
        return label - HANDLE if label >= HANDLE else None


def _point(x: np.ndarray) -> tuple[float, float, float]:
    return float(x[0]), float(x[1]), float(x[2])


def _pivots(document: Document) -> tuple[Pivot, ...]:
    """The handles that can be moved, and the centres of what they hold."""
    if document.problem is not None:
        return ()
    found = []
    for k, handle in enumerate(document.handles):
        gripped = document.pivot(k)
        if gripped is not None:
            found.append(Pivot(k, handle.name, handle_color(k), handle.pose, gripped))
    return tuple(found)


def _active(pivots: tuple[Pivot, ...], handle: int) -> Pivot | None:
    """The pivot of the handle with a number, if it can be moved."""
    return next((pivot for pivot in pivots if pivot.number == handle), None)
