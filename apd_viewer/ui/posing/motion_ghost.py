"""Ghost of the handles at the end of a typed motion."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QColor, QPainter, QPen

from apd_viewer.errors import InputError
from apd_viewer.geometry.pose.constraints import HANDLE, transform
from apd_viewer.geometry.pose.transforms import rigid_transform
from apd_viewer.presentation.palette import handle_color
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.state import State
from apd_viewer.session.posing.motion import AmountKind, Motion, MotionReference
from apd_viewer.session.session import Session
from apd_viewer.ui.posing.motion_field import MotionField
from apd_viewer.ui.scene.ghost import PatchGhost
from apd_viewer.ui.scene.navigation import MouseTool
from apd_viewer.ui.scene.viewport import Viewport
from apd_viewer.ui.tools.active_parts import ActiveParts
from apd_viewer.ui.tools.canvas import Canvas
from apd_viewer.ui.tools.polylines import draw_polyline, to_polygon, with_opacity

_DOT = 4.5  # radius in pixels
_SECTOR = 64  # opacity, from 0 to 255
_DASHES = [6.0, 4.0]  # lengths in line widths


class MotionGhost(MouseTool):
    """Translucent handles at the end of a motion; ignores the mouse."""

    def __init__(self, viewport: Viewport) -> None:
        super().__init__()
        self._viewport = viewport
        self.patches = PatchGhost(viewport)
        self.traces: list[tuple[tuple[int, int, int], MotionTrace]] = []
        viewport.tools.insert(0, self)  # the first tool is drawn last, over the gizmo

    def show_motion(self, start: Document, documents: Sequence[Document], has_amount: bool = True) -> None:
        """Show the handles moved by a motion at its end, with their paths.

        Without an amount, show only the axes of their rotations.
        """
        end = documents[-1].handles
        moved = [k for k, handle in enumerate(start.handles) if not np.array_equal(handle.pose, end[k].pose)]
        self.traces = []
        patches = []
        for k in moved:
            ids, F = _handle_patch(start, k)
            poses = [document.handles[k].pose for document in documents]
            trace = motion_trace(start.initial_positions[ids], poses)
            trace = trace._replace(pivot=_pivot_on(trace.axis, MotionReference(start.relative_to_rest, k)))
            if not has_amount:
                self.traces.append((handle_color(k), trace._replace(path=trace.path[:1])))
                continue
            self.traces.append((handle_color(k), trace))
            patches.append((transform(poses[-1], start.initial_positions[ids]), F, handle_color(k)))
        self._show_patches(patches)
        self._viewport.tool_layer.update()

    def hide(self) -> None:
        """Hide the ghost."""
        if self.traces or len(self.patches.vertices):
            self.traces = []
            self.patches.hide()
            self._viewport.tool_layer.update()

    def show_handles(self, document: Document) -> None:
        """Show all handles at their positions in a document, without paths."""
        self.traces, patches = [], []
        for k, handle in enumerate(document.handles):
            ids, F = _handle_patch(document, k)
            if len(F):
                patches.append((transform(handle.pose, document.initial_positions[ids]), F, handle_color(k)))
        self._show_patches(patches)
        self._viewport.tool_layer.update()

    def _show_patches(self, patches: list[tuple[np.ndarray, np.ndarray, tuple[int, int, int]]]) -> None:
        if not patches:
            self.patches.hide()
            return
        sizes = [len(V) for V, _, _ in patches]
        starts = np.cumsum([0, *sizes[:-1]])
        self.patches.show(
            np.vstack([V for V, _, _ in patches]),
            np.vstack([F + start for (_, F, _), start in zip(patches, starts, strict=True)]),
            np.repeat(np.array([color for *_, color in patches], dtype=np.uint8), sizes, axis=0),
        )

    def paint(self, painter: QPainter) -> None:
        """Draw axis and pivot, the path with a dot at its end, and the swept sector."""
        ink, halo = ("#ffffff", "#14161a") if self._viewport.is_dark else ("#14161a", "#ffffff")
        for color, trace in self.traces:
            corners = np.vstack([trace.path, trace.axis_with_pivot])
            if not len(trace.path) or not self._is_in_front(corners):
                continue
            if len(trace.axis):
                _draw_sector(painter, self._project(np.vstack([trace.axis.mean(axis=0), trace.path])), color)
                _draw_axis(painter, self._project(trace.axis_with_pivot), QColor(ink), halo)
                _draw_dots(painter, self._project(trace.pivot), QColor(halo), ink)
            if len(trace.path) > 1:
                _draw_path(painter, self._project(trace.path), QColor(ink), halo)

    def _project(self, points: np.ndarray) -> np.ndarray:
        return self._viewport.camera_controller.camera.project(points)

    def _is_in_front(self, points: np.ndarray) -> bool:
        eye = self._viewport.camera_controller.camera
        return bool((eye.depth(points) > 1e-6 * eye.distance).all())


def _handle_patch(document: Document, k: int) -> tuple[np.ndarray, np.ndarray]:
    """Vertex indices (n,) of handle ``k``, and its triangles (m, 3) into them."""
    mine = document.labels == HANDLE + k
    ids, place = np.flatnonzero(mine), np.cumsum(mine) - 1
    F = document.mesh.F
    return ids, place[F[mine[F].all(axis=1)]]


def _draw_sector(painter: QPainter, at: np.ndarray, color: tuple[int, int, int]) -> None:
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(QColor(*color, _SECTOR))
    painter.drawPolygon(to_polygon(at))


def _draw_axis(painter: QPainter, at: np.ndarray, color: QColor, halo: str) -> None:
    painter.setPen(QPen(with_opacity(halo), 3.0))
    painter.drawLine(QPointF(*at[0]), QPointF(*at[1]))
    pen = QPen(color, 1.4)
    pen.setDashPattern(_DASHES)
    painter.setPen(pen)
    painter.drawLine(QPointF(*at[0]), QPointF(*at[1]))


def _draw_path(painter: QPainter, at: np.ndarray, color: QColor, halo: str) -> None:
    draw_polyline(painter, at, color, 2.2, halo)
    _draw_dots(painter, at[-1:], color, halo)


def _draw_dots(painter: QPainter, at: np.ndarray, color: QColor, rim: str) -> None:
    painter.setPen(QPen(with_opacity(rim), 1.5))
    painter.setBrush(color)
    for point in at:
        painter.drawEllipse(QPointF(*point), _DOT, _DOT)
    painter.setBrush(Qt.BrushStyle.NoBrush)


# Radians; smaller angles count as no rotation, as their axis is ill-defined.
_STILL = 1e-9
# Fraction of the fastest vertex's speed: a slower centre is near the axis, and its path almost a point.
_CENTRAL = 0.5
# Distance of the traced point from the centre, relative to the fastest vertex: on the surface, the path
# would be hard to see.
_ASIDE = 1.6
# Half the drawn length of the axis, in radii of the handle.
_AXIS = 1.8
# Largest distance of a pivot from its axis, in drawn lengths of the axis.
_ON_AXIS = 1e-3


class MotionTrace(NamedTuple):
    """Path of a point of a handle, and the axis of its rotation.

    Attributes
    ----------
    path : (k, 3) float array
        Empty without a motion.
    axis : (2, 3) float array
        End points of the axis beside the path; (0, 3) without a rotation.
    pivot : (1, 3) float array
        Centre of base or handle that the axis leads through; otherwise (0, 3).
    """

    path: np.ndarray
    axis: np.ndarray
    pivot: np.ndarray = np.empty((0, 3))

    @property
    def axis_with_pivot(self) -> np.ndarray:
        """End points of the axis, extended to the pivot; (0, 3) without a rotation."""
        if not len(self.axis):
            return self.axis
        points = np.vstack([self.axis, self.pivot])
        heights = points @ (self.axis[1] - self.axis[0])
        return points[[heights.argmin(), heights.argmax()]]


def motion_trace(initial: np.ndarray, poses: Sequence[np.ndarray]) -> MotionTrace:
    """Path of a handle's centre, or of a point off a rotation axis through it.

    Parameters
    ----------
    initial : (n, 3) float array
        Vertices of the handle.
    poses : sequence of (4, 4) float arrays
        Along one rotation or one translation.
    """
    nothing = np.empty((0, 3))
    if len(poses) < 2:
        return MotionTrace(nothing, nothing)
    step = poses[1] @ np.linalg.inv(poses[0])
    path = np.array([transform(pose, _tracer(initial, poses[0], step)[None])[0] for pose in poses])
    size = float(np.linalg.norm(initial - initial.mean(axis=0), axis=1).max())
    return MotionTrace(path, _rotation_axis_ends(step, path[0], _AXIS * size))


def _tracer(initial: np.ndarray, pose: np.ndarray, step: np.ndarray) -> np.ndarray:
    centre: np.ndarray = initial.mean(axis=0)
    points = np.vstack([centre, initial])
    now = transform(pose, points)
    speed = np.linalg.norm(transform(step, now) - now, axis=1)
    if speed[0] >= _CENTRAL * speed.max():
        return centre
    fastest: np.ndarray = points[int(speed.argmax())]
    return centre + _ASIDE * (fastest - centre)


def _rotation_axis_ends(step: np.ndarray, point: np.ndarray, reach: float) -> np.ndarray:
    """End points of the axis of a small motion (4, 4), centred near ``point``."""
    rigid = rigid_transform(step, point)
    if rigid.angle < _STILL:
        return np.empty((0, 3))
    # The axis lies at cot(angle / 2) times half the chord of the point's path from the chord's midpoint.
    across = rigid.displacement - (rigid.displacement @ rigid.axis) * rigid.axis
    middle = point + 0.5 * (across + np.cross(rigid.axis, across) / np.tan(rigid.angle / 2.0))
    return np.array([middle - reach * rigid.axis, middle + reach * rigid.axis])


def _pivot_on(axis: np.ndarray, at: MotionReference) -> np.ndarray:
    """Centre of base or handle on an axis, nearer to its middle; (0, 3) if none is."""
    if not len(axis):
        return np.empty((0, 3))
    along, base = axis[1] - axis[0], at.document.base_centre
    centres = np.array([at.pivot] if base is None else [at.pivot, base])
    aside = np.linalg.norm(np.cross(centres - axis[0], along), axis=1)
    centres = centres[aside <= _ON_AXIS * float(along @ along)]
    return centres[np.argsort(np.linalg.norm(centres - axis.mean(axis=0), axis=1))[:1]]


class MotionPreview:
    """Preview of the active handle after a motion, while it is typed.

    It also shows the requested positions of handles stopped by contact, and the targets while the first shape
    waits for its kernels.
    """

    def __init__(self, canvas: Canvas, field: MotionField, session: Session, parts: ActiveParts) -> None:
        self._canvas, self._field = canvas, field
        self._session, self._parts = session, parts
        self.ghost, self.requested_ghost = MotionGhost(canvas.viewport), MotionGhost(canvas.viewport)
        field.edited.connect(self._preview)
        field.editing_ended.connect(self.ghost.hide)

    def follow_document(self, old: State | None, new: State) -> None:
        """Update the preview for a changed document, while an amount is being typed."""
        if self._field.amount.hasFocus() and old is not None and old.document is not new.document:
            self._field.request_preview()

    def show_requested_positions(self) -> None:
        """Show handle positions that are requested but not reached, as under contact."""
        state = self._session.store.state
        if state is None:
            return
        stopped = state.frame.share_reached < 1.0 and state.frame.settled
        if stopped or self._session.store.is_previewing:
            self.requested_ghost.show_handles(state.document)
        else:
            self.requested_ghost.hide()

    def _preview(self, motion: Motion, text: str, to: bool) -> None:
        if (state := self._session.store.state) is None:
            return
        try:
            turns = motion.kind.amount is AmountKind.ANGLE  # about an axis to be shown before any amount
            planned = text if text.strip() or not turns else motion.kind.example
            step = self._session.handles.plan_motion(
                motion, planned, self._parts.handle, self._canvas.bend_line, to and planned is text
            )
            way = step.intermediate_documents(state.document)
        except InputError as error:
            self.ghost.hide()
            self._field.show_error_later(str(error) if text.strip() else "")
        else:
            self._field.show_error_later("")
            self.ghost.show_motion(state.document, way, planned is text)
