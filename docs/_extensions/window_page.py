"""The controls of the window, written from their own titles and tips."""

from __future__ import annotations

from typing import NamedTuple

from control_words import GROUPS, SENTENCES, TITLES
from plain_markdown import escaped, marked, table
from window_facts import Control, controls

from apd_viewer.ui.help.manual_places import control_place


class Row(NamedTuple):
    """A line of a table: what controls of a path are called and do."""

    anchor: str
    title: str
    sentence: str


def window_page() -> str:
    """Markdown with a section for each part of the window."""
    found = controls()
    parts, part = [], ""
    for group in GROUPS:
        if group.part != part:
            part = group.part
            parts.append(f"## {part}\n")
        own = [control for control in found if group_of(control.path) == group.path]
        parts.append(f"({control_place(group.path).anchor})=\n### {group.title}\n\n{group.lead}\n")
        rows = [(marked(escaped(row.title), row.anchor), escaped(row.sentence)) for row in rows_of(own)]
        parts.append(table(("control", "what it does"), rows) if rows else "")
    return "\n".join(parts)


def group_of(path: tuple[str, ...]) -> tuple[str, ...]:
    """Path of the group that a control is listed in."""
    return path[: 2 if path[0] == "panel" else 1]


def rows_of(found: list[Control]) -> list[Row]:
    """Rows of the controls of a group; the group itself has its heading."""
    rows: dict[str, Row] = {}
    for control in found:
        if control.path == group_of(control.path):
            continue
        place, key = control_place(control.path), "/".join(control.path)
        title = TITLES.get(key, control.title.rstrip("…"))
        sentence = SENTENCES.get(key, control.tip)
        if key in rows and key not in TITLES:  # members of a list: one anchor, all of their words
            before = rows[key]
            also = sentence if sentence in before.sentence else f"{before.sentence}. {title}: {sentence}"
            rows[key] = before._replace(
                title=f"{before.title}, {title}", sentence=also if key not in SENTENCES else sentence
            )
        else:
            rows.setdefault(key, Row(place.anchor, title, sentence))
    return list(rows.values())
