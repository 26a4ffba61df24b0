"""Unit of length of each mesh: its button, and the choice stored per file."""

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from weakref import WeakKeyDictionary

from PySide6.QtCore import QRect, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QActionGroup, QIcon, QPainter, QPaintEvent
from PySide6.QtWidgets import QMenu, QToolButton

from apd_viewer.files.storage.atomic_file import resolved_path
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.language import tr
from apd_viewer.session.quantities.units import UNIT_NAMES, Unit
from apd_viewer.ui.preferences.preferences import Preferences, user_file
from apd_viewer.ui.widgets.fields import attach_menu
from apd_viewer.ui.widgets.theme import LIGHT, Theme, icon

_CHEVRON, _PADDING = 16, 6
_TIP = tr("Unit of length of this file: measurements are shown in it, and nothing is scaled")
_GUESS_TIP = tr("The unit of your last two files is a guess for this one: click to confirm or to change it")


class UnitButton(QToolButton):
    """Button with the name of the unit and a menu of all units.

    Attributes
    ----------
    chosen : Signal(Unit)
    """

    chosen = Signal(object)

    def __init__(self) -> None:
        super().__init__(toolTip=_TIP)
        self._theme = LIGHT
        self._unit = Unit.NONE
        menu = QMenu(self)
        group = QActionGroup(menu)
        for unit, name in with_mnemonics(UNIT_NAMES).items():
            action = menu.addAction(name)
            action.setCheckable(True)
            action.setData(unit.value)
            action.triggered.connect(lambda _checked=False, unit=unit: self.chosen.emit(unit))
            group.addAction(action)
        # Preselected, so that Enter or a second click confirms a guess.
        menu.aboutToShow.connect(lambda: menu.setActiveAction(group.checkedAction()))
        attach_menu(self, menu)
        self.show_unit(Unit.NONE)

    def show_unit(self, unit: Unit) -> None:
        """Show the name of the current unit."""
        self._unit = unit
        self.setText(unit.title)
        self.setAccessibleName(tr("Unit of length: {title}").format(title=unit.title))
        self.setToolTip(_GUESS_TIP if unit.is_guess else _TIP)
        for action in self.menu().actions():
            action.setChecked(action.data() == unit.symbol)
        self.updateGeometry()

    def set_theme(self, theme: Theme) -> None:
        """Apply the colours of the theme."""
        self._theme = theme
        self.update()

    def sizeHint(self) -> QSize:
        """Size of name and chevron, aligned with the chevrons of the sections."""
        metrics = self.fontMetrics()
        return QSize(_PADDING + metrics.horizontalAdvance(self.text()) + 4 + _CHEVRON, metrics.height() + 6)

    def paintEvent(self, _: QPaintEvent) -> None:
        """Draw name and chevron, highlighted until a unit is chosen."""
        theme, room = self._theme, self.rect()
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        if self.underMouse() or self.hasFocus() or self.isDown():
            painter.setPen(theme.accent if self.hasFocus() else theme.accent_soft)
            painter.setBrush(theme.accent_soft)
            painter.drawRoundedRect(QRectF(room).adjusted(0.5, 0.5, -0.5, -0.5), 4, 4)
        ink = theme.accent if self._unit is Unit.NONE else theme.warm if self._unit.is_guess else theme.ink
        painter.setPen(ink if self.isEnabled() else theme.faint)
        painter.drawText(room.adjusted(_PADDING, 0, 0, 0), Qt.AlignmentFlag.AlignVCenter, self.text())
        chevron = QRect(room.right() + 1 - _CHEVRON, (room.height() - _CHEVRON) // 2, _CHEVRON, _CHEVRON)
        mode = QIcon.Mode.Normal if self.isEnabled() else QIcon.Mode.Disabled
        icon("unfolded", theme).paint(painter, chevron, Qt.AlignmentFlag.AlignCenter, mode)


def with_mnemonics(names: Mapping[Unit, str]) -> dict[Unit, str]:
    """Names with different mnemonics, the first letters of their symbols if possible."""
    found, taken = dict(names), set[str]()

    def place(unit: Unit, places: Iterable[int]) -> None:
        name = names[unit]
        for k in places:
            letter = name[k].lower()
            if found[unit] is name and letter.isascii() and letter.isalpha() and letter not in taken:
                taken.add(letter)
                found[unit] = f"{name[:k]}&{name[k:]}"

    # A symbol of one letter comes first, as it has no other.
    for unit in sorted(names, key=lambda unit: len(unit.symbol)):
        place(unit, [names[unit].rfind(unit.symbol[:1]) if unit.symbol else 0])
    for unit, name in names.items():
        place(unit, range(len(name)))
    return found


class Units:
    """Units of length of the meshes opened.

    The choice for a file is remembered; for a sample, or a mesh without a file, it lasts as long as the mesh
    is open. The default is the unit stated in the file, else the one for new files, else a guess.

    Parameters
    ----------
    default_unit : callable
        Unit of a file opened for the first time; None follows the habit.
    """

    def __init__(
        self, preferences: Preferences, default_unit: Callable[[], Unit | None] = lambda: None
    ) -> None:
        self._memory = preferences
        self._usual = default_unit
        self._chosen: WeakKeyDictionary[Mesh, Unit] = WeakKeyDictionary()

    def unit_of(self, mesh: Mesh) -> Unit:
        """Chosen unit of a mesh, or the default or guessed one."""
        if mesh not in self._chosen:
            self._chosen[mesh] = self._default_unit(mesh, user_file(mesh))
        return self._chosen[mesh]

    def carry_over(self, before: Mesh, after: Mesh) -> None:
        """Take the unit for another rest shape of a mesh, or its welded mesh."""
        self._chosen[after] = self.unit_of(before)

    def set_unit(self, mesh: Mesh, unit: Unit) -> None:
        """Set the unit of a mesh, and remember it for the file of the mesh."""
        self._chosen[mesh] = unit
        path = user_file(mesh)
        if path is not None and not unit.is_guess:
            self._memory.remember_unit(path, unit)

    def _default_unit(self, mesh: Mesh, path: Path | None) -> Unit:
        units = self._memory.units
        if path is not None and resolved_path(path) in units:
            return units[resolved_path(path)]
        if mesh.unit or path is None:
            return Unit(mesh.unit)
        if (usual := self._usual()) is not None:
            return usual
        # A single choice may be an exception: only two equal ones in a row suggest a unit.
        latest = list(units.values())[:2]
        return latest[0].as_guess if len(latest) == 2 and latest[0] is latest[1] else Unit.NONE
