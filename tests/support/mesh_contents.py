"""Contents of mesh files, written by hand."""

import base64
import json
import struct
import zlib

import numpy as np
from meshes import box, rotation

# Six corners, of which the last coincides with the first and the fourth is used by no face.
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [1, 1.5, 0], [7, 7, 7], [0.1, 1, -2e-3], [0, 0, 0]])

POLYGONS = [[0, 1, 2], [5, 1, 2, 4], [4, 2, 1], [0, 1, 2, 4, 5]]


def rows(V):
    return [" ".join(map(repr, map(float, v))) for v in V]


def obj(V, polygons, word="{0}", offset=1):
    lines = [f"v {row}" for row in rows(V)]
    lines += ["f " + " ".join(word.format(i + offset) for i in p) for p in polygons]
    return "\n".join(lines) + "\n"


def off(V, polygons, head="OFF\n", tail=""):
    lines = rows(V) + [" ".join(map(str, [len(p), *p])) + tail for p in polygons]
    return f"{head}{len(V)} {len(polygons)} 0\n" + "\n".join(lines) + "\n"


def ply(V, polygons, kind="ascii", real="double", before="", after="", name="vertex_indices"):
    """PLY with the properties ``before`` and ``after`` (uchar, all 200) around the coordinates."""
    extra = [[f"property uchar {w}" for w in words.split()] for words in (before, after)]
    head = ["ply", f"format {kind} 1.0", "comment made in a test", f"element vertex {len(V)}", *extra[0]]
    head += [f"property {real} {axis}" for axis in "xyz"] + extra[1]
    head += [f"element face {len(polygons)}", f"property list uchar int {name}", "end_header", ""]
    pad = [["200"] * len(e) for e in extra]
    if kind == "ascii":
        lines = [" ".join([*pad[0], row, *pad[1]]) for row in rows(V)]
        lines += [" ".join(map(str, [len(p), *p])) for p in polygons]
        return "\n".join(head + lines).replace("\n\n", "\n").encode() + b"\n"
    order = "<" if kind == "binary_little_endian" else ">"
    one = order + f"{len(pad[0])}B3{'d' if real == 'double' else 'f'}{len(pad[1])}B"
    body = [struct.pack(one, *map(int, pad[0]), *v, *map(int, pad[1])) for v in V]
    body += [struct.pack(f"{order}B{len(p)}i", len(p), *p) for p in polygons]
    return "\n".join(head).encode() + b"".join(body)


def stl(V, F, name="part"):
    facet = "facet normal 0 0 1\n outer loop\n  vertex {}\n  vertex {}\n  vertex {}\n endloop\nendfacet\n"
    text = rows(V)
    return f"solid {name}\n" + "".join(facet.format(*(text[i] for i in f)) for f in F) + f"endsolid {name}\n"


def binary_stl(V, F, header=b"a test"):
    facets = [struct.pack("<12fH", 0, 0, 1, *V[list(f)].ravel(), 0) for f in F]
    return header.ljust(80, b"\0") + struct.pack("<I", len(F)) + b"".join(facets)


def glb(parts, shifts=None):
    """GLB with a mesh and a node for every (V, F) of ``parts``, the node shifted by its ``shifts``."""
    blob, views, accessors = b"", [], []
    for V, F in parts:
        for array, code, kind in ((V.astype("<f4"), 5126, "VEC3"), (F.astype("<u4").ravel(), 5125, "SCALAR")):
            views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": array.nbytes})
            accessor = {
                "bufferView": len(views) - 1,
                "componentType": code,
                "count": len(array),
                "type": kind,
            }
            accessors.append(accessor | ({"min": [-9] * 3, "max": [9] * 3} if kind == "VEC3" else {}))
            blob += array.tobytes()
    which = range(len(parts))
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": list(which)}],
        "nodes": [{"mesh": k, "translation": shifts[k] if shifts else [0, 0, 0]} for k in which],
        "meshes": [
            {"primitives": [{"attributes": {"POSITION": 2 * k}, "indices": 2 * k + 1}]} for k in which
        ],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": len(blob)}],
    }
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(blob), b"BIN\0") + blob
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


BOX = box(2, 2, 3)

QUADS = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]

CUBE = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)]) / 3.0

