"""Vertex colours of files: read as eight bits, wherever a format keeps them."""

import json
import struct

import numpy as np
import pytest

from apd_viewer.files.meshes import read_mesh

V = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
COLORS = [(255, 0, 0), (0, 255, 0), (0, 0, 255)]


def written(place, words):
    return "".join(place.format(" ".join(map(str, v)), " ".join(map(str, c))) for v, c in words)


def ply(kind, scale, order="ascii"):
    properties = "".join(f"property float {x}\n" for x in "xyz")
    properties += "".join(f"property {kind} {name}\n" for name in ("red", "green", "blue"))
    head = f"ply\nformat {order} 1.0\nelement vertex 3\n{properties}"
    head += "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    scaled = [[x * scale for x in color] for color in COLORS]
    if order == "ascii":
        return (head + written("{} {}\n", zip(V, scaled, strict=True)) + "3 0 1 2\n").encode()
    code = {"uchar": "3B", "float": "3f", "ushort": "3H"}[kind]
    rows = [
        struct.pack("<3f" + code, *v, *(x if kind == "float" else int(x) for x in c))
        for v, c in zip(V, scaled, strict=True)
    ]
    return head.encode() + b"".join(rows) + struct.pack("<B3i", 3, 0, 1, 2)


def obj(scale):
    scaled = [[x * scale for x in color] for color in COLORS]
    return (written("v {} {}\n", zip(V, scaled, strict=True)) + "f 1 2 3\n").encode()


def off():
    rows = written("{} {} 255\n", zip(V, COLORS, strict=True))
    return f"COFF\n3 1 0\n{rows}3 0 1 2\n".encode()


def gltf(normalized):
    points = np.array(V, dtype="<f4").tobytes()
    colors = np.array(COLORS, dtype="u1") if normalized else np.array(COLORS, dtype="<f4") / 255
    if normalized:
        colors = np.column_stack([colors, np.full(3, 255, dtype="u1")])
    blob = points + colors.tobytes()
    document = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "COLOR_0": 1}}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3},
            {
                "bufferView": 1,
                "componentType": 5121 if normalized else 5126,
                "normalized": normalized,
                "type": "VEC4" if normalized else "VEC3",
                "count": 3,
            },
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": len(points)},
            {"buffer": 0, "byteOffset": len(points), "byteLength": len(blob) - len(points)},
        ],
        "buffers": [{"byteLength": len(blob)}],
    }
    said = json.dumps(document).encode()
    said += b" " * (-len(said) % 4)
    body = struct.pack("<I4s", len(said), b"JSON") + said + struct.pack("<I4s", len(blob), b"BIN\0") + blob
    return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body


FILES = {
    "text.ply": ply("uchar", 1),
    "fractions.ply": ply("float", 1 / 255),
    "binary.ply": ply("uchar", 1, "binary_little_endian"),
    "deep.ply": ply("ushort", 257, "binary_little_endian"),
    "fractions.obj": obj(1 / 255),
    "bytes.obj": obj(1),
    "bytes.off": (
        "COFF\n3 1 0\n" + written("{} {} 255\n", zip(V, COLORS, strict=True)) + "3 0 1 2\n"
    ).encode(),
    "floats.glb": gltf(normalized=False),
    "bytes.glb": gltf(normalized=True),
}


@pytest.mark.parametrize("name", FILES)
def test_read_mesh_reads_colors_from_every_format(tmp_path, name):
    mesh = read_mesh(tmp_path / name, FILES[name])
    np.testing.assert_array_equal(mesh.colors, COLORS)
    assert mesh.colors.dtype == np.uint8
    assert not mesh.colors.flags.writeable
    np.testing.assert_array_equal(mesh.baked(mesh.V).colors, COLORS)


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("plain.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
        ("commented.obj", b"v 0 0 0 # 1 2 3\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
        ("some.obj", b"v 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
        ("words.obj", b"v 0 0 0 a b c\nv 1 0 0 a b c\nv 0 1 0 a b c\nf 1 2 3\n"),
        ("short.off", b"COFF\n3 1 0\n0 0 0 255 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
    ],
)
def test_read_mesh_opens_a_mesh_without_usable_colors(tmp_path, name, content):
    mesh = read_mesh(tmp_path / name, content)
    assert len(mesh.V) == 3
    assert mesh.colors is None
