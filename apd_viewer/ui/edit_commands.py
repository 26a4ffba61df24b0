"""What the user does to the document by keys, menus and the panel, brought to the session."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.language import tr
from apd_viewer.ui.overlays.text_entry import Typed
from apd_viewer.ui.tools.toolbox import Tool

if TYPE_CHECKING:
    from apd_viewer.session.session import Session
    from apd_viewer.ui.panel.panel import Panel
    from apd_viewer.ui.tools.active_parts import ActiveParts
    from apd_viewer.ui.tools.canvas import Canvas


class Editing:
    """The verbs of a window that change what is open; before there is something they do nothing.

    Parameters
    ----------
    canvas : Canvas
    panel : Panel
    take : callable
        Puts a tool into the hand.
    """

    def __init__(self, canvas: Canvas, panel: Panel, take: Callable[[Tool], None]) -> None:
        self._canvas = canvas
        self._panel = panel
        self._take = take
        self._at_work: tuple[Session, ActiveParts] | None = None

    def start(self, session: Session, parts: ActiveParts) -> None:
        """Begin to work."""
        self._at_work = session, parts
        handles = self._panel.handles
        handles.added.connect(self.verbs["add_handle"])
        handles.reset_asked.connect(self.verbs["reset"])
        handles.put_back_asked.connect(self.verbs["put_back"])
        handles.motion.typed.connect(self.verbs["move_by"])
        self._panel.regions.added.connect(self.verbs["add_region"])
        handles.motion.line_asked.connect(self.verbs["pick_line"])
        handles.motion.choice.currentIndexChanged.connect(self._show_line)
        self.typed = Typed(self._canvas, session, parts, self.give_up)

    @property
    def verbs(self) -> dict[str, Callable[..., None]]:
        """What can be done, by name; in the middle of a drag most of them take that back, and no more."""
        free: dict[str, Callable[..., object]] = {
            "undo": lambda session, _: session.gestures.undo(),
            "redo": lambda session, _: session.gestures.redo(),
            "travel": lambda session, _, steps: session.gestures.travel(steps),
            "reshape": lambda session, _, change: session.painting.reshape(self._canvas.part, change),
            "bake": lambda session, _: session.rest_shape.bake(),
            "put_back": lambda session, parts: session.handles.reset(parts.handle),
            "nudge": self._nudge,
            "pick_pivot": self._pick_pivot,
            "pick_line": self._pick_line,
            "centre_pivot": lambda session, parts: session.handles.set_pivot(None, parts.handle),
        }
        any_time: dict[str, Callable[..., object]] = {
            "reset": self._reset,
            "add_handle": self._add_handle,
            "next_handle": lambda _, parts: parts.next_handle(),
            "add_region": self._add_region,
            "move_by": self._move_by,
            "choose_by_numbers": lambda *_: self.typed.open(self.typed.vertices),
            "type_brush": self._type_brush,
            "type_pivot": lambda *_: self.typed.open(self.typed.pivot),
        }
        return {
            **{name: partial(self._do, verb, True) for name, verb in free.items()},
            **{name: partial(self._do, verb, False) for name, verb in any_time.items()},
        }

    def _do(self, verb: Callable[..., object], waits: bool, *what: object) -> None:
        if self._at_work is None or self._at_work[0].store.state is None or (waits and self.give_up()):
            return
        verb(*self._at_work, *what)

    def give_up(self) -> bool:
        """Take back the drag or the sweep that is under way; True if there was one."""
        return self._canvas.viewport.cancel() or self._panel.give_up_sweep()

    def _reset(self, session: Session, _: ActiveParts) -> None:
        self.give_up()
        session.rest_shape.restore()

    def _add_handle(self, _: Session, parts: ActiveParts) -> None:
        parts.add_handle()
        self._take(Tool.HANDLE)

    def _add_region(self, _: Session, parts: ActiveParts) -> None:
        parts.add_region()
        self._take(Tool.REGION)

    def _move_by(self, session: Session, parts: ActiveParts, motion: str, text: str) -> None:
        field = self._panel.handles.motion
        try:
            session.handles.move_by(motion, text, parts.handle, self._canvas.line)
        except InputError as error:
            field.refuse(str(error))
        else:
            field.done()

    def _pick_pivot(self, session: Session, parts: ActiveParts) -> None:
        self._take(Tool.MOVE)
        self._canvas.picker.ask(
            1,
            lambda points: session.handles.set_pivot(points[0], parts.handle),
            tr("Click the point of the mesh to rotate the handle about; Esc cancels"),
        )

    def _pick_line(self, _: Session, __: ActiveParts) -> None:
        self._take(Tool.MOVE)
        words = tr("Click two points of the mesh to set the line to bend about")
        self._canvas.picker.ask(2, self._keep_line, words)

    def _keep_line(self, line: np.ndarray) -> None:
        self._canvas.line = line
        self._show_line()
        self._panel.show_motion()

    def _show_line(self) -> None:
        line = self._canvas.line if self._panel.handles.motion.about_line else None
        self._canvas.picker.shown = np.empty((0, 3)) if line is None else line

    def _type_brush(self, _: Session, __: ActiveParts) -> None:
        if not self._canvas.tool.words.is_brush:
            self._take(Tool.HANDLE)
        self.typed.open(self.typed.brush)

    def _nudge(self, session: Session, parts: ActiveParts, step: tuple[int, int, int]) -> None:
        pose = self._canvas.nudged(step)
        if pose is not None:
            session.handles.pose(pose, parts.handle, tr("Nudge handle"), repeats=True)
