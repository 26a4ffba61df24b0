"""Controller of the obstacles in scene, gizmo and panel."""

from collections.abc import Callable

import numpy as np
from PySide6.QtCore import QObject, QPointF, Qt, Signal
from PySide6.QtGui import QMouseEvent

from apd_viewer.errors import InputError
from apd_viewer.geometry.mesh.arrays import checked_direction, used_vertices
from apd_viewer.language import tr
from apd_viewer.presentation.plate_readings import FindConversion
from apd_viewer.session.model.named_obstacle import NamedObstacle, ObstacleKind
from apd_viewer.session.model.state import State
from apd_viewer.session.session import Session
from apd_viewer.ui.obstacles.obstacle_picker import ObstaclePicker
from apd_viewer.ui.obstacles.obstacle_scene import DrawnObstacle, ObstacleScene
from apd_viewer.ui.obstacles.obstacle_section import ObstacleSection
from apd_viewer.ui.obstacles.obstacle_shapes import ShapeExtent, axes_along, drawing_anchor
from apd_viewer.ui.scene.navigation import MouseTool
from apd_viewer.ui.scene.surface import Surface
from apd_viewer.ui.scene.viewport import Viewport
from apd_viewer.ui.tools.active_parts import ActiveParts
from apd_viewer.ui.tools.canvas import Canvas
from apd_viewer.ui.tools.gizmo import Gizmo
from apd_viewer.ui.tools.gizmo_drag import ARROWS, SQUARES, GizmoOrientation, nice_step
from apd_viewer.ui.tools.tool_modes import Tool

_ALONG_NORMAL, _FREELY = frozenset({"z"}), frozenset({*ARROWS, *SQUARES, "centre"})
_LATE = 2.0  # pixels by which an obstacle may lag before its requested position is outlined
_NUDGE = 5.0  # pixels, approximate


