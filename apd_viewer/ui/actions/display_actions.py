"""The actions that show more than the shape: overlays, and what helps to see."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtWidgets import QMenu

from apd_viewer.language import tr
from apd_viewer.presentation.scales import Measure

if TYPE_CHECKING:
    from apd_viewer.ui.actions.action_factory import ActionMaker


class LookActions:
    """How the shape is looked at.

    Parameters
    ----------
    maker : ActionMaker

    Attributes
    ----------
    off : QAction
    measures : dict of Measure to QAction
    worst : list of QAction
    switches : dict of str to QAction
        What is on or off, by the names of their verbs.
    """

    def __init__(self, maker: ActionMaker) -> None:
        make = maker.make
        self.off = make(
            tr("&No overlay"),
            "overlay-off",
            tr("Show the paint without an overlay"),
            "Alt+0",
            "no_measure",
        )
        self.measures = {
            measure: make(
                measure.words.title, "overlay", measure.words.tip, measure.words.key, "measure", measure
            )
            for measure in Measure
        }
        maker.one_of([self.off, *self.measures.values()])
        self.worst = [
            make(
                tr("Ne&xt extreme"),
                "worst",
                tr("Go to the next extreme value of the overlay"),
                "C",
                "worst",
                1,
            ),
            make(
                tr("Pre&vious extreme"),
                "worst",
                tr("Go to the previous extreme value of the overlay"),
                "Shift+C",
                "worst",
                -1,
            ),
        ]

        self.switches = {
            name: maker.switch(title, image, tip, key, name)
            for name, title, image, tip, key in (
                (
                    "ghost",
                    tr("&Rest shape"),
                    "ghost",
                    tr("Show the rest shape as a transparent ghost"),
                    "A",
                ),
                (
                    "compare",
                    tr("&Before and after"),
                    "compare",
                    tr("Drag a slider to see the path from the rest shape"),
                    "Shift+A",
                ),
                ("cut", tr("Se&ction"), "cut", tr("Cut the mesh with a plane to see inside"), "S"),
                (
                    "ground",
                    tr("&Axes and grid"),
                    "ground",
                    tr("Show the axes and a ground grid in the unit of length"),
                    "I",
                ),
                (
                    "turntable",
                    tr("&Turntable"),
                    "turntable",
                    tr("Rotate the camera around the mesh until you use the mouse"),
                    "Shift+T",
                ),
            )
        }

    def show_measure(self, measure: Measure | None) -> None:
        """Check the measure that is shown."""
        (self.off if measure is None else self.measures[measure]).setChecked(True)

    def fill(self, menu: QMenu) -> None:
        """Put all of them into a menu."""
        self.overlay = menu.addMenu(tr("&Overlay"))
        self.overlay.addActions([self.off, *self.measures.values()])
        self.overlay.addSeparator()
        self.overlay.addActions(self.worst)
        menu.addSeparator()
        menu.addActions(list(self.switches.values()))
