"""STL as programs write it: with more behind the last facet, without an end, with any name."""

import struct

import numpy as np
import pytest
from mesh_contents import binary_stl, stl
from meshes import box
from opened_files import opened, said_of

from apd_viewer.errors import InputError
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.mesh.operators import volume

V, F = box(2, 1, 3)
TEXT, BINARY = stl(V, F), binary_stl(V, F)
LAST = " endloop\nendfacet\nendsolid part\n"
assert TEXT.endswith(LAST)
BODY = TEXT.removesuffix("endsolid part\n")


def assert_is_the_box(mesh):
    np.testing.assert_array_equal(mesh.V[mesh.F], V[F])
    assert volume(mesh.V, mesh.F) == pytest.approx(6.0)


@pytest.mark.parametrize(
    "tail",
    [b"\0", bytes(92), bytes(100), b"\r\n", b"made by a program", b"\1" * 84 + bytes(50), BINARY],
    ids=["a zero", "zeros", "zeros like facets", "a line end", "words", "data", "another file"],
)
def test_read_stl_says_and_keeps_bytes_after_the_last_facet(tail, tmp_path):
    mesh = opened(tmp_path / "a.stl", BINARY + tail)
    assert_is_the_box(mesh)
    (said,) = said_of(mesh)
    assert said.startswith(f"{len(tail):,} byte")
    assert said.endswith(("was not read.", "were not read."))


COUNTS = {
    "none": (0, len(F), b""),
    "too many": (len(F) + 5, len(F), b""),
    "one too many": (len(F) + 1, len(F), b""),
    "one too few": (len(F) - 1, len(F), b""),
    "half of them": (len(F) // 2, len(F), b""),
    "as a stream": (2**32 - 1, len(F), b""),
    "none, and more behind": (0, len(F), b"\1" * 7),
}


@pytest.mark.parametrize(("declared", "there", "tail"), COUNTS.values(), ids=COUNTS)
@pytest.mark.parametrize("head", [b"\0", b"solid of a program"])
def test_read_stl_refuses_a_wrong_number_of_facets_with_both_numbers(declared, there, tail, head, tmp_path):
    content = binary_stl(V, F, head)
    path = tmp_path / "a.stl"
    path.write_bytes(content[:80] + struct.pack("<I", declared) + content[84:] + tail)
    with pytest.raises(InputError, match=f"it declares {declared:,} facets and has {there:,}\\)"):
        open_mesh(path)


@pytest.mark.parametrize("missing", [1, 2, 25, 49])
def test_read_stl_refuses_a_file_cut_in_its_last_facet(missing, tmp_path):
    path = tmp_path / "a.stl"
    path.write_bytes(BINARY[:-missing])
    with pytest.raises(InputError, match=f"it declares {len(F)} facets and has {len(F) - 1}\\)"):
        open_mesh(path)


ENDS = {
    "glued": "endsolidpart\n",
    "capitals": "ENDSOLID PART",
    "a blank": "end solid part\n",
    "an underscore": "end_solid",
    "no name": "endsolid",
    "zeros behind": "endsolid part\n\0\0\0",
    "lines behind": "endsolid part\n\n\n",
    "more behind": "endsolid part\nwritten by a program\n",
}


@pytest.mark.parametrize("end", ENDS.values(), ids=ENDS)
def test_read_stl_knows_many_spellings_of_the_end_of_a_text(end, tmp_path):
    mesh = opened(tmp_path / "a.stl", BODY + end)
    assert_is_the_box(mesh)
    assert said_of(mesh) == []


ENDLESS = {
    "at the facet": BODY,
    "at the loop": BODY.removesuffix("endfacet\n"),
    "without a line end": BODY.rstrip(),
    "another word": BODY + "end",
}


@pytest.mark.parametrize("content", ENDLESS.values(), ids=ENDLESS)
def test_read_stl_opens_a_text_without_its_end_and_says_so(content, tmp_path):
    mesh = opened(tmp_path / "a.stl", content)
    assert_is_the_box(mesh)
    (said,) = said_of(mesh)
    assert "endsolid" in said


@pytest.mark.parametrize("kept", [1, 2, 3])
def test_read_stl_refuses_a_text_cut_in_its_last_facet(kept, tmp_path):
    """Even behind the last corner: the number there may have been longer."""
    pieces = TEXT.split("vertex")
    path = tmp_path / "a.stl"
    path.write_text("vertex".join(pieces[: len(pieces) - 3 + kept]).removesuffix(LAST).rstrip())
    with pytest.raises(InputError, match="a facet is incomplete"):
        open_mesh(path)


NAMES = ["", "of facet normal and vertex", "vertex 1 2 3", "Ätzteil, 3 mm", "solid", "facet", "part\0\0\0"]


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("line_end", ["\n", "\r\n", "\r"])
def test_read_stl_takes_any_name_of_a_solid(name, line_end, tmp_path):
    content = stl(V, F, name).replace("\n", line_end)
    mesh = opened(tmp_path / "a.stl", content)
    assert_is_the_box(mesh)
    assert said_of(mesh) == []


WRITTEN = {
    "capitals": TEXT.upper(),
    "exponents": TEXT.replace("1.0\n", "1.000000E+00\n").replace("vertex 1.0", "vertex 10.0e-1"),
    "tabs": TEXT.replace(" ", "\t"),
    "on one line": " ".join(TEXT.split()),
    "a word a line": TEXT.replace(" ", "\n"),
    "no solid before": TEXT.partition("\n")[2],
    "a remark before": "; by hand\n" + TEXT,
}


@pytest.mark.parametrize("content", WRITTEN.values(), ids=WRITTEN)
def test_read_stl_reads_a_text_however_it_is_laid_out(content, tmp_path):
    assert_is_the_box(opened(tmp_path / "a.stl", content))


def test_read_stl_reads_all_solids_of_a_text(tmp_path):
    halves = stl(V, F[: len(F) // 2], "left") + "\n" + stl(V, F[len(F) // 2 :], "right facet")
    mesh = opened(tmp_path / "a.stl", halves)
    assert_is_the_box(mesh)
    assert said_of(mesh) == []


@pytest.mark.parametrize("header", [b"solid part", b"solid\nfacet normal 0 0 1\nvertex 1 2 3", b"\xff\xfe"])
def test_read_stl_takes_a_binary_file_that_begins_as_others_do(header, tmp_path):
    mesh = opened(tmp_path / "a.stl", binary_stl(V, F, header))
    assert_is_the_box(mesh)
    assert said_of(mesh) == []


def test_read_stl_keeps_colors_of_facets_before_bytes_of_no_facet(tmp_path):
    content = bytearray(BINARY)
    content[84 + 48 : 84 + 50] = b"\x1f\x80"
    mesh = opened(tmp_path / "a.stl", bytes(content) + b"tail")
    assert mesh.origin.extras == ("facet attributes",)
    assert_is_the_box(mesh)
