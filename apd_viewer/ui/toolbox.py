"""The tools that the mouse can hold, and the words for them."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple


class _Words(NamedTuple):
    title: str
    key: str
    icon: str
    tip: str
    hint: str = ""
    is_brush: bool = False


_MODIFIERS = "Alt removes, Ctrl replaces, Esc goes back"
_CAMERA = "drag turns, middle button or Shift+drag shifts, wheel zooms to the cursor"


class Tool(Enum):
    """A tool; its value holds the words."""

    ORBIT = _Words("Orbit", "O", "orbit", "Look around", f"Orbit: {_CAMERA}")
    BASE = _Words("Paint base", "B", "paint-base", "Paint the part that stays in place", is_brush=True)
    HANDLE = _Words("Paint handle", "H", "paint-handle", "Paint a part that you will move", is_brush=True)
    REGION = _Words(
        "Paint region",
        "R",
        "paint-region",
        "Paint a part whose area you want to see, or to keep",
        is_brush=True,
    )
    ERASE = _Words(
        "Erase",
        "E",
        "erase",
        "Take base and handle away, so that the part can deform; where there is neither, the region",
        is_brush=True,
    )
    MOVE = _Words(
        "Move handle",
        "M",
        "move",
        "Move and turn a handle with arrows, squares and rings",
        "Move handle: drag an arrow, a square or a ring; Ctrl snaps, Esc goes back, a click takes another",
    )

    @property
    def words(self) -> _Words:
        """Title, key, icon, tip and hint, and whether it paints."""
        words: _Words = self.value
        return words

    def hint(self, way: Way) -> str:
        """What it does, with the modifiers, when it paints in this way."""
        if not self.words.is_brush:
            return self.words.hint
        modifiers = "Esc goes back" if self is Tool.ERASE else _MODIFIERS
        return f"{self.words.title}: {way.words.hint}; {modifiers}"


class Way(Enum):
    """How vertices are chosen by the tools that paint; its value holds the words."""

    BRUSH = _Words(
        "Brush",
        "D",
        "way-brush",
        "Paint what lies under a round brush, along the surface",
        "drag on the mesh, wheel or [ ] for the size, Ctrl+wheel zooms",
    )
    BOX = _Words("Box", "X", "way-box", "Take what lies within a box on the screen", "drag a box")
    LASSO = _Words(
        "Lasso", "Z", "way-lasso", "Take what lies within a line drawn by hand", "draw a line around"
    )
    POLYGON = _Words(
        "Polygon",
        "P",
        "way-polygon",
        "Take what lies within a polygon on the screen",
        "click its corners, and the first one again or Return to close it",
    )
    FILL = _Words(
        "Fill up to creases",
        "G",
        "way-fill",
        "Take the surface around a place, up to where it is creased",
        "click a place, wheel for how sharp a crease must be, Ctrl+wheel zooms",
    )
    PIECE = _Words(
        "Whole piece", "J", "way-piece", "Take all that is connected with a place", "click a piece"
    )
    LOOP = _Words(
        "Border loop", "U", "way-loop", "Take the open border nearest to a place", "click near an open border"
    )
    SLAB = _Words(
        "Between planes",
        "Y",
        "way-slab",
        "Take what lies between two planes",
        "drag from one plane to the other, wheel for the axis, Ctrl+wheel zooms",
    )

    @property
    def words(self) -> _Words:
        """Title, key, icon, tip and hint."""
        words: _Words = self.value
        return words
