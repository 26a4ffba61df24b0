"""Menu entries with their keys, taken from the window's own actions."""

from __future__ import annotations

from pathlib import Path

from plain_markdown import escaped, marked, table
from window_facts import Entry, entries

from apd_viewer.ui.help.manual import action_place

_PAGES = sorted((Path(__file__).parents[1] / "howto").glob("*.md"))
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
    said = escaped(entry.tip)
    if (page := page_about(entry)) is not None:
        said = f"{said}. See [{_title(page)}](../howto/{page.name})."
    return marked(escaped(entry.title), action_place(entry.name).anchor), shown, said


def page_about(entry: Entry) -> Path | None:
    """Page about an entry: where its path or title in bold type, or its keys, stand first."""
    bare = entry.title.rpartition(": ")[2]
    keys = [f"`{key}`" for key in _LINUX.get(entry.name, entry.keys).split("; ") if key]
    words = (f"**{entry.menu} > {bare}**", f"**{bare}**", *keys)
    texts = {page: page.read_text(encoding="utf-8") for page in _PAGES}
    places = [(text.find(word), page) for page, text in texts.items() for word in words if word in text]
    return min(places, default=(0, None))[1]


def _title(page: Path) -> str:
    return page.read_text(encoding="utf-8").partition("\n")[0].lstrip("# ")
