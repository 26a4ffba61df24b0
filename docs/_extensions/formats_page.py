"""The mesh formats, written from what the program reads and writes."""

from __future__ import annotations

from plain_markdown import table

from apd_viewer.files.mesh_formats import CAD_FORMATS, MESH_FORMATS


def formats_page() -> str:
    """Markdown table of suffixes."""
    rows = [(f"`{suffix}`", "yes", each.writing.value) for suffix, each in MESH_FORMATS.items()]
    rows += [(f"`{suffix}`", "with the extra `cad`", "no") for suffix in CAD_FORMATS]
    return table(("suffix", "read", "written"), rows)
