"""Actions to open and write files."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path

from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import QMenu

from apd_viewer.files.samples import SAMPLES
from apd_viewer.language import tr
from apd_viewer.session.model.document import Document
from apd_viewer.ui.actions.commands import Commands
from apd_viewer.ui.actions.window_menus import WindowMenus
from apd_viewer.ui.preferences.action_maker import ActionMaker, connect_action
from apd_viewer.ui.widgets.display_names import distinct_names, menu_text

_KEYS = QKeySequence.StandardKey


class FileActions:
    """Actions to open and write files.

    Attributes
    ----------
    recent : QMenu
        The files that were opened last.
    """

    def __init__(self, menus: WindowMenus, commands: Commands) -> None:
        maker, filing, reporting = menus.maker, commands.files, commands.reports
        make = maker.make
        requests = commands.requests
        self._open_path = requests.open_path
        self.open, self.export, self.quit = menus.open, menus.export, menus.quit
        connect_action(self.export, filing.export_mesh)
        tip = tr("Open the results of a study from their folder, also while it runs elsewhere")
        self.open_study = make(
            "open_study", tr("Open st&udy…"), "open-study", tip, None, commands.case_studies.ask_for_folder
        )
        tip = tr("Divide the surface into even triangles, in a new file: for needles and scans")
        self.remesh = make("remesh", tr("Remesh e&venly…"), "remesh", tip, None, filing.remesh)
        self._make_target(maker, commands)
        tip = tr("Export area change, strain, displacement and labels as CSV or PLY")
        self.scalars = make(
            "export_scalars", tr("Export sca&lars…"), "export-scalars", tip, None, filing.export_scalars
        )
        tip = tr("Export shells and boundary conditions for CalculiX or Abaqus")
        self.deck = make("export_deck", tr("Export &FE deck…"), "export-deck", tip, None, filing.export_deck)
        tip = tr("Export the motion of the handles for Blender, glTF or ParaView")
        self.animation = make(
            "export_animation", tr("Export a&nimation…"), "film", tip, None, commands.runs.open_animation
        )
        tip = tr("Save painted parts, poses, settings and shape")
        self.save = make("save", tr("&Save session"), "save", tip, _KEYS.Save, filing.save)
        tip = tr("Save the session to another file")
        self.save_as = make(
            "save_as", tr("Save session &as…"), "save-as", tip, "Ctrl+Shift+S", filing.save_as
        )
        tip = tr("Save pictures, measurements and settings as an HTML page")
        self.report = make("report", tr("Repor&t…"), "report", tip, "Ctrl+Shift+E", reporting.ask_for_report)
        tip = tr("Save the view as a picture of any size, with or without background")
        self.picture = make(
            "save_picture", tr("Save &picture…"), "picture", tip, "Ctrl+Shift+P", reporting.ask_for_picture
        )
        tip = tr("Copy the view to the clipboard")
        self.copy_picture = make(
            "copy_picture", tr("&Copy picture"), "copy-picture", tip, "Ctrl+Shift+C", reporting.pictures.copy
        )
        tip = tr("Copy the Python lines that repeat this deformation to the clipboard")
        self.copy_python = make(
            "copy_python", tr("Copy as P&ython"), "copy-python", tip, None, reporting.copy_python_script
        )
        self.samples = []
        for name, sample in SAMPLES.items():
            command = partial(requests.open_sample, name)
            self.samples.append(
                make(f"open_sample:{name}", sample.title, f"sample-{name}", sample.tip, None, command)
            )

    def _make_target(self, maker: ActionMaker, commands: Commands) -> None:
        self.load_target = maker.make(
            "load_target",
            tr("Load tar&get shape…"),
            "load-target",
            tr("Compare the shape with another mesh: distances in colours and in numbers"),
            None,
            commands.target.ask_for_target_shape,
        )
        tip = tr("Stop comparing with the target shape")
        self.clear_target = maker.make(
            "clear_target",
            tr("Clear target s&hape"),
            "clear-target",
            tip,
            None,
            commands.target.clear_target_shape,
        )
        self.clear_target.setEnabled(False)

    def add_to_menu(self, menu: QMenu) -> None:
        """Add the file actions to a menu."""
        menu.addAction(self.open)
        self.recent = menu.addMenu(tr("Open &recent"))
        menu.addMenu(tr("Open sa&mple")).addActions(self.samples)
        menu.addAction(self.open_study)
        menu.addSeparator()
        menu.addActions([self.load_target, self.clear_target, self.remesh])
        menu.addSeparator()
        menu.addActions([self.save, self.save_as, self.export, self.scalars, self.animation, self.deck])
        menu.addSeparator()
        menu.addActions([self.report, self.picture, self.copy_picture, self.copy_python])
        menu.addSeparator()
        menu.addAction(self.quit)

    def follow_document(self, document: Document) -> None:
        """Enable the action to clear the target shape if there is one."""
        compares = document.target_shape is not None or document.missing_target_shape is not None
        self.clear_target.setEnabled(compares)

    def fill_recent(self, paths: Sequence[Path]) -> None:
        """List the recent files in their submenu."""
        self.recent.clear()
        for path, name in zip(paths, distinct_names(paths), strict=True):
            action = self.recent.addAction(menu_text(name))
            action.setStatusTip(str(path))
            action.triggered.connect(lambda _checked=False, path=path: self._open_path(path))
        self.recent.setEnabled(bool(paths))

    @property
    def mesh_actions(self) -> list[QAction]:
        """Actions available only for an open mesh."""
        made = self.report, self.picture, self.copy_picture, self.copy_python
        exports = self.export, self.scalars, self.animation, self.deck
        return [self.load_target, self.remesh, self.save, self.save_as, *exports, *made]
