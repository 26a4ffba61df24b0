"""The actions that choose vertices: the ways of the tools that paint, and changes of a part as a whole."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtWidgets import QMenu

from apd_viewer.language import tr
from apd_viewer.ui.tools.toolbox import Way

if TYPE_CHECKING:
    from apd_viewer.ui.actions.action_factory import ActionMaker

# Title, icon, tip, keys, and the name in apd_viewer.session.part_operations.Change, which is loaded later.
_CHANGES = (
    (tr("&Grow"), "grow", tr("Add the neighbouring vertices to the active part"), "Ctrl++", "GROW"),
    (tr("S&hrink"), "shrink", tr("Remove the outermost vertices from the active part"), "Ctrl+-", "SHRINK"),
    (
        tr("&Smooth boundary"),
        "smooth-border",
        tr("Smooth the boundary of the active part"),
        "Ctrl+B",
        "SMOOTH",
    ),
    (
        tr("In&vert"),
        "invert",
        tr("Paint the unpainted vertices and clear the active part"),
        "Ctrl+Shift+I",
        "INVERT",
    ),
)
_MIRRORS = tuple(
    (
        tr("Along {axis}").format(axis=axis),
        "mirror",
        tr("Add the mirror image of the active part along {axis}").format(axis=axis),
        None,
        f"MIRROR_{axis}",
    )
    for axis in "XYZ"
)


class SelectActions:
    """How vertices are chosen.

    Parameters
    ----------
    maker : ActionMaker

    Attributes
    ----------
    ways : dict of Way to QAction
    through, numbers : QAction
    sizes, files, changes, mirrors : list of QAction
    """

    def __init__(self, maker: ActionMaker) -> None:
        self.ways = {
            way: maker.make(way.words.title, way.words.icon, way.words.tip, way.words.key, "way", way)
            for way in Way
        }
        maker.one_of(self.ways.values())
        self.through = maker.switch(
            tr("&X-ray (select hidden)"),
            "through",
            tr("Let box, lasso and polygon also select hidden vertices"),
            "T",
            "through",
        )
        self.sizes = [
            maker.make(tr("&Larger brush"), "grow", tr("Make the brush larger"), "]", "larger"),
            maker.make(tr("S&maller brush"), "shrink", tr("Make the brush smaller"), "[", "smaller"),
            maker.make(
                tr("Brush si&ze…"),
                "way-brush",
                tr("Enter the brush radius, in pixels or as a length on the mesh"),
                "Shift+D",
                "type_brush",
            ),
        ]
        self.numbers = maker.make(
            tr("Select by ID or expressio&n…"),
            "type",
            tr("Select vertices by ID or by conditions on their coordinates"),
            "Ctrl+L",
            "choose_by_numbers",
        )
        self.files = [
            maker.make(
                tr("&Load selection…"),
                "open",
                tr("Load base, handles and regions from a file"),
                None,
                "load_selection",
            ),
            maker.make(
                tr("Save selec&tion…"),
                "save",
                tr("Save base, handles and regions to a file"),
                None,
                "save_selection",
            ),
        ]
        self.changes = [maker.make(*words[:4], "reshape", words[4]) for words in _CHANGES]
        self.mirrors = [maker.make(*words[:4], "reshape", words[4]) for words in _MIRRORS]

    def fill(self, menu: QMenu) -> None:
        """Put all of them into a menu."""
        menu.addActions(list(self.ways.values()))
        menu.addSeparator()
        menu.addActions([self.numbers, self.through, *self.sizes])
        menu.addSeparator()
        menu.addActions(self.changes)
        self.mirror = menu.addMenu(tr("&Mirror"))
        self.mirror.addActions(self.mirrors)
        menu.addSeparator()
        menu.addActions(self.files)
