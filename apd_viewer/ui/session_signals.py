"""Listener of a session with Qt signals, and connections of the panel."""

from collections.abc import Callable
from functools import partial
from typing import Any

from PySide6.QtCore import QObject, Signal

from apd_viewer.geometry.pose.constraints import BASE, HANDLE
from apd_viewer.geometry.solver.methods import METHODS
from apd_viewer.language import tr
from apd_viewer.session.model.document_parts import PaintedPart
from apd_viewer.session.model.state import State
from apd_viewer.session.model.status_text import lock_sentence
from apd_viewer.session.part_operations import PartOperation
from apd_viewer.session.session import Session
from apd_viewer.session.state_store import Listener
from apd_viewer.ui.panel.panel import Panel
from apd_viewer.ui.panel.status_bar import StatusBar
from apd_viewer.ui.tools.active_parts import ActiveParts
from apd_viewer.ui.tools.canvas import Canvas
from apd_viewer.ui.tools.click_tool import ClickTool
from apd_viewer.ui.tools.tool_modes import SelectionMode, Tool
from apd_viewer.ui.widgets.part_row import PartList


class SessionSignals(QObject):
    """One signal for each callback of a :class:`Listener`.

    Attributes
    ----------
    woken : Signal()
        Emitted on any thread; the others on the thread of the session.
    changed : Signal(State or None, State)
    status_changed : Signal()
        Emitted after ``changed``, too.
    view_opened : Signal(View)
    animation_opened : Signal(Path or None)
    file_written : Signal(Path)
    """

    woken = Signal()
    changed = Signal(object, object)
    status_changed = Signal()
    message_sent = Signal(str)
    failed = Signal(str)
    view_opened = Signal(object)
    animation_opened = Signal(object)
    measured = Signal()
    file_written = Signal(object)

    def listener(self) -> Listener:
        """Listener emitting the signals."""
        return Listener(
            wake=self.woken.emit,
            changed=self._change,
            status_changed=self.status_changed.emit,
            message_sent=self.message_sent.emit,
            failed=self.failed.emit,
            view_opened=self.view_opened.emit,
            animation_opened=self.animation_opened.emit,
            measurements_changed=self.measured.emit,
            file_written=self.file_written.emit,
        )

    def _change(self, old: State | None, new: State) -> None:
        self.changed.emit(old, new)
        self.status_changed.emit()


def connect_settings(panel: Panel, session: Session, wall_settings: Callable[..., dict[str, Any]]) -> None:
    """Connect the settings; each slider drag is one undo step.

    Parameters
    ----------
    wall_settings : callable
        Settings by name that the Wall method takes from the wall.
    """

    def change(name: str, value: Any) -> None:
        is_wall = name == "method" and METHODS[value].is_wall
        more = wall_settings("wall_thickness", "poisson") if is_wall else {}
        session.settings.change(**{name: value}, **more)

    for chosen, name in (
        (panel.area.target.chosen, "area"),
        (panel.area.keep_toggled, "hold_area"),
        (panel.volume.target.chosen, "volume"),
        (panel.method.stiffness.chosen, "stiffness"),
        (panel.method.convergence.chosen, "convergence"),
    ):
        chosen.connect(partial(_change, session, name))
    panel.method.changed.connect(change)
    panel.volume.target_changed.connect(partial(_hold_volume, panel, session))
    gestures = tr("Change area"), tr("Change volume"), tr("Change stiffness"), tr("Change falloff")
    for dial, gesture in zip(panel.slider_fields, gestures, strict=True):
        dial.drag_began.connect(session.gestures.begin)
        dial.drag_ended.connect(partial(session.gestures.end, gesture))
        dial.drag_cancelled.connect(session.gestures.cancel)


def _change(session: Session, name: str, value: object) -> None:
    session.settings.change(**{name: value})


def _hold_volume(panel: Panel, session: Session, changes: dict[str, Any]) -> None:
    """Change what is held inside; a refused target is not shown."""
    session.settings.change(**changes)
    panel.volume.show_settings(session.store.required_state())


