"""Hint on the next step, until a first drag, and on a drag's wait for its kernels."""

from __future__ import annotations

import math
from collections.abc import Mapping

from PySide6.QtGui import QAction

from apd_viewer.geometry.pose.constraints import BASE, HANDLE
from apd_viewer.language import tr
from apd_viewer.session.model.document import Document
from apd_viewer.session.state_store import StateStore
from apd_viewer.ui.overlays.notice import CanvasHint
from apd_viewer.ui.preferences.shortcut_hints import with_keys
from apd_viewer.ui.tools.toolbox import Tool

_TWIST = tr("Drag a ring to rotate, an arrow to move")
_PUSH = tr("Drag an arrow of the obstacle, or enter a distance, to push the surface")
_SELECT = tr("Click an obstacle to move it")
_WAITS = tr("Preview: the surface follows once enough is compiled for this computer ({percent} %)")


class NextStep:
    """Chooses the sentence for the invitation.

    Parameters
    ----------
    invitation : CanvasHint
    tools : mapping of Tool to QAction
        Whose keys are named.

    Attributes
    ----------
    has_moved : bool
        Whether something has been dragged since the window was opened.
    """

    def __init__(self, invitation: CanvasHint, tools: Mapping[Tool, QAction]) -> None:
        self._invitation = invitation
        self._tools = tools
        self.has_moved = False
        self._waits = ""
        self._asked: tuple[Document, Tool, int, int | None] | None = None
        for action in tools.values():
            action.changed.connect(self._say_again)

    def note_drag(self) -> None:
        """Note a drag: no more hints are needed."""
        self.has_moved = True
        self.hide_hint()

    def hide_hint(self) -> None:
        """Show no next step."""
        self._invitation.show_text(self._waits)

    def follow(self, store: StateStore) -> None:
        """Say that a preview is shown, as long as it is."""
        waits = ""
        if store.is_previewing:
            waits = _WAITS.format(percent=math.floor(100.0 * (store.compiled_share or 0.0)))
        if waits != self._waits:
            self._waits = waits
            self.hide_hint()

    def show_hint(self, document: Document, tool: Tool, handle: int, obstacle: int | None) -> None:
        """Show the next step for ``tool``, the active handle and the obstacle in the hand."""
        self._asked = document, tool, handle, obstacle
        self._invitation.show_text(self._waits or self._sentence(*self._asked))

    def _say_again(self) -> None:
        """Update the keys named."""
        if self._asked is not None and not self._invitation.isHidden():
            self._invitation.show_text(self._waits or self._sentence(*self._asked))

    def _sentence(self, document: Document, tool: Tool, handle: int, obstacle: int | None) -> str:
        if document.has_active_obstacles and not tool.words.is_brush:
            nothing_held = not document.label_counts[BASE] and not document.label_counts[HANDLE:].any()
            if obstacle is not None or nothing_held:  # obstacles alone suffice
                return self._of_obstacles(document, tool, obstacle)
        if not document.label_counts[BASE]:
            return with_keys(tr("Paint the part that stays in place: the base"), self._tools[Tool.BASE])
        if not document.label_counts[HANDLE:].any():
            return with_keys(tr("Now paint the part to move: the handle"), self._tools[Tool.HANDLE])
        if document.paint_problem:
            return document.paint_problem
        if not document.label_counts[HANDLE + handle]:
            name = document.handles[handle].name
            return with_keys(
                tr("Paint the part that “{name}” moves").format(name=name), self._tools[Tool.HANDLE]
            )
        if tool is Tool.REGION and not document.member.any():
            return tr("Paint a part to measure its area or keep it")
        if self.has_moved or document.relative_to_rest.is_posed:
            return ""
        return _TWIST if tool is Tool.MOVE else with_keys(tr("Now move the handle"), self._tools[Tool.MOVE])

    def _of_obstacles(self, document: Document, tool: Tool, obstacle: int | None) -> str:
        if self.has_moved or any(each.shift.any() for each in document.obstacles):
            return ""
        if tool is not Tool.MOVE:
            return with_keys(tr("Now move an obstacle"), self._tools[Tool.MOVE])
        return _SELECT if obstacle is None else _PUSH


def may_change_next_step(before: Document, after: Document) -> bool:
    """True if a change may lead to another next step."""
    same = before.labels is after.labels and before.obstacles is after.obstacles
    return not same or before.relative_to_rest.is_posed != after.relative_to_rest.is_posed
