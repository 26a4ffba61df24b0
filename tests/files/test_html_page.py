"""Pages of HTML: well-formed, whole in one file, and safe with whatever name they hold."""

import base64
import hashlib
import os
import re
from pathlib import Path

import pytest
from page_parts import PageParts

from apd_viewer.errors import InputError
from apd_viewer.files.html_page import (
    Page,
    PageAttachment,
    PageCommand,
    PageDrawing,
    PageGrid,
    PageNote,
    PagePicture,
    PagePictureRow,
    PageSection,
    PageTable,
    page_html,
    write_page,
)
from apd_viewer.files.known_file import display_path, fingerprint
from apd_viewer.files.samples import resource_path

HOSTILE = "</td><script>alert('x')</script> & \"quoted\" {braces} ü"


def page(name="bunny"):
    blocks = (
        PageTable(((name, name, name), ("plain", "value", ""))),
        PageGrid((name, name), ((((f"{name}!", ""),), ((name, name), ("more", ""))), ((("none", ""),), ()))),
        PageNote(name),
        PageNote(name, is_warning=True),
        PageCommand(name),
        PagePictureRow((PagePicture(b"\x89PNG", name),), "<svg></svg>"),
        PageDrawing("<svg></svg>", "<svg></svg>", name),
        PageAttachment(name, b"content", name),
    )
    return Page(
        name, name, (name, name), (PageSection(name, blocks), PageSection("empty", (), is_wide=True)), name
    )


@pytest.mark.parametrize("name", ["bunny", HOSTILE, "a\nb", ""])
def test_page_html_is_well_formed_and_says_what_it_was_given(name):
    found = PageParts(page_html(page(name)))
    assert found.wrong == []
    assert "script" not in found.tags
    assert found.title == name
    assert found.headings == [name, "empty"]
    rows = found.rows[name]
    assert (rows["plain"], rows["none"]) == ("value", "")
    assert rows[f"{name}!"] == (f"{name}\n{name}more" if name else "more")
    assert set(rows) == {name, "plain", f"{name}!", "none"}
    assert found.notes[name][:3] == [name, name, name]


def test_html_page_reader_sees_what_is_wrong():
    assert PageParts("<p><b>x</p>").wrong == ["</p> closes something else", "<p> is not closed"]
    assert PageParts("<div>").wrong == ["<div> is not closed"]
    assert PageParts("<p onclick='x()'></p>").wrong == ["<p> would run onclick"]


def test_page_html_makes_a_page_that_needs_nothing_but_itself():
    text = page_html(page())
    found = PageParts(text)
    assert len(found.held) == 2
    assert all(value.startswith("data:") for _, value in found.held)
    assert re.findall(r"url\((?!#)|@import|https?://(?!www\.w3\.org/2000/svg)", text) == []
    held = dict(found.held)
    assert base64.b64decode(held["src"].partition(",")[2]) == b"\x89PNG"
    assert base64.b64decode(held["href"].partition(",")[2]) == b"content"


def test_write_page_writes_a_page_whole_or_not_at_all(tmp_path):
    path = tmp_path / "page.html"
    write_page(path, page("half of a character: \udcff"))
    assert PageParts(path.read_bytes().decode("utf-8")).title == "half of a character: ?"
    before = path.read_bytes()
    with pytest.raises(InputError, match="cannot be written"):
        write_page(path / "below", page())
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


def test_fingerprint_knows_a_file_by_its_content(tmp_path):
    path, content = tmp_path / "mesh.obj", os.urandom((1 << 20) + 17)
    path.write_bytes(content)
    found = fingerprint(path)
    assert (found.size, found.sha256) == (len(content), hashlib.sha256(content).hexdigest())
    path.unlink()
    assert fingerprint(path)[1:] == (None, "")


def test_display_path_a_file_tells_nobodys_name(monkeypatch, tmp_path):
    monkeypatch.setattr(Path, "home", lambda: tmp_path / "somebody")
    assert display_path(tmp_path / "somebody" / "meshes" / "a.obj") == "~/meshes/a.obj"
    assert display_path(tmp_path / "else" / "a.obj") == str(tmp_path / "else" / "a.obj")
    assert display_path(resource_path("bottle.obj")) == "bottle.obj"
