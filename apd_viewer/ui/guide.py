"""What to do next: the line over the canvas, until a handle has been dragged once."""

from __future__ import annotations

from typing import TYPE_CHECKING

from apd_viewer.geometry.constraints import BASE, HANDLE
from apd_viewer.language import tr
from apd_viewer.ui.notice import Invitation
from apd_viewer.ui.toolbox import Tool

if TYPE_CHECKING:
    from apd_viewer.session.document import Document

_TWIST = tr("Drag a ring around the handle to twist, an arrow to bend")


class Guide:
    """Chooses the sentence for the invitation.

    Parameters
    ----------
    invitation : Invitation
    """

    def __init__(self, invitation: Invitation) -> None:
        self._invitation = invitation
        self._moved = False

    def moved(self) -> None:
        """A handle was dragged: whoever can do that needs no more telling."""
        self._moved = True
        self._invitation.say("")

    def say_next(self, document: Document, tool: Tool, handle: int) -> None:
        """Say what to do next with ``tool`` in the hand and ``handle`` active, by its number."""
        self._invitation.say(self._next_step(document, tool, handle))

    def _next_step(self, document: Document, tool: Tool, handle: int) -> str:
        if not document.counts[BASE]:
            return tr("Paint the part that stays in place: the base (B)")
        if not document.counts[HANDLE:].any():
            return tr("Now paint the part to be moved: the handle (H)")
        if document.problem:
            return document.problem
        if not document.counts[HANDLE + handle]:
            return tr("Paint the part that “{name}” moves (H)").format(name=document.handles[handle].name)
        if tool is Tool.REGION and not document.member.any():
            return tr("Paint a part whose area you want to see, or to keep")
        if self._moved:
            return ""
        return _TWIST if tool is Tool.MOVE else tr("Now move the handle (M)")
