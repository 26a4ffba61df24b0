"""Every file that is no mesh is refused with a sentence, in Python as on the command line."""

import contextlib
import logging
import os
import struct
import warnings

import numpy as np
import pytest

from apd_viewer.__main__ import main
from apd_viewer.errors import InputError
from apd_viewer.files.meshes import open_mesh

CORNERS = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
FACES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]

OBJ = "".join(f"v {x} {y} {z}\n" for x, y, z in CORNERS)
OBJ += "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in FACES)
OFF = "OFF\n4 4 0\n" + "".join(f"{x} {y} {z}\n" for x, y, z in CORNERS)
OFF += "".join(f"3 {a} {b} {c}\n" for a, b, c in FACES)
_HEAD = "ply\nformat {} 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
_HEAD += "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
PLY = _HEAD.format("ascii") + "".join(OFF.splitlines(keepends=True)[2:])
PLY_BINARY = _HEAD.format("binary_little_endian").encode()
PLY_BINARY += b"".join(struct.pack("<3f", *v) for v in CORNERS)
PLY_BINARY += b"".join(struct.pack("<B3i", 3, *f) for f in FACES)
STL = "solid a\n"
for face in FACES:
    corners = "".join("vertex {} {} {}\n".format(*CORNERS[i]) for i in face)
    STL += f"facet normal 0 0 0\nouter loop\n{corners}endloop\nendfacet\n"
STL += "endsolid a\n"
STL_BINARY = bytes(80) + struct.pack("<I", 4)
STL_BINARY += b"".join(struct.pack("<12fH", 0, 0, 0, *(x for i in f for x in CORNERS[i]), 0) for f in FACES)
GLB = struct.pack("<4sIII4s", b"glTF", 2, 28, 8, b"JSON") + b'{"a":1 }'

TEXT = "To whom it may concern:\nthis is a letter.\n"
NOISE = np.random.default_rng(0).bytes(700)

