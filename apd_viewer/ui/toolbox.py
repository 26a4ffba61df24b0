"""The tools that the mouse can hold, and the words for them."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple

from apd_viewer.geometry.constraints import BASE, FREE, HANDLE
from apd_viewer.ui.palette import BASE_COLOR, FREE_COLOR, HANDLE_COLOR


class _Words(NamedTuple):
    title: str
    key: str
    icon: str
    tip: str
    hint: str
    label: int | None = None
    color: tuple[int, int, int] | None = None


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
        BASE,
        BASE_COLOR,
    )
    HANDLE = _Words(
        "Paint handle",
        "H",
        "paint-handle",
        "Paint the part that you will move",
        f"Paint handle: drag on the mesh; {_BRUSH}",
        HANDLE,
        HANDLE_COLOR,
    )
    ERASE = _Words(
        "Erase",
        "E",
        "erase",
        "Take paint away, so that the part can deform",
        "Erase: drag on the mesh; wheel or [ ] for the size, Ctrl+wheel zooms, Esc takes the stroke back",
        FREE,
        FREE_COLOR,
    )
    MOVE = _Words(
        "Move handle",
        "M",
        "move",
        "Move and turn the handle with arrows, squares and rings",
        "Move handle: drag an arrow, a square or a ring; Ctrl snaps, Esc goes back",
    )

    @property
    def words(self) -> _Words:
        """Title, key, icon, tip and hint; for a brush also the label that it paints."""
        words: _Words = self.value
        return words
