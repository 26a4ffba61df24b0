"""OFF as programs write it: headers of all kinds, and rows wrapped in any way."""

import numpy as np
import pytest
from mesh_contents import CUBE, QUADS, off
from opened_files import opened, said_of

from apd_viewer.errors import InputError
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.analysis.inspection import inspect

V = 3 * CUBE
BODY = off(V, QUADS).split("\n", 2)[2]
COLOURED = BODY.replace("\n", " 255 0 10 255\n", len(V))
NORMALS = BODY.replace("\n", " 0 0 1\n", len(V))
TEXTURED = BODY.replace("\n", " 0.5 0.5\n", len(V))

HEADERS = {
    "glued": ("OFF8 6 0\n", BODY),
    "glued, two numbers": ("OFF8 6\n", BODY),
    "glued, with colours": ("COFF8 6 12\n", COLOURED),
    "on one line": ("OFF 8 6 0\n", BODY),
    "on two lines": ("OFF\n8 6 0\n", BODY),
    "remarks and empty lines": ("# by hand\n\nOFF # a cube\n# of six\n 8\t6 0 # faces\n\n", BODY),
    "colours": ("COFF\n8 6 0\n", COLOURED),
    "normals": ("NOFF\n8 6 0\n", NORMALS),
    "texture": ("STOFF\n8 6 0\n", TEXTURED),
    "all of them": ("STCNOFF\n8 6 0\n", BODY.replace("\n", " 0 0 1 255 0 10 255 0.5 0.5\n", len(V))),
    "colours of faces": ("OFF\n8 6 0\n", BODY.replace("\n", " 1 0 0\n").replace(" 1 0 0\n", "\n", len(V))),
    "a word a line": ("OFF\n8 6 0\n", BODY.replace(" ", "\n")),
    "all on one line": ("OFF8 6 0\n", " ".join(BODY.split())),
    "wrapped normals": ("NOFF\n8 6 0\n", NORMALS.replace(" 0 0 1\n", "\n0 0 # up\n1\n")),
}


@pytest.mark.parametrize(("header", "body"), HEADERS.values(), ids=HEADERS)
@pytest.mark.parametrize("line_end", ["\n", "\r\n", "\r"])
def test_read_off_knows_many_spellings_of_headers_and_rows(header, body, line_end, tmp_path):
    mesh = opened(tmp_path / "a.off", (header + body).replace("\n", line_end))
    np.testing.assert_array_equal(mesh.V, V)
    assert inspect(mesh).volume == pytest.approx(1.0)
    assert said_of(mesh) == []


REFUSED = {
    "four coordinates": ("4OFF\n8 6 0\n" + BODY, "do not have three coordinates"),
    "four, with colours": ("C4OFF 8 6 0\n" + BODY, "do not have three coordinates"),
    "n coordinates": ("nOFF\n3\n8 6 0\n" + BODY, "do not have three coordinates"),
    "binary": ("OFF BINARY\n\0\0\0\x08", "binary OFF file, which is not supported"),
    "a word that begins alike": ("OFFICE 8 6 0\n" + BODY, "does not start with OFF"),
    "a face too few": ("OFF8 7 0\n" + BODY, "its header declares 8 vertices and 7 faces"),
    "wrapped and cut": ("OFF\n8 6 0\n" + BODY.replace(" ", "\n")[:-3], "not a valid OFF file"),
}


@pytest.mark.parametrize(("content", "words"), REFUSED.values(), ids=REFUSED)
def test_read_off_refuses_other_kinds_in_words(content, words, tmp_path):
    (tmp_path / "a.off").write_text(content)
    with pytest.raises(InputError, match=words):
        open_mesh(tmp_path / "a.off")


def test_read_off_says_faces_beyond_their_number(tmp_path):
    mesh = opened(tmp_path / "a.off", "OFF8 5 0\n" + BODY)
    assert len(mesh.F) == 10
    (said,) = said_of(mesh)
    assert said.startswith("9 bytes after the last face")
