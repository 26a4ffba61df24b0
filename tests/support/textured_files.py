"""A square with four colours on it, in each format that has textures."""

import base64
import io
import json
import struct

import numpy as np
from PIL import Image

COLORS = np.array([[[220, 40, 40], [40, 200, 60]], [[50, 70, 220], [230, 210, 50]]], dtype=np.uint8)
V = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 2, 0], [1, 2, 0], [2, 2, 0]], dtype=np.float32)
F = np.array([[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]])


def image():
    """PNG of 64 x 64 pixels, a colour in each quarter; the first row is the upper one."""
    buffer = io.BytesIO()
    Image.fromarray(COLORS.repeat(32, axis=0).repeat(32, axis=1)).save(buffer, "png")
    return buffer.getvalue()


def obj(folder, with_image=True):
    """The square in two halves, each with a seam in the middle: u runs from 0 to 0.5, from 1.5 to 2."""
    if with_image:
        (folder / "four.png").write_bytes(image())
    (folder / "square.mtl").write_text("newmtl paint\nmap_Kd -s 1 1 1 four.png\n", encoding="utf-8")
    rows = ["mtllib square.mtl", *(f"v {x} {y} {z}" for x, y, z in V)]
    rows += [f"vt {u} {v}" for v in (0, 1) for u in (0, 0.5, 1.5, 2)] + ["usemtl paint"]
    rows += ["f 1/1 2/2 5/6 4/5", "f 2/3 3/4 6/8 5/7"]
    path = folder / "square.obj"
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")
    return path


def ply(folder):
    (folder / "four.png").write_bytes(image())
    rows = ["ply", "format ascii 1.0", "comment TextureFile four.png", f"element vertex {len(V)}"]
    rows += [f"property float {name}" for name in ("x", "y", "z", "s", "t")]
    rows += [f"element face {len(F)}", "property list uchar int vertex_indices", "end_header"]
    rows += [f"{x} {y} {z} {x / 2} {y / 2}" for x, y, z in V] + ["3 " + " ".join(map(str, f)) for f in F]
    path = folder / "square.ply"
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")
    return path


def gltf(folder):
    """With the image in the file; texture coordinates run downwards."""
    uv = np.column_stack([V[:, 0] / 2, 1 - V[:, 1] / 2]).astype("<f4")
    parts = V.astype("<f4").tobytes(), uv.tobytes(), F.astype("<u4").tobytes(), image()
    starts = np.cumsum([0, *map(len, parts)])[:-1].tolist()
    views = [{"buffer": 0, "byteOffset": k, "byteLength": len(p)} for k, p in zip(starts, parts, strict=True)]
    kinds = (5126, 6, "VEC3"), (5126, 6, "VEC2"), (5125, 12, "SCALAR")
    data = base64.b64encode(b"".join(parts)).decode()
    document = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [
            {"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}
        ],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        "textures": [{"source": 0}],
        "images": [{"bufferView": 3, "mimeType": "image/png"}],
        "accessors": [
            {"bufferView": k, "componentType": code, "count": count, "type": kind}
            for k, (code, count, kind) in enumerate(kinds)
        ],
        "bufferViews": views,
        "buffers": [
            {"uri": "data:application/octet-stream;base64," + data, "byteLength": sum(map(len, parts))}
        ],
    }
    path = folder / "square.gltf"
    path.write_text(json.dumps(document), encoding="utf-8")
    return path


def glb(folder):
    """The same in one binary file."""
    document = json.loads(gltf(folder).read_text(encoding="utf-8"))
    blob = base64.b64decode(document["buffers"][0].pop("uri").partition(",")[2])
    said = json.dumps(document).encode()
    said, blob = said + b" " * (-len(said) % 4), blob + b"\0" * (-len(blob) % 4)
    head = struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(said) + 8 + len(blob))
    path = folder / "square.glb"
    path.write_bytes(
        head
        + struct.pack("<I4s", len(said), b"JSON")
        + said
        + struct.pack("<I4s", len(blob), b"BIN\0")
        + blob
    )
    return path


FILES = {"obj": obj, "ply": ply, "gltf": gltf, "glb": glb}
