"""The gallery as Markdown, from its list of entries."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING

DOCS = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(DOCS / "gallery"), str(DOCS / "pictures")]

from entries import GROUPS  # noqa: E402

_LONGEST = 43  # characters of a line

if TYPE_CHECKING:
    from entry import Entry


def gallery_page() -> str:
    """All entries under the headings of their groups."""
    return "\n".join(_group(title, entries) for title, entries in GROUPS.items())


def _group(title: str, entries: tuple[Entry, ...]) -> str:
    cards = "\n".join(map(_card, entries))
    return f"## {title}\n\n:::::{{grid}} 1 1 2 2\n:gutter: 3\n\n{cards}\n:::::\n"


def _card(entry: Entry) -> str:
    # Lines of Python are long: their cards take the whole row.
    wide = ":columns: 12\n" if entry.language == "python" else ""
    return f"""::::{{grid-item-card}} {entry.title}
:class-card: gallery-card
{wide}
![{_described(entry)}](pictures/gallery_{entry.name}.webp)

{entry.sentence}

```{entry.language}
{printed(entry)}
```

[Download the session](gallery/sessions/{entry.name}.apd)
::::
"""


def printed(entry: Entry) -> str:
    """The code as it is shown: commands go on in another line before an option."""
    if entry.language == "python":
        return entry.code
    lines = []
    for command in entry.code.splitlines():
        line = ""
        for words in re.split(r" (?=-)", command):
            if line and len(line) + len(words) > _LONGEST:
                lines.append(f"{line} \\")
                line = f"    {words}"
            else:
                line = f"{line} {words}".lstrip() if not line else f"{line} {words}"
        lines.append(line)
    return "\n".join(lines)


def _described(entry: Entry) -> str:
    return entry.title if entry.figure else f"{entry.title}: the shape at rest, and deformed"