TWO_MATERIALS = b"""# Exported by hand\r
mtllib two.mtl\r
o Cube one\r
v 0.0000 0.0 0 0.1 0.2 0.3\r
v   1e0\t0.0 0 0.1 0.2 0.3   # a comment\r
v +1.00 1 0.0 0.1 0.2 0.3\r
v 0 1.0 -0 0.1 0.2 0.3\r
v .5 .5 \\\r
  1.5 0.1 0.2 0.3\r
vt 0 0\r
vt 1 0\r
vt 1 1\r
vn 0 0 -1.000\r
vn 0 0.9487 0.3162\r
\r
usemtl red\r
s 1\r
g sides left\r
f 4/1/1 3/2/1 2/3/1 1/1/1\r
usemtl blue\r
g sides right\r
f 3/1/2 4/2/2 5/3/2\r
f -4/1 -3/2 -1/3\r
f 1 2 5\r
f 4 1 5\r
"""


def rich_ply(order):
    """Doubles among other properties, faces with a scalar after their list, and an element nobody knows."""
    head = f"""ply
format {order} 1.0
comment as it comes from a scanner
element vertex {len(CUBE)}
property uchar red
property double x
property double y
property double z
property float quality
property float nx
property float ny
property float nz
element face {len(QUADS)}
property list uchar int vertex_indices
property short material
element camera 1
property list uchar float values
end_header
"""
    sign = {"binary_little_endian": "<", "binary_big_endian": ">"}.get(order)
    N = CUBE - CUBE.mean(axis=0)
    N /= np.linalg.norm(N, axis=1, keepdims=True)
    if sign is None:
        rows = [
            f"200 {x!r}  {y!r}\t{z!r} 0.50 {a:.4f} {b:.4f} {c:.4f}"
            for (x, y, z), (a, b, c) in zip(CUBE.tolist(), N, strict=True)
        ]
        rows += [f"4 {a} {b} {c} {d} {k}" for k, (a, b, c, d) in enumerate(QUADS)]
        return (head + "\n".join(rows) + "\n3 0.1 0.2 0.3\n").encode()
    body = b"".join(struct.pack(sign + "Bddd4f", 200, *v, 0.5, *n) for v, n in zip(CUBE, N, strict=True))
    body += b"".join(struct.pack(sign + "B4ih", 4, *q, k) for k, q in enumerate(QUADS))
    return head.encode() + body + struct.pack(sign + "B3f", 3, 0.1, 0.2, 0.3)


def strips_ply(V, rows, kind="binary_little_endian", length="int", more=""):
    """PLY with strips of triangles for faces, and ``more`` elements declared behind them."""
    head = f"ply\nformat {kind} 1.0\nobj_info made by hand\nelement vertex {len(V)}\n"
    head += "".join(f"property double {axis}\n" for axis in "xyz")
    head += f"element tristrips {len(rows)}\nproperty list {length} int vertex_indices\n{more}end_header\n"
    if kind == "ascii":
        lines = [" ".join(map(repr, v)) for v in V.tolist()]
        lines += [" ".join(map(str, [len(row), *row])) for row in rows]
        return (head + "\n".join(lines) + "\n").encode()
    order = "<" if kind == "binary_little_endian" else ">"
    code = {"int": "i", "uchar": "B"}[length]
    body = b"".join(struct.pack(f"{order}3d", *v) for v in V)
    return head.encode() + body + b"".join(struct.pack(f"{order}{code}{len(r)}i", len(r), *r) for r in rows)


def wrapped(content):
    """PLY in text, one word a line."""
    head, body = content.split(b"end_header\n")
    return head + b"end_header\n" + b"\n".join(body.split()) + b"\n"


def coff():
    lines = [f"{x!r} {y!r}  {z!r} 255 0 10 255" for x, y, z in CUBE.tolist()]
    faces = ["4 " + " ".join(map(str, q)) + " 0.1 0.2 0.3" for q in QUADS]
    return "\r\n".join(
        ["COFF # colours", "", f"{len(CUBE)} {len(QUADS)} 0", *lines, "# faces", *faces, ""]
    ).encode()


def noff():
    N = (CUBE - CUBE.mean(axis=0)) * 2
    lines = [
        f"{x!r} {y!r} {z!r} {a:.5f} {b:.5f} {c:.5f}"
        for (x, y, z), (a, b, c) in zip(CUBE.tolist(), N, strict=True)
    ]
    return "\n".join(
        [f"NOFF {len(CUBE)} {len(QUADS)} 0", *lines, *("4 " + " ".join(map(str, q)) for q in QUADS)]
    ).encode()


