"""Actions to move handles: nudges, gizmo axes and returns to rest."""

from functools import partial

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QMenu

from apd_viewer.language import tr
from apd_viewer.ui.actions.commands import Commands
from apd_viewer.ui.preferences.action_maker import ActionMaker
from apd_viewer.ui.tools.gizmo_drag import GizmoOrientation

# Directions in view coordinates: right, up and towards the viewer.
_NUDGES = (
    (tr("Nudge left"), tr("Move the active handle a little to the left"), "left", "Left", (-1, 0, 0)),
    (tr("Nudge right"), tr("Move the active handle a little to the right"), "right", "Right", (1, 0, 0)),
    (tr("Nudge up"), tr("Move the active handle a little up"), "up", "Up", (0, 1, 0)),
    (tr("Nudge down"), tr("Move the active handle a little down"), "down", "Down", (0, -1, 0)),
    (tr("Nudge nearer"), tr("Move the active handle a little nearer"), "nearer", "PgDown", (0, 0, 1)),
    (tr("Nudge farther"), tr("Move the active handle a little farther"), "farther", "PgUp", (0, 0, -1)),
)
_ALONG = {
    GizmoOrientation.WORLD: (
        tr("&World axes"),
        "axes",
        tr("Align gizmo to the axes of the mesh"),
        "Shift+W",
    ),
    GizmoOrientation.HANDLE: (tr("&Handle axes"), "axes-handle", tr("Align gizmo to the handle"), "L"),
    GizmoOrientation.VIEW: (tr("&View axes"), "axes-view", tr("Align gizmo to view"), "Shift+V"),
}


class PoseActions:
    """Actions to move handles and to keep named poses."""

    def __init__(self, maker: ActionMaker, commands: Commands) -> None:
        make, editing = maker.make, commands.edits
        self._gizmo = commands.canvas.gizmo
        add, region = tr("Add another handle"), tr("Add another region to measure or keep its area")
        after = tr("Select next handle")
        self.part_actions = [
            make("add_handle", tr("&Add handle"), "add-handle", add, "Shift+H", editing.add_handle),
            make("next_handle", tr("&Next handle"), "next-handle", after, "N", editing.activate_next_handle),
            make("add_region", tr("Add &region"), "add-region", region, "Shift+R", editing.add_region),
        ]
        tip = tr("Enter an amount to move, rotate, twist or bend the handle")
        self.enter_motion = make(
            "type_motion", tr("&Enter motion"), "type-motion", tip, "Ctrl+M", commands.type_motion
        )
        tip = tr("Return the active handle to its rest position")
        self.reset_handle = make(
            "put_back", tr("Rese&t handle"), "reset-handle", tip, "Shift+M", editing.reset_handle
        )
        tip = tr("Move each handle together with its mirror image")
        self.symmetric = maker.make_checkable(
            "symmetric", tr("Sy&mmetric"), "mirror", tip, "Shift+S", commands.symmetry.set_symmetric
        )
        poses, keep = commands.poses, tr("Keep the present places of all handles under a name")
        onwards, back = (
            tr("Move the handles to the next pose kept"),
            tr("Move the handles to the previous pose kept"),
        )
        self.named_poses = [
            make("keep_pose", tr("&Keep pose"), "keep-pose", keep, "Ctrl+K", poses.keep_pose),
            make("next_pose", tr("&Next pose"), "next-pose", onwards, ".", partial(poses.step_pose, 1)),
            make(
                "previous_pose",
                tr("&Previous pose"),
                "previous-pose",
                back,
                ",",
                partial(poses.step_pose, -1),
            ),
        ]
        pick = tr("Click the point of the mesh to rotate the handle about")
        enter = tr("Enter the coordinates of the point to rotate the handle about")
        title, centre = tr("Set pivot b&y coordinates…"), tr("Rotate about the centre of the handle")
        self.pivots = [
            make("pick_pivot", tr("Pick p&ivot"), "pivot", pick, "V", editing.pick_pivot),
            make("type_pivot", title, "type-pivot", enter, "Ctrl+Shift+V", editing.open_pivot_entry),
            make(
                "centre_pivot",
                tr("&Pivot at centre"),
                "centre-pivot",
                centre,
                "Shift+P",
                editing.centre_pivot,
            ),
        ]
        self.nudges = []
        for title, tip, way, key, step in _NUDGES:
            name, command = f"nudge:({step[0]},{step[1]},{step[2]})", partial(editing.nudge, step)
            nudge = make(name, title, f"nudge-{way}", tip, key, command)
            nudge.setShortcutContext(Qt.ShortcutContext.WidgetShortcut)  # arrow keys also move sliders
            commands.canvas.viewport.addAction(nudge)
            self.nudges.append(nudge)
        self.orientations = {}
        for along, (title, image, tip, key) in _ALONG.items():
            command = partial(self._align, along)
            self.orientations[along] = make(f"along:{along.name}", title, image, tip, key, command)
        maker.make_exclusive(self.orientations.values())
        self.orientations[GizmoOrientation.WORLD].setChecked(True)

    def _align(self, along: GizmoOrientation) -> None:
        self._gizmo.orientation = along

    def show_symmetry(self, on: bool) -> None:
        """Set the check mark of the symmetry action: on if handles move symmetrically."""
        self.symmetric.blockSignals(True)
        self.symmetric.setChecked(on)
        self.symmetric.blockSignals(False)

    def add_to_menu(self, menu: QMenu) -> None:
        """Add the actions to a menu."""
        menu.addActions(self.part_actions)
        menu.addSeparator()
        menu.addActions([self.enter_motion, self.reset_handle, self.symmetric, *self.pivots])
        self.nudge = menu.addMenu(tr("N&udge"))
        self.nudge.addActions(self.nudges)
        self.poses = menu.addMenu(tr("Name&d poses"))
        self.poses.addActions(self.named_poses)
        menu.addSeparator()
        menu.addActions(list(self.orientations.values()))
