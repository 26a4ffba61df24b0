"""Changes of the document and its parts by shortcuts, menus and panel."""

from collections.abc import Callable

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.pose.constraints import BASE, HANDLE
from apd_viewer.language import tr
from apd_viewer.session.model.document_parts import PaintedPart
from apd_viewer.session.model.handles_and_regions import PartFlags
from apd_viewer.session.part_operations import PartOperation
from apd_viewer.session.posing.motion import Motion
from apd_viewer.session.session import Session
from apd_viewer.ui.overlays.text_entries import TextEntries
from apd_viewer.ui.panel.panel import Panel
from apd_viewer.ui.tools.active_parts import ActiveParts
from apd_viewer.ui.tools.canvas import Canvas
from apd_viewer.ui.tools.tool_modes import Tool


class EditController:
    """Commands to change the document; during a drag most only cancel the drag.

    Parameters
    ----------
    choose_tool : callable
        Chooses a tool.

    Attributes
    ----------
    nudge_obstacle : callable, returns False if no obstacle is in the hand
    stop_placing : callable, gives up waiting for the place of an obstacle
    show_timeline : callable, shows the steps of a motion
    """

    def __init__(
        self,
        canvas: Canvas,
        panel: Panel,
        session: Session,
        parts: ActiveParts,
        choose_tool: Callable[[Tool], None],
    ) -> None:
        self._canvas, self._panel = canvas, panel
        self._session, self._parts, self._take = session, parts, choose_tool
        self.nudge_obstacle: Callable[[tuple[int, int, int]], bool] = lambda _: False
        self.stop_placing: Callable[[], object] = lambda: None
        self.show_timeline: Callable[[], object] = lambda: None
        self.text_entries = TextEntries(canvas, session, parts, self.cancel_drag)
        handles = panel.handles
        handles.reset_all_requested.connect(self.reset_all)
        handles.reset_handle_requested.connect(self.reset_handle)
        handles.motion.motion_entered.connect(self.move_by)
        handles.motion.line_requested.connect(self.pick_line)
        handles.motion.choice.currentIndexChanged.connect(self._show_line)

    @property
    def _is_open(self) -> bool:
        return self._session.store.state is not None

    def _may_begin(self) -> bool:
        """True if a document is open and no drag was in progress; cancel such a drag."""
        return self._is_open and not self.cancel_drag()

    def cancel_drag(self) -> bool:
        """Cancel the mouse or slider drag in progress; True if there was one."""
        return self._canvas.viewport.mouse.cancel() or self._panel.cancel_slider_drag()

    # Undo, redo and reset

    def undo(self) -> None:
        """Undo the last step."""
        if self._may_step():
            self._session.gestures.undo()

    def redo(self) -> None:
        """Redo the last undone step."""
        if self._may_step():
            self._session.gestures.redo()

    def _may_step(self) -> bool:
        """True if steps may be undone; the placing of an obstacle is cancelled."""
        self.stop_placing()
        self._canvas.picker.cancel()
        return self._may_begin()

    def go_to_step(self, steps: int) -> None:
        """Undo or redo until ``steps`` steps of the history are done."""
        if self._may_step():
            self._session.gestures.go_to_step(steps)

    def reset_all(self) -> None:
        """Reset all handles and return the mesh to its rest shape."""
        if self._is_open:
            self.cancel_drag()
            self._session.shapes.restore()

    def bake(self) -> None:
        """Make the displayed shape the rest shape."""
        if self._may_begin():
            self._session.shapes.bake()

    # Adding and selecting parts

    def add_handle(self) -> None:
        """Add a handle and select its brush."""
        if self._is_open:
            self._parts.add_handle()
            self._take(Tool.HANDLE)

    def activate_next_handle(self) -> None:
        """Activate the next handle."""
        if self._is_open:
            self._parts.activate_next_handle()

    def add_region(self) -> None:
        """Add a region and select its brush."""
        if self._is_open:
            self._parts.add_region()
            self._take(Tool.REGION)

    def edit_part(self, operation: PartOperation) -> None:
        """Apply an operation to the whole part of the current tool."""
        if self._may_begin():
            self._session.painting.apply_operation(self._canvas.strokes.part, operation)

    def open_vertex_entry(self) -> None:
        """Open a card to select vertices by ID or coordinates."""
        if self._is_open:
            self.text_entries.open_entry(self.text_entries.vertices)

    def open_brush_entry(self) -> None:
        """Open a card to enter the brush radius."""
        if self._is_open:
            if not self._canvas.tool.traits.is_brush:
                self._take(Tool.HANDLE)
            self.text_entries.open_brush_entry()

    # Motion of the active handle

    def reset_handle(self) -> None:
        """Reset the active handle to its rest position."""
        if self._may_begin():
            self._session.handles.reset_handle(self._parts.handle)

    def nudge(self, step: tuple[int, int, int]) -> None:
        """Move the handle or obstacle a small step right, up or towards the viewer."""
        may = self._may_begin() and not self.nudge_obstacle(step)
        if may and (pose := self._canvas.nudged_pose(step)) is not None:
            self._session.handles.set_pose(pose, self._parts.handle, tr("Nudge handle"), is_repeat=True)

    def move_by(self, motion: Motion, text: str, is_total: bool) -> None:
        """Move the active handle by a typed motion, or show an error in the field."""
        if not self._is_open:
            return
        field, handles = self._panel.handles.motion, self._session.handles
        asked = motion, text, self._parts.handle, self._canvas.bend_line, is_total
        try:
            if (count := round(field.steps.value())) > 1:
                self._session.gestures.cancel()
                handles.play_motion(handles.plan_motion(*asked), count, self._session.player)
                self.show_timeline()
            else:
                handles.move_by(*asked)
        except InputError as error:
            field.show_error(str(error))
        else:
            field.finish_entry()

    # Pivot and bending axis

    def pick_pivot(self) -> None:
        """Let the next click on the mesh set the pivot of the active handle."""
        if self._may_begin():
            self._take(Tool.MOVE)
            self._canvas.picker.pick_points(
                1,
                lambda points: self._session.handles.set_pivot(points[0], self._parts.handle),
                tr("Click the point of the mesh to rotate the handle about; Esc cancels"),
            )

    def open_pivot_entry(self) -> None:
        """Choose the Move tool, and open a card to enter the coordinates of the pivot."""
        if self._is_open:
            self._take(Tool.MOVE)
            self.text_entries.open_entry(self.text_entries.pivot)

    def centre_pivot(self) -> None:
        """Move the pivot of the active handle to its centre."""
        if self._may_begin():
            self._session.handles.set_pivot(None, self._parts.handle)

    def pick_line(self) -> None:
        """Let the next two clicks on the mesh set the bending axis."""
        if self._may_begin():
            self._take(Tool.MOVE)
            words = tr("Click two points of the mesh to set the line to bend about")
            self._canvas.picker.pick_points(2, self._keep_line, words)

    def _keep_line(self, line: np.ndarray) -> None:
        self._canvas.bend_line = line
        self._show_line()
        self._panel.focus_motion_field()

    def _show_line(self) -> None:
        line = self._canvas.bend_line if self._panel.handles.motion.is_about_line else None
        self._canvas.picker.marked_points = np.empty((0, 3)) if line is None else line


