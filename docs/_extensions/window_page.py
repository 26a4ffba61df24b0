"""The controls of the window, written from their own titles and tips."""

from __future__ import annotations

import re

from control_words import GROUPS, SENTENCES, TITLES
from plain_markdown import escaped, table
from window_facts import Control, controls

from apd_viewer.ui.help.manual import section_place


def window_page() -> str:
    """Markdown with a section for each part of the window."""
    found = controls()
    parts, part = [], ""
    for group in GROUPS:
        if group.part != part:
            part = group.part
            parts.append(f"## {part}\n")
        parts.append(f"({section_place(group.name).anchor})=\n### {group.title}\n\n{group.lead}\n")
        rows = rows_of([control for control in found if control.section == group.name])
        words = [(escaped(title), escaped(sentence)) for title, sentence in rows.items()]
        parts.append(table(("control", "what it does"), words) if words else "")
    return "\n".join(parts)


def rows_of(found: list[Control]) -> dict[str, str]:
    """Titles and sentences of the controls of a group, each title once."""
    rows: dict[str, str] = {}
    for control in found:
        own = f"{control.section}/{control.title.rstrip('…')}"
        key = next((key for pattern, key in TITLES.items() if re.fullmatch(pattern, own)), own)
        title = key.rpartition("/")[2]
        rows.setdefault(title, SENTENCES.get(key) or SENTENCES.get(title) or control.tip)
    return rows
