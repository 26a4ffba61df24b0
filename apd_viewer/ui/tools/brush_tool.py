"""Brush tool, with strokes on the surface as vertex sets."""

from collections.abc import Iterator

import numpy as np
from PySide6.QtCore import QObject, QPointF, Qt, Signal
from PySide6.QtGui import QMouseEvent, QPainter, QPen, QPolygonF, QWheelEvent

from apd_viewer.ui.scene.pointing import brush_share, wheel_notches
from apd_viewer.ui.scene.surface import Hit, Surface
from apd_viewer.ui.scene.viewport import Viewport
from apd_viewer.ui.tools.selection_tool import SelectionTool, may_begin_stroke, stroke_effect

RADIUS_PER_NOTCH = 1.12
RING_POINTS = 65
STEEPEST_STEP = 4.0  # hits farther apart than this multiple of their screen distance are not joined
_NEAR_MISS = 16.0  # px: a press this close beside the surface still paints
_AROUND = [QPointF(_NEAR_MISS * np.cos(a), _NEAR_MISS * np.sin(a)) for a in np.pi / 4 * np.arange(8)]


class BrushTool(SelectionTool):
    """Brush to paint vertices by strokes.

    A left press on the surface begins a stroke; the wheel changes the radius, or zooms with Ctrl; Esc cancels
    the stroke. ``painted`` is emitted with the vertices covered by the stroke for the first time.

    Attributes
    ----------
    missed : Signal()
        A press closely beside the surface, which moves the camera.
    """

    missed = Signal()

    def __init__(self, viewport: Viewport, surface: Surface) -> None:
        super().__init__(viewport, surface)
        self.size = BrushSize(viewport)
        self._covered: np.ndarray | None = None  # vertices covered so far, (n,) bool; None between strokes
        self._cursor: QPointF | None = None
        self._hit: Hit | None = None
        self._share = 1.0  # of the radius, by the pressure of a pen
        self._seen: tuple[object, ...] = ()  # camera and shape at the latest hit test

    def press(self, event: QMouseEvent) -> bool:
        """Begin a stroke if the cursor is on the surface."""
        if not may_begin_stroke(event):
            return False
        self._update_hit(event)
        if self._hit is None:
            if self._enabled and any(self._surface.hit(event.position() + way) for way in _AROUND):
                self.missed.emit()
            return False
        self._covered = np.zeros(len(self._surface.U), dtype=bool)
        self.stroke_began.emit(self.effect)
        self._cover([(None, self._hit)], [self._share])
        return True

    def move(self, event: QMouseEvent) -> bool:
        """Continue the stroke, or show the brush ring."""
        if self._covered is None:
            self._update_hit(event)
            if self._hit is not None:
                self._viewport.setCursor(Qt.CursorShape.CrossCursor)
            return self._hit is not None
        last, hit, self._cursor = self._cursor, self._hit, event.position()
        share, self._share = self._share, brush_share(event)
        steps = list(self._steps(last or self._cursor, hit, self._cursor))
        self._hit = steps[-1][1]
        self._seen = self._view_key
        self._cover(steps, np.linspace(share, self._share, len(steps) + 1)[1:].tolist())
        self._viewport.tool_layer.update()
        return True

    def release(self, _event: QMouseEvent) -> None:
        """End the stroke."""
        if self._covered is None:
            return
        self._covered = None
        self.stroke_ended.emit()

    def wheel(self, event: QWheelEvent) -> bool:
        """Change the radius."""
        if not self._enabled or event.modifiers() & Qt.KeyboardModifier.ControlModifier:
            return False
        self.size.scale_radius(RADIUS_PER_NOTCH ** wheel_notches(event))
        return True

    def leave(self) -> None:
        """Hide the ring."""
        if self._covered is None and self._cursor is not None:
            self._cursor = self._hit = None
            self._viewport.tool_layer.update()

    def cancel(self) -> bool:
        """Cancel the stroke; True if there was one."""
        if self._covered is None:
            return False
        self._covered = None
        self.stroke_cancelled.emit()
        return True

    def paint(self, painter: QPainter) -> None:
        """Draw the ring of the brush on the surface."""
        if self._cursor is not None and self._seen != self._view_key:
            self._pick()  # the mesh or camera has moved under a resting cursor
        if self._hit is None:
            return
        ring = QPolygonF(
            [QPointF(x, y) for x, y in self._viewport.camera_controller.camera.project(self._ring(self._hit))]
        )
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.setPen(QPen(self._halo, 4.2))
        painter.drawPolyline(ring)
        painter.setPen(QPen(self._color, 2.0, self._pen_style))
        painter.drawPolyline(ring)

    def _update_hit(self, event: QMouseEvent) -> None:
        """Update the hit under the cursor; redraw the ring if needed."""
        before = self._hit, self.effect
        self._cursor = event.position() if self._enabled else None
        self.effect, self._share = stroke_effect(event), brush_share(event)
        self._pick()
        if self._hit is not None or before[0] is not None:
            self._viewport.tool_layer.update()

    def _pick(self) -> None:
        self._hit = None if self._cursor is None else self._surface.hit(self._cursor)
        self._seen = self._view_key

    def _steps(
        self, start: QPointF, last: Hit | None, end: QPointF
    ) -> Iterator[tuple[Hit | None, Hit | None]]:
        """Pairs of consecutive hits along the cursor's path, closely spaced.

        The first hit of a pair is None if the surface under the cursor jumps to another depth: the part in
        between was never touched.
        """
        way = end - start
        count = max(1, int(np.ceil(np.hypot(way.x(), way.y()) / self.size.dab_spacing(last, self._share))))
        spacing = np.hypot(way.x(), way.y()) / count
        for i in range(1, count + 1):
            hit = self._surface.hit(start + way * (i / count))
            joined = last is not None and hit is not None and self._are_near(last, hit, spacing)
            yield (last if joined else None), hit
            last = hit

    def _are_near(self, a: Hit, b: Hit, spacing: float) -> bool:
        reach = (
            STEEPEST_STEP
            * max(spacing, 1.0)
            * self._viewport.camera_controller.camera.world_per_pixel(b.point)
        )
        return bool(np.linalg.norm(b.point - a.point) <= reach)

    def _cover(self, steps: list[tuple[Hit | None, Hit | None]], shares: list[float]) -> None:
        """Emit the vertices newly covered by the steps, each with a share of the radius."""
        if self._covered is None:
            return
        fresh = []
        for (last, hit), share in zip(steps, shares, strict=True):
            if hit is not None:
                ids = self._vertices_under(hit if last is None else last, hit, share)
                fresh.append(ids[~self._covered[ids]])
                self._covered[ids] = True
        covered = np.concatenate(fresh) if fresh else np.empty(0, dtype=np.int32)
        if len(covered):
            self.vertices_painted.emit(covered)

    def _vertices_under(self, last: Hit, hit: Hit, share: float) -> np.ndarray:
        skin = self._surface.picking_index
        assert skin is not None
        radius = share * self.size.radius_on_mesh(hit)
        return skin.vertices_under_brush(
            self._surface.U, (hit.face, last.face), last.point, hit.point, radius
        )

    def _ring(self, hit: Hit) -> np.ndarray:
        """Circle (65, 3) around the hit in the tangent plane of the surface."""
        a = np.cross(hit.normal, np.eye(3)[np.argmin(np.abs(hit.normal))])
        a /= np.linalg.norm(a)
        b = np.cross(hit.normal, a)
        turn = np.linspace(0.0, 2 * np.pi, RING_POINTS)
        return hit.point + self._share * self.size.radius_on_mesh(hit) * (
            np.outer(np.cos(turn), a) + np.outer(np.sin(turn), b)
        )