# name of the file: what is in it, words of the sentence that refuses it
REFUSED = {
    "empty.obj": ("", "is empty"),
    "empty.ply": ("", "is empty"),
    "empty.stl": ("", "is empty"),
    "empty.off": ("", "is empty"),
    "empty.glb": ("", "is empty"),
    "letter.obj": (TEXT, "has no vertices; it begins with “To whom it may concern:”"),
    "letter.ply": (TEXT, "not a valid PLY file"),
    "letter.stl": (TEXT, "has no vertices; it begins with “To whom it may concern:”"),
    "letter.off": (TEXT, "not a valid OFF file"),
    "letter.glb": (TEXT, "not a valid GLB file"),
    "noise.obj": (NOISE, "has no vertices; export the mesh again"),
    "noise.ply": (NOISE, "not a valid PLY file"),
    "noise.stl": (NOISE, "not a valid STL file"),
    "noise.off": (NOISE, "not a valid OFF file"),
    "noise.glb": (NOISE, "not a valid GLB file"),
    "really a ply.obj": (PLY, r"The content of really a ply.obj is PLY; rename it to end in \.ply"),
    "really an obj.ply": (OBJ, r"is OBJ; rename it to end in \.obj"),
    "really an off.stl": (OFF, r"is OFF; rename it to end in \.off"),
    "really a stl.off": (STL_BINARY, r"is STL; rename it to end in \.stl"),
    "really an obj.glb": (OBJ, r"is OBJ; rename it to end in \.obj"),
    "other.xyz": (
        OFF,
        r"not a supported file type; use OBJ, .* VTK, STEP or IGES\.",
    ),
    "no suffix": (OBJ, "not a supported file type"),
    "points.obj": (OBJ.split("f ")[0], "No faces"),
    "lines.obj": (OBJ.split("f ")[0] + "l 1 2\n", "No faces"),
    "points.off": (OFF.split("3 0")[0].replace("4 4 0", "4 0 0"), "No faces"),
    "points.ply": (PLY.split("3 0")[0].replace("face 4", "face 0"), "No faces"),
    "faceless.ply": (PLY.split("element f")[0] + "end_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n", "No faces"),
    "points.stl": ("solid a\nendsolid a\n", "has no vertices"),
    "nothing.stl": (bytes(84), "has no vertices"),
    "nothing.glb": (GLB, "has no vertices|not a valid GLB file"),
    "nan.obj": (OBJ.replace("v 1 0 0", "v nan 0 0"), r"1 vertex has a coordinate .*vertex 1\)"),
    "inf.obj": (OBJ.replace("v 1 0 0", "v inf 0 0"), "coordinate that is not a number"),
    "too large.obj": (OBJ.replace("v 1 0 0", "v 1e999 0 0"), "coordinate that is not a number"),
    "nan.off": (OFF.replace("1 0 0", "1 nan 0"), "coordinate that is not a number"),
    "inf.off": (OFF.replace("1 0 0", "-inf 0 0"), "coordinate that is not a number"),
    "nan.ply": (PLY.replace("1 0 0", "1 nan 0"), "coordinate that is not a number"),
    "nan binary.ply": (
        PLY_BINARY.replace(struct.pack("<f", 1), struct.pack("<f", np.nan)),
        "3 vertices have a coordinate that is not a number",
    ),
    "nan.stl": (STL.replace("vertex 1 0 0", "vertex 1 nan 0", 1), "coordinate that is not a number"),
    "inf binary.stl": (
        STL_BINARY.replace(struct.pack("<f", 1), struct.pack("<f", np.inf)),
        "coordinate that is not a number",
    ),
    "missing.obj": (OBJ + "f 1 2 5\n", r"1 face refers to missing vertices \(there are 4\)"),
    "zero.obj": (OBJ + "f 0 1 2\nf 3 2 0\n", "2 faces refer to missing vertices"),
    "far back.obj": (OBJ + "f -1 -2 -5\n", "1 face refers to missing vertices"),
    "missing.off": (OFF.replace("3 0 2 1", "3 0 2 4"), "missing vertices|outside the range of its vertices"),
    "negative.off": (
        OFF.replace("3 0 2 1", "3 0 2 -1"),
        "missing vertices|outside the range of its vertices",
    ),
    "missing.ply": (PLY.replace("3 0 2 1", "3 0 2 4"), "1 face refers to missing vertices"),
    "negative.ply": (PLY.replace("3 0 2 1", "3 0 2 -1"), "1 face refers to missing vertices"),
    "missing binary.ply": (PLY_BINARY[:-1] + b"\x7f", "1 face refers to missing vertices"),
    "word for number.obj": (OBJ.replace("v 1 0 0", "v 1 zero 0"), r"line 2 is not valid: v 1 zero 0"),
    "fraction for face.obj": (OBJ + "f 1 2 2.5\n", r"line 9 is not valid: f 1 2 2\.5"),
    "absurd face.obj": (OBJ + "f 1 2 99999999999999999999\n", "1 face refers to missing vertices"),
    "absurd last.obj": (OBJ + "f 1 2 99999999999999999999 # 4\n", "has a vertex index out of range"),
    "thousands of digits.off": (OFF.replace("4 4 0", "9" * 5000 + " 4 0"), "“9+” is not a whole number"),
    "hexadecimal.off": (OFF.replace("1 0 0", "0x10 0 0"), "“0x10” is not a number"),
    "beyond all sizes.obj": (OBJ.replace("v 1 0 0", "v 1e200 0 0"), r"coordinates as large as 1e\+200"),
    "twice the vertices.ply": (PLY.replace("element face 4", "element vertex 4"), "uses one name twice"),
    "lists of coordinates.ply": (PLY.replace("float x", "list uchar float x"), "lists of coordinates"),
    "fractions for faces.ply": (PLY.replace("uchar int", "uchar float"), "have fractional vertex indices"),
    "fractional lengths.ply": (PLY.replace("uchar int", "float int"), "lists of fractional lengths"),
    "one corner a face.ply": (PLY.replace("list uchar int", "int"), "no vertex_indices list"),
    "types of its own.ply": (PLY.replace("float y", "real y"), "invalid line: “property real y”"),
    "millions announced.ply": (
        PLY_BINARY.replace(b"vertex 4", b"vertex 400000000"),
        "ends before the last of its 400,000,000 rows of vertex",
    ),
    "signalling nan.ply": (
        PLY_BINARY.replace(struct.pack("<f", 1), b"\1\0\x80\x7f"),
        "coordinate that is not a number",
    ),
    "signalling nan.stl": (
        STL_BINARY.replace(struct.pack("<f", 1), b"\1\0\x80\x7f"),
        "coordinate that is not a number",
    ),
    "blanks without end.ply": (
        PLY.replace("1 0 0", " " * 300_000),
        "ends before the last of its 4 rows of face",
    ),
    # Searched for words with the blanks before them, this took half a minute.
    "blanks without end.vtk": (
        b"# vtk DataFile Version 3.0\na\nASCII\nDATASET POLYDATA\nPOINTS 2 float\n0 0 0 1" + b"\n" * 70_000,
        "it ends early",
    ),
    "two coordinates.obj": (OBJ.replace("v 1 0 0", "v 1 0"), "fewer than three coordinates"),
    "word for number.off": (OFF.replace("1 0 0", "1 zero 0"), "not a valid OFF file"),
    "word for number.ply": (PLY.replace("1 0 0", "1 zero 0"), "not a valid PLY file"),
    "word for number.stl": (STL.replace("vertex 1 0 0", "vertex 1 zero 0"), "not a valid STL file"),
    "cut in a vertex.obj": (OBJ[:21], "fewer than three coordinates"),
    "cut in the vertices.off": (OFF[:22], "not a valid OFF file"),
    "cut after the head.off": (OFF[:10], "not a valid OFF file"),
    "cut before a face.off": (OFF[: OFF.rindex("3 ")], "not a valid OFF file"),
    "cut in a face.off": (OFF[:-3], "not a valid OFF file"),
    "cut in the head.ply": (PLY[:60], "not a valid PLY file"),
    "cut in the vertices.ply": (PLY[: PLY.index("0 1 0")], "not a valid PLY file"),
    "cut before a face.ply": (PLY[: PLY.rindex("3 ")], "not a valid PLY file"),
    "cut in a face.ply": (PLY[:-3], "not a valid PLY file"),
    "cut in the vertices, binary.ply": (PLY_BINARY[:-70], "not a valid PLY file"),
    "cut in a face, binary.ply": (PLY_BINARY[:-3], "not a valid PLY file"),
    "cut in the head.stl": (STL_BINARY[:70], "has no vertices"),
    "words and zeros.stl": (b"a header\0of a file", "has no vertices"),
    "cut in a face.stl": (STL[: STL.rindex("vertex")], "a facet is incomplete"),
    "cut in a face, binary.stl": (STL_BINARY[:-7], "it declares 4 facets and has 3"),
    "cut.glb": (GLB[:-4], "not a valid GLB file"),
    "cut in the head.glb": (GLB[:10], "not a valid GLB file"),
}


