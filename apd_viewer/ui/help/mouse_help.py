"""Mouse gestures of each tool, in the words of the toolbox."""

from __future__ import annotations

from typing import NamedTuple

from apd_viewer.language import tr
from apd_viewer.ui.tools.toolbox import Tool, Way


class Gesture(NamedTuple):
    """Mouse gesture of a tool.

    Parameters
    ----------
    title : str
        Of the tool, or of the way to paint.
    image : str
        Name of its icon.
    words : str
    """

    title: str
    image: str
    words: str


# Camera gestures of apd_viewer.ui.scene.navigation, the same with every tool.
_ALWAYS = tr("right drag orbits, middle button or Shift+drag pans, Ctrl+right drag zooms")


def gestures() -> list[Gesture]:
    """All mouse gestures."""
    plain = [tool for tool in Tool if not tool.words.is_brush]
    found = [
        Gesture(tr("With any tool"), "view", _ALWAYS),
        *(Gesture(tool.words.title, tool.words.icon, tool.words.hint) for tool in plain),
        Gesture(tr("While painting"), Tool.HANDLE.words.icon, Tool.HANDLE.modifiers),
        *(Gesture(way.words.title, way.words.icon, way.words.hint) for way in Way),
    ]
    return [gesture._replace(words=gesture.words[:1].upper() + gesture.words[1:]) for gesture in found]
