"""Actions of the camera: axis views, projection and up axis."""

from __future__ import annotations

from functools import partial

from PySide6.QtWidgets import QMenu

from apd_viewer.language import tr, trc
from apd_viewer.session.model.up_axis import UpAxis
from apd_viewer.ui.actions.action_maker import ActionMaker
from apd_viewer.ui.tools.canvas import Canvas

_VIEWS = (
    (trc("view", "Front"), tr("View the mesh from the front"), "1", "front"),
    (trc("view", "Right"), tr("View the mesh from the right"), "3", "side"),
    (trc("view", "Top"), tr("View the mesh from the top"), "7", "top"),
    (trc("view", "Back"), tr("View the mesh from the back"), "Ctrl+1", "-front"),
    (trc("view", "Left"), tr("View the mesh from the left"), "Ctrl+3", "-side"),
    (trc("view", "Bottom"), tr("View the mesh from the bottom"), "Ctrl+7", "-top"),
)


class CameraActions:
    """Actions to choose direction, projection and up axis.

    Parameters
    ----------
    maker : ActionMaker
    canvas : Canvas

    Attributes
    ----------
    directions : dict of str to QAction
        By the direction, as in Look.along.
    orthographic, stand_upright : QAction
    up_axes : dict of UpAxis to QAction
    """

    def __init__(self, maker: ActionMaker, canvas: Canvas) -> None:
        self._look = canvas.viewport.camera_controller
        self.directions = {}
        for title, tip, key, axis in _VIEWS:
            command = partial(canvas.look_along, axis)
            self.directions[axis] = maker.make(f"look:{axis}", title, "view", tip, key, command)
        tip = tr("View the mesh without perspective")
        project = canvas.viewport.camera_controller.set_orthographic
        self.orthographic = maker.make_switch("orthographic", tr("Ortho&graphic"), "view", tip, "5", project)
        self.up_axes = {}
        for up_axis in UpAxis:
            name, tip = up_axis.value, tr("Show the mesh with {axis} up").format(axis=up_axis.value)
            self.up_axes[up_axis] = maker.make(
                f"up:{name}", name, "axes", tip, None, partial(canvas.set_up_axis, up_axis)
            )
        maker.make_exclusive(self.up_axes.values())
        tip = tr("Make the axis that points up in the view the up axis")
        self.stand_upright = maker.make(
            "upright", tr("&Stand upright"), "axes", tip, None, self._stand_upright
        )
        self._canvas = canvas
        self.refresh()

    def _stand_upright(self) -> None:
        self._canvas.set_up_axis(UpAxis.nearest(self._look.camera.axes[1]))
        self.refresh()

    def refresh(self) -> None:
        """Check the actions of the camera's projection and up axis."""
        eye = self._look.camera
        self.up_axes[eye.up_axis].setChecked(True)
        self.orthographic.setChecked(eye.is_orthographic)

    def fill(self, menu: QMenu) -> None:
        """Put all of them into a menu."""
        menu.addActions(list(self.directions.values()))
        menu.addAction(self.orthographic)
        up = menu.addMenu(tr("&Up axis"))
        up.addActions(list(self.up_axes.values()))
        up.addSeparator()
        up.addAction(self.stand_upright)