@contextlib.contextmanager
def nothing_else_is_said():
    """Fail on a warning or a log message: either would be printed beside the one sentence.

    Warnings are recorded and not raised, or open_mesh would turn them into its own error.
    """
    said = []
    handler = logging.Handler(logging.WARNING)
    handler.emit = lambda record: said.append(record.getMessage())
    logging.getLogger().addHandler(handler)
    try:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            yield
    finally:
        logging.getLogger().removeHandler(handler)
    assert said + [str(warning.message) for warning in caught] == []


@pytest.fixture
def refused_by_the_command_line(tmp_path, capsys):
    """Check that both commands refuse the path in one line and leave the folder as it is."""
    for name, content in (("s.sel", "0 1 1 2"), ("t.def", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1")):
        (tmp_path / name).write_text(content)
    out = tmp_path / "out.off"
    out.write_text("precious")
    more = ["--selection", tmp_path / "s.sel", "--transform", tmp_path / "t.def", "-o", out]
    more += ["--report", tmp_path / "new.json"]

    def check(path, words):
        before = sorted(tmp_path.iterdir())
        for command in (["info", path], ["deform", path, *more]):
            capsys.readouterr()
            with nothing_else_is_said():
                assert main([str(word) for word in command]) == 2
            said = capsys.readouterr()
            assert said.out == ""
            assert said.err.startswith("error: ")
            assert said.err.endswith("\n")
            assert len(said.err.splitlines()) == 1
            assert all(word in said.err for word in words)
        assert out.read_text() == "precious"
        assert sorted(tmp_path.iterdir()) == before

    return check


@pytest.mark.parametrize("name", REFUSED)
def test_open_mesh_refuses_what_is_no_mesh(name, tmp_path, refused_by_the_command_line):
    content, words = REFUSED[name]
    path = tmp_path / name
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    with nothing_else_is_said(), pytest.raises(InputError, match=words) as caught:
        open_mesh(path)
    assert name in str(caught.value)
    refused_by_the_command_line(path, [str(caught.value)])


@pytest.mark.parametrize("content", [OBJ, OFF, PLY, PLY_BINARY, STL, STL_BINARY], ids=lambda c: repr(c[:6]))
def test_open_mesh_opens_what_the_refused_files_were_made_from(content, tmp_path):
    content = content.encode() if isinstance(content, str) else content
    suffix = {b"v": "obj", b"O": "off", b"p": "ply", b"s": "stl", b"\0": "stl"}[content[:1]]
    (tmp_path / f"good.{suffix}").write_bytes(content)
    mesh = open_mesh(tmp_path / f"good.{suffix}")
    assert np.array_equal(mesh.V[mesh.F], np.array(CORNERS, dtype=float)[np.array(FACES)])


@pytest.mark.parametrize("name", ["gone.obj", "gone.ply", "no folder/gone.off"])
def test_open_mesh_refuses_a_missing_file(name, tmp_path, refused_by_the_command_line):
    with pytest.raises(InputError, match=r"There is no file .*check the name"):
        open_mesh(tmp_path / name)
    refused_by_the_command_line(tmp_path / name, ["There is no file", str(tmp_path / name)])


def test_open_mesh_refuses_a_folder(tmp_path, refused_by_the_command_line):
    (tmp_path / "folder.obj").mkdir()
    with pytest.raises(InputError, match="is not a file"):
        open_mesh(tmp_path / "folder.obj")
    refused_by_the_command_line(tmp_path / "folder.obj", ["is not a file"])


def test_open_mesh_refuses_a_name_that_is_longer_than_names_can_be(tmp_path, refused_by_the_command_line):
    path = tmp_path / ("x" * 300 + ".obj")
    with pytest.raises(InputError):
        open_mesh(path)
    refused_by_the_command_line(path, [])


@pytest.mark.parametrize("suffix", ["obj", "off", "ply"])
def test_open_mesh_refuses_a_file_that_may_not_be_read(
    suffix, tmp_path, monkeypatch, refused_by_the_command_line
):
    path = tmp_path / f"secret.{suffix}"
    path.write_text({"obj": OBJ, "off": OFF, "ply": PLY}[suffix])
    mode = path.stat().st_mode
    real = os.open

    def denied(wanted, *flags, **more):  # root may read everything, so permissions cannot be taken away here
        if wanted == path:
            raise PermissionError(13, "Permission denied", str(wanted))
        return real(wanted, *flags, **more)

    monkeypatch.setattr(os, "open", denied)
    with pytest.raises(InputError, match=r"cannot be read \(Permission denied\)"):
        open_mesh(path)
    refused_by_the_command_line(path, ["cannot be read", "Permission denied"])
    assert path.stat().st_mode == mode
