"""Settings to and from the JSON of a session."""

from __future__ import annotations

from typing import Any

from apd_viewer.errors import InputError
from apd_viewer.files.storage.json_fields import JsonFields
from apd_viewer.geometry.solver.convergence import DEFAULT_CONVERGENCE, Convergence, check_convergence
from apd_viewer.geometry.solver.methods import METHODS
from apd_viewer.geometry.solver.settings import DEFAULT_SETTINGS, SETTINGS, SettingKind, Settings
from apd_viewer.language import tr
from apd_viewer.session.storage.part_json import LARGEST_NUMBER, LEAST_POSITIVE, number_to_json


def settings_to_json(settings: Settings) -> dict[str, Any]:
    """All settings by their names; unset ones are null."""
    return {name: _to_json(setting.kind, getattr(settings, name)) for name, setting in SETTINGS.items()}


def settings_from_json(fields: JsonFields) -> Settings:
    """The settings again; raises ValueError with a phrase on damaged ones."""
    return Settings(**{name: _from_json(fields, name, setting.kind) for name, setting in SETTINGS.items()})


def _to_json(kind: SettingKind, value: Any) -> Any:
    match kind:
        case SettingKind.METHOD:
            return value
        case SettingKind.SWITCH:
            return bool(value)
        case SettingKind.CONVERGENCE:
            return value._asdict()
        case SettingKind.NUMBER | SettingKind.TOLERANCE | SettingKind.PERCENTAGE | SettingKind.LENGTH:
            return number_to_json(value)


def _from_json(fields: JsonFields, name: str, kind: SettingKind) -> Any:
    match kind:
        case SettingKind.METHOD:
            return _method_from_json(fields.text(name))
        case SettingKind.SWITCH:
            # Switches that came later were off in the sessions of before.
            return fields.has_value(name) and fields.flag(name)
        case SettingKind.CONVERGENCE:
            return (
                _convergence_from_json(fields.nested_fields(name))
                if fields.has_value(name)
                else DEFAULT_CONVERGENCE
            )
        case SettingKind.NUMBER:
            return fields.number(name, 0.0, LARGEST_NUMBER)
        case SettingKind.TOLERANCE | SettingKind.PERCENTAGE | SettingKind.LENGTH:
            if getattr(DEFAULT_SETTINGS, name) is None and not fields.has_value(name):
                return None
            return fields.number(name, LEAST_POSITIVE, LARGEST_NUMBER)


def _method_from_json(name: str) -> str:
    if name not in METHODS:
        raise ValueError(tr("its “method” is unknown"))
    return name


def _convergence_from_json(fields: JsonFields) -> Convergence:
    found = Convergence(
        fields.count("most_iterations"), fields.number("energy_tolerance"), fields.number("step_tolerance")
    )
    try:
        check_convergence(found)
    except InputError:
        raise ValueError(tr("its “convergence” is damaged")) from None
    return found
