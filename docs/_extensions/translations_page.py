"""The catalogues of translations, with what a reader of each language must check."""

from __future__ import annotations

from pathlib import Path

from babel.core import Locale
from babel.messages.catalog import Catalog, Message
from babel.messages.pofile import read_po
from plain_markdown import escaped, table

FOLDER = Path(__file__).parents[2] / "apd_viewer" / "languages"


def translations_page(folder: Path = FOLDER) -> str:
    """Markdown with a section for each language."""
    return "\n".join(map(_section, sorted(folder.glob("*/LC_MESSAGES/*.po"))))


def _section(path: Path) -> str:
    name = path.parents[1].name
    with path.open("rb") as stream:
        catalogue = read_po(stream, locale=name)
    return f"## {_title(name)}\n\n{_said(catalogue)}\n"


def _title(name: str) -> str:
    locale = Locale.parse(name)
    return f"{locale.get_display_name('en')} ({locale.get_display_name()})"


def _said(catalogue: Catalog) -> str:
    messages = [message for message in catalogue if message.id]
    rows = [_row(message) for message in messages if message.fuzzy]
    left = sum(not all(_texts(message.string)) for message in messages)
    head = f"{len(messages):,} texts, {left:,} of them still English, {len(rows):,} to check."
    titles = "English", "translation", "question"
    return f"{head}\n\n{table(titles, rows)}" if rows else f"{head}\n"


def _row(message: Message) -> tuple[str, ...]:
    words = (message.id, message.string, message.user_comments)
    return tuple(escaped(" / ".join(_texts(one))) for one in words)


def _texts(text: object) -> tuple[str, ...]:
    return (text,) if isinstance(text, str) else tuple(map(str, text))  # type: ignore[arg-type, call-overload]
