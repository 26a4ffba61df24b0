"""The actions that move handles: nudges by keys, the axes of the gizmo, and the way back."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtGui import QAction, QActionGroup
from PySide6.QtWidgets import QMainWindow, QMenu

from apd_viewer.language import tr
from apd_viewer.ui.gizmo import Along

if TYPE_CHECKING:
    from apd_viewer.ui.action_maker import ActionMaker

# Right, up and towards the viewer, in the picture.
_NUDGES = (
    ("left", "Left", (-1, 0, 0)),
    ("right", "Right", (1, 0, 0)),
    ("up", "Up", (0, 1, 0)),
    ("down", "Down", (0, -1, 0)),
    ("nearer", "PgDown", (0, 0, 1)),
    ("farther", "PgUp", (0, 0, -1)),
)
_ALONG = {
    Along.WORLD: ("&World axes", "Let arrows and rings stand along the axes of the mesh", "Shift+W"),
    Along.HANDLE: ("&Handle's axes", "Let arrows and rings turn with the handle", "L"),
    Along.VIEW: ("&View's axes", "Let arrows and rings stand along the picture", "Shift+V"),
}


class PoseActions:
    """How handles are moved.

    Parameters
    ----------
    window : QMainWindow
    maker : ActionMaker

    Attributes
    ----------
    parts, nudges : list of QAction
    along : dict of Along to QAction
    put_back : QAction
    """

    def __init__(self, window: QMainWindow, maker: ActionMaker) -> None:
        make = maker.make
        self.parts = [
            make("&Add handle", "add", "Add one more part to be moved by itself", "Shift+H", "add_handle"),
            make("&Next handle", "next-handle", "Take the next handle into the hand", "N", "next_handle"),
            make("Add &region", "add", "Add one more part whose area is measured", "Shift+R", "add_region"),
        ]
        self.typed = make(
            "&Type a motion",
            "type",
            "Type by how much the handle moves, turns, twists or bends",
            "Ctrl+M",
            "type_motion",
        )
        self.put_back = make(
            "&Put back", "reset", "Put the active handle back where it was gripped", "Shift+M", "put_back"
        )
        self.pivots = [
            make(
                "Pick the p&ivot",
                "pivot",
                "Click the point of the mesh that the handle turns about",
                "V",
                "pick_pivot",
            ),
            make(
                tr("T&ype the pivot…"),
                "pivot",
                tr("Type the coordinates of the point that the handle turns about"),
                "Ctrl+P",
                "type_pivot",
            ),
            make(
                "Pivot at the &centre",
                "pivot",
                "Turn about the middle of the handle again",
                "Shift+P",
                "centre_pivot",
            ),
        ]
        self.nudges = []
        for name, key, step in _NUDGES:
            tip = f"Move the active handle a little {'to the ' if name in ('left', 'right') else ''}{name}"
            self.nudges.append(make(f"Nudge {name}", f"nudge-{name}", tip, key, "nudge", step))
        group = QActionGroup(window)
        self.along: dict[Along, QAction] = {}
        for along, (title, tip, key) in _ALONG.items():
            action = make(title, "axes", tip, key, "along", along)
            action.setCheckable(True)
            action.setChecked(along is Along.WORLD)
            group.addAction(action)
            self.along[along] = action

    def fill(self, menu: QMenu) -> None:
        """Put all of them into a menu."""
        menu.addActions(self.parts)
        menu.addSeparator()
        menu.addActions([self.typed, self.put_back, *self.pivots])
        self.nudge = menu.addMenu("N&udge")
        self.nudge.addActions(self.nudges)
        menu.addSeparator()
        menu.addActions(list(self.along.values()))
