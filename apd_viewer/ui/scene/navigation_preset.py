"""Presets of navigation: mouse buttons and keys that move the camera."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from PySide6.QtCore import Qt

from apd_viewer.language import tr

_LEFT, _MIDDLE, _RIGHT = Qt.MouseButton.LeftButton, Qt.MouseButton.MiddleButton, Qt.MouseButton.RightButton
_ALONE, _SHIFT = Qt.KeyboardModifier.NoModifier, Qt.KeyboardModifier.ShiftModifier
_CTRL, _ALT = Qt.KeyboardModifier.ControlModifier, Qt.KeyboardModifier.AltModifier


class CameraMotion(Enum):
    """Motion of the camera by a drag."""

    ORBIT = "orbit"
    PAN = "pan"
    ZOOM = "zoom"


@dataclass(frozen=True)
class NavigationPreset:
    """Drags that move the camera as in another program; all others orbit.

    The wheel zooms in all presets, towards the point under the cursor.

    Parameters
    ----------
    title : str
        Name of the program.
    sentence : str
        What the drags do, for the status bar and the sheet of shortcuts.
    chords : tuple
        Button, key held with it, and motion of each drag.
    """

    title: str
    sentence: str
    chords: tuple[tuple[Qt.MouseButton, Qt.KeyboardModifier, CameraMotion], ...]

    def motion(self, button: Qt.MouseButton, keys: Qt.KeyboardModifier) -> CameraMotion:
        """Camera motion of a drag; a chord with a held key precedes one without a key."""
        found = [chord for chord in self.chords if chord[0] == button and (chord[1] & keys) == chord[1]]
        found.sort(key=lambda chord: chord[1] == _ALONE)
        return found[0][2] if found else CameraMotion.ORBIT

    def precedes_tools(self, button: Qt.MouseButton, keys: Qt.KeyboardModifier) -> bool:
        """True for a drag with Alt, which moves the camera before tools see it."""
        return any(chord[:2] == (button, _ALT) for chord in self.chords) and bool(keys & _ALT)


_ORBIT, _PAN, _ZOOM = CameraMotion
NAVIGATION_PRESETS = {
    "own": NavigationPreset(
        "APD Viewer",
        tr("right drag orbits, middle button or Shift+drag pans, Ctrl+right drag zooms"),
        ((_MIDDLE, _ALONE, _PAN), (_LEFT, _SHIFT, _PAN), (_RIGHT, _SHIFT, _PAN), (_RIGHT, _CTRL, _ZOOM)),
    ),
    "blender": NavigationPreset(
        "Blender",
        tr("middle drag orbits, with Shift it pans, with Ctrl it zooms"),
        ((_MIDDLE, _ALONE, _ORBIT), (_MIDDLE, _SHIFT, _PAN), (_MIDDLE, _CTRL, _ZOOM)),
    ),
    "rhino": NavigationPreset(
        "Rhino",
        tr("right drag orbits, with Shift it pans, with Ctrl it zooms"),
        ((_RIGHT, _ALONE, _ORBIT), (_RIGHT, _SHIFT, _PAN), (_RIGHT, _CTRL, _ZOOM)),
    ),
    "fusion": NavigationPreset(
        "Fusion",
        tr("middle drag pans, with Shift it orbits"),
        ((_MIDDLE, _ALONE, _PAN), (_MIDDLE, _SHIFT, _ORBIT)),
    ),
    "maya": NavigationPreset(
        "Maya",
        tr("Alt+left drag orbits, Alt+middle drag pans, Alt+right drag zooms"),
        ((_LEFT, _ALT, _ORBIT), (_MIDDLE, _ALT, _PAN), (_RIGHT, _ALT, _ZOOM)),
    ),
    "meshlab": NavigationPreset(
        "MeshLab",
        tr("left drag orbits, middle or Ctrl+left drag pans, Shift+left drag zooms"),
        ((_LEFT, _ALONE, _ORBIT), (_MIDDLE, _ALONE, _PAN), (_LEFT, _CTRL, _PAN), (_LEFT, _SHIFT, _ZOOM)),
    ),
}
DEFAULT_PRESET = NAVIGATION_PRESETS["own"]