class PartController:
    """Commands to clear, lock and hide parts; no effect without a document.

    Parameters
    ----------
    cancel_drag : callable
        Function to cancel the current drag; True if there was one.
    """

    def __init__(
        self, canvas: Canvas, session: Session, parts: ActiveParts, cancel_drag: Callable[[], bool]
    ) -> None:
        self._canvas, self._session, self._parts = canvas, session, parts
        self._give_up = cancel_drag

    def clear_base(self) -> None:
        """Clear the base."""
        self._clear(PaintedPart(BASE))

    def clear_handle(self) -> None:
        """Clear the active handle."""
        self._clear(PaintedPart(HANDLE + self._parts.handle))

    def clear_region(self) -> None:
        """Clear the active region."""
        self._clear(PaintedPart(self._parts.region + 1, is_region=True))

    def clear_all(self) -> None:
        """Clear base, handles and regions."""
        if self._may_begin():
            self._session.painting.clear_all()

    def toggle_lock(self) -> None:
        """Lock or unlock the part painted by the current tool."""
        if (flags := self._flags) is not None:
            self._session.parts.lock(self._canvas.strokes.part, not flags.locked)

    def toggle_hidden(self) -> None:
        """Hide or show the part painted by the current tool."""
        if (flags := self._flags) is not None:
            self._session.parts.hide(self._canvas.strokes.part, not flags.hidden)

    def _may_begin(self) -> bool:
        return self._session.store.state is not None and not self._give_up()

    def _clear(self, part: PaintedPart) -> None:
        if self._may_begin():
            self._session.painting.apply_operation(part, PartOperation.CLEAR)

    @property
    def _flags(self) -> PartFlags | None:
        """Flags of the part painted by the current tool; None without such a part."""
        part, state = self._canvas.strokes.part, self._session.store.state
        if state is None or self._give_up() or not part.exists_in(state.document):
            return None
        return part.flags(state.document)
