"""Options for the settings of a deformation."""

import argparse
from collections.abc import Iterable
from typing import Any

from apd_viewer.commands.terminal.mesh_options import unit_option_in_errors
from apd_viewer.commands.terminal.parser import Parser, add_option
from apd_viewer.errors import InputError
from apd_viewer.geometry.mesh.arrays import diagonal
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.solver.convergence import CRITERIA, DEFAULT_CONVERGENCE, Convergence
from apd_viewer.geometry.solver.methods import METHODS, MOST_VERTICES_IN_CONTACT, contact_by_default
from apd_viewer.geometry.solver.settings import DEFAULT_SETTINGS, SETTINGS, SettingKind
from apd_viewer.language import tr
from apd_viewer.session.quantities.newton_conversion import wall_pascals
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.volume_target import parse_volume_target
from apd_viewer.session.quantities.wall import parse_thickness
from apd_viewer.session.quantities.wall_distribution import distribution_file, thickness_text
from apd_viewer.session.quantities.wall_material import parse_pressure_difference, parse_young_modulus


def add_setting_options(parser: Parser, names: Iterable[str], methods: Iterable[str] = METHODS) -> None:
    """Add an option for each of the named settings, with its default."""
    for name in names:
        setting, default = SETTINGS[name], getattr(DEFAULT_SETTINGS, name)
        words = setting.help.replace("%", "%%")
        more: dict[str, Any] = {"help": tr("{what}; default: %(default)s").format(what=words)}
        match setting.kind:
            case SettingKind.METHOD:
                more |= {"choices": tuple(methods), "help": tr("default: %(default)s")}
            case SettingKind.NUMBER | SettingKind.TOLERANCE:
                more |= {"metavar": "A", "type": float}
            case SettingKind.PERCENTAGE:
                more |= {"metavar": "VOLUME" if name == "volume" else "PERCENT", "help": words}
                default = None  # the default depends on the method
            case SettingKind.LENGTH | SettingKind.VOLUME:
                number = length if name == "wall_thickness" else float
                more |= {"metavar": "LENGTH", "type": number, "help": words}
            case SettingKind.AMOUNT:
                more |= {"metavar": "A", "type": float, "help": words}
            case SettingKind.PRESSURE:
                more |= {"metavar": "PRESSURE", "help": words}
            case SettingKind.SWITCH:
                more |= {"action": argparse.BooleanOptionalAction, "help": words}
            case SettingKind.CONVERGENCE:
                add_criteria(parser)
                continue
        parser.add_argument(_option(name), default=default, **more)


def length(word: str) -> float | str:
    """Number, or the name of a file of a wall distribution."""
    return word if distribution_file(word) else float(word)


def _option(name: str) -> str:
    return "--" + name.replace("_", "-")


def add_criteria(parser: Parser, names: Iterable[str] = CRITERIA, of_session: bool = False) -> None:
    """Add an option for each of the named criteria of convergence.

    Without it the value is the default, or None where a session has its own.
    """
    for name in names:
        default = getattr(DEFAULT_CONVERGENCE, name)
        words = tr("{what}; default: {default}").format(what=CRITERIA[name], default=default)
        parser.add_argument(
            _option(name),
            metavar="N" if isinstance(default, int) else "T",
            type=type(default),
            default=None if of_session else default,
            help=words,
        )


def given_criteria(options: argparse.Namespace) -> dict[str, Any]:
    """Convergence criteria given as options."""
    values = {name: getattr(options, name, None) for name in CRITERIA}
    return {name: value for name, value in values.items() if value is not None}


def add_contact_option(parser: Parser) -> None:
    """Add ``--contact`` and ``--no-contact``; the value is None without either."""
    about = tr(
        "keep walls from passing through each other, or not; default: up to {most:,} vertices, for methods "
        "that can"
    ).format(most=MOST_VERTICES_IN_CONTACT)
    add_option(parser, "--contact", about, action=argparse.BooleanOptionalAction)


def has_contact(options: argparse.Namespace, vertices: int) -> bool:
    """True if the options of ``deform`` enable contact for this number of vertices."""
    if options.contact is not None:
        return bool(options.contact)
    if options.obstacles:
        return True
    return options.iterations is None and contact_by_default(options.method, vertices)


@unit_option_in_errors()
def volume_arguments(text: str | None, unit: str) -> dict[str, float | None]:
    """Arguments of a volume target from its text; raises InputError."""
    if text is None:
        return {"volume": None, "filled_volume": None}
    return parse_volume_target(text, Unit(unit))._asdict()


@unit_option_in_errors()
def setting_arguments(options: argparse.Namespace, mesh: Mesh) -> dict[str, Any]:
    """Arguments of :func:`deform` from the options, for a mesh."""
    given = {name: getattr(options, name) for name in SETTINGS if hasattr(options, name)}
    given |= volume_arguments(options.volume, mesh.unit)
    unit = Unit(mesh.unit)
    if isinstance(given.get("wall_thickness"), str):
        given["wall_thickness"] = parse_thickness(thickness_text(given["wall_thickness"], mesh, unit), unit)
    if options.pressure is not None:
        if options.young is None:
            raise InputError(tr("A pressure needs Young's modulus of the wall; add --young, such as 2.8GPa."))
        wall = diagonal(mesh.V), given["wall_thickness"], options.poisson
        unit_pressure = wall_pascals(parse_young_modulus(options.young), *wall)
        given["pressure"] = parse_pressure_difference(options.pressure) / unit_pressure
    return {**given, "convergence": Convergence(**given_criteria(options))}
