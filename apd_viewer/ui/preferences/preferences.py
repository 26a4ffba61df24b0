"""Preferences kept from one start to the next, and the up axis of each mesh."""

import contextlib
import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any
from weakref import WeakKeyDictionary

from PySide6.QtCore import QSettings
from PySide6.QtWidgets import QMainWindow

from apd_viewer.files.samples import resource_path
from apd_viewer.files.storage.atomic_file import resolved_path
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.language import tr
from apd_viewer.session.model.up_axis import UpAxis
from apd_viewer.session.quantities.units import UNIT_NAMES, Unit
from apd_viewer.session.quantities.wall import WallText
from apd_viewer.ui.preferences.preference_values import PreferenceValues

_MOST_RECENT = 8
MOST_REMEMBERED = 64
_UP_AXES = {axis.value for axis in UpAxis}
_UNITS = {unit.symbol or "-": unit for unit in UNIT_NAMES}


def user_file(mesh: Mesh) -> Path | None:
    """File of a mesh opened by the user; None for samples and meshes without one."""
    return None if mesh.path is None or resource_path("") in mesh.path.parents else mesh.path


class Preferences:
    """Stored recent files, folders, units, window layout and preferences.

    Parameters
    ----------
    settings : QSettings
        Settings storage of the platform.

    Attributes
    ----------
    values : PreferenceValues
        Preferences of the Settings page.
    """

    def __init__(self, settings: QSettings) -> None:
        self._settings = settings
        self.values = PreferenceValues(settings)

    def _lines(self, key: str, default: Sequence[str] = ()) -> list[str]:
        """Stored list of lines; QSettings returns a single line as a string."""
        value: Any = self._settings.value(key, list(default))
        return [value] if isinstance(value, str) else [str(line) for line in value or []]

    def _dictionary(self, key: str) -> dict[str, str]:
        """Stored lines as a dictionary of name to text."""
        return {name: text for name, _, text in (line.partition(" ") for line in self._lines(key))}

    def _keep_named(self, key: str, texts: dict[str, str]) -> None:
        self._settings.setValue(key, [f"{name} {text}" for name, text in texts.items()])

    @property
    def recent_files(self) -> list[Path]:
        """Recent files, latest first."""
        return [Path(path) for path in self._lines("recent")]

    @property
    def folded_sections(self) -> list[str]:
        """Names of the folded panel sections."""
        return self._lines("folded")

    @folded_sections.setter
    def folded_sections(self, names: list[str]) -> None:
        self._settings.setValue("folded", names)

    @property
    def plots(self) -> list[str] | None:
        """Names of the plots shown; None if never chosen."""
        value = self._settings.value("plots")
        return None if value is None else [name for name in str(value).split() if name]

    @plots.setter
    def plots(self, names: list[str]) -> None:
        self._settings.setValue("plots", " ".join(names))

    @property
    def compared_methods(self) -> list[str]:
        """Names of the methods last compared; empty if there were none."""
        return str(self._settings.value("compared", "")).split()

    @compared_methods.setter
    def compared_methods(self, names: list[str]) -> None:
        self._settings.setValue("compared", " ".join(names))

    @property
    def report_customer(self) -> str:
        """Customer named by the last report; empty if none was."""
        return str(self._settings.value("customer", ""))

    @report_customer.setter
    def report_customer(self, name: str) -> None:
        self._settings.setValue("customer", name)

    @property
    def storage_problem(self) -> str:
        """Error message if the settings cannot be written; empty otherwise."""
        if self._settings.isWritable():
            return ""
        return tr(
            "Settings and recent files are not kept, since {path} cannot be written; check its permissions."
        ).format(path=self._settings.fileName())

    @property
    def last_folder(self) -> Path:
        """Folder of the last file opened or saved."""
        return Path(str(self._settings.value("folder", str(Path.home()))))

    def remember_file(self, path: Path) -> None:
        """Move ``path`` to the front of the recent files."""
        path = resolved_path(path)
        recent = [path, *(other for other in self.recent_files if other != path)][:_MOST_RECENT]
        self._settings.setValue("recent", [str(other) for other in recent])
        self.remember_folder(path)

    def remember_folder(self, path: Path) -> None:
        """Propose the folder of a file the next time."""
        self._settings.setValue("folder", str(resolved_path(path).parent))

    @property
    def units(self) -> dict[Path, Unit]:
        """Chosen units by file, latest first."""
        units = {}
        for line in self._lines("units"):
            symbol, _, path = line.partition(" ")
            if path and symbol in _UNITS:
                units[Path(path)] = _UNITS[symbol]
        return units

    def remember_unit(self, path: Path, unit: Unit) -> None:
        """Store ``unit`` as the latest choice, for the file at ``path``."""
        path = resolved_path(path)
        units = {path: unit, **{other: old for other, old in self.units.items() if other != path}}
        lines = [f"{unit.symbol or '-'} {other}" for other, unit in units.items()]
        self._settings.setValue("units", lines[:MOST_REMEMBERED])

    @property
    def up_axes(self) -> dict[Path, UpAxis]:
        """Chosen up axes by file, latest first."""
        lines = (line.partition(" ") for line in self._lines("up_axes"))
        return {Path(path): UpAxis(axis) for axis, _, path in lines if path and axis in _UP_AXES}

    def remember_up_axis(self, path: Path, axis: UpAxis) -> None:
        """Store ``axis`` as the latest choice, for the file at ``path``."""
        path = resolved_path(path)
        axes = {path: axis, **{other: old for other, old in self.up_axes.items() if other != path}}
        lines = [f"{axis.value} {other}" for other, axis in axes.items()]
        self._settings.setValue("up_axes", lines[:MOST_REMEMBERED])

    @property
    def walls(self) -> dict[Path, WallText]:
        """Typed walls by file, latest first."""
        walls = {}
        for line in self._lines("walls"):
            with contextlib.suppress(ValueError, TypeError):  # ignore damaged entries
                path, *words = json.loads(line)
                walls[Path(path)] = WallText.from_field_texts(*map(str, words))
        return walls

    def remember_wall(self, path: Path, wall: WallText) -> None:
        """Store ``wall`` as the latest entry, for the file at ``path``."""
        path = resolved_path(path)
        walls = {path: wall, **{other: old for other, old in self.walls.items() if other != path}}
        lines = [json.dumps([str(other), *wall.field_texts]) for other, wall in walls.items()]
        self._settings.setValue("walls", lines[:MOST_REMEMBERED])

    @property
    def shortcuts(self) -> dict[str, str]:
        """User-defined shortcuts by action name."""
        return self._dictionary("shortcuts")

    @shortcuts.setter
    def shortcuts(self, shortcuts: dict[str, str]) -> None:
        self._keep_named("shortcuts", shortcuts)

    @property
    def display_options(self) -> dict[str, str]:
        """Display options by name."""
        return self._dictionary("looks")

    @display_options.setter
    def display_options(self, looks: dict[str, str]) -> None:
        self._keep_named("looks", looks)

    @property
    def has_seen_tour(self) -> bool:
        """True from the second run on: the tour then starts only on request."""
        return bool(self._settings.value("tour", False, bool))

    @has_seen_tour.setter
    def has_seen_tour(self, seen: bool) -> None:
        self._settings.setValue("tour", seen)

    def save_layout(self, window: QMainWindow) -> None:
        """Store the size, position and panels of ``window``."""
        self._settings.setValue("geometry", window.saveGeometry())
        self._settings.setValue("layout", window.saveState())

    def restore_layout(self, window: QMainWindow) -> None:
        """Restore the size, position and panels of ``window``."""
        geometry, layout = self._settings.value("geometry"), self._settings.value("layout")
        if geometry is not None:
            window.restoreGeometry(geometry)
        if layout is not None:
            window.restoreState(layout)


