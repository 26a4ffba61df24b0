"""Table of all preferences: names, defaults, allowed values and texts."""

import os
from typing import Any, NamedTuple

from PySide6.QtCore import QLocale, Qt

from apd_viewer.language import languages, tr, trc
from apd_viewer.session.model.up_axis import UpAxis
from apd_viewer.session.quantities.units import UNIT_NAMES, Unit
from apd_viewer.ui.preferences.preference_values import Choice, NumberRange, Option, Preference
from apd_viewer.ui.scene.navigation_preset import DEFAULT_PRESET, NAVIGATION_PRESETS, NavigationPreset
from apd_viewer.ui.tools.brush_tool import DEFAULT_RADIUS, LARGEST_RADIUS, SMALLEST_RADIUS
from apd_viewer.ui.tools.tool_modes import FIRST_MODE, SelectionMode

_RESTART = tr("Takes effect after a restart")
_SYSTEM = tr("System default")
_MIB = 2**20
_MINUTE = 60.0  # seconds
_CORES = os.cpu_count() or 1


def _language_name(name: str) -> str:
    if name == "en":  # Qt names it American English
        return "English"
    return QLocale(name).nativeLanguageName().capitalize() or name


def _count(number: int) -> Option[int]:
    return Option(str(number), number, str(number))


def _unit(unit: Unit | None, name: str) -> Option[Unit | None]:
    return Option("-" if unit is None else unit.value or "-", unit, name)


def _memory(mebibytes: int) -> Option[int]:
    title = f"{mebibytes} MiB" if mebibytes < 1024 else f"{mebibytes // 1024} GiB"
    return Option(str(mebibytes), mebibytes * _MIB, title)


LANGUAGE: Preference[str] = Preference(
    "language",
    "",
    Choice((Option("", "", _SYSTEM), *(Option(name, name, _language_name(name)) for name in languages()))),
    tr("Language"),
    tr("Language of the window and of the command line"),
    _RESTART,
)
COLOR_SCHEME: Preference[Qt.ColorScheme] = Preference(
    "scheme",
    Qt.ColorScheme.Unknown,
    Choice(
        (
            Option("0", Qt.ColorScheme.Unknown, _SYSTEM),
            Option("1", Qt.ColorScheme.Light, trc("colors", "Light")),
            Option("2", Qt.ColorScheme.Dark, trc("colors", "Dark")),
        )
    ),
    tr("Appearance"),
    tr("Light or dark colours of the window"),
)
NAVIGATION: Preference[NavigationPreset] = Preference(
    "navigation",
    DEFAULT_PRESET,
    Choice(tuple(Option(name, preset, preset.title) for name, preset in NAVIGATION_PRESETS.items())),
    tr("Navigation"),
    tr("Mouse buttons that orbit, pan and zoom, as in another program"),
    tr("The wheel zooms in all of them"),
)
UNIT: Preference[Unit | None] = Preference(
    "default_unit",
    None,
    Choice((Option("", None, tr("Automatic")), *(_unit(unit, name) for unit, name in UNIT_NAMES.items()))),
    tr("Unit of length"),
    tr("Unit of files opened for the first time"),
    tr("Automatic follows your last two files"),
)
UP_AXIS: Preference[UpAxis] = Preference(
    "default_up_axis",
    UpAxis.PLUS_Y,
    Choice(tuple(Option(axis.value, axis, axis.value) for axis in UpAxis)),
    tr("Up axis"),
    tr("Up axis of files opened for the first time"),
    tr("glTF and 3MF files have their own"),
)
SELECTION_MODE: Preference[SelectionMode] = Preference(
    "selection_mode",
    FIRST_MODE,
    Choice(tuple(Option(way.name.lower(), way, way.traits.title) for way in SelectionMode)),
    tr("Selection mode"),
    tr("Selection mode when the program starts"),
)
BRUSH_RADIUS: Preference[float] = Preference(
    "brush_radius",
    DEFAULT_RADIUS,
    NumberRange(SMALLEST_RADIUS, LARGEST_RADIUS, tr(" px")),
    tr("Brush radius"),
    tr("Radius of the brush when the program starts"),
    tr("The wheel changes it while you paint"),
)
AUTOSAVE: Preference[float | None] = Preference(
    "autosave",
    0.0,
    Choice(
        (
            Option("0", 0.0, tr("After every step")),
            Option("60", _MINUTE, tr("Once a minute")),
            Option("300", 5.0 * _MINUTE, tr("Every 5 minutes")),
            Option("off", None, trc("autosave", "Off")),
        )
    ),
    tr("Autosave"),
    tr("How often unsaved work is kept for recovery"),
    tr("Recovers your work after a crash"),
)
UNDO_MEMORY: Preference[int] = Preference(
    "undo_memory",
    512 * _MIB,
    Choice(tuple(map(_memory, (64, 128, 256, 512, 1024, 2048, 4096, 8192)))),
    tr("Undo memory"),
    tr("Memory for the steps that can be undone"),
    tr("Beyond it, the oldest steps are dropped"),
)
THREADS: Preference[int] = Preference(
    "threads",
    0,
    Choice(
        (
            Option("0", 0, tr("All cores ({n})").format(n=_CORES)),
            *(_count(2**power) for power in range(16) if 2**power < _CORES),
        )
    ),
    tr("Threads"),
    tr("Largest number of processor cores for the solver and the measurements"),
    _RESTART,
)


class PreferenceGroup(NamedTuple):
    """Group of rows on the Settings page, with a heading."""

    title: str
    rows: tuple[Preference[Any], ...]


GROUPS = (
    PreferenceGroup(tr("General"), (LANGUAGE, COLOR_SCHEME, NAVIGATION)),
    PreferenceGroup(tr("New files"), (UNIT, UP_AXIS)),
    PreferenceGroup(tr("Painting"), (SELECTION_MODE, BRUSH_RADIUS)),
    PreferenceGroup(tr("Undo and recovery"), (AUTOSAVE, UNDO_MEMORY)),
    PreferenceGroup(tr("Performance"), (THREADS,)),
)
PREFERENCES = tuple(row for group in GROUPS for row in group.rows)
