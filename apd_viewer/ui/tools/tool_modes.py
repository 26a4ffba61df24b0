"""Mouse tools and their texts."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple

from apd_viewer.language import tr, trc


class _ToolTraits(NamedTuple):
    title: str
    key: str
    icon: str
    tip: str
    hint: str = ""
    is_brush: bool = False


_MODIFIERS = tr("Alt removes, Ctrl replaces, Esc cancels")
_CAMERA = tr("drag orbits, wheel zooms to the cursor")


class Tool(Enum):
    """Mouse tool; the value holds the tool's texts."""

    ORBIT = _ToolTraits(tr("Orbit"), "O", "orbit", tr("Look around"), _CAMERA)
    BASE = _ToolTraits(
        tr("Paint base"), "B", "paint-base", tr("Paint the part that stays in place"), is_brush=True
    )
    HANDLE = _ToolTraits(tr("Paint handle"), "H", "paint-handle", tr("Paint a part to move"), is_brush=True)
    REGION = _ToolTraits(
        tr("Paint region"),
        "R",
        "paint-region",
        tr("Paint a part to measure or keep its area"),
        is_brush=True,
    )
    ERASE = _ToolTraits(
        tr("Erase"),
        "E",
        "erase",
        tr("Erase base and handle so that the part can deform; where there is neither, erase the region"),
        is_brush=True,
    )
    MOVE = _ToolTraits(
        tr("Move handle"),
        "M",
        "move",
        tr("Move and rotate a handle, or move an obstacle, with arrows, squares and rings"),
        tr("drag an arrow, a square or a ring; Ctrl snaps, Esc cancels, a click selects another"),
    )
    MEASURE = _ToolTraits(
        tr("Measure"),
        "Q",
        "measure",
        tr("Measure distances, angles, geodesics and sections"),
        tr("click points on the mesh; Esc cancels"),
    )

    @property
    def traits(self) -> _ToolTraits:
        """Title, shortcut, icon, tooltip and hint, and whether the tool paints."""
        traits: _ToolTraits = self.value
        return traits

    def hint(self, mode: SelectionMode, camera: str, holds_obstacle: bool = False) -> str:
        """Status hint of the tool with its modifier keys; for Orbit, with camera drags."""
        if self is Tool.MOVE and holds_obstacle:
            return tr("Move obstacle: drag an arrow; Ctrl snaps, Esc cancels, a click selects another")
        if not self.traits.is_brush and self is not Tool.ORBIT:
            return tr("{tool}: {deed}").format(tool=self.traits.title, deed=self.traits.hint)
        return tr("{tool}: {deed}; {modifiers}").format(
            tool=self.traits.title,
            deed=self.traits.hint or mode.traits.hint,
            modifiers=camera if self is Tool.ORBIT else self.modifiers,
        )

    @property
    def modifiers(self) -> str:
        """Effects of the modifier keys while painting."""
        return tr("Esc cancels") if self is Tool.ERASE else _MODIFIERS


class SelectionMode(Enum):
    """Selection mode of the painting tools; the value holds the mode's texts."""

    BRUSH = _ToolTraits(
        tr("Brush"),
        "D",
        "way-brush",
        tr("Paint the surface under a round brush"),
        tr("drag on the mesh, wheel changes the size, Ctrl+wheel zooms"),
    )
    BOX = _ToolTraits(
        trc("selection", "Box"),
        "X",
        "way-box",
        tr("Select inside a box on the screen"),
        tr("drag a box"),
    )
    LASSO = _ToolTraits(
        tr("Lasso"),
        "Z",
        "way-lasso",
        tr("Select inside a freehand outline"),
        tr("draw an outline"),
    )
    POLYGON = _ToolTraits(
        tr("Polygon"),
        "P",
        "way-polygon",
        tr("Select inside a polygon on the screen"),
        tr("click its corners; click the first again or press Enter to close it"),
    )
    FILL = _ToolTraits(
        tr("Fill to sharp edges"),
        "G",
        "way-fill",
        tr("Select the surface around a point, up to sharp edges"),
        tr("click a point, wheel sets the edge angle, Ctrl+wheel zooms"),
    )
    PIECE = _ToolTraits(
        tr("Connected part"),
        "J",
        "way-piece",
        tr("Select everything connected to a point"),
        tr("click a part"),
    )
    LOOP = _ToolTraits(
        tr("Boundary loop"),
        "U",
        "way-loop",
        tr("Select the open boundary nearest to a point"),
        tr("click near an open boundary"),
    )
    SLAB = _ToolTraits(
        tr("Between planes"),
        "Y",
        "way-slab",
        tr("Select between two planes"),
        tr("drag from one plane to the other, wheel changes the axis, Ctrl+wheel zooms"),
    )

    @property
    def traits(self) -> _ToolTraits:
        """Title, shortcut, icon, tooltip and hint."""
        traits: _ToolTraits = self.value
        return traits


FIRST_TOOL, FIRST_MODE = Tool.MOVE, SelectionMode.BRUSH