def textured_glb():
    """A mesh with normals, texture coordinates and a picture, turned and scaled by its node; interleaved."""
    V, F = BOX
    V = V.astype("<f4")
    N = (V - V.mean(axis=0)) / np.linalg.norm(V - V.mean(axis=0), axis=1, keepdims=True)
    rows = np.concatenate([V, N.astype("<f4"), V[:, :2]], axis=1).astype("<f4").tobytes()
    index, picture = F.astype("<u2").tobytes(), b"\x89PNG not really"
    index += b"\0" * (-len(index) % 4)
    blob = rows + index + picture
    blob += b"\0" * (-len(blob) % 4)
    lows, highs = V.min(axis=0).astype(float).tolist(), V.max(axis=0).astype(float).tolist()
    document = {
        "asset": {"version": "2.0", "generator": "by hand — ü"},
        "extras": {"min": [1, 2], "accessors": "not these"},
        "scene": 0,
        "scenes": [{"nodes": [1]}],
        "nodes": [
            {"mesh": 0, "rotation": [0, 0.6, 0, 0.8], "scale": [2, 2, 2]},
            {"children": [0], "translation": [5, 0, 0]},
        ],
        "meshes": [
            {
                "primitives": [
                    {"attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2}, "indices": 3, "material": 0}
                ]
            }
        ],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        "textures": [{"source": 0}],
        "images": [{"bufferView": 2, "mimeType": "image/png"}],
        "accessors": [
            {
                "bufferView": 0,
                "componentType": 5126,
                "count": len(V),
                "type": "VEC3",
                "max": highs,
                "min": lows,
            },
            {"bufferView": 0, "byteOffset": 12, "componentType": 5126, "count": len(V), "type": "VEC3"},
            {"bufferView": 0, "byteOffset": 24, "componentType": 5126, "count": len(V), "type": "VEC2"},
            {"bufferView": 1, "componentType": 5123, "count": F.size, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": len(rows), "byteStride": 32},
            {"buffer": 0, "byteOffset": len(rows), "byteLength": len(index)},
            {"buffer": 0, "byteOffset": len(rows) + len(index), "byteLength": len(picture)},
        ],
        "buffers": [{"byteLength": len(blob)}],
    }
    text = json.dumps(document, indent=1, ensure_ascii=False).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(blob), b"BIN\0") + blob
    extra = struct.pack("<I4s", 4, b"MORE") + b"abcd"
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks) + len(extra)) + chunks + extra


