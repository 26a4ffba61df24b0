"""The rows of the Settings page, written from their definitions."""

from __future__ import annotations

from typing import Any

from plain_markdown import escaped, marked, table

from apd_viewer.ui.help.manual import setting_place
from apd_viewer.ui.preferences.preference_values import NumberRange, Option, Preference
from apd_viewer.ui.scene.navigation_preset import NAVIGATION_PRESETS
from apd_viewer.ui.settings_page.preference_table import GROUPS


def settings_page() -> str:
    """Markdown with a table for each group."""
    titles = "setting", "values", "default", "what it does"
    return "\n".join(
        f"## {group.title}\n\n" + table(titles, [_row(row) for row in group.rows]) for group in GROUPS
    )


def navigation_page() -> str:
    """Markdown of a table with a row for each preset of navigation."""
    rows = [(preset.title, escaped(preset.sentence)) for preset in NAVIGATION_PRESETS.values()]
    return table(("preset", "what the mouse does with any tool"), rows)


def _row(preference: Preference[Any]) -> tuple[str, ...]:
    said = f"{preference.tip}. {preference.note}." if preference.note else f"{preference.tip}."
    title = marked(escaped(preference.title), setting_place(preference.name).anchor)
    return title, escaped(_values(preference)), escaped(_default(preference)), escaped(said)


def _values(preference: Preference[Any]) -> str:
    allowed = preference.allowed
    if isinstance(allowed, NumberRange):
        return f"{allowed.least:g} to {allowed.most:g}{allowed.suffix}"
    numbers = [option for option in allowed.options if option.title.isdigit()]
    titles = [_title(option) for option in allowed.options if option not in numbers]
    return ", ".join([*titles, *(["a number"] if numbers else [])])


def _default(preference: Preference[Any]) -> str:
    allowed = preference.allowed
    if isinstance(allowed, NumberRange):
        return f"{preference.default:g}{allowed.suffix}"
    return next(_title(option) for option in allowed.options if option.value == preference.default)


def _title(option: Option[Any]) -> str:
    """Title without what depends on the machine, such as its number of cores."""
    return option.title.partition(" (")[0]
