"""Actions to press, compare, sweep and study, and to pause the solver."""

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMenu

from apd_viewer.language import tr
from apd_viewer.ui.actions.commands import Commands
from apd_viewer.ui.actions.window_menus import WindowMenus
from apd_viewer.ui.obstacles.obstacle_actions import ObstacleActions
from apd_viewer.ui.preferences.action_maker import connect_action


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
