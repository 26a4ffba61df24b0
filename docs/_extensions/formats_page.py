"""The mesh formats, written from what the program reads and writes."""

from __future__ import annotations

from plain_markdown import table

from apd_viewer.files.meshes import MESH_FORMATS, WRITABLE_FORMATS

# Of a format that is read but not written for any mesh.
_ONLY = {".3mf": "no"}


def formats_page() -> str:
    """Markdown table of suffixes."""
    rows = [
        (
            f"`{suffix}`",
            "yes",
            "any mesh" if suffix in WRITABLE_FORMATS else _ONLY.get(suffix, "a mesh that was read from one"),
        )
        for suffix in MESH_FORMATS
    ]
    return table(("suffix", "read", "written"), rows)
