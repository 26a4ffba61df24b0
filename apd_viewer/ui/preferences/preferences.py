"""What the window remembers from one start to the next."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QSettings, Qt
from PySide6.QtWidgets import QMainWindow

from apd_viewer.files.samples import resource
from apd_viewer.language import tr
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.wall_mass import Wall

if TYPE_CHECKING:
    from apd_viewer.geometry.mesh.mesh import Mesh

_MOST_RECENT = 8
_MOST_UNITS = 64
_UNITS = {unit.value or "-": unit for unit in Unit}


def own_file(mesh: Mesh) -> Path | None:
    """The user's file that a mesh came from; the samples are there to be played with."""
    return None if mesh.path is None or resource("") in mesh.path.parents else mesh.path


class Memory:
    """Recent files, the folder of the last one, their units, the layout of the window, light or dark.

    Parameters
    ----------
    settings : QSettings
        Where the platform keeps such things.
    """

    def __init__(self, settings: QSettings) -> None:
        self._settings = settings

    def _lines(self, key: str, default: Sequence[str] = ()) -> list[str]:
        """What is kept as lines; a file of settings tells one line from a list of one no more."""
        value: Any = self._settings.value(key, list(default))
        return [value] if isinstance(value, str) else [str(line) for line in value or []]

    def _named(self, key: str) -> dict[str, str]:
        """What is kept as lines of a name and a text."""
        return {name: text for name, _, text in (line.partition(" ") for line in self._lines(key))}

    def _keep_named(self, key: str, texts: dict[str, str]) -> None:
        self._settings.setValue(key, [f"{name} {text}" for name, text in texts.items()])

    @property
    def recent(self) -> list[Path]:
        """The files that were opened last, the latest first."""
        return [Path(path) for path in self._lines("recent")]

    @property
    def folded(self) -> list[str]:
        """The sections of the panel that are folded away, by their titles."""
        return self._lines("folded", [tr("Size and mass")])

    @folded.setter
    def folded(self, titles: list[str]) -> None:
        self._settings.setValue("folded", titles)

    @property
    def plots(self) -> list[str] | None:
        """What is plotted, by its names; None before anything was chosen."""
        value = self._settings.value("plots")
        return None if value is None else [name for name in str(value).split() if name]

    @plots.setter
    def plots(self, names: list[str]) -> None:
        self._settings.setValue("plots", " ".join(names))

    @property
    def compared(self) -> list[str]:
        """The methods that were compared last, by their names; empty before any were."""
        return str(self._settings.value("compared", "")).split()

    @compared.setter
    def compared(self, names: list[str]) -> None:
        self._settings.setValue("compared", " ".join(names))

    @property
    def folder(self) -> Path:
        """Where the last file was."""
        return Path(str(self._settings.value("folder", str(Path.home()))))

    def remember(self, path: Path) -> None:
        """Put ``path`` at the head of the recent files."""
        path = path.resolve()
        recent = [path, *(other for other in self.recent if other != path)][:_MOST_RECENT]
        self._settings.setValue("recent", [str(other) for other in recent])
        self._settings.setValue("folder", str(path.parent))

    @property
    def units(self) -> dict[Path, Unit]:
        """The units of the files for which one was chosen, the latest choice first."""
        units = {}
        for line in self._lines("units"):
            symbol, _, path = line.partition(" ")
            if path and symbol in _UNITS:
                units[Path(path)] = _UNITS[symbol]
        return units

    def remember_unit(self, path: Path, unit: Unit) -> None:
        """Put the choice of ``unit`` for the file at ``path`` before all others."""
        path = path.resolve()
        units = {path: unit, **{other: old for other, old in self.units.items() if other != path}}
        lines = [f"{unit.value or '-'} {other}" for other, unit in units.items()]
        self._settings.setValue("units", lines[:_MOST_UNITS])

    @property
    def walls(self) -> dict[Path, Wall]:
        """What the files' surfaces are made of, where that was said, the latest first."""
        walls = {}
        for line in self._lines("walls"):
            with contextlib.suppress(ValueError, TypeError):  # somebody has written into the settings
                path, thickness, density = json.loads(line)
                walls[Path(path)] = Wall(str(thickness), str(density))
        return walls

    def remember_wall(self, path: Path, wall: Wall) -> None:
        """Put what the surface in the file at ``path`` is made of before all others."""
        path = path.resolve()
        walls = {path: wall, **{other: old for other, old in self.walls.items() if other != path}}
        lines = [json.dumps([str(other), *wall]) for other, wall in walls.items()]
        self._settings.setValue("walls", lines[:_MOST_UNITS])

    @property
    def shortcuts(self) -> dict[str, str]:
        """The keys that were chosen, by the names of their actions."""
        return self._named("shortcuts")

    @shortcuts.setter
    def shortcuts(self, shortcuts: dict[str, str]) -> None:
        self._keep_named("shortcuts", shortcuts)

    @property
    def looks(self) -> dict[str, str]:
        """How the shape was looked at, by names that :class:`Looks` gives."""
        return self._named("looks")

    @looks.setter
    def looks(self, looks: dict[str, str]) -> None:
        self._keep_named("looks", looks)

    @property
    def toured(self) -> bool:
        """Whether this is not the first start of all: then the tour is shown only when asked for."""
        return bool(self._settings.value("tour", False, bool))

    @toured.setter
    def toured(self, toured: bool) -> None:
        self._settings.setValue("tour", toured)

    @property
    def scheme(self) -> Qt.ColorScheme:
        """Light, dark, or as the platform has it."""
        return Qt.ColorScheme(self._settings.value("scheme", 0, int))

    @scheme.setter
    def scheme(self, scheme: Qt.ColorScheme) -> None:
        self._settings.setValue("scheme", scheme.value)

    def keep_layout(self, window: QMainWindow) -> None:
        """Remember size, place and panels of ``window``."""
        self._settings.setValue("geometry", window.saveGeometry())
        self._settings.setValue("layout", window.saveState())

    def restore_layout(self, window: QMainWindow) -> None:
        """Give ``window`` the size, place and panels that it had."""
        geometry, layout = self._settings.value("geometry"), self._settings.value("layout")
        if geometry is not None:
            window.restoreGeometry(geometry)
        if layout is not None:
            window.restoreState(layout)
