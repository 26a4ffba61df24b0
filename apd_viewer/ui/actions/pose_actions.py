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
    Along.WORLD: (tr("&World axes"), tr("Align gizmo to the axes of the mesh"), "Shift+W"),
    Along.HANDLE: (tr("&Handle axes"), tr("Align gizmo to the handle"), "L"),
    Along.VIEW: (tr("&View axes"), tr("Align gizmo to view"), "Shift+V"),
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
                tr("Add another handle"),
                "Shift+H",
                "add_handle",
            ),
            make(
                tr("&Next handle"),
                "next-handle",
                tr("Select next handle"),
                "N",
                "next_handle",
            ),
            make(
                tr("Add &region"),
                "add",
                tr("Add another region to measure or keep its area"),
                "Shift+R",
                "add_region",
            ),
        ]
        self.typed = make(
            tr("&Enter motion"),
            "type",
            tr("Enter an amount to move, rotate, twist or bend the handle"),
            "Ctrl+M",
            "type_motion",
        )
        self.put_back = make(
            tr("Rese&t handle"),
            "reset",
            tr("Return the active handle to its rest position"),
            "Shift+M",
            "put_back",
        )
        self.compare = make(
            tr("&Compare methods…"),
            "methods",
            tr("Compare the methods side by side in this pose, with a table of measurements"),
            "Ctrl+Shift+M",
            "compare_methods",
        )
        self.pivots = [
            make(
                tr("Pick p&ivot"),
                "pivot",
                tr("Click the point of the mesh to rotate the handle about"),
                "V",
                "pick_pivot",
            ),
            make(
                tr("Set pivot b&y coordinates…"),
                "pivot",
                tr("Enter the coordinates of the point to rotate the handle about"),
                "Ctrl+Shift+V",
                "type_pivot",
            ),
            make(
                tr("Pivot at &centre"),
                "pivot",
                tr("Rotate about the centre of the handle"),
                "Shift+P",
                "centre_pivot",
            ),
        ]
        self.sweep = make(
            tr("&Sweep…"), "sweep", tr("Plot area, volume and energy along the motion"), None, "sweep"
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
