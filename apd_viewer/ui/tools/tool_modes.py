"""Mouse tools and their texts."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple

from apd_viewer.language import tr, trc


class _ToolWords(NamedTuple):
    title: str
    key: str
    icon: str
    tip: str
    hint: str = ""
    is_brush: bool = False


_MODIFIERS = tr("Alt removes, Ctrl replaces, Esc cancels")
_CAMERA = tr("drag orbits, middle button or Shift+drag pans, wheel zooms to the cursor")


class Tool(Enum):
    """Mouse tool; its value holds its texts."""

    ORBIT = _ToolWords(tr("Orbit"), "O", "orbit", tr("Look around"), _CAMERA)
    BASE = _ToolWords(
        tr("Paint base"), "B", "paint-base", tr("Paint the part that stays in place"), is_brush=True
    )
    HANDLE = _ToolWords(tr("Paint handle"), "H", "paint-handle", tr("Paint a part to move"), is_brush=True)
    REGION = _ToolWords(
        tr("Paint region"),
        "R",
        "paint-region",
        tr("Paint a part to measure its area or keep it"),
        is_brush=True,
    )
    ERASE = _ToolWords(
        tr("Erase"),
        "E",
        "erase",
        tr("Erase base and handle so that the part can deform; where there is neither, erase the region"),
        is_brush=True,
    )
    MOVE = _ToolWords(
        tr("Move handle"),
        "M",
        "move",
        tr("Move and rotate a handle, or move an obstacle, with arrows, squares and rings"),
        tr("drag an arrow, a square or a ring; Ctrl snaps, Esc cancels, a click selects another"),
    )
    MEASURE = _ToolWords(
        tr("Measure"),
        "Q",
        "measure",
        tr("Measure distances, angles, geodesics and sections"),
        tr("click points on the mesh; Esc cancels"),
    )

    @property
    def words(self) -> _ToolWords:
        """Title, shortcut, icon, tooltip and hint, and whether the tool paints."""
        words: _ToolWords = self.value
        return words

    def hint(self, mode: SelectionMode) -> str:
        """Status hint of the tool, with the modifier keys of the selection mode."""
        if not self.words.is_brush:
            return tr("{tool}: {deed}").format(tool=self.words.title, deed=self.words.hint)
        return tr("{tool}: {deed}; {modifiers}").format(
            tool=self.words.title, deed=mode.words.hint, modifiers=self.modifiers
        )

    @property
    def modifiers(self) -> str:
        """Effects of the modifier keys while painting."""
        return tr("Esc cancels") if self is Tool.ERASE else _MODIFIERS


class SelectionMode(Enum):
    """Selection mode of the painting tools; its value holds its texts."""

    BRUSH = _ToolWords(
        tr("Brush"),
        "D",
        "way-brush",
        tr("Paint the surface under a round brush"),
        tr("drag on the mesh, wheel changes the size, Ctrl+wheel zooms"),
    )
    BOX = _ToolWords(
        trc("selection", "Box"),
        "X",
        "way-box",
        tr("Select inside a box on the screen"),
        tr("drag a box"),
    )
    LASSO = _ToolWords(
        tr("Lasso"),
        "Z",
        "way-lasso",
        tr("Select inside a freehand outline"),
        tr("draw an outline"),
    )
    POLYGON = _ToolWords(
        tr("Polygon"),
        "P",
        "way-polygon",
        tr("Select inside a polygon on the screen"),
        tr("click its corners; click the first again or press Enter to close it"),
    )
    FILL = _ToolWords(
        tr("Fill to sharp edges"),
        "G",
        "way-fill",
        tr("Select the surface around a point, up to sharp edges"),
        tr("click a point, wheel sets the edge angle, Ctrl+wheel zooms"),
    )
    PIECE = _ToolWords(
        tr("Connected part"),
        "J",
        "way-piece",
        tr("Select everything connected to a point"),
        tr("click a part"),
    )
    LOOP = _ToolWords(
        tr("Boundary loop"),
        "U",
        "way-loop",
        tr("Select the open boundary nearest to a point"),
        tr("click near an open boundary"),
    )
    SLAB = _ToolWords(
        tr("Between planes"),
        "Y",
        "way-slab",
        tr("Select between two planes"),
        tr("drag from one plane to the other, wheel changes the axis, Ctrl+wheel zooms"),
    )

    @property
    def words(self) -> _ToolWords:
        """Title, shortcut, icon, tooltip and hint."""
        words: _ToolWords = self.value
        return words


FIRST_TOOL, FIRST_MODE = Tool.MOVE, SelectionMode.BRUSH
