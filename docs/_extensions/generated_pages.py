"""Sphinx extension that writes parts of pages: reference from the program, and files of the root.

``<!-- generated: NAME -->`` in a page stands for what the writer NAME returns, and ``<!-- file: PATH -->``
for the file PATH, relative to the page. Links to such a file lead to the page that shows it. Where Markdown
is read as it is, the comments are not seen, and the links lead to the files themselves.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

from commands_page import commands_page
from formats_page import formats_page
from gallery_page import gallery_page
from keys_page import keys_page
from python_page import python_page
from settings_page import navigation_page, settings_page
from translations_page import translations_page
from verification_page import verification_page
from window_page import window_page

WRITERS: dict[str, Callable[[], str]] = {
    "commands": commands_page,
    "formats": formats_page,
    "gallery": gallery_page,
    "keys": keys_page,
    "navigation": navigation_page,
    "python": python_page,
    "settings": settings_page,
    "translations": translations_page,
    "verification": verification_page,
    "window": window_page,
}
_GENERATED = re.compile(r"<!-- generated: (\w+) -->")
_FILE = re.compile(r"(?s)\A.*<!-- file: (\S+) -->.*\Z")
_LINK = re.compile(r"(?<=\]\()([^)\s#:]+)")


def shown_files(docs: Path) -> dict[Path, Path]:
    """Files outside of ``docs`` that a page shows, and the pages."""
    found = {}
    for page in sorted(docs.rglob("*.md")):
        match = _FILE.match(page.read_text(encoding="utf-8"))
        if match:
            found[(page.parent / match[1]).resolve()] = page
    return found


def completed(page: Path, text: str, shown: dict[Path, Path]) -> str:
    """Text of a page with what its comments stand for."""
    home = page
    match = _FILE.match(text)
    if match:
        home = (page.parent / match[1]).resolve()
        text = home.read_text(encoding="utf-8")
    text = _LINK.sub(lambda link: _moved(link[1], home, page, shown), text)
    return _GENERATED.sub(lambda comment: WRITERS[comment[1]](), text)


def _moved(link: str, home: Path, page: Path, shown: dict[Path, Path]) -> str:
    """A link of the file ``home``, as seen from ``page``."""
    target = (home.parent / link).resolve()
    if not target.exists():
        return link
    return Path(os.path.relpath(shown.get(target, target), page.parent)).as_posix()


def setup(app: Any) -> dict[str, bool]:
    """Complete each page when it is read."""
    docs = Path(app.srcdir)
    shown = shown_files(docs)

    def complete(app: Any, name: str, source: list[str]) -> None:
        # Each time: none of what they are made of is known to Sphinx.
        if _GENERATED.search(source[0]) or _FILE.match(source[0]):
            app.env.note_reread()
        source[0] = completed(docs / f"{name}.md", source[0], shown)

    app.connect("source-read", complete)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
