"""Actions to press, compare, sweep and study, and to pause the solver."""

from functools import partial

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMenu

from apd_viewer.language import tr
from apd_viewer.session.model.named_obstacle import ObstacleKind
from apd_viewer.ui.actions.commands import Commands
from apd_viewer.ui.actions.window_menus import WindowMenus
from apd_viewer.ui.obstacles.obstacle_controller import ObstacleController
from apd_viewer.ui.obstacles.obstacle_section import FLOOR_TIP, SIDES_TIP, TIPS
from apd_viewer.ui.preferences.action_maker import ActionMaker, connect_action

_KINDS = {
    ObstacleKind.PLATE: (tr("Add &plate"), "obstacle-plate"),
    ObstacleKind.SPHERE: (tr("Add &sphere"), "obstacle-sphere"),
    ObstacleKind.CYLINDER: (tr("Add &cylinder"), "obstacle-cylinder"),
}


class ObstacleActions:
    """Actions to add, reset and remove obstacles."""

    def __init__(self, maker: ActionMaker, obstacles: ObstacleController) -> None:
        make = maker.make
        self.kinds = {}
        for kind, (title, image) in _KINDS.items():
            place = partial(obstacles.begin_placing, kind)
            self.kinds[kind] = make(f"add_obstacle:{kind.name}", title, image, TIPS[kind], None, place)
        self.floor = make(
            "add_floor", tr("Add &floor"), "obstacle-floor", FLOOR_TIP, None, obstacles.add_floor
        )
        self.side_plates = []
        for axis, letter in enumerate("XYZ"):
            title = tr("Plates on both sides along &{axis}").format(axis=letter)
            place = partial(obstacles.add_plates, axis)
            self.side_plates.append(
                make(f"plates:{letter}", title, f"plates-{letter.lower()}", SIDES_TIP, None, place)
            )
        tip = tr("Return the active obstacle to its initial place")
        self.reset = make(
            "reset_obstacle", tr("&Reset obstacle"), "reset-obstacle", tip, None, obstacles.reset
        )
        tip = tr("Remove the active obstacle")
        self.remove = make(
            "remove_obstacle", tr("Re&move obstacle"), "remove-obstacle", tip, None, obstacles.remove
        )
        self.enable_actions(False, False)
        obstacles.availability_changed.connect(self.enable_actions)

    @property
    def mesh_actions(self) -> list[QAction]:
        """Obstacle actions available only with an open mesh."""
        return [*self.kinds.values(), self.floor, *self.side_plates]

    def add_to_menu(self, menu: QMenu) -> None:
        """Add a submenu of the obstacle actions to a menu."""
        own = menu.addMenu(tr("Obstac&les"))
        own.addActions([*self.kinds.values(), self.floor])
        own.addSeparator()
        own.addActions(self.side_plates)
        own.addSeparator()
        own.addActions([self.reset, self.remove])

    def enable_actions(self, in_hand: bool, moved: bool) -> None:
        """Enable the actions for the active obstacle."""
        self.reset.setEnabled(in_hand and moved)
        self.remove.setEnabled(in_hand)


class SimulateActions:
    """Actions of the menu Simulate."""

    def __init__(self, menus: WindowMenus, commands: Commands) -> None:
        make = menus.maker.make
        self.press_live = menus.press_live
        connect_action(self.press_live, commands.press.begin)
        self.obstacles = ObstacleActions(menus.maker, commands.obstacles)
        tip = tr("Press the mesh at rest between two plates, and plot load and volume")
        self.press = make("press", tr("Press &between plates…"), "press", tip, None, commands.runs.open_press)
        tip = tr("Compare the methods side by side in this pose, with a table of measurements")
        self.compare = make(
            "compare_methods",
            tr("&Compare methods…"),
            "methods",
            tip,
            "Ctrl+Shift+M",
            commands.comparison.open,
        )
        tip = tr("Plot area, volume and energy along the motion")
        self.sweep = make("sweep", tr("&Sweep…"), "sweep", tip, None, commands.runs.open_sweep)
        tip = tr("Compute many variants of this deformation, and compare what comes of them")
        self.study = make("study", tr("Study…"), "study", tip, None, commands.case_studies.design_study)
        tip = tr("Show the volumes at rest and now beside published figures of crushed bottles")
        self.volumes = make("volumes", tr("&Volumes…"), "volumes", tip, None, commands.reports.open_volumes)
        tip = tr("Pause the solver, or let it continue")
        self.pause = make(
            "pause", tr("Pause or c&ontinue solving"), "pause", tip, "Space", commands.pause_or_resume
        )
        self.pause.setShortcutContext(Qt.ShortcutContext.WidgetShortcut)  # Space also presses buttons
        commands.canvas.viewport.addAction(self.pause)

    @property
    def mesh_actions(self) -> list[QAction]:
        """Actions available only with an open mesh."""
        runs = [self.press_live, self.press, self.compare, self.sweep, self.study, self.volumes]
        return [*runs, *self.obstacles.mesh_actions]

    def add_to_menu(self, menu: QMenu) -> None:
        """Add the actions to a menu."""
        menu.addAction(self.press_live)
        self.obstacles.add_to_menu(menu)
        menu.addSeparator()
        menu.addActions([self.press, self.compare, self.sweep, self.study])
        menu.addAction(self.volumes)
        menu.addSeparator()
        menu.addAction(self.pause)