class ObstacleController(QObject):
    """Adds, draws, moves and lists the obstacles of a session.

    Parameters
    ----------
    section : ObstacleSection
        Of the panel.
    parts : ActiveParts
        Say which obstacle is in the hand.
    choose_tool : callable
        Puts a tool into the hand.
    cancel_drag : callable
        Function to cancel the current drag.
    wall_thickness : callable
        Thickness of the walls as typed, mesh units, or None.
    newtons : callable
        Conversion of the loads of a state into newtons, or None.

    Attributes
    ----------
    drag_moved : Signal()
        An obstacle is being dragged.
    availability_changed : Signal(bool, bool)
        Whether an obstacle is active, and whether it has been moved.
    """

    drag_moved = Signal()
    availability_changed = Signal(bool, bool)

    def __init__(
        self,
        canvas: Canvas,
        section: ObstacleSection,
        session: Session,
        parts: ActiveParts,
        choose_tool: Callable[[Tool], object],
        cancel_drag: Callable[[], bool],
        wall_thickness: Callable[[], float | None],
        newtons: FindConversion,
    ) -> None:
        super().__init__(canvas)
        self._newtons = newtons
        self._canvas, self._section, self._session, self._parts = canvas, section, session, parts
        self._take, self._give_up, self._thickness = choose_tool, cancel_drag, wall_thickness
        self._hot: int | None = None
        self._preview: NamedObstacle | None = None
        self._extent_of: tuple[np.ndarray, ShapeExtent] | None = None
        viewport, surface = canvas.viewport, canvas.surface
        self.scene = ObstacleScene(viewport)
        self.gizmo = Gizmo(viewport)
        self.picker = ObstaclePicker(viewport, surface, self.gizmo)
        self.placer = ObstaclePlacer(viewport, surface, self._propose)
        # Mouse events reach the picker only after the gizmo and the handle dots, drawn on top of obstacles.
        at = viewport.tools.index(canvas.picker)
        viewport.tools[at : at + 1] = [self.placer, canvas.picker, self.gizmo]
        viewport.tools.insert(viewport.tools.index(canvas.inactive_handles) + 1, self.picker)
        canvas.is_covered = self._covers
        self._connect()

    def _connect(self) -> None:
        self.gizmo.began.connect(self._session.gestures.begin)
        self.gizmo.began.connect(self.drag_moved)
        self.gizmo.moved.connect(self._drag)
        self.gizmo.ended.connect(self._release)
        self.gizmo.cancelled.connect(self._session.gestures.cancel)
        self.picker.chosen.connect(self._parts.choose_obstacle)
        self.picker.hovered.connect(self._hover)
        self.placer.previewed.connect(self._show_preview)
        self.placer.placed.connect(self._add)
        section, obstacles = self._section, self._session.obstacles
        section.list.chosen.connect(self._choose)
        section.list.renamed.connect(obstacles.rename)
        section.list.removed.connect(self.remove)
        section.fields.obstacle_entered.connect(self._replace)
        section.fields.distance_entered.connect(self._move_by)
        section.fields.reset_requested.connect(self.reset)
        section.contact_requested.connect(lambda: self._session.settings.set_contact(True, self._thickness()))
        self._parts.changed.connect(self.refresh)

    # Commands of the user

    def begin_placing(self, kind: ObstacleKind) -> None:
        """Let the next click on the surface place an obstacle."""
        if self._may_begin():
            self._take(Tool.MOVE)
            self._canvas.viewport.setFocus()  # the viewport handles Esc to cancel
            self.placer.begin_placing(kind)

    def add_floor(self) -> None:
        """Add a plate below the shape."""
        if self._may_begin():
            up = self._canvas.viewport.camera_controller.camera.up_axis.direction
            self._activate_new(self._session.obstacles.add_floor(up, self._thickness()))

    def add_plates(self, axis: int) -> None:
        """Add plates on both sides of the shape, along axis 0, 1 or 2."""
        if self._may_begin():
            self._activate_new(self._session.obstacles.add_plates(np.eye(3)[axis], self._thickness()))

    def remove(self, k: int | None = None) -> None:
        """Remove obstacle ``k``, or the active one."""
        k = self._parts.obstacle if k is None else k
        if self._may_begin() and k is not None:
            self._parts.remove_obstacle(k)

    def reset(self) -> None:
        """Move the active obstacle back to its initial place."""
        if self._may_begin() and self._parts.obstacle is not None:
            self._session.obstacles.reset(self._parts.obstacle)

    def nudge(self, step: tuple[int, int, int]) -> bool:
        """Move the active obstacle by a small step in the view; False without one."""
        k, state = self._parts.obstacle, self._session.store.state
        if k is None or state is None or self._canvas.tool is not Tool.MOVE:
            return False
        eye, obstacle = self._canvas.viewport.camera_controller.camera, state.document.obstacles[k]
        way = (np.array(step) * [1, 1, -1]) @ eye.axes
        if obstacle.kind is ObstacleKind.PLATE:  # moving a plate within its plane has no effect
            along = float(way @ obstacle.axis)
            way = np.sign(along) * obstacle.axis if abs(along) > 0.3 else np.zeros(3)
        length = nice_step(_NUDGE * eye.world_per_pixel(obstacle.centre))
        self._session.obstacles.move(k, length * way, is_repeat=True)
        return True

    def _may_begin(self) -> bool:
        self.placer.cancel()  # any other command cancels placing
        return self._session.store.state is not None and not self._give_up()

    # Placing new obstacles

    def _propose(
        self, kind: ObstacleKind, point: np.ndarray, outwards: np.ndarray, at_once: bool
    ) -> NamedObstacle:
        return self._session.obstacles.proposed_obstacle(kind, point, outwards, self._thickness(), at_once)

    def _add(self, obstacle: NamedObstacle) -> None:
        self._activate_new(self._session.obstacles.add(obstacle, self._thickness()))

    def _activate_new(self, k: int | None) -> None:
        """Make a new obstacle active and show it in the panel."""
        if k is not None:
            self._take(Tool.MOVE)
            self._parts.choose_obstacle(k)
            self._section.reveal()
            self._canvas.viewport.setFocus()  # the viewport handles the arrow keys for nudges

    def _show_preview(self, obstacle: NamedObstacle | None) -> None:
        self._preview = obstacle
        self.refresh()

    # Moving and editing obstacles

    def _drag(self, pose: np.ndarray) -> None:
        k, state = self._parts.obstacle, self._session.store.state
        if k is not None and state is not None and k < len(state.document.obstacles):
            start = drawing_anchor(state.document.obstacles[k], np.zeros(3), self._extent(state))
            self._session.obstacles.drag(k, pose[:3, 3] - start)

    def _release(self) -> None:
        if self._parts.obstacle is not None:
            self._session.obstacles.end_drag(self._parts.obstacle)
        self.refresh()

    def _choose(self, k: int) -> None:
        if self._canvas.tool is not Tool.MOVE:
            self._take(Tool.MOVE)
        self._parts.choose_obstacle(k)

    def _replace(self, obstacle: NamedObstacle) -> None:
        if self._parts.obstacle is None or not self._may_begin():
            return
        try:
            self._session.obstacles.replace(self._parts.obstacle, obstacle)
        except InputError as error:
            self._section.fields.show_error(str(error))

    def _move_by(self, along: int | None, text: str) -> None:
        k, state = self._parts.obstacle, self._session.store.state
        if k is None or state is None or not self._may_begin():
            return
        try:
            distance = self._session.typed_values.parse_length(text)
        except InputError as error:
            self._section.fields.show_distance_error(str(error))
            return
        way = checked_direction(state.document.obstacles[k].axis) if along is None else np.eye(3)[along]
        self._session.obstacles.move(k, distance * way)
        self._section.fields.finish_entry()

    # Display in scene, gizmo and panel

    def follow_tool(self, _tool: Tool) -> None:
        """Cancel placing and update the display after a change of tool."""
        self.placer.cancel()
        self.refresh()

    def refresh(self, *_: object) -> None:
        """Update scene, gizmo and panel from the session's state."""
        state = self._session.store.state
        if state is None:
            return
        active, obstacles = self._parts.obstacle, state.document.obstacles
        if not (obstacles or self.scene.drawn_obstacles or self._preview):
            return
        in_hand = active is not None and self._canvas.tool is Tool.MOVE
        self._canvas.is_handle_inactive = in_hand
        self.picker.enabled = self._canvas.tool is Tool.MOVE and self.placer.kind is None
        shown = [self._drawn_obstacle(state, k, in_hand) for k in range(len(obstacles))]
        self.picker.set_obstacles(shown, self._extent(state))
        if self._preview is not None:
            shown.append(DrawnObstacle(self._preview, np.zeros(3), is_chosen=True))
        self.scene.show_obstacles(shown, self._extent(state))
        self._place_gizmo(state, active if in_hand else None)
        self.availability_changed.emit(
            active is not None, active is not None and bool(obstacles[active].shift.any())
        )
        unit, values = self._session.store.unit, self._session.typed_values
        self._section.show_state(state, unit, active, values, self._newtons(state))

    def _drawn_obstacle(self, state: State, k: int, in_hand: bool) -> DrawnObstacle:
        obstacle, shift = state.document.obstacles[k], state.obstacle_shifts[k]
        behind = float(np.linalg.norm(obstacle.shift - shift))
        pixel = self._canvas.viewport.camera_controller.camera.world_per_pixel(obstacle.centre)
        asked = obstacle.shift if behind > _LATE * pixel and state.is_contact_active else None
        chosen = in_hand and k == self._parts.obstacle
        return DrawnObstacle(
            obstacle, shift, asked, chosen, k == self._hot, is_idle=not state.is_contact_active
        )

    def _place_gizmo(self, state: State, k: int | None) -> None:
        if k is not None:
            obstacle = state.document.obstacles[k]
            flat = obstacle.kind is ObstacleKind.PLATE
            pose = np.eye(4)
            if obstacle.kind is not ObstacleKind.SPHERE:
                pose[:3, :3] = axes_along(obstacle.axis).T
            pose[:3, 3] = drawing_anchor(obstacle, obstacle.shift, self._extent(state))
            self.gizmo.offered_handles = _ALONG_NORMAL if flat else _FREELY
            self.gizmo.orientation = GizmoOrientation.HANDLE if flat else self._canvas.gizmo.orientation
            self.gizmo.place(pose, np.zeros(3))
        if (k is not None) != self.gizmo.visible:
            self.gizmo.visible = k is not None

    def _hover(self, k: int | None) -> None:
        self._hot = k
        self.refresh()

    def _covers(self, position: QPointF) -> bool:
        """True if a sphere or cylinder hides the surface at a position."""
        return self.picker.obstacle_at(position, solid_only=True) is not None

    def _extent(self, state: State) -> ShapeExtent:
        """Bounding box of the mesh at rest, cached."""
        mesh = state.document.mesh
        if self._extent_of is None or self._extent_of[0] is not mesh.V:
            self._extent_of = mesh.V, ShapeExtent.from_points(mesh.V[used_vertices(mesh.F)])
        return self._extent_of[1]


