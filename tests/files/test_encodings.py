"""Text in UTF-16 and with byte order marks, and any mixture of line ends, in all formats of text."""

import codecs

import numpy as np
import pytest
from mesh_contents import CUBE, QUADS, binary_stl, gltf_of, legacy_vtk, obj, off, ply, stl, textured_glb, vtp
from meshes import box
from opened_files import opened, said_of

from apd_viewer.files.mesh_location import mesh_members
from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.analysis.inspection import inspect

V = 3 * CUBE
BOX = box(2, 1, 3)
TEXTS = {
    "obj": obj(V, QUADS),
    "off": off(V, QUADS),
    "ply": ply(V, QUADS).decode(),
    "stl": stl(*BOX, name="Ätzteil"),
    "vtk": legacy_vtk(V, QUADS).decode(),
    "vtp": vtp(V, QUADS).decode(),
}
ENCODINGS = {
    "UTF-16 LE": (codecs.BOM_UTF16_LE, "utf-16-le"),
    "UTF-16 BE": (codecs.BOM_UTF16_BE, "utf-16-be"),
    "UTF-16 LE without a mark": (b"", "utf-16-le"),
    "UTF-16 BE without a mark": (b"", "utf-16-be"),
    "UTF-32 LE": (codecs.BOM_UTF32_LE, "utf-32-le"),
    "UTF-32 BE": (codecs.BOM_UTF32_BE, "utf-32-be"),
    "UTF-8 with a mark": (codecs.BOM_UTF8, "utf-8"),
}


@pytest.mark.parametrize("suffix", TEXTS)
@pytest.mark.parametrize(("mark", "codec"), ENCODINGS.values(), ids=ENCODINGS)
def test_open_mesh_opens_a_text_in_any_encoding_and_save_mesh_writes_it_back_in_it(
    suffix, mark, codec, tmp_path
):
    text = TEXTS[suffix].replace("\n", "\r\n").replace('"1.0"', f'"1.0" encoding="{codec[:6].upper()}"')
    mesh = opened(tmp_path / f"a.{suffix}", mark + text.encode(codec))
    assert inspect(mesh).volume == pytest.approx(6.0 if suffix == "stl" else 1.0)
    assert said_of(mesh) == []
    save_mesh(mesh, 2 * mesh.V, tmp_path / f"b.{suffix}")
    written = (tmp_path / f"b.{suffix}").read_bytes()
    assert written.startswith(mark)
    lines, before = (each.split("\r\n") for each in (written[len(mark) :].decode(codec), text))
    assert len(lines) == len(before)


def test_mesh_members_brings_letters_of_all_languages_back(tmp_path):
    text = "# Größe 瓶子 🍾\r\n" + obj(V, QUADS)
    content = codecs.BOM_UTF16_LE + text.encode("utf-16-le")
    assert mesh_members(opened(tmp_path / "a.obj", content)) == {"mesh.obj": content}


def test_read_obj_lets_other_bytes_stay_after_a_mark_of_utf8(tmp_path):
    content = codecs.BOM_UTF8 + b"# Gr\xf6\xdfe\n" + obj(V, QUADS).encode()
    assert inspect(opened(tmp_path / "a.obj", content)).volume == pytest.approx(1.0)


def test_images_of_takes_materials_in_utf16_too(tmp_path):
    text = "mtllib a.mtl\nusemtl skin\nvt 0 0\nvt 1 0\nvt 1 1\n" + obj(V, [QUADS[0][:3]], "{0}/1")
    (tmp_path / "a.obj").write_bytes(codecs.BOM_UTF16_LE + text.encode("utf-16-le"))
    material = "newmtl skin\nmap_Kd gone.png\n"
    (tmp_path / "a.mtl").write_bytes(codecs.BOM_UTF16_LE + material.encode("utf-16-le"))
    _, sentence = open_mesh(tmp_path / "a.obj").texture
    assert "gone.png" in sentence


@pytest.mark.parametrize("mark", [codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE, codecs.BOM_UTF8, b"a\0" * 40])
def test_read_stl_takes_binary_data_that_begins_like_a_mark(mark, tmp_path):
    mesh = opened(tmp_path / "a.stl", binary_stl(*BOX, header=mark))
    assert inspect(mesh).volume == pytest.approx(6.0)


def test_read_gltf_opens_a_text_with_a_mark(tmp_path):
    (tmp_path / "a.gltf").write_bytes(codecs.BOM_UTF8 + gltf_of(textured_glb()))
    mesh = open_mesh(tmp_path / "a.gltf")
    save_mesh(mesh, mesh.V, tmp_path / "b.gltf")
    assert (tmp_path / "b.gltf").read_bytes() == (tmp_path / "a.gltf").read_bytes()


MIXED = {
    "vertices end in CR, faces in CRLF": lambda lines: "".join(
        line + ("\r" if line[0] == "v" else "\r\n") for line in lines
    ),
    "in turns": lambda lines: "".join(line + ("\r", "\n")[k % 2] for k, line in enumerate(lines)),
    "three kinds": lambda lines: "".join(line + ("\n", "\r", "\r\n")[k % 3] for k, line in enumerate(lines)),
    "converted twice": "\r\r\n".join,
    "CR alone": "\r".join,
}


@pytest.mark.parametrize("suffix", ["obj", "off", "ply", "stl"])
@pytest.mark.parametrize("ended", MIXED.values(), ids=MIXED)
def test_open_mesh_takes_mixed_line_ends(suffix, ended, tmp_path):
    content = ended(TEXTS[suffix].splitlines()).encode()
    mesh = opened(tmp_path / f"a.{suffix}", content)
    assert len(mesh.V) == (3 * len(BOX[1]) if suffix == "stl" else len(V))
    assert inspect(mesh).volume == pytest.approx(6.0 if suffix == "stl" else 1.0)


@pytest.mark.parametrize("line_end", ["\n", "\r\n", "\r"])
def test_read_obj_goes_on_with_a_line_after_a_backslash_whatever_ends_it(line_end, tmp_path):
    text = obj(V, QUADS).replace("f 1 3", "f 1 \\\n 3").replace("v 0.0 0.0", "v 0.0 \\\n0.0", 1)
    text = text.replace("f 5 6 8 7", "f -4 -3 -1 -2")
    assert text.count("\\") == 2
    mesh = opened(tmp_path / "a.obj", text.replace("\n", line_end))
    assert inspect(mesh).volume == pytest.approx(1.0)
    np.testing.assert_array_equal(mesh.V, V)
