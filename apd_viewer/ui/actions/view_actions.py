"""Actions of the camera, shading, overlays and other display options."""

from __future__ import annotations

from functools import partial

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMenu

from apd_viewer.language import tr, trc
from apd_viewer.presentation.scales import Measure
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.up_axis import UpAxis
from apd_viewer.ui.actions.commands import Commands
from apd_viewer.ui.actions.window_menus import WindowMenus
from apd_viewer.ui.overlays.display_options import DisplayOptions
from apd_viewer.ui.overlays.region_picture import RegionPicture
from apd_viewer.ui.preferences.action_maker import ActionMaker
from apd_viewer.ui.preferences.shortcuts import show_shortcut_in_tooltip
from apd_viewer.ui.scene.surface_shading import Finish, Shading
from apd_viewer.ui.tools.canvas import Canvas

_SCHEMES = (
    (
        tr("&System default"),
        "scheme",
        Qt.ColorScheme.Unknown,
        tr("Follow the light or dark mode of the system"),
    ),
    (tr("&Light"), "scheme-light", Qt.ColorScheme.Light, tr("Use the light theme")),
    (tr("&Dark"), "scheme-dark", Qt.ColorScheme.Dark, tr("Use the dark theme")),
)
_SHADINGS = (
    (
        "shade:file",
        tr("As in the f&ile"),
        "shade-file",
        tr("Shade with the normals of the file"),
        Shading.FILE,
    ),
    ("smooth", tr("&Smooth"), "smooth", tr("Shade smoothly across all edges"), Shading.SMOOTH),
    (
        "shade:sharp",
        tr("Sharp &edges"),
        "shade-sharp",
        tr("Shade smoothly, except across edges above 30°"),
        Shading.SHARP,
    ),
    ("shade:flat", tr("&Flat"), "shade-flat", tr("Shade each triangle by itself"), Shading.FLAT),
)


class ViewActions:
    """Actions of the camera, shading and colours of the window."""

    def __init__(self, menus: WindowMenus, commands: Commands) -> None:
        maker, canvas = menus.maker, commands.canvas
        self._surface = canvas.surface
        self.frame = menus.frame
        tip = tr("List the issues found in the mesh and show where they are")
        self.findings = maker.make(
            "findings", tr("Mesh chec&k"), "warning", tip, "Ctrl+I", commands.findings.toggle_list
        )
        commands.findings.badge.show_shortcut_in_tooltip(self.findings)
        self.camera = CameraActions(maker, canvas)
        commands.comparison.set_shortcuts(self.camera.directions, self.frame)
        tip = tr("Show the triangle edges")
        self.edges = maker.make_checkable("edges", tr("&Edges"), "edges", tip, "W", self._show_edges)
        self.shadings = {}
        for name, title, image, tip, shading in _SHADINGS:
            self.shadings[shading] = maker.make(name, title, image, tip, None, partial(self._shade, shading))
        maker.make_exclusive(self.shadings.values())
        self.refresh()
        self.schemes = {}
        for title, image, scheme, tip in _SCHEMES:
            name, choose = f"scheme:{scheme.name}", partial(commands.set_scheme, scheme)
            self.schemes[scheme] = maker.make(name, title, image, tip, None, choose)
        maker.make_exclusive(self.schemes.values())

    def _show_edges(self, on: bool) -> None:
        self._surface.shows_edges = on

    def _shade(self, shading: Shading) -> None:
        self._surface.shading = shading

    def refresh(self) -> None:
        """Enable the shadings possible for the mesh, and check the current one."""
        of_file, has = self.shadings[Shading.FILE], self._surface.has_normals
        of_file.setEnabled(has)
        of_file.setToolTip("" if has else tr("The file has no normals"))
        self.shadings[self._surface.shading].setChecked(True)
        self.camera.refresh()

    def add_to_menu(self, menu: QMenu, display: DisplayActions) -> None:
        """Add the view actions to a menu, with the display actions in between."""
        menu.addAction(self.frame)
        self.camera.add_to_menu(menu, display.switches["turntable"])
        menu.addSeparator()
        display.add_to_menu(menu)
        menu.addAction(self.edges)
        shading = menu.addMenu(tr("&Shading"))
        shading.addActions(list(self.shadings.values()))
        shading.addSeparator()
        shading.addActions([display.switches[name] for name in ("file_colors", "textures")])
        shading.setToolTipsVisible(True)
        menu.addSeparator()
        menu.addAction(self.findings)
        menu.addSeparator()
        self._menu, self._appearance = menu, menu.addMenu(tr("A&ppearance"))
        self._appearance.addActions(list(self.schemes.values()))

    def add_panel_actions(self, actions: list[QAction]) -> None:
        """Insert the panel actions above the submenu of the appearance."""
        self._menu.insertActions(self._appearance.menuAction(), actions)
        self._menu.insertSeparator(self._appearance.menuAction())


