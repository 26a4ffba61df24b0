"""The table of formats: whoever adds a row finds what else it needs."""

import re
from pathlib import Path

import pytest
from mesh_contents import FILES

from apd_viewer.files.mesh_formats import MESH_FORMATS, WriteSupport
from apd_viewer.files.meshes import open_mesh

ROOT = Path(__file__).parents[2]
PAGES = ("README.md", "SECURITY.md", "docs/howto/open.md")


def test_mesh_formats_have_files_to_test_that_they_are_rewritten():
    written = {suffix for suffix, each in MESH_FORMATS.items() if each.writing is not WriteSupport.NONE}
    assert {Path(name).suffix for name in FILES} == written


@pytest.mark.parametrize("page", [*PAGES, "open_mesh"])
def test_mesh_formats_are_named_where_a_reader_looks_for_them(page):
    text = open_mesh.__doc__ if page == "open_mesh" else (ROOT / page).read_text(encoding="utf-8")
    names = [each.name for each in MESH_FORMATS.values()]
    assert [name for name in names if not re.search(rf"\b{name}\b", text, re.IGNORECASE)] == []
