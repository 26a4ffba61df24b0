"""The tools that the mouse can hold, and the words for them."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple


class _Words(NamedTuple):
    title: str
    key: str
    icon: str
    tip: str
    hint: str
    is_brush: bool = False


_BRUSH = "wheel or [ ] for the size, Alt erases, Ctrl+wheel zooms, Esc takes the stroke back"
_CAMERA = "drag turns, middle button or Shift+drag shifts, wheel zooms to the cursor"


class Tool(Enum):
    """A tool; its value holds the words."""

    ORBIT = _Words("Orbit", "O", "orbit", "Look around", f"Orbit: {_CAMERA}")
    BASE = _Words(
        "Paint base",
        "B",
        "paint-base",
        "Paint the part that stays in place",
        f"Paint base: drag on the mesh; {_BRUSH}",
        True,
    )
    HANDLE = _Words(
        "Paint handle",
        "H",
        "paint-handle",
        "Paint a part that you will move",
        f"Paint handle: drag on the mesh; {_BRUSH}",
        True,
    )
    REGION = _Words(
        "Paint region",
        "R",
        "paint-region",
        "Paint a part whose area you want to see, or to keep",
        f"Paint region: drag on the mesh; {_BRUSH}",
        True,
    )
    ERASE = _Words(
        "Erase",
        "E",
        "erase",
        "Take base and handle away, so that the part can deform; where there is neither, the region",
        "Erase: drag on the mesh; wheel or [ ] for the size, Ctrl+wheel zooms, Esc takes the stroke back",
        True,
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
        """Title, key, icon, tip and hint, and whether it is a brush."""
        words: _Words = self.value
        return words