_FINISHES = (
    (tr("&Clay"), "finish-clay", Finish.CLAY, tr("Show the mesh as if it were made of clay")),
    (
        tr("&PET"),
        "finish-pet",
        Finish.PET,
        tr("Show the mesh as if it were made of clear PET, with its inside"),
    ),
    (tr("&Foil"), "finish-foil", Finish.FOIL, tr("Show the mesh as if it were made of foil")),
    (tr("F&abric"), "finish-fabric", Finish.FABRIC, tr("Show the mesh as if it were made of fabric")),
)


_VIEWS = (
    (trc("view", "Front"), "look-front", tr("View the mesh from the front"), "1", "front"),
    (trc("view", "Right"), "look-right", tr("View the mesh from the right"), "3", "side"),
    (trc("view", "Top"), "look-top", tr("View the mesh from the top"), "7", "top"),
    (trc("view", "Back"), "look-back", tr("View the mesh from the back"), "Ctrl+1", "-front"),
    (trc("view", "Left"), "look-left", tr("View the mesh from the left"), "Ctrl+3", "-side"),
    (trc("view", "Bottom"), "look-bottom", tr("View the mesh from the bottom"), "Ctrl+7", "-top"),
)


class CameraActions:
    """Actions to choose the view direction, projection and up axis.

    Attributes
    ----------
    directions : dict of str to QAction
        By the name of the view, as in :meth:`Camera.standard_view`.
    """

    def __init__(self, maker: ActionMaker, canvas: Canvas) -> None:
        self._look = canvas.viewport.camera_controller
        self.directions = {}
        for title, image, tip, key, axis in _VIEWS:
            command = partial(canvas.show_standard_view, axis)
            self.directions[axis] = maker.make(f"look:{axis}", title, image, tip, key, command)
        canvas.orientation.views = self.directions
        tip = tr("View the mesh without perspective")
        project = canvas.viewport.camera_controller.set_orthographic
        self.orthographic = maker.make_checkable(
            "orthographic", tr("Ortho&graphic"), "orthographic", tip, "5", project
        )
        self.up_axes = {}
        for up_axis in UpAxis:
            name = up_axis.value.replace("-", "\N{MINUS SIGN}")
            tip = tr("Show the mesh with {axis} up").format(axis=name)
            image, choose = f"up-{up_axis.name.lower()}", partial(canvas.set_up_axis, up_axis)
            self.up_axes[up_axis] = maker.make(f"up:{up_axis.value}", name, image, tip, None, choose)
        maker.make_exclusive(self.up_axes.values())
        tip = tr("Make the axis that points up in the view the up axis")
        self.stand_upright = maker.make(
            "upright", tr("&Stand upright"), "upright", tip, None, self._stand_upright
        )
        self._canvas = canvas
        self.refresh()

    def _stand_upright(self) -> None:
        self._canvas.set_up_axis(UpAxis.nearest(self._look.camera.axes[1]))
        self.refresh()

    def refresh(self) -> None:
        """Check the actions for the camera's current projection and up axis."""
        eye = self._look.camera
        self.up_axes[eye.up_axis].setChecked(True)
        self.orthographic.setChecked(eye.is_orthographic)

    def add_to_menu(self, menu: QMenu, turntable: QAction) -> None:
        """Add a submenu of these actions and of the turntable to a menu."""
        camera = menu.addMenu(tr("Ca&mera"))
        camera.addActions(list(self.directions.values()))
        camera.addSeparator()
        camera.addActions([self.orthographic, turntable])
        up = camera.addMenu(tr("&Up axis"))
        up.addActions(list(self.up_axes.values()))
        up.addSeparator()
        up.addAction(self.stand_upright)