HINTS = {
    ObstacleKind.PLATE: tr("Click the surface to put a plate there; Ctrl snaps to the axes, Esc cancels"),
    ObstacleKind.SPHERE: tr("Click the surface to put a sphere there; Ctrl snaps to the axes, Esc cancels"),
    ObstacleKind.CYLINDER: tr(
        "Click the surface to put a cylinder there; Ctrl snaps to the axes, Esc cancels"
    ),
}


class ObstaclePlacer(MouseTool, QObject):
    """Mouse tool to place an obstacle by a click on the surface; Esc cancels.

    Parameters
    ----------
    propose : callable
        ``propose(kind, point, outwards, at_once)``: the obstacle that would be put there.

    Attributes
    ----------
    kind : ObstacleKind or None
        Kind of the obstacle to place.
    prompt_changed : Signal(str)
        Instruction to the user; empty after placing or cancelling.
    previewed : Signal(object)
        The NamedObstacle under the cursor, or None.
    placed : Signal(object)
        The NamedObstacle where it was clicked.
    """

    prompt_changed = Signal(str)
    previewed = Signal(object)
    placed = Signal(object)

    def __init__(
        self,
        viewport: Viewport,
        surface: Surface,
        propose: Callable[[ObstacleKind, np.ndarray, np.ndarray, bool], NamedObstacle],
    ) -> None:
        super().__init__(viewport)
        self._viewport, self._surface, self._propose = viewport, surface, propose
        self.kind: ObstacleKind | None = None
        self._there = False  # True while a preview is shown

    def begin_placing(self, kind: ObstacleKind) -> None:
        """Start placing an obstacle of a kind at the next click."""
        self.kind = kind
        self.prompt_changed.emit(HINTS[kind])

    def press(self, event: QMouseEvent) -> bool:
        """Show the obstacle at the cursor, and grab the mouse to move it until release."""
        if self.kind is None or event.button() != Qt.MouseButton.LeftButton:
            return False
        return self._show(self._proposed_obstacle(event, at_once=True))

    def move(self, event: QMouseEvent) -> bool:
        """Preview the obstacle at the point under the cursor."""
        if self.kind is None:
            return False
        there = self._show(self._proposed_obstacle(event, at_once=True))
        if there:
            self._viewport.setCursor(Qt.CursorShape.CrossCursor)
        return there

    def release(self, event: QMouseEvent) -> None:
        """Place the obstacle under the cursor, unless it has left the surface."""
        obstacle = None if self.kind is None else self._proposed_obstacle(event, at_once=False)
        if obstacle is not None:
            self.cancel()
            self.placed.emit(obstacle)

    def leave(self) -> None:
        """Hide the preview when the cursor leaves the view."""
        self._show(None)

    def cancel(self) -> bool:
        """Cancel placing; True if it was in progress."""
        waited, self.kind = self.kind is not None, None
        if waited:
            self.prompt_changed.emit("")
        self.leave()
        return waited

    def _proposed_obstacle(self, event: QMouseEvent, at_once: bool) -> NamedObstacle | None:
        hit = self._surface.hit(event.position())
        if hit is None or self.kind is None:
            return None
        normal = hit.normal
        if event.modifiers() & Qt.KeyboardModifier.ControlModifier:
            along = int(np.argmax(np.abs(normal)))
            normal = np.copysign(1.0, normal[along]) * np.eye(3)[along]
        return self._propose(self.kind, hit.point, normal, at_once)

    def _show(self, obstacle: NamedObstacle | None) -> bool:
        if obstacle is not None or self._there:
            self._there = obstacle is not None
            self.previewed.emit(obstacle)
        return self._there
