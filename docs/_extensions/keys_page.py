"""Menu entries with their keys, taken from the window's own actions."""

from __future__ import annotations

from plain_markdown import escaped, marked, table
from window_facts import Entry, entries

from apd_viewer.ui.help.places import of_action

# The offscreen platform has the keys of Windows; these are those of Linux, as the pages name them.
_LINUX = {"redo": "Ctrl+Shift+Z", "quit": "Ctrl+Q"}


def keys_page() -> str:
    """Markdown with a table for each menu."""
    found = entries()
    parts = []
    for menu in dict.fromkeys(entry.menu for entry in found):
        rows = [_row(entry) for entry in found if entry.menu == menu]
        parts.append(f"## {menu}\n\n" + table(("entry", "keys", "what it does"), rows))
    return "\n".join(parts)


def _row(entry: Entry) -> tuple[str, ...]:
    keys = _LINUX.get(entry.name, entry.keys).split("; ")
    shown = " or ".join(f"`{key}`" for key in keys if key)
    return marked(escaped(entry.title), of_action(entry.name).anchor), shown, escaped(entry.tip)
