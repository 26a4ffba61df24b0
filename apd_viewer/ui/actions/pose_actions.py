"""The actions that move handles: nudges by keys, the axes of the gizmo, and the way back."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtWidgets import QMenu

from apd_viewer.language import tr
from apd_viewer.ui.tools.gizmo import Along

if TYPE_CHECKING:
    from apd_viewer.ui.actions.action_factory import ActionMaker

# Right, up and towards the viewer, in the picture.
_NUDGES = (
    (tr("Nudge left"), tr("Move the active handle a little to the left"), "left", "Left", (-1, 0, 0)),
    (tr("Nudge right"), tr("Move the active handle a little to the right"), "right", "Right", (1, 0, 0)),
    (tr("Nudge up"), tr("Move the active handle a little up"), "up", "Up", (0, 1, 0)),
    (tr("Nudge down"), tr("Move the active handle a little down"), "down", "Down", (0, -1, 0)),
    (tr("Nudge nearer"), tr("Move the active handle a little nearer"), "nearer", "PgDown", (0, 0, 1)),
    (tr("Nudge farther"), tr("Move the active handle a little farther"), "farther", "PgUp", (0, 0, -1)),
)
_ALONG = {
    Along.WORLD: (tr("&World axes"), tr("Let arrows and rings stand along the axes of the mesh"), "Shift+W"),
    Along.HANDLE: (tr("&Handle's axes"), tr("Let arrows and rings turn with the handle"), "L"),
    Along.VIEW: (tr("&View's axes"), tr("Let arrows and rings stand along the picture"), "Shift+V"),
}


class PoseActions:
    """How handles are moved.

    Parameters
    ----------
    maker : ActionMaker

    Attributes
    ----------
    parts, pivots, nudges : list of QAction
    along : dict of Along to QAction
    typed, put_back, compare, sweep : QAction
    """

    def __init__(self, maker: ActionMaker) -> None:
        make = maker.make
        self.parts = [
            make(
                tr("&Add handle"),
                "add",
                tr("Add one more part to be moved by itself"),
                "Shift+H",
                "add_handle",
            ),
            make(
                tr("&Next handle"),
                "next-handle",
                tr("Take the next handle into the hand"),
                "N",
                "next_handle",
            ),
            make(
                tr("Add &region"),
                "add",
                tr("Add one more part whose area is measured"),
                "Shift+R",
                "add_region",
            ),
        ]
        self.typed = make(
            tr("&Type a motion"),
            "type",
            tr("Type by how much the handle moves, turns, twists or bends"),
            "Ctrl+M",
            "type_motion",
        )
        self.put_back = make(
            tr("&Put back"),
            "reset",
            tr("Put the active handle back where it was gripped"),
            "Shift+M",
            "put_back",
        )
        self.compare = make(
            tr("&Compare methods…"),
            "methods",
            tr("See side by side what the methods make of this pose, with a table of the readings"),
            "Ctrl+Shift+M",
            "compare_methods",
        )
        self.pivots = [
            make(
                tr("Pick the p&ivot"),
                "pivot",
                tr("Click the point of the mesh that the handle turns about"),
                "V",
                "pick_pivot",
            ),
            make(
                tr("T&ype the pivot…"),
                "pivot",
                tr("Type the coordinates of the point that the handle turns about"),
                "Ctrl+Shift+V",
                "type_pivot",
            ),
            make(
                tr("Pivot at the &centre"),
                "pivot",
                tr("Turn about the middle of the handle again"),
                "Shift+P",
                "centre_pivot",
            ),
        ]
        self.sweep = make(
            tr("&Sweep…"), "sweep", tr("Go along the motion in steps: area, volume and energy"), None, "sweep"
        )
        self.nudges = [
            make(title, f"nudge-{name}", tip, key, "nudge", step) for title, tip, name, key, step in _NUDGES
        ]
        self.along = {
            along: make(title, "axes", tip, key, "along", along)
            for along, (title, tip, key) in _ALONG.items()
        }
        maker.one_of(self.along.values())
        self.along[Along.WORLD].setChecked(True)

    def fill(self, menu: QMenu) -> None:
        """Put all of them into a menu."""
        menu.addActions(self.parts)
        menu.addSeparator()
        menu.addActions([self.typed, self.put_back, *self.pivots])
        self.nudge = menu.addMenu(tr("N&udge"))
        self.nudge.addActions(self.nudges)
        menu.addSeparator()
        menu.addActions(list(self.along.values()))
        menu.addSeparator()
        menu.addActions([self.compare, self.sweep])