SMALLEST_RADIUS, LARGEST_RADIUS, DEFAULT_RADIUS = 4.0, 200.0, 24.0


class BrushSize(QObject):
    """Radius of the brush, fixed either in pixels or in mesh units.

    Attributes
    ----------
    changed : Signal()
        The radius is another one, or in another unit.
    """

    changed = Signal()

    def __init__(self, viewport: Viewport) -> None:
        super().__init__(viewport)
        self._viewport = viewport
        self._radius = DEFAULT_RADIUS
        self._mesh_radius: float | None = None

    @property
    def radius(self) -> float:
        """Radius of the brush in logical pixels, from 4 to 200."""
        return self._radius

    @radius.setter
    def radius(self, radius: float) -> None:
        radius = float(np.clip(radius, SMALLEST_RADIUS, LARGEST_RADIUS))
        if radius != self._radius or self._mesh_radius is not None:
            self._radius, self._mesh_radius = radius, None
            self._announce_change()

    def set_radius(self, radius: float) -> None:
        """Set the radius in pixels."""
        self.radius = radius

    @property
    def mesh_radius(self) -> float | None:
        """Radius in mesh units, independent of the zoom; None if set in pixels."""
        return self._mesh_radius

    @mesh_radius.setter
    def mesh_radius(self, radius: float | None) -> None:
        if radius != self._mesh_radius:
            self._mesh_radius = radius
            self._announce_change()

    def scale_radius(self, factor: float) -> None:
        """Multiply the radius by a factor."""
        if self._mesh_radius is None:
            self.radius = self._radius * factor
        else:
            self.mesh_radius = self._mesh_radius * factor

    def radius_on_mesh(self, hit: Hit) -> float:
        """Radius in mesh units at a hit."""
        if self._mesh_radius is not None:
            return self._mesh_radius
        return self._radius * self._viewport.camera_controller.camera.world_per_pixel(hit.point)

    def dab_spacing(self, hit: Hit | None, share: float = 1.0) -> float:
        """Largest spacing of dabs without a gap, in pixels, at a share of the radius."""
        if self._mesh_radius is None or hit is None:
            return max(share * self._radius / 2, SMALLEST_RADIUS)
        length = self._viewport.camera_controller.camera.world_per_pixel(hit.point)
        return max(share * self._mesh_radius / (2 * length), 1.0)

    def _announce_change(self) -> None:
        self._viewport.tool_layer.update()
        self.changed.emit()
