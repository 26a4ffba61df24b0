"""What is no mesh of its kind is said for what it is, whatever it is called: never a point cloud."""

import bz2
import gzip
import io
import lzma
import struct
import tarfile
import zipfile
import zlib

import numpy as np
import pytest
from mesh_contents import BOX, CUBE, QUADS, binary_stl, glb, gltf_of, legacy_vtk, obj, off, ply, stl, vtp, vtu

from apd_viewer.errors import InputError
from apd_viewer.files.meshes import MESH_FORMATS, open_mesh

SUFFIXES = [suffix[1:] for suffix in MESH_FORMATS]
MESH = obj(CUBE, QUADS).encode() * 9


def archive(members):
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as there:
        for name, content in members.items():
            there.writestr(name, content)
    return packed.getvalue()


def tar():
    packed = io.BytesIO()
    scan = ply(CUBE, QUADS)
    with tarfile.open(fileobj=packed, mode="w") as there:
        about = tarfile.TarInfo("bottle.ply")
        about.size = len(scan)
        there.addfile(about, io.BytesIO(scan))
    return packed.getvalue()


def png():
    rows = struct.pack(">4sIIBBBBB", b"IHDR", 1, 1, 8, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + struct.pack(">I", 13) + rows + struct.pack(">I", zlib.crc32(rows))


WEB_PAGE = "holds a web page and no mesh; download the mesh itself."
OTHER = "The content of {{}} is {}, which cannot be opened; export the mesh as OBJ, PLY or STL."
READABLE = "The content of {{}} is {}; rename it to end in .{}."
LFS = b"version https://git-lfs.github.com/spec/v1\noid sha256:%s\nsize 132735\n" % (b"4d7a" * 16)

KNOWN = {
    "page": (
        b"<!DOCTYPE html>\n<html><head><title>404</title></head><body>Not found</body></html>\n",
        WEB_PAGE,
    ),
    "page in capitals": (b"\r\n  <HTML>\r\n<BODY>v 1 2 3</BODY></HTML>", WEB_PAGE),
    "page as XML": (b'<?xml version="1.0"?>\n<!-- a -->\n<!doctype HTML PUBLIC "-//W3C">\n<html/>', WEB_PAGE),
    "page in UTF-16": (
        "\ufeff<!doctype html><html><body>Sign in</body></html>".encode("utf-16-le"),
        WEB_PAGE,
    ),
    "LFS": (LFS, "points to a mesh that Git LFS keeps elsewhere; get it with “git lfs pull”."),
    "LFS on Windows": (LFS.replace(b"\n", b"\r\n"), "get it with “git lfs pull”."),
    "annex": (b"/annex/objects/SHA256E-s132--4d7a.obj\n", "get it with “git annex get”."),
    "annex, a link": (
        b"../../.git/annex/objects/Wj/8q/SHA256E-s1--4d.obj/SHA256E",
        "get it with “git annex get”.",
    ),
    "gzip": (gzip.compress(MESH), "is compressed (gzip); unpack it first."),
    "bzip2": (bz2.compress(MESH), "is compressed (bzip2); unpack it first."),
    "xz": (lzma.compress(MESH), "is compressed (xz); unpack it first."),
    "zstd": (b"\x28\xb5\x2f\xfd\x04\x58" + bytes(30), "is compressed (Zstandard); unpack it first."),
    "7z": (b"7z\xbc\xaf\x27\x1c\0\4" + bytes(30), "is compressed (7z); unpack it first."),
    "rar": (b"Rar!\x1a\7\1\0" + bytes(30), "is compressed (RAR); unpack it first."),
    "tar": (tar(), "is compressed (tar); unpack it first."),
    "PNG": (png(), OTHER.format("PNG")),
    "JPEG": (b"\xff\xd8\xff\xe0\0\x10JFIF\0" + bytes(30), OTHER.format("JPEG")),
    "PDF": (b"%PDF-1.7\n%\xe2\xe3\xcf\xd3\n1 0 obj\n", OTHER.format("PDF")),
    "STEP": (
        b"ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION(('v 1 2 3'),'2;1');\n",
        READABLE.format("STEP", "step"),
    ),
    "IGES": (
        b"part".ljust(72) + b"S      1\n1H,,1H;,".ljust(72),
        READABLE.format("IGES", "iges"),
    ),
    "DXF": (b"  0\r\nSECTION\r\n  2\r\nHEADER\r\n", OTHER.format("DXF")),
    "DXF with a remark": (b"999\nby a program\n0\nSECTION\n2\nENTITIES\n", OTHER.format("DXF")),
    "DWG": (b"AC1027\0\0\0", OTHER.format("DWG")),
    "FBX": (b"Kaydara FBX Binary  \0\x1a\0", OTHER.format("FBX")),
    "FBX in text": (b"; FBX 7.3.0 project file\n; ----\n", OTHER.format("FBX")),
    "COLLADA": (b'<?xml version="1.0"?>\n<COLLADA version="1.4.1"></COLLADA>', OTHER.format("COLLADA")),
    "Blender": (b"BLENDER-v293RENDH\0\0\0", OTHER.format("Blender")),
    "3DS": (struct.pack("<2sIHI", b"MM", 40, 2, 10) + bytes(28), OTHER.format("3DS")),
    "VRML": (b"#VRML V2.0 utf8\nShape { }\n", OTHER.format("VRML")),
}


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize("name", KNOWN)
def test_open_mesh_names_content_that_is_known(name, suffix, tmp_path):
    content, words = KNOWN[name]
    path = tmp_path / f"bottle.{suffix}"
    path.write_bytes(content)
    with pytest.raises(InputError) as refused:
        open_mesh(path)
    said = str(refused.value)
    assert words.format(path.name) in said
    assert path.name in said


MESHES = {
    "obj": obj(CUBE, QUADS).encode(),
    "ply": ply(CUBE, QUADS, "binary_big_endian"),
    "stl": binary_stl(*BOX),
    "off": off(CUBE, QUADS, "OFF").encode(),
    "glb": glb([BOX]),
    "gltf": gltf_of(glb([BOX])),
    "3mf": archive({"[Content_Types].xml": "<Types/>", "picture.png": MESH, "3D/3dmodel.model": "<model/>"}),
    "vtp": vtp(CUBE, QUADS),
    "vtu": vtu(CUBE, QUADS),
    "vtk": legacy_vtk(CUBE, QUADS),
}
MORE = {
    "obj": b"# by hand\r\nmtllib a.mtl\r\no cube\r\n" + obj(CUBE, QUADS).encode(),
    "stl": stl(*BOX, name="cube").encode(),
    "off": b"\xef\xbb\xbfCOFF\n0 0 0\n",
}
# Of both kinds, so they open under the other name, too, or it is said by the reader itself.
ALIKE = {("glb", "gltf"), ("gltf", "glb"), ("vtp", "vtu"), ("vtu", "vtp")}


@pytest.mark.parametrize("called", SUFFIXES)
@pytest.mark.parametrize(("kind", "content"), [*MESHES.items(), *MORE.items()])
def test_open_mesh_names_a_mesh_under_the_name_of_another_format(kind, content, called, tmp_path):
    path = tmp_path / f"bottle.{called}"
    path.write_bytes(content)
    if called == kind or (kind, called) in ALIKE:
        return
    with pytest.raises(InputError) as refused:
        open_mesh(path)
    said = f"The content of {path.name} is {kind.upper()}; rename it to end in .{kind}."
    assert str(refused.value) == said


NOTHING = {
    "a letter": (b"404: Not Found", "has no vertices; it begins with “404: Not Found”."),
    "remarks": (b"# exported\n# by a program\n", "has no vertices; it begins with “# exported”."),
    "a long line": (b"x" * 5000, f"has no vertices; it begins with “{'x' * 40}”."),
    "blanks": (b"\n \n\t\n", "has no vertices; export the mesh again."),
    "zeros": (bytes(500), "has no vertices; export the mesh again."),
}


@pytest.mark.parametrize(("content", "words"), NOTHING.values(), ids=NOTHING)
def test_open_mesh_shows_content_without_vertices_that_is_not_known(content, words, tmp_path):
    path = tmp_path / "bottle.obj"
    path.write_bytes(content)
    with pytest.raises(InputError) as refused:
        open_mesh(path)
    assert str(refused.value) == f"bottle.obj {words}"


EMPTY = {
    "obj": b"f 1 2 3\n",
    "ply": ply(CUBE[:0], []),
    "stl": b"solid a\nendsolid a\n",
    "off": b"OFF\n0 0 0\n",
    "vtk": legacy_vtk(CUBE[:0], [[0, 1, 2]]),
    "glb": glb([(BOX[0][:0], np.empty((0, 3), int))]),
}


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize("content", [*EMPTY.values(), *(content for content, _ in NOTHING.values())])
def test_open_mesh_calls_nothing_without_a_vertex_a_point_cloud(content, suffix, tmp_path):
    path = tmp_path / f"bottle.{suffix}"
    path.write_bytes(content)
    with pytest.raises(InputError) as refused:
        open_mesh(path)
    assert "point cloud" not in str(refused.value)


@pytest.mark.parametrize(
    ("suffix", "content"),
    [("obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\n"), ("ply", ply(CUBE, [])), ("off", off(CUBE, []))],
)
def test_open_mesh_calls_vertices_without_faces_a_point_cloud(suffix, content, tmp_path):
    path = tmp_path / f"bottle.{suffix}"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(InputError, match="this looks like a point cloud"):
        open_mesh(path)
