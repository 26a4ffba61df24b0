"""Hint on the next step, until a first drag of a handle."""

from __future__ import annotations

from typing import TYPE_CHECKING

from apd_viewer.geometry.pose.constraints import BASE, HANDLE
from apd_viewer.language import tr
from apd_viewer.ui.overlays.notice import Invitation
from apd_viewer.ui.preferences.shortcut_hints import with_keys
from apd_viewer.ui.tools.toolbox import Tool

if TYPE_CHECKING:
    from collections.abc import Mapping

    from PySide6.QtGui import QAction

    from apd_viewer.session.model.document import Document

_TWIST = tr("Drag a ring to rotate, an arrow to move")


class NextStep:
    """Chooses the sentence for the invitation.

    Parameters
    ----------
    invitation : Invitation
    tools : mapping of Tool to QAction
        Whose keys are named.
    """

    def __init__(self, invitation: Invitation, tools: Mapping[Tool, QAction]) -> None:
        self._invitation = invitation
        self._tools = tools
        self._moved = False
        self._asked: tuple[Document, Tool, int] | None = None
        for action in tools.values():
            action.changed.connect(self._say_again)

    def moved(self) -> None:
        """Note a drag of a handle: no more hints are needed."""
        self._moved = True
        self._invitation.say("")

    def say_next(self, document: Document, tool: Tool, handle: int) -> None:
        """Show the next step for ``tool`` and the active ``handle``'s number."""
        self._asked = document, tool, handle
        self._invitation.say(self._sentence(document, tool, handle))

    def _say_again(self) -> None:
        """Update the keys named."""
        if self._asked is not None and not self._invitation.isHidden():
            self._invitation.say(self._sentence(*self._asked))

    def _sentence(self, document: Document, tool: Tool, handle: int) -> str:
        if not document.counts[BASE]:
            return with_keys(tr("Paint the part that stays in place: the base"), self._tools[Tool.BASE])
        if not document.counts[HANDLE:].any():
            return with_keys(tr("Now paint the part to move: the handle"), self._tools[Tool.HANDLE])
        if document.problem:
            return document.problem
        if not document.counts[HANDLE + handle]:
            name = document.handles[handle].name
            return with_keys(
                tr("Paint the part that “{name}” moves").format(name=name), self._tools[Tool.HANDLE]
            )
        if tool is Tool.REGION and not document.member.any():
            return tr("Paint a part to measure its area or keep it")
        if self._moved or document.posed:
            return ""
        return _TWIST if tool is Tool.MOVE else with_keys(tr("Now move the handle"), self._tools[Tool.MOVE])