_COLORS = tr("Show the vertex colours of the file under the paint")
_TEXTURES = tr("Show the textures of the file under the paint")
_TARGET = tr("Show the target shape as a transparent ghost")


class DisplayActions:
    """Actions to choose the overlay and the display options.

    Attributes
    ----------
    switches : dict of str to QAction
        Checkable actions by name.
    """

    def __init__(self, maker: ActionMaker, display_options: DisplayOptions, picture: RegionPicture) -> None:
        self._looks = display_options
        self._make_measures(maker)
        self._make_checkable_actions(maker)
        self.finishes = {}
        for title, image, finish, tip in _FINISHES:
            name = f"finish:{finish.value}"
            choose = partial(display_options.choose_finish, finish)
            self.finishes[finish] = maker.make(name, title, image, tip, None, choose)
        maker.make_exclusive(self.finishes.values())
        self._make_picture(maker, picture)
        self._connect_display_options()

    def _make_picture(self, maker: ActionMaker, picture: RegionPicture) -> None:
        tip = tr("Lay an image, such as a label, on the active region; it deforms with the mesh")
        title, ask = tr("Picture on a &region…"), picture.ask_for_picture
        lay = maker.make("region_picture", title, "region-picture", tip, None, ask)
        tip = tr("Show the region without the picture again")
        remove = maker.make(
            "remove_picture", tr("Remo&ve picture"), "remove-picture", tip, None, picture.remove
        )
        remove.setEnabled(False)
        picture.changed.connect(remove.setEnabled)
        self.pictures = lay, remove

    def _make_measures(self, maker: ActionMaker) -> None:
        heat = self._looks.overlay
        tip = tr("Show the paint without an overlay")
        self.no_overlay = maker.make(
            "no_measure", tr("&No overlay"), "overlay-off", tip, "Alt+0", partial(heat.choose_measure, None)
        )
        self.measures = {}
        for measure in Measure:
            name, words, choose = (
                f"measure:{measure.name}",
                measure.traits,
                partial(heat.choose_measure, measure),
            )
            image = f"overlay-{measure.name.lower()}"
            self.measures[measure] = maker.make(name, words.title, image, words.tip, words.key, choose)
        maker.make_exclusive([self.no_overlay, *self.measures.values()])
        onwards, back = (partial(heat.show_next_extreme, step) for step in (1, -1))
        following = tr("Go to the next extreme value of the overlay")
        previous = tr("Go to the previous extreme value of the overlay")
        self.extremes = [
            maker.make("worst:1", tr("Ne&xt extreme"), "worst", following, "C", onwards),
            maker.make("worst:-1", tr("Pre&vious extreme"), "worst-previous", previous, "Shift+C", back),
        ]

    def _make_checkable_actions(self, maker: ActionMaker) -> None:
        looks = self._looks
        ghost = tr("Show the rest shape as a transparent ghost")
        compare = tr("Drag a slider to see the path from the rest shape")
        cut = tr("Cut the mesh with a plane to see inside")
        ground = tr("Show a ground grid in the unit of length")
        shadow = tr("Show a soft shadow on the ground under the mesh")
        axes = tr("Show the axes in a corner of the view; a click on one looks along it")
        turntable = tr("Rotate the camera around the mesh until you use the mouse")
        target, colors, textures = looks.target_ghost.visible, looks.shows_file_colors, looks.shows_textures
        self.switches = {
            name: maker.make_checkable(name, title, name, tip, key, command, on)
            for name, title, tip, key, command, on in (
                ("ghost", tr("&Rest shape"), ghost, "A", looks.show_ghost, looks.ghost.visible),
                ("target_ghost", tr("Target s&hape"), _TARGET, None, looks.show_target, target),
                ("compare", tr("&Before and after"), compare, "Shift+A", looks.before_after.show_card, False),
                ("cut", tr("Se&ction"), cut, "S", looks.cutting_plane.show_card, False),
                ("ground", tr("Groun&d grid"), ground, "I", looks.show_ground, looks.ground.visible),
                ("shadow", tr("Ground shado&w"), shadow, None, looks.show_shadow, looks.shadow.visible),
                ("orientation", tr("&Axes"), axes, None, looks.show_orientation, looks.orientation.visible),
                ("file_colors", tr("Co&lours of the file"), _COLORS, None, looks.show_file_colors, colors),
                ("textures", tr("Te&xtures"), _TEXTURES, None, looks.show_textures, textures),
                ("turntable", tr("&Turntable"), turntable, "Shift+T", looks.set_turntable_running, False),
            )
        }

    def follow_document(self, document: Document) -> None:
        """Enable the options available for a document and its mesh file."""
        mesh, looks, compares = document.mesh, self._looks, document.target_shape is not None
        colors, textures, target = looks.shows_file_colors, looks.shows_textures, looks.target_ghost.visible
        for name, has, on, tip, lack in (
            ("file_colors", mesh.colors is not None, colors, _COLORS, tr("The file has no vertex colours")),
            ("textures", mesh.texture[0] is not None, textures, _TEXTURES, tr("The file has no texture")),
            ("target_ghost", compares, target, _TARGET, tr("There is no target shape")),
        ):
            switch, said = self.switches[name], tip if has else lack
            switch.setEnabled(has)
            switch.blockSignals(True)
            switch.setChecked(has and on)  # the stored choice stays for other files
            switch.blockSignals(False)
            switch.setStatusTip(said)
            switch.setToolTip(said)

    def _connect_display_options(self) -> None:
        """Update check marks and tooltips when display options change."""
        looks, switches = self._looks, self.switches
        looks.overlay.changed.connect(self._check_measure)
        looks.before_after.dismissed.connect(partial(switches["compare"].setChecked, False))
        looks.cutting_plane.dismissed.connect(partial(switches["cut"].setChecked, False))
        looks.turntable.stopped.connect(partial(switches["turntable"].setChecked, False))
        show_shortcut_in_tooltip(looks.legend.close_button, self.no_overlay)
        show_shortcut_in_tooltip(looks.legend.next_extreme, self.extremes[0])
        show_shortcut_in_tooltip(looks.cutting_plane.close_button, switches["cut"])
        self._check_measure()

    def _check_measure(self) -> None:
        measure, offered = self._looks.overlay.measure, self._looks.overlay.offered_measures
        for each, action in self.measures.items():
            action.setEnabled(each in offered)
        (self.no_overlay if measure is None else self.measures[measure]).setChecked(True)
        self.finishes[self._looks.finish].setChecked(True)

    def add_to_menu(self, menu: QMenu) -> None:
        """Add submenus of these actions to a menu, and what is often switched itself."""
        self.overlay = menu.addMenu(tr("&Overlay"))
        self.overlay.addActions([self.no_overlay, *self.measures.values()])
        self.overlay.addSeparator()
        self.overlay.addActions(self.extremes)
        menu.addActions([self.switches[name] for name in ("ghost", "target_ghost", "compare", "cut")])
        menu.addSeparator()
        around = menu.addMenu(tr("Surrou&ndings"))
        around.addActions([self.switches[name] for name in ("ground", "shadow", "orientation")])
        finish = menu.addMenu(tr("F&inish"))
        finish.addActions(list(self.finishes.values()))
        finish.addSeparator()
        finish.addActions(list(self.pictures))
        finish.setToolTipsVisible(True)
