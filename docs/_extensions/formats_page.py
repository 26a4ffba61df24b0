"""The mesh formats, written from what the program reads and writes."""

from __future__ import annotations

from plain_markdown import table

from apd_viewer.files.meshes import FORMATS, WRITTEN

# Of a format that is read but not written for any mesh.
_ONLY = {".3mf": "no"}


def formats_page() -> str:
    """Markdown table of suffixes."""
    rows = [
        (
            f"`{suffix}`",
            "yes",
            "any mesh" if suffix in WRITTEN else _ONLY.get(suffix, "a mesh that was read from one"),
        )
        for suffix in FORMATS
    ]
    return table(("suffix", "read", "written"), rows)