def gltf_of(content):
    """The same as a text with its buffer inside."""
    (length,) = struct.unpack_from("<I", content, 12)
    document = json.loads(content[20 : 20 + length])
    blob = content[28 + length : 28 + length + document["buffers"][0]["byteLength"]]
    document["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(blob).decode()
    return json.dumps(document, indent=2).encode()


def vtp(V, polygons, form="ascii", compressed=False):
    """PolyData with data at points and faces, in text, in base64, or appended as bytes."""
    appended, arrays = bytearray(), []

    def array(name, values, components=1):
        kind = {"f4": "Float32", "f8": "Float64", "i8": "Int64"}[values.dtype.str[1:]]
        data = values.tobytes()
        if compressed:
            block = zlib.compress(data)
            head, data = struct.pack("<4I", 1, 32768, len(data), len(block)), block
        else:
            head = struct.pack("<I", len(data))
        place = f'offset="{len(appended)}"' if form == "appended" else ""
        about = f'Name="{name}" NumberOfComponents="{components}" format="{form}"'
        head_tag = f'<DataArray type="{kind}" {about} {place}>'
        if form == "appended":
            appended.extend(head + data)
            return f"{head_tag}</DataArray>"
        if form == "ascii":
            return f"{head_tag}\n{' '.join(map(str, values.ravel().tolist()))}\n</DataArray>"
        coded = [base64.b64encode(part).decode() for part in ([head, data] if compressed else [head + data])]
        return f"{head_tag}\n  {''.join(coded)}\n</DataArray>"

    real = np.float32 if form == "appended" else np.float64
    arrays = {
        "PointData": array("heat", np.arange(len(V)) / 7.0),
        "CellData": array("layer", np.arange(len(polygons))),
        "Points": array("Points", V.astype(real), 3),
        "Polys": array("connectivity", np.concatenate([*polygons]).astype(np.int64))
        + array("offsets", np.cumsum([len(p) for p in polygons])),
    }
    body = "\n".join(f"<{name}>{text}</{name}>" for name, text in arrays.items())
    head = (
        '<?xml version="1.0"?>\n<!-- by hand: 1 < 2 -->\n<VTKFile type="PolyData" byte_order="LittleEndian"'
    )
    head += ' compressor="vtkZLibDataCompressor"' * compressed
    text = f'{head}>\n<PolyData><Piece NumberOfPoints="{len(V)}" NumberOfPolys="{len(polygons)}">\n{body}\n'
    text = f"{text}</Piece></PolyData>\n".encode()
    if form == "appended":
        text += b'<AppendedData encoding="raw">\n_' + bytes(appended) + b"\n</AppendedData>"
    return text + b"\n</VTKFile>\n"


def vtu(V, polygons):
    """UnstructuredGrid of the same, in base64."""
    text = (
        vtp(V, polygons, "binary").decode().replace("PolyData", "UnstructuredGrid").replace("Polys", "Cells")
    )
    kinds = struct.pack("<I", len(polygons)) + bytes({3: 5, 4: 9}.get(len(p), 7) for p in polygons)
    types = '<DataArray type="UInt8" Name="types" format="binary">'
    types += base64.b64encode(kinds).decode() + "</DataArray>"
    return text.replace("</Cells>", types + "</Cells>").encode()


def legacy_vtk(V, polygons, binary=False):
    """Legacy PolyData with a field before, and data behind."""

    def array(values, kind):
        values = np.asarray(values)
        if binary:
            return values.astype(kind).tobytes() + b"\n"
        return " ".join(map(str, values.ravel().tolist())).encode() + b"\n"

    counted = np.concatenate([[len(p), *p] for p in polygons])
    out = [b"# vtk DataFile Version 3.0\na test\n", b"BINARY\n" if binary else b"ASCII\n"]
    out += [b"DATASET POLYDATA\nFIELD FieldData 1\nTIME 1 1 double\n", array([0.5], ">f8")]
    out += [b"POINTS %d double\n" % len(V), array(V, ">f8")]
    out += [b"POLYGONS %d %d\n" % (len(polygons), len(counted)), array(counted, ">i4")]
    out += [b"POINT_DATA %d\nSCALARS heat float 1\nLOOKUP_TABLE default\n" % len(V)]
    out += [array(np.arange(len(V)) / 8.0, ">f4")]
    return b"".join(out)


FILES = {
    "two materials.obj": TWO_MATERIALS,
    "plain.obj": obj(*BOX).encode(),
    "seams.obj": obj(*BOX, word="{0}/{0}").encode(),
    "quads.obj": obj(CUBE, QUADS).encode(),
    "mac.obj": obj(CUBE, QUADS).replace("\n", "\r").encode(),
    "marked.obj": b"\xef\xbb\xbf" + obj(CUBE, QUADS).encode(),
    "text.ply": rich_ply("ascii"),
    "little.ply": rich_ply("binary_little_endian"),
    "big.ply": rich_ply("binary_big_endian"),
    "float.ply": ply(CUBE, QUADS, "binary_little_endian", "float"),
    "mixed.ply": ply(CUBE, [*QUADS[:5], QUADS[5][:3], [7, 5, 1]], "binary_big_endian"),
    "strips.ply": strips_ply(CUBE, [[0, 1, 2, 3, 6, 7, 4, 5, 0, 1, -1, 0, 2, 4, 6, -1, 1, 5, 3, 7]]),
    "wrapped.ply": wrapped(rich_ply("ascii")),
    "text.stl": stl(*BOX).encode(),
    "endless.stl": stl(*BOX).partition("endsolid")[0].encode(),
    "binary.stl": binary_stl(*BOX),
    "tail.stl": binary_stl(*BOX) + b"written by hand",
    "plain.off": off(CUBE, QUADS).encode(),
    "glued.off": off(CUBE, QUADS, "OFF").encode(),
    "colours.off": coff(),
    "normals.off": noff(),
    "parts.glb": glb([BOX, (BOX[0] * 0.5, BOX[1])], [[0, 0, 0], [9, 0, 0]]),
    "textured.glb": textured_glb(),
    "textured.gltf": gltf_of(textured_glb()),
    "text.vtp": vtp(CUBE, QUADS),
    "coded.vtp": vtp(CUBE, [*QUADS[:5], QUADS[5][:3], [7, 5, 1]], "binary", compressed=True),
    "appended.vtp": vtp(CUBE, QUADS, "appended"),
    "packed.vtp": vtp(*BOX, "appended", compressed=True),
    "coded.vtu": vtu(CUBE, QUADS),
    "text.vtk": legacy_vtk(CUBE, QUADS),
    "binary.vtk": legacy_vtk(CUBE, QUADS, binary=True),
}


def bent(V, where=slice(None)):
    """Other positions of some of the vertices."""
    U = V.copy()
    U[where] = (V @ rotation((1, 2, 3), 0.3).T * [1.1, 0.9, 1.2] + [0.01, 0.2, 1 / 3])[where]
    return U
