"""Plain text as Markdown."""

from __future__ import annotations

import re


def escaped(text: str) -> str:
    """Text in which no sign means anything to Markdown, on one line."""
    return re.sub(r"([\\`*_{}\[\]<>$|#~^])", r"\\\1", " ".join(text.split()))


def table(titles: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    """Table of cells that are Markdown already."""
    lines = [titles, tuple("---" for _ in titles), *rows]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines) + "\n"


def marked(text: str, anchor: str) -> str:
    """Text that can be linked to by ``anchor``."""
    return f"[{text}]{{#{anchor}}}"
