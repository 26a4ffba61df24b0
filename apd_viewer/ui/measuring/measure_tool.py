"""Mouse tools for picking surface points, planes and openings, to measure."""

import numpy as np
from PySide6.QtCore import QObject, QPointF, Qt, Signal
from PySide6.QtGui import QMouseEvent, QPainter, QWheelEvent

from apd_viewer.geometry.measuring.measurement import MeasurementResult, Plane
from apd_viewer.geometry.measuring.measurement_kind import MeasurementKind
from apd_viewer.geometry.measuring.surface_point import SurfacePoint, point_positions
from apd_viewer.geometry.measuring.vessel import vessel_openings
from apd_viewer.geometry.mesh.hole_caps import Caps
from apd_viewer.language import tr
from apd_viewer.session.model.document import Document
from apd_viewer.ui.scene.navigation import MouseTool
from apd_viewer.ui.scene.pointing import WheelSteps
from apd_viewer.ui.scene.surface import Surface
from apd_viewer.ui.scene.viewport import Viewport
from apd_viewer.ui.tools.polylines import CAP, draw_labels, draw_lines, fill_contours
from apd_viewer.ui.tools.selection_tool import may_begin_stroke


class MeasureTool(MouseTool, QObject):
    """Tool for picking as many surface points as a measurement needs.

    Attributes
    ----------
    axis : int
        0, 1 or 2: what the plane of a section is perpendicular to.
    picked : Signal(object, object)
        All is there: a tuple of SurfacePoint and None, or an empty one and a Plane.
    """

    picked = Signal(object, object)
    axis_changed = Signal(int)

    def __init__(self, viewport: Viewport, surface: Surface) -> None:
        super().__init__(viewport)
        self._viewport, self._surface = viewport, surface
        self._kind = MeasurementKind.DISTANCE
        self._enabled = False
        self._points: list[SurfacePoint] = []
        self._under: SurfacePoint | None = None  # point under the cursor
        self.axis = 1
        self._wheel = WheelSteps()

    @property
    def kind(self) -> MeasurementKind:
        """Kind of the next measurement."""
        return self._kind

    @kind.setter
    def kind(self, kind: MeasurementKind) -> None:
        self.cancel()
        self._kind = kind

    @property
    def enabled(self) -> bool:
        """True while the tool is active."""
        return self._enabled

    @enabled.setter
    def enabled(self, on: bool) -> None:
        self.cancel()
        self._enabled = on

    @property
    def points(self) -> np.ndarray:
        """Positions (k, 3) of the clicked points and the point under the cursor."""
        skin = self._surface.picking_index
        places = [*self._points, *([] if self._under is None else [self._under])]
        if skin is None or not places or not self._enabled:
            return np.empty((0, 3))
        return point_positions(places, self._surface.U, skin.F)

    @property
    def plane(self) -> Plane | None:
        """Plane through the point under the cursor, of a section or a fill level."""
        points = self.points
        if self._kind.points or not len(points):
            return None
        up = self._viewport.camera_controller.camera.up_axis.direction
        normal = np.eye(3)[self.axis] if self._kind is MeasurementKind.SECTION else up
        x, y, z = normal.tolist()
        return Plane((x, y, z), float(points[-1] @ normal))

    def press(self, event: QMouseEvent) -> bool:
        """Show the point under the cursor; a drag can still move it."""
        if not self._enabled or not may_begin_stroke(event):
            return False
        self._update_hit(event.position())
        return self._under is not None

    def move(self, event: QMouseEvent) -> bool:
        """Show the point under the cursor."""
        if not self._enabled:
            return False
        self._update_hit(event.position())
        if self._under is not None:
            self._viewport.setCursor(Qt.CursorShape.CrossCursor)
        return self._under is not None

    def release(self, event: QMouseEvent) -> None:
        """Add the point; emit ``picked`` once all points are there."""
        self._update_hit(event.position())
        if self._under is None:
            return
        if (plane := self.plane) is not None:
            self.picked.emit((), plane)
            return
        self._points.append(self._under)
        if len(self._points) == self._kind.points:
            points, self._points = tuple(self._points), []
            self.picked.emit(points, None)

    def wheel(self, event: QWheelEvent) -> bool:
        """Switch to the next axis of the section plane."""
        if not self._enabled or self._kind is not MeasurementKind.SECTION:
            return False
        if event.modifiers() & Qt.KeyboardModifier.ControlModifier:
            return False
        if steps := self._wheel.take(event):
            self.axis = (self.axis - steps) % 3
            self._viewport.tool_layer.update()
            self.axis_changed.emit(self.axis)
        return True

    def leave(self) -> None:
        """Hide the point under the cursor."""
        if self._under is not None:
            self._under = None
            self._viewport.tool_layer.update()

    def cancel(self) -> bool:
        """Discard the points clicked so far; True if there were any."""
        there, self._points = bool(self._points), []
        self._under = None
        self._viewport.tool_layer.update()
        return there

    def _update_hit(self, position: QPointF) -> None:
        hit = self._surface.hit(position)
        self._under = None
        if hit is not None:
            a, b, c = self._surface.barycentric_weights(hit).tolist()
            self._under = SurfacePoint(hit.face, (a, b, c))
        self._viewport.tool_layer.update()


