"""All that can be told of a window, to compare one that has been used with one just opened."""

import gc
import threading
from enum import Enum
from pathlib import Path

import numpy as np
from PySide6.QtCore import QObject, QTimer
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QApplication, QWidget
from shiboken6 import isValid

from apd_viewer.ui.settings_page.preference_table import GROUPS
from apd_viewer.ui.widgets.fields import ComboBox

_PLAIN = str, int, float, bool, Enum, type(None)
_TOLD = (
    *("visible", "enabled", "checked", "toolTip", "text", "currentText", "value", "windowTitle"),
    *("x", "y", "width", "height"),
)
_ROUNDING = 2  # pixels, by which a row of a layout is moved by what it has shown
_DEEPEST = 5
_COUNTS = {
    "draw_count",
    "revision",
    "shape_revision",
    "moment",
    "compiled_fraction",
    "step",
    "dab_spacing",
    "grid_step",
}
_NOTHING = "–"


def whole_state(window):
    """What is told, by its place."""
    gc.collect()
    found = {}
    for child in (window.shell, *window.shell.findChildren(QObject)):
        if isinstance(child, QWidget | QAction):
            _tell_shown(found, child)
        elif isinstance(child, QTimer) and child.isActive() and _in_sight(child.parent()):
            found[_unique_place(found, child)] = child.interval()
    _tell_attributes(found, window, "window", set(), 0)
    return {**found, **_surroundings(window)}


def _is_ours(thread):
    return thread.daemon and not thread.name.startswith("Thread-")  # all of the program's have names


def _in_sight(thing):
    return not isinstance(thing, QWidget) or (isValid(thing) and thing.isVisible())


def _tell_shown(found, child):
    if type(child) is ComboBox:  # hidden, too; those of results come with them
        found[f"{_unique_place(found, child)}.chosen"] = child.currentIndex()
    if not _in_sight(child) or child.objectName().startswith("qt_"):
        return
    place = _unique_place(found, child)
    if "qt_toolbar_ext" in place:
        return
    found[place] = type(child).__name__
    for name in _TOLD:
        if (value := child.property(name)) is not None:
            found[f"{place}.{name}"] = value if isinstance(value, int | float) else str(value)
    if isinstance(child, QAction):
        found[f"{place}.keys"] = [key.toString() for key in child.shortcuts()]


def _unique_place(found, child):
    """The names of a thing and of all that it is in, told apart from those of its like."""
    names = []
    while child is not None:
        names.append(f"{type(child).__name__} {child.objectName()}".strip())
        child = child.parent()
    place = "/".join(reversed(names))
    while place in found:
        place += "'"
    return place


def _tell_attributes(found, thing, place, seen, level):
    """Plain values of the program's objects that anybody may read, and of those that they have."""
    if isinstance(thing, _PLAIN):
        found[place] = thing
    elif not _in_sight(thing):
        found[place] = "hidden"
    elif id(thing) not in seen and level < _DEEPEST and type(thing).__module__.startswith("apd_viewer"):
        seen.add(id(thing))
        for name, value in getattr(thing, "__dict__", {}).items():
            if not name.startswith("_") and name not in _COUNTS:
                _tell_attributes(found, value, f"{place}.{name}", seen, level + 1)


def _surroundings(window):
    view = window.canvas.viewport
    eye, picture = view.camera_controller.camera, np.asarray(view.screenshot(return_img=True))
    return {
        "threads": sorted(thread.name for thread in threading.enumerate() if _is_ours(thread)),
        "handles": len(list(Path("/proc/self/fd").iterdir())),
        "windows": sorted(type(top).__name__ for top in QApplication.topLevelWidgets() if top.isVisible()),
        "focus": type(window.shell.focusWidget()).__name__,
        "clipboard": QApplication.clipboard().text(),
        "camera": [repr(np.round(part, 4)) for part in (eye.position, eye.focal, eye.up)],
        "brush": (window.canvas.brush.size.radius, window.canvas.brush.size.mesh_radius),
        "kind": window.measurements.tool.kind,
        "preferences": [window.preferences.values[row] for group in GROUPS for row in group.rows],
        "picture": hash(picture.tobytes()),
    }


def differences(before, after):
    """Lines that say what is not the same."""
    places = sorted({*before, *after})
    pairs = [(place, before.get(place, _NOTHING), after.get(place, _NOTHING)) for place in places]
    return [f"{place}: {one} → {other}" for place, one, other in pairs if not _are_alike(place, one, other)]


def _are_alike(place, one, other):
    if place.rpartition(".")[2] in ("x", "y", "width", "height") and _NOTHING not in (one, other):
        return abs(one - other) <= _ROUNDING
    return one == other or (one != one and other != other)
