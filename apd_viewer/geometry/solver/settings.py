"""Settings of a deformation, and the table of their properties.

Options of the command line, columns of plans, keys of sessions, rows of reports and arguments of exported
scripts all follow from the table.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields, replace
from enum import Enum, auto
from operator import attrgetter
from typing import Any

from apd_viewer.geometry.energy.material import Material
from apd_viewer.geometry.goals.target_values import LEAST_PERCENTAGE, MOST_PERCENTAGE
from apd_viewer.geometry.mesh.arrays import MOST_HARDENING
from apd_viewer.geometry.solver.convergence import DEFAULT_CONVERGENCE, LARGEST_TOLERANCE, Convergence
from apd_viewer.geometry.solver.methods import (
    DEFAULT_AREA_STIFFNESS,
    DEFAULT_METHOD,
    DEFAULT_POISSON,
    DEFAULT_SHEAR_STIFFNESS,
    DEFAULT_TOLERANCE,
    METHODS,
    Method,
    method_material,
    method_named,
)
from apd_viewer.language import alternatives, tr

_LARGEST_STIFFNESS = 1e6
_LARGEST_VOLUME = 1e12  # cubic mesh units
_LARGEST_PRESSURE = 1e12  # 1 / mesh unit, where Young's modulus times thickness is 4


class SettingKind(Enum):
    """Kind of a setting's value; readers and writers handle each kind."""

    METHOD = auto()
    NUMBER = auto()
    TOLERANCE = auto()
    PERCENTAGE = auto()
    SWITCH = auto()
    LENGTH = auto()
    VOLUME = auto()
    AMOUNT = auto()
    PRESSURE = auto()
    CONVERGENCE = auto()


@dataclass(frozen=True)
class Setting:
    """Description of a setting, without its name and default.

    Attributes
    ----------
    kind : SettingKind
    title : str
        For reports, tables and fields.
    help : str
        For the command line.
    gesture, off_gesture : str
        Name of its change in the history; of turning a switch off, if that has another name.
    applies : callable
        True for settings in which this one has an effect.
    least, most : float
        Range of what can be entered, in its own unit.
    """

    kind: SettingKind
    title: str
    help: str
    gesture: str
    applies: Callable[[Settings], bool] = lambda _: True
    least: float = 0.0
    most: float = _LARGEST_STIFFNESS
    off_gesture: str = ""


def _setting(default: object, *row: Any, **more: Any) -> Any:
    """Settings field with its description."""
    return field(default=default, metadata={"setting": Setting(*row, **more)})


def _percentage(default: float | None, *words: str, **more: Any) -> Any:
    more |= {"least": LEAST_PERCENTAGE, "most": MOST_PERCENTAGE}
    return _setting(default, SettingKind.PERCENTAGE, *words, **more)


def _stiffness(default: float, title: str, words: str, **more: Any) -> Any:
    return _setting(default, SettingKind.NUMBER, title, words, tr("Change stiffness"), **more)