class UpAxes:
    """Chosen up axes; for a mesh without a file, only while the mesh exists.

    Parameters
    ----------
    default_axis : callable
        Up axis of a mesh whose format prescribes none, unless it is a sample.
    """

    def __init__(
        self, preferences: Preferences, default_axis: Callable[[], UpAxis] = lambda: UpAxis.PLUS_Y
    ) -> None:
        self._memory = preferences
        self._usual = default_axis
        self._chosen: WeakKeyDictionary[Mesh, UpAxis] = WeakKeyDictionary()

    def up_axis_of(self, mesh: Mesh) -> UpAxis:
        """Chosen up axis of a mesh, or the default of its file format."""
        return self.known_axis(mesh) or self._usual()

    def known_axis(self, mesh: Mesh) -> UpAxis | None:
        """Up axis chosen for a mesh or file, or prescribed by its format; else None."""
        path = user_file(mesh)
        if mesh in self._chosen:
            return self._chosen[mesh]
        if path is not None and (kept := self._memory.up_axes.get(resolved_path(path))) is not None:
            return kept
        if mesh.path is None:
            return None
        return UpAxis.from_suffix(mesh.path.suffix) or (UpAxis.PLUS_Y if path is None else None)

    def set_up_axis(self, mesh: Mesh, axis: UpAxis) -> None:
        """Set the up axis of a mesh, and remember it for the file of the mesh."""
        self._chosen[mesh] = axis
        path = user_file(mesh)
        if path is not None:
            self._memory.remember_up_axis(path, axis)
