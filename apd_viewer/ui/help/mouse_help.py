"""Mouse gestures of each tool, in the words of the toolbox."""

from __future__ import annotations

from typing import NamedTuple

from apd_viewer.language import tr
from apd_viewer.ui.tools.toolbox import SelectionMode, Tool


class MouseGesture(NamedTuple):
    """Mouse gesture of a tool.

    Parameters
    ----------
    title : str
        Of the tool, or of the way to paint.
    image : str
        Name of its icon.
    text : str
    """

    title: str
    image: str
    text: str


# Camera gestures of apd_viewer.ui.scene.navigation, the same with every tool.
_ALWAYS = tr("right drag orbits, middle button or Shift+drag pans, Ctrl+right drag zooms")


def mouse_gestures() -> list[MouseGesture]:
    """All mouse gestures."""
    plain = [tool for tool in Tool if not tool.words.is_brush]
    found = [
        MouseGesture(tr("With any tool"), "view", _ALWAYS),
        *(MouseGesture(tool.words.title, tool.words.icon, tool.words.hint) for tool in plain),
        MouseGesture(tr("While painting"), Tool.HANDLE.words.icon, Tool.HANDLE.modifiers),
        *(MouseGesture(way.words.title, way.words.icon, way.words.hint) for way in SelectionMode),
    ]
    return [gesture._replace(text=gesture.text[:1].upper() + gesture.text[1:]) for gesture in found]