@dataclass(frozen=True)
class Settings:
    """Method, material, targets and criteria of a deformation, for any mesh.

    Attributes
    ----------
    method : str
    stiffness, area_stiffness, shear_stiffness, tolerance
        See :class:`apd_viewer.geometry.solver.deformation.Deformation`.
    wall_thickness : float or None
        Of a thin elastic wall, mesh units; None is a thousandth of the size of the mesh.
    poisson : float
        Of a thin elastic wall.
    tension_field : bool
        Whether a thin elastic wall wrinkles finer than its mesh, and resists no compression.
    area : float
        Target of the total area, in percent of its rest value.
    volume : float or None
        Target of the volume, in percent; None leaves it free. Always None without a volume.
    filled_volume : float or None
        Target of the volume in cubic mesh units, in place of a percentage; None for none.
    hold_area : bool
        Whether "local" and "wall" keep the total area too.
    calm : bool
        Whether "exact" keeps the area of calm parts too.
    contact : bool
        Whether walls are kept from passing through each other, by methods that can.
    thickness : float or None
        Distance that walls in contact keep, mesh units; None is a thousandth of the size of the mesh.
    yield_radius : float or None
        Stiff walls in contact that are bent to a smaller radius keep a crease, mesh units; None for none.
    hardening : float
        Of creases of a thin wall: its stiffness where it yields over the elastic one.
    gas : float or None
        Pressure times volume of the gas enclosed in contact, in areas of the surface; None for none.
    pressure : float or None
        Constant pressure inside less outside for a thin elastic wall, 1 / mesh unit, where Young's modulus
        times thickness is 4; None for none.
    convergence : Convergence
        Criteria that end the iterations.
    """

    method: str = _setting(
        DEFAULT_METHOD,
        SettingKind.METHOD,
        tr("Method"),
        alternatives(METHODS),
        tr("Change method"),
    )
    stiffness: float = _stiffness(
        0.0,
        tr("Stiffness"),
        tr("bending stiffness, 0 (cloth) to 0.1 (sheet metal); CGAL's alpha for 'sr-arap'"),
        applies=lambda settings: not settings.traits.is_wall,
    )
    area_stiffness: float = _stiffness(
        DEFAULT_AREA_STIFFNESS,
        tr("Area stiffness"),
        tr("how strongly 'local' keeps the area of each triangle"),
        applies=attrgetter("traits.has_moduli"),
    )
    shear_stiffness: float = _stiffness(
        DEFAULT_SHEAR_STIFFNESS,
        tr("Shear stiffness"),
        tr("how strongly 'local' keeps the shape of each triangle"),
        applies=attrgetter("traits.has_moduli"),
    )
    wall_thickness: float | None = _setting(
        None,
        SettingKind.LENGTH,
        tr("Wall thickness"),
        tr("wall thickness for 'wall', in mesh units, or a file of it; default: 1/1000 of the diagonal"),
        tr("Change wall thickness"),
        applies=attrgetter("traits.is_wall"),
    )
    poisson: float = _setting(
        DEFAULT_POISSON,
        SettingKind.NUMBER,
        tr("Poisson's ratio"),
        tr("Poisson's ratio of the wall for 'wall'"),
        tr("Change Poisson's ratio"),
        applies=attrgetter("traits.is_wall"),
        most=0.5,
    )
    tension_field: bool = _setting(
        False,
        SettingKind.SWITCH,
        tr("Tension field"),
        tr("the wall wrinkles finer than the mesh and resists no compression, as film and cloth do"),
        tr("Turn tension field on"),
        applies=attrgetter("traits.is_wall"),
        off_gesture=tr("Turn tension field off"),
    )
    area: float = _percentage(
        100.0,
        tr("Area target"),
        tr("target of the total area, in percent of the rest area; default: 100 for 'exact' and 'paper'"),
        tr("Change area"),
    )
    volume: float | None = _percentage(
        None,
        tr("Volume target"),
        tr("target of the volume, in percent of the rest volume, or such as 250ml; default: free"),
        tr("Change volume"),
    )
    filled_volume: float | None = _setting(
        None,
        SettingKind.VOLUME,
        tr("Filled volume"),
        tr("volume to hold, in cubic mesh units, also of a shape that is flat at rest; default: free"),
        tr("Change volume"),
        applies=lambda settings: not settings.traits.keeps_only_total_area,
        most=_LARGEST_VOLUME,
    )
    tolerance: float = _setting(
        DEFAULT_TOLERANCE,
        SettingKind.TOLERANCE,
        tr("Tolerance"),
        tr("area tolerance of 'paper'; 0.001 is 0.1 %"),
        tr("Change tolerance"),
        applies=attrgetter("traits.has_tolerance"),
        least=1e-12,
        most=LARGEST_TOLERANCE,
    )
    hold_area: bool = _setting(
        False,
        SettingKind.SWITCH,
        tr("Total area kept"),
        tr("keep the total area with 'local' and 'wall', too"),
        tr("Change area"),
        applies=attrgetter("traits.may_keep_total_area"),
    )
    calm: bool = _setting(
        True,
        SettingKind.SWITCH,
        tr("Calm parts kept"),
        tr("with 'exact', keep the area of calm parts, which the handles hardly reach"),
        tr("Keep calm parts"),
        applies=attrgetter("traits.keeps_calm_parts"),
        off_gesture=tr("Let calm parts change"),
    )
    contact: bool = _setting(
        False,
        SettingKind.SWITCH,
        tr("Contact"),
        tr("keep walls from passing through each other"),
        tr("Turn contact on"),
        applies=attrgetter("traits.may_use_contact"),
        off_gesture=tr("Turn contact off"),
    )
    thickness: float | None = _setting(
        None,
        SettingKind.LENGTH,
        tr("Wall distance"),
        tr("distance that walls in contact keep, in mesh units; default: 1/1000 of the diagonal"),
        tr("Change wall distance"),
        applies=attrgetter("uses_contact"),
    )
    yield_radius: float | None = _setting(
        None,
        SettingKind.LENGTH,
        tr("Yield radius"),
        tr("walls in contact bent to less than this radius keep a crease, in mesh units; default: none"),
        tr("Change yield radius"),
        applies=lambda settings: (
            settings.uses_contact and (settings.traits.is_wall or settings.effective_stiffness > 0.0)
        ),
    )
    hardening: float = _setting(
        0.0,
        SettingKind.NUMBER,
        tr("Hardening"),
        tr("stiffness of a wall where it yields, over the elastic one, for creases of 'wall'"),
        tr("Change hardening"),
        applies=lambda settings: (
            settings.uses_contact and settings.traits.is_wall and settings.yield_radius is not None
        ),
        most=MOST_HARDENING,
    )
    gas: float | None = _setting(
        None,
        SettingKind.AMOUNT,
        tr("Enclosed gas"),
        tr(
            "gas enclosed by walls in contact, openings capped: pressure times volume in surface areas; "
            "default: none"
        ),
        tr("Change enclosed gas"),
        applies=attrgetter("uses_contact"),
    )
    pressure: float | None = _setting(
        None,
        SettingKind.PRESSURE,
        tr("Pressure"),
        tr(
            "constant pressure inside less outside for 'wall', such as 30mbar, or -50mbar with contact; "
            "default: none"
        ),
        tr("Change pressure"),
        applies=attrgetter("traits.is_wall"),
        least=-_LARGEST_PRESSURE,
        most=_LARGEST_PRESSURE,
    )
    convergence: Convergence = _setting(  # noqa: RUF009 (a field)
        DEFAULT_CONVERGENCE,
        SettingKind.CONVERGENCE,
        tr("Convergence"),
        tr("criteria for ending the iterations"),
        tr("Change convergence"),
    )

    @property
    def traits(self) -> Method:
        """Traits of the method."""
        return method_named(self.method)

    @property
    def material(self) -> Material:
        """Weights of the method's energy; raises InputError on impossible values."""
        moduli = self.stiffness, self.area_stiffness, self.shear_stiffness
        return method_material(self.traits, *moduli, self.yield_radius)

    @property
    def effective_stiffness(self) -> float:
        """Stiffness; 0 for a method that has none."""
        return 0.0 if self.traits.is_wall else self.stiffness

    @property
    def uses_contact(self) -> bool:
        """True if contact is on and the method supports it."""
        return self.contact and self.traits.may_use_contact

    @property
    def is_filled(self) -> bool:
        """True if the volume is one in cubic mesh units, or that of a pressure."""
        return self.filled_volume is not None or self.pressure is not None

    @property
    def effective_settings(self) -> Settings:
        """Settings, with inapplicable ones reset to their defaults."""
        idle = {name for name, setting in SETTINGS.items() if not setting.applies(self)}
        return replace(self, **{name: getattr(DEFAULT_SETTINGS, name) for name in idle})


SETTINGS: Mapping[str, Setting] = {each.name: each.metadata["setting"] for each in fields(Settings)}
DEFAULT_SETTINGS = Settings()
