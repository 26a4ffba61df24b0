"""Actions of the camera and of the appearance."""

from __future__ import annotations

from functools import partial

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMenu

from apd_viewer.language import tr
from apd_viewer.ui.actions.action_maker import ActionMaker
from apd_viewer.ui.actions.camera_actions import CameraActions
from apd_viewer.ui.actions.commands import Commands
from apd_viewer.ui.actions.display_actions import DisplayActions
from apd_viewer.ui.appearance.shading import Shading

_SCHEMES = (
    (tr("&System default"), Qt.ColorScheme.Unknown, tr("Follow the light or dark mode of the system")),
    (tr("&Light"), Qt.ColorScheme.Light, tr("Use the light theme")),
    (tr("&Dark"), Qt.ColorScheme.Dark, tr("Use the dark theme")),
)
_SHADINGS = (
    ("shade:file", tr("As in the f&ile"), tr("Shade with the normals of the file"), Shading.FILE),
    ("smooth", tr("&Smooth"), tr("Shade smoothly across all edges"), Shading.SMOOTH),
    ("shade:sharp", tr("Sharp &edges"), tr("Shade smoothly, except across edges above 30°"), Shading.SHARP),
    ("shade:flat", tr("&Flat"), tr("Shade each triangle by itself"), Shading.FLAT),
)


class ViewActions:
    """Actions of the camera, shading and colours of the window.

    Parameters
    ----------
    maker : ActionMaker
    commands : Commands

    Attributes
    ----------
    frame, findings, edges : QAction
    shadings : dict of Shading to QAction
    camera : CameraActions
    schemes : dict of Qt.ColorScheme to QAction
    """

    def __init__(self, maker: ActionMaker, commands: Commands) -> None:
        canvas = commands.canvas
        self._surface = canvas.surface
        self.frame = maker.make(
            "frame", tr("&Frame mesh"), "frame", tr("Zoom to the whole mesh"), "F", canvas.frame_mesh
        )
        self.findings = maker.make(
            "findings",
            tr("Mesh chec&k"),
            "warning",
            tr("List the issues found in the mesh and show where they are"),
            "Ctrl+I",
            commands.findings.toggle_list,
        )
        commands.findings.badge.show_keys_in_tip(self.findings)
        self.camera = CameraActions(maker, canvas)
        commands.comparison.set_shortcuts(self.camera.directions, self.frame)
        tip = tr("Show the triangle edges")
        self.edges = maker.make_switch("edges", tr("&Edges"), "edges", tip, "W", self._show_edges)
        self.shadings = {}
        for name, title, tip, shading in _SHADINGS:
            self.shadings[shading] = maker.make(
                name, title, "smooth", tip, None, partial(self._shade, shading)
            )
        maker.make_exclusive(self.shadings.values())
        self.refresh()
        self.schemes = {}
        for title, scheme, tip in _SCHEMES:
            name, choose = f"scheme:{scheme.name}", partial(commands.set_scheme, scheme)
            self.schemes[scheme] = maker.make(name, title, "scheme", tip, None, choose)
        maker.make_exclusive(self.schemes.values())

    def _show_edges(self, on: bool) -> None:
        self._surface.shows_edges = on

    def _shade(self, shading: Shading) -> None:
        self._surface.shading = shading

    def refresh(self) -> None:
        """Offer the shadings that the mesh on screen has, and check the present one."""
        of_file, has = self.shadings[Shading.FILE], self._surface.has_normals
        of_file.setEnabled(has)
        of_file.setToolTip("" if has else tr("The file has no normals"))
        self.shadings[self._surface.shading].setChecked(True)
        self.camera.refresh()

    def fill(self, menu: QMenu, display: DisplayActions) -> None:
        """Put all of them into a menu, with those of the overlays between."""
        menu.addAction(self.frame)
        self.camera.fill(menu)
        menu.addSeparator()
        display.fill(menu)
        menu.addSeparator()
        menu.addAction(self.edges)
        shading = menu.addMenu(tr("&Shading"))
        shading.addActions(list(self.shadings.values()))
        shading.setToolTipsVisible(True)
        menu.addAction(self.findings)
        menu.addSeparator()
        self._menu, self._appearance = menu, menu.addMenu(tr("A&ppearance"))
        self._appearance.addActions(list(self.schemes.values()))

    def add_panels(self, actions: list[QAction]) -> None:
        """Add the panels above the appearance."""
        self._menu.insertActions(self._appearance.menuAction(), actions)
        self._menu.insertSeparator(self._appearance.menuAction())
