"""Actions of the overlays and other viewing aids."""

from __future__ import annotations

from functools import partial

from PySide6.QtWidgets import QMenu

from apd_viewer.language import tr
from apd_viewer.presentation.scales import Measure
from apd_viewer.session.model.document import Document
from apd_viewer.ui.actions.action_maker import ActionMaker
from apd_viewer.ui.overlays.display_options import DisplayOptions
from apd_viewer.ui.preferences.shortcut_hints import show_keys_in_tip

_COLORS = tr("Show the vertex colours of the file under the paint")
_TEXTURES = tr("Show the textures of the file under the paint")
_TARGET = tr("Show the target shape as a transparent ghost")


class DisplayActions:
    """Actions of the display of the shape.

    Parameters
    ----------
    maker : ActionMaker
    display_options : DisplayOptions

    Attributes
    ----------
    no_overlay : QAction
    measures : dict of Measure to QAction
    extremes : list of QAction
    switches : dict of str to QAction
        What is on or off, by name.
    """

    def __init__(self, maker: ActionMaker, display_options: DisplayOptions) -> None:
        self._looks = display_options
        self._make_measures(maker)
        self._make_checkablees(maker)
        self._follow()

    def _make_measures(self, maker: ActionMaker) -> None:
        heat = self._looks.overlay
        self.no_overlay = maker.make(
            "no_measure",
            tr("&No overlay"),
            "overlay-off",
            tr("Show the paint without an overlay"),
            "Alt+0",
            partial(heat.choose_measure, None),
        )
        self.measures = {}
        for measure in Measure:
            name, words = f"measure:{measure.name}", measure.traits
            self.measures[measure] = maker.make(
                name, words.title, "overlay", words.tip, words.key, partial(heat.choose_measure, measure)
            )
        maker.make_exclusive([self.no_overlay, *self.measures.values()])
        self.extremes = [
            maker.make(
                "worst:1",
                tr("Ne&xt extreme"),
                "worst",
                tr("Go to the next extreme value of the overlay"),
                "C",
                partial(heat.show_next_extreme, 1),
            ),
            maker.make(
                "worst:-1",
                tr("Pre&vious extreme"),
                "worst",
                tr("Go to the previous extreme value of the overlay"),
                "Shift+C",
                partial(heat.show_next_extreme, -1),
            ),
        ]

    def _make_checkablees(self, maker: ActionMaker) -> None:
        looks = self._looks
        ghost = tr("Show the rest shape as a transparent ghost")
        compare = tr("Drag a slider to see the path from the rest shape")
        cut = tr("Cut the mesh with a plane to see inside")
        ground = tr("Show the axes and a ground grid in the unit of length")
        turntable = tr("Rotate the camera around the mesh until you use the mouse")
        self.switches = {
            name: maker.make_checkable(name, title, name, tip, key, command, on)
            for name, title, tip, key, command, on in (
                ("ghost", tr("&Rest shape"), ghost, "A", looks.show_ghost, looks.ghost.visible),
                (
                    "target_ghost",
                    tr("Target s&hape"),
                    _TARGET,
                    None,
                    looks.show_target,
                    looks.target_ghost.visible,
                ),
                ("compare", tr("&Before and after"), compare, "Shift+A", looks.before_after.show_card, False),
                ("cut", tr("Se&ction"), cut, "S", looks.cutting_plane.show_card, False),
                ("ground", tr("&Axes and grid"), ground, "I", looks.show_ground, looks.ground.visible),
                (
                    "file_colors",
                    tr("Co&lours of the file"),
                    _COLORS,
                    None,
                    looks.show_file_colors,
                    looks.shows_file_colors,
                ),
                ("textures", tr("Te&xtures"), _TEXTURES, None, looks.show_textures, looks.shows_textures),
                ("turntable", tr("&Turntable"), turntable, "Shift+T", looks.set_turning, False),
            )
        }

    def follow(self, document: Document) -> None:
        """Offer what a document and the file of its mesh have."""
        mesh, compares = document.mesh, document.target_shape is not None
        for name, has, tip, lack in (
            ("file_colors", mesh.colors is not None, _COLORS, tr("The file has no vertex colours")),
            ("textures", mesh.texture[0] is not None, _TEXTURES, tr("The file has no texture")),
            ("target_ghost", compares, _TARGET, tr("There is no target shape")),
        ):
            switch, said = self.switches[name], tip if has else lack
            switch.setEnabled(has)
            switch.setStatusTip(said)
            switch.setToolTip(said)

    def _follow(self) -> None:
        """Check the action of the overlay shown, and name equivalent keys."""
        looks, switches = self._looks, self.switches
        looks.overlay.changed.connect(self._check_measure)
        looks.before_after.dismissed.connect(partial(switches["compare"].setChecked, False))
        looks.cutting_plane.dismissed.connect(partial(switches["cut"].setChecked, False))
        looks.turntable.stopped.connect(partial(switches["turntable"].setChecked, False))
        show_keys_in_tip(looks.legend.close_button, self.no_overlay)
        show_keys_in_tip(looks.legend.next_extreme, self.extremes[0])
        show_keys_in_tip(looks.cutting_plane.close_button, switches["cut"])
        self._check_measure()

    def _check_measure(self) -> None:
        measure, offered = self._looks.overlay.measure, self._looks.overlay.offered_measures
        for each, action in self.measures.items():
            action.setEnabled(each in offered)
        (self.no_overlay if measure is None else self.measures[measure]).setChecked(True)

    def fill(self, menu: QMenu) -> None:
        """Put all of them into a menu."""
        self.overlay = menu.addMenu(tr("&Overlay"))
        self.overlay.addActions([self.no_overlay, *self.measures.values()])
        self.overlay.addSeparator()
        self.overlay.addActions(self.extremes)
        menu.addSeparator()
        menu.addActions(list(self.switches.values()))
