"""The tools that the mouse can hold, and the words for them."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple

from apd_viewer.language import tr


class _Words(NamedTuple):
    title: str
    key: str
    icon: str
    tip: str
    hint: str = ""
    is_brush: bool = False


_MODIFIERS = tr("Alt removes, Ctrl replaces, Esc goes back")
_CAMERA = tr("drag turns, middle button or Shift+drag shifts, wheel zooms to the cursor")


class Tool(Enum):
    """A tool; its value holds the words."""

    ORBIT = _Words(tr("Orbit"), "O", "orbit", tr("Look around"), _CAMERA)
    BASE = _Words(
        tr("Paint base"), "B", "paint-base", tr("Paint the part that stays in place"), is_brush=True
    )
    HANDLE = _Words(
        tr("Paint handle"), "H", "paint-handle", tr("Paint a part that you will move"), is_brush=True
    )
    REGION = _Words(
        tr("Paint region"),
        "R",
        "paint-region",
        tr("Paint a part whose area you want to see, or to keep"),
        is_brush=True,
    )
    ERASE = _Words(
        tr("Erase"),
        "E",
        "erase",
        tr("Take base and handle away, so that the part can deform; where there is neither, the region"),
        is_brush=True,
    )
    MOVE = _Words(
        tr("Move handle"),
        "M",
        "move",
        tr("Move and turn a handle with arrows, squares and rings"),
        tr("drag an arrow, a square or a ring; Ctrl snaps, Esc goes back, a click takes another"),
    )

    @property
    def words(self) -> _Words:
        """Title, key, icon, tip and hint, and whether it paints."""
        words: _Words = self.value
        return words

    def hint(self, way: Way) -> str:
        """What it does, with the modifiers, when it paints in this way."""
        if not self.words.is_brush:
            return tr("{tool}: {deed}").format(tool=self.words.title, deed=self.words.hint)
        return tr("{tool}: {deed}; {modifiers}").format(
            tool=self.words.title, deed=way.words.hint, modifiers=self.modifiers
        )

    @property
    def modifiers(self) -> str:
        """What other keys do while it paints."""
        return tr("Esc goes back") if self is Tool.ERASE else _MODIFIERS


class Way(Enum):
    """How vertices are chosen by the tools that paint; its value holds the words."""

    BRUSH = _Words(
        tr("Brush"),
        "D",
        "way-brush",
        tr("Paint what lies under a round brush, along the surface"),
        tr("drag on the mesh, wheel for the size, Ctrl+wheel zooms"),
    )
    BOX = _Words(tr("Box"), "X", "way-box", tr("Take what lies within a box on the screen"), tr("drag a box"))
    LASSO = _Words(
        tr("Lasso"),
        "Z",
        "way-lasso",
        tr("Take what lies within a line drawn by hand"),
        tr("draw a line around"),
    )
    POLYGON = _Words(
        tr("Polygon"),
        "P",
        "way-polygon",
        tr("Take what lies within a polygon on the screen"),
        tr("click its corners, and the first one again or Return to close it"),
    )
    FILL = _Words(
        tr("Fill up to creases"),
        "G",
        "way-fill",
        tr("Take the surface around a place, up to where it is creased"),
        tr("click a place, wheel for how sharp a crease must be, Ctrl+wheel zooms"),
    )
    PIECE = _Words(
        tr("Whole piece"),
        "J",
        "way-piece",
        tr("Take all that is connected with a place"),
        tr("click a piece"),
    )
    LOOP = _Words(
        tr("Border loop"),
        "U",
        "way-loop",
        tr("Take the open border nearest to a place"),
        tr("click near an open border"),
    )
    SLAB = _Words(
        tr("Between planes"),
        "Y",
        "way-slab",
        tr("Take what lies between two planes"),
        tr("drag from one plane to the other, wheel for the axis, Ctrl+wheel zooms"),
    )

    @property
    def words(self) -> _Words:
        """Title, key, icon, tip and hint."""
        words: _Words = self.value
        return words