_NEAR = 9.0  # px between the cursor and a border that it points at


class OpeningTool(MouseTool, QObject):
    """Tool for clicking an opening to close it, or to open it again.

    Attributes
    ----------
    clicked : Signal(object)
        Vertices at the border of the clicked opening, (k,) int array.
    """

    clicked = Signal(object)

    def __init__(self, viewport: Viewport, surface: Surface, tool: MeasureTool) -> None:
        super().__init__(viewport)
        self._viewport, self._surface, self._tool = viewport, surface, tool
        self._document: Document | None = None
        self._F: np.ndarray | None = None  # of the mesh with the openings
        self._openings: Caps | None = None
        self._under: int | None = None  # opening under the cursor

    def show_document(self, document: Document) -> None:
        """Show the openings of a document, and those that count as closed."""
        self._document = document
        self._viewport.tool_layer.update()

    def press(self, event: QMouseEvent) -> bool:
        """Take a press at an opening."""
        return may_begin_stroke(event) and self.move(event)

    def move(self, event: QMouseEvent) -> bool:
        """Show the opening under the cursor."""
        self._under = self._opening_at(event.position())
        if self._under is not None:
            self._viewport.setCursor(Qt.CursorShape.PointingHandCursor)
            self._viewport.tool_layer.update()
        return self._under is not None

    def release(self, event: QMouseEvent) -> None:
        """Emit ``clicked`` at an opening."""
        self._under = self._opening_at(event.position())
        if self._under is not None and (openings := self._shown_openings()) is not None:
            self.clicked.emit(np.split(openings.ends[:, 0], openings.start[1:])[self._under])

    def leave(self) -> None:
        """Hide the opening under the cursor."""
        self._under = None
        self._viewport.tool_layer.update()

    def paint(self, painter: QPainter) -> None:
        """Draw the borders of the openings, and caps over the closed ones."""
        openings, document = self._shown_openings(), self._document
        if openings is None or document is None:
            return
        eye = self._viewport.camera_controller.camera
        is_closed = openings.at(np.array(document.closed_openings, dtype=np.int64))
        for k, segments in enumerate(np.split(self._surface.U[openings.ends], openings.start[1:])):
            (start, stop), middle = segments.transpose(1, 0, 2), segments[:, 0].mean(axis=0)
            rightmost = start[np.argmax(eye.project(start)[:, 0])]
            outwards = np.cross(stop - start, middle - start)
            border = MeasurementResult((), segments, outwards, rightmost, middle)
            if is_closed[k]:
                fill_contours(painter, eye, segments, CAP)
            draw_lines(painter, eye, border, chosen=not is_closed[k])
            if k == self._under:
                said = tr("Closed: click to open") if is_closed[k] else tr("Open: click to close")
                draw_labels(painter, eye, [(border, [said], True)])

    def _shown_openings(self) -> Caps | None:
        """Openings of the mesh while fill levels are measured; None without any."""
        active = self._tool.enabled and self._tool.kind is MeasurementKind.FILL_LEVEL
        if not active or self._document is None or self._surface.picking_index is None:
            return None
        mesh = self._document.mesh
        if self._F is not mesh.joined_F:  # also once its seams are welded
            self._F, self._openings = mesh.joined_F, vessel_openings(mesh.V, mesh.joined_F)
        return self._openings if len(self._surface.U) == len(mesh.V) else None

    def _opening_at(self, position: QPointF) -> int | None:
        """Nearest opening with its border near a position and not behind the surface."""
        if (openings := self._shown_openings()) is None:
            return None
        eye = self._viewport.camera_controller.camera
        p, q = self._surface.U[openings.ends.T]
        start, stop = eye.project(p), eye.project(q)
        at, along = np.array([position.x(), position.y()]), stop - start
        share = np.einsum("ij,ij->i", at - start, along) / np.maximum(
            np.einsum("ij,ij->i", along, along), 1e-9
        )
        share = np.clip(share, 0.0, 1.0)[:, None]
        nearest = p + share * (q - p)
        away = np.linalg.norm(start + share * along - at, axis=1)
        depth, hit = eye.depth(nearest), self._surface.hit(position)
        hidden = np.inf if hit is None else float(eye.depth(hit.point[None])[0])
        room = 2.0 * _NEAR * eye.world_per_pixel(nearest[int(np.argmin(away))])
        away[(depth <= 0.0) | (depth > hidden + room)] = np.inf
        edge = int(np.argmin(away))
        return int(np.searchsorted(openings.start, edge, "right")) - 1 if away[edge] < _NEAR else None