def connect_parts(panel: Panel, session: Session, parts: ActiveParts) -> None:
    """Connect the lists of handles and regions to the session."""
    panel.handles.list.chosen.connect(parts.choose_handle)
    panel.handles.list.renamed.connect(session.parts.rename_handle)
    panel.handles.list.removed.connect(parts.remove_handle)
    panel.handles.falloff.chosen.connect(partial(_set_falloff, session, parts))
    panel.regions.list.chosen.connect(parts.choose_region)
    panel.regions.list.renamed.connect(session.parts.rename_region)
    panel.regions.list.removed.connect(parts.remove_region)
    panel.regions.target_changed.connect(session.settings.set_region_area)
    panel.parts.base.hide_requested.connect(partial(session.parts.hide, PaintedPart(BASE)))
    panel.parts.base.lock_requested.connect(partial(session.parts.lock, PaintedPart(BASE)))
    panel.parts.base.clear_requested.connect(
        partial(session.painting.apply_operation, PaintedPart(BASE), PartOperation.CLEAR)
    )
    panel.paint.clear_all.clicked.connect(lambda: session.painting.clear_all())
    _connect_flags(panel.handles.list, session, lambda k: PaintedPart(HANDLE + k))
    _connect_flags(panel.regions.list, session, lambda k: PaintedPart(k + 1, is_region=True))


def _connect_flags(rows: PartList, session: Session, part: Callable[[int], PaintedPart]) -> None:
    rows.hidden.connect(lambda k, on: session.parts.hide(part(k), on))
    rows.locked.connect(lambda k, on: session.parts.lock(part(k), on))
    rows.cleared.connect(lambda k: session.painting.apply_operation(part(k), PartOperation.CLEAR))


def _set_falloff(session: Session, parts: ActiveParts, percent: float) -> None:
    state = session.store.state
    if state is not None:
        session.settings.set_falloff(parts.handle, percent / 100.0 * float(max(state.inspection.size)))


def connect_canvas(
    canvas: Canvas,
    session: Session,
    parts: ActiveParts,
    show_message: Callable[[str], None],
    prompt: Callable[[str], None],
) -> None:
    """Connect painting and dragging on the canvas; each drag is one undo step.

    ``show_message`` shows a sentence to the user, ``prompt`` an instruction, or none if empty.
    """
    loop = canvas.selectors[SelectionMode.LOOP]
    assert isinstance(loop, ClickTool)
    loop.nothing_found.connect(
        lambda: show_message(tr("This surface is closed: it has no boundary to select."))
    )
    canvas.brush.missed.connect(
        lambda: show_message(tr("Begun beside the mesh: a drag there turns the view."))
    )
    canvas.picker.prompt_changed.connect(prompt)
    canvas.strokes.began.connect(lambda: _begin_stroke(session, canvas, show_message))
    canvas.strokes.ended.connect(session.painting.end_stroke)
    canvas.strokes.painted.connect(session.painting.paint)
    canvas.strokes.region_painted.connect(session.painting.paint_region)
    canvas.drag_began.connect(session.gestures.begin)
    canvas.handle_moved.connect(lambda pose: session.handles.drag(pose, parts.handle))
    canvas.drag_ended.connect(lambda: session.handles.end_drag(parts.handle))
    canvas.gesture_cancelled.connect(session.gestures.cancel)
    canvas.handle_chosen.connect(parts.choose_handle)


def connect_wheel(canvas: Canvas, session: Session, status: StatusBar) -> None:
    """Show the brush size or edge angle in the status bar when the wheel changes it."""
    fill, brush = canvas.selectors[SelectionMode.FILL], canvas.brush
    assert isinstance(fill, ClickTool)
    fill.crease_angle_changed.connect(status.show_edge_angle)
    brush.size.changed.connect(lambda: status.show_brush_size(brush.size, session.store.unit))


def _begin_stroke(session: Session, canvas: Canvas, tell: Callable[[str], None]) -> None:
    if session.store.state is None:  # a selection box can also be dragged over an empty canvas
        return
    document, part = session.store.state.document, canvas.strokes.part
    session.gestures.begin()
    if canvas.tool is not Tool.ERASE and part.exists_in(document):
        flags, name = part.flags(document), part.name(document)
        if flags.locked:
            tell(lock_sentence(name))
        elif flags.hidden:
            tell(tr("{name} is hidden: its paint is not shown.").format(name=name))
