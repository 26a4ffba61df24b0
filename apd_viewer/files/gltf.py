"""glTF: the triangles of a scene, each mesh where its node puts it; the same file with other coordinates."""

from __future__ import annotations

import base64
import binascii
import json
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.parsed import Parsed
from apd_viewer.files.spans import spans
from apd_viewer.geometry.mesh import Mesh
from apd_viewer.geometry.normals import turned_normals

_TYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
_TRIANGLES, _STRIP, _FAN = 4, 5, 6
_COMPRESSED = ("KHR_draco_mesh_compression", "EXT_meshopt_compression")
_MOST = 1 << 28  # numbers of an accessor


class _Block(NamedTuple):
    """The vertices that one node shows of one accessor."""

    first: int
    position: int
    normal: int | None
    matrix: np.ndarray


@dataclass(frozen=True)
class GltfFile:
    """The content of a GLB or glTF file, and which of its vertices are whose."""

    content: bytes
    suffix: str
    text: str
    document: dict[str, Any]
    buffers: list[bytes]
    blocks: list[_Block]

    @property
    def extras(self) -> tuple[str, ...]:
        """What it holds besides positions and triangles, in words."""
        has = [what for what in ("materials", "textures", "animations", "skins") if self.document.get(what)]
        attributes = {
            name
            for mesh in self.document.get("meshes", [])
            for part in mesh["primitives"]
            for name in part["attributes"]
        }
        kinds = {"NORMAL": "normals", "TEXCOORD_0": "texture coordinates", "COLOR_0": "vertex colours"}
        return (*has, *(what for name, what in kinds.items() if name in attributes))

    def rewritten(self, mesh: Mesh, U: np.ndarray) -> bytes:
        """The file with the positions ``U`` (n, 3), their bounds, and normals that have turned along."""
        buffers = [bytearray(buffer) for buffer in self.buffers]
        written: dict[int, np.ndarray] = {}
        touched: list[int] = []
        for block in self.blocks:
            old = self._array(self.buffers, block.position).astype(np.float64)
            mine = slice(block.first, block.first + len(old))
            new, moved = old.copy(), (U[mine] != mesh.V[mine]).any(axis=1)
            inverse = np.linalg.pinv(block.matrix[:3, :3])
            new[moved] = (U[mine][moved] - block.matrix[:3, 3]) @ inverse.T
            if block.position in written:
                if np.abs(written[block.position] - new).max() > 1e-6 * np.ptp(old, axis=0).max():
                    raise InputError(
                        "The file shows one mesh in several places, which are no longer alike; "
                        "choose another format to write."
                    )
                continue
            if self._kind(block.position) != "<f4":
                raise InputError("The file holds rounded positions; choose another format to write.")
            written[block.position] = new
            if not moved.any():
                continue
            touched.append(block.position)
            self._array(buffers, block.position)[moved] = new[moved]
            if block.normal is not None and block.normal not in written and self._kind(block.normal) == "<f4":
                F = mesh.F[((mine.start <= mesh.F) & (mine.stop > mesh.F)).all(axis=1)] - mine.start
                N = self._array(self.buffers, block.normal).astype(np.float64)
                turned = turned_normals(old, new, F, N, F)
                self._array(buffers, block.normal)[...] = np.where(turned == N, N, turned)
                written[block.normal] = turned
        return self._packed(buffers, touched)

    def _kind(self, accessor: int) -> str:
        return _TYPES[self.document["accessors"][accessor]["componentType"]]

    def _array(self, buffers: list[Any], accessor: int) -> np.ndarray:
        return _array(self.document, buffers, accessor)

    def _packed(self, buffers: list[bytearray], touched: list[int]) -> bytes:
        text, changes = self.text, []
        for accessor in touched:
            told = self.document["accessors"][accessor]
            array = self._array(buffers, accessor)
            for bound, value in (("min", array.min(axis=0)), ("max", array.max(axis=0))):
                if bound in told and not np.array_equal(np.float32(told[bound]), value):
                    changes.append((("accessors", accessor, bound), json.dumps(value.astype(float).tolist())))
        if self.suffix == ".gltf":
            for k, buffer in enumerate(buffers):
                if buffer != self.buffers[k]:
                    changes.append((("buffers", k, "uri"), json.dumps(self._uri(k, buffer))))
        found = spans(text, [path for path, _ in changes])
        for path, new in sorted(changes, key=lambda change: -found[change[0]][0]):
            begin, end = found[path]
            text = text[:begin] + new + text[end:]
        said = text.encode()
        if self.suffix == ".gltf":
            return said
        head = struct.calcsize("<4sIII4s")
        (old,) = struct.unpack_from("<I", self.content, 12)
        if said != self.text.encode():
            said += b" " * (-len(said) % 4)
        rest = bytearray(self.content[head + old :])
        if buffers and rest:
            rest[8 : 8 + len(buffers[0])] = buffers[0]
        start = struct.pack("<4sIII4s", b"glTF", 2, head + len(said) + len(rest), len(said), b"JSON")
        return start + said + bytes(rest)

    def _uri(self, k: int, buffer: bytearray) -> str:
        uri = self.document["buffers"][k]["uri"]
        if not uri.startswith("data:"):
            raise InputError(
                f"The file keeps its coordinates in another one, {uri}; pack both into a GLB first."
            )
        return uri.partition(",")[0] + "," + base64.b64encode(buffer).decode()


def read_gltf(content: bytes, path: Path) -> Parsed:
    """Positions (n, 3) and triangles (m, 3) of the scene in a GLB or glTF file.

    Raises
    ------
    ValueError
        If the file cannot be understood or ends too early.
    """
    try:
        return _read(content, path)
    except (KeyError, IndexError, TypeError, AttributeError, struct.error, binascii.Error) as error:
        raise ValueError(f"something in it is missing or out of place: {error}") from error


def _read(content: bytes, path: Path) -> Parsed:
    is_binary = path.suffix.lower() == ".glb"
    said, blob = _chunks(content) if is_binary else (content, None)
    text = said.decode("utf-8-sig")
    document = json.loads(text)
    compressed = [name for name in _COMPRESSED if name in document.get("extensionsRequired", [])]
    if compressed:
        raise ValueError(f"it is compressed ({compressed[0]}), which is not supported")
    buffers = [_buffer(buffer, blob, path) for buffer in document.get("buffers", [])]
    V, F, blocks, count = [np.empty((0, 3))], [np.empty((0, 3), dtype=np.int64)], [], 0
    placed = _placed(document)
    for node, matrix in sorted(
        placed.items(), key=lambda item: (document["nodes"][item[0]]["mesh"], item[0])
    ):
        first: dict[int, int] = {}
        for part in document["meshes"][document["nodes"][node]["mesh"]]["primitives"]:
            mode = part.get("mode", _TRIANGLES)
            if mode not in (_TRIANGLES, _STRIP, _FAN):
                continue
            position, normal = part["attributes"]["POSITION"], part["attributes"].get("NORMAL")
            if position not in first:
                local = _array(document, buffers, position).astype(np.float64)
                first[position] = count
                blocks.append(_Block(count, position, normal, matrix))
                V.append(local @ matrix[:3, :3].T + matrix[:3, 3])
                count += len(local)
            F.append(_triangles(document, buffers, part, mode) + first[position])
    file = GltfFile(content, path.suffix.lower(), text, document, buffers, blocks)
    return Parsed(np.vstack(V), np.vstack(F), file)


def _chunks(content: bytes) -> tuple[bytes, bytes | None]:
    magic, version, _, length, kind = struct.unpack_from("<4sIII4s", content)
    if magic != b"glTF" or kind != b"JSON":
        raise ValueError("it does not begin as a GLB")
    if version != 2:
        raise ValueError(f"it is of version {version}; only version 2 is supported")
    begin = 20 + length
    if begin > len(content):
        raise ValueError("it ends too early")
    if begin + 8 > len(content):
        return content[20:begin], None
    (size,) = struct.unpack_from("<I", content, begin)
    return content[20:begin], content[begin + 8 : begin + 8 + size]


def _buffer(told: dict[str, Any], blob: bytes | None, path: Path) -> bytes:
    uri = told.get("uri")
    if uri is None:
        if blob is None:
            raise ValueError("its binary part is missing")
        return blob
    if uri.startswith("data:"):
        return base64.b64decode(uri.partition(",")[2])
    beside = path.parent / uri
    if not beside.is_file():
        raise ValueError(f"it needs the file {uri} beside it")
    return beside.read_bytes()


def _placed(document: dict[str, Any]) -> dict[int, np.ndarray]:
    """The nodes of the scene that show a mesh, and their matrices to the world."""
    nodes = document.get("nodes", [])
    scenes = document.get("scenes")
    children = {child for node in nodes for child in node.get("children", [])}
    roots = (
        scenes[document.get("scene", 0)].get("nodes", [])
        if scenes
        else sorted({*range(len(nodes))} - children)
    )
    found: dict[int, np.ndarray] = {}
    seen: set[int] = set()
    todo = [(root, np.eye(4)) for root in reversed(roots)]
    while todo:
        k, above = todo.pop()
        if k in seen or not 0 <= k < len(nodes):
            raise ValueError("its nodes are no tree")
        seen.add(k)
        matrix = above @ _matrix(nodes[k])
        if "mesh" in nodes[k]:
            found[k] = matrix
        todo += [(child, matrix) for child in reversed(nodes[k].get("children", []))]
    return found


def _matrix(node: dict[str, Any]) -> np.ndarray:
    if "matrix" in node:
        return np.array(node["matrix"], dtype=np.float64).reshape(4, 4).T
    M = np.eye(4)
    x, y, z, w = (float(number) for number in node.get("rotation", (0, 0, 0, 1)))
    R = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    M[:3, :3] = R * np.array(node.get("scale", (1, 1, 1)), dtype=np.float64)
    M[:3, 3] = node.get("translation", (0, 0, 0))
    return M


def _array(document: dict[str, Any], buffers: list[Any], accessor: int) -> np.ndarray:
    """The numbers of an accessor, (count, width): they lie in the buffer."""
    told = document["accessors"][accessor]
    if accessor < 0 or "sparse" in told or "bufferView" not in told:
        raise ValueError("it has sparse accessors, which are not supported")
    view = document["bufferViews"][told["bufferView"]]
    kind, width, count = np.dtype(_TYPES[told["componentType"]]), _WIDTHS[told["type"]], int(told["count"])
    buffer = buffers[view["buffer"]]
    start = view.get("byteOffset", 0) + told.get("byteOffset", 0)
    stride = view.get("byteStride") or kind.itemsize * width
    if count < 0 or count > _MOST or start < 0 or stride < kind.itemsize * width:
        raise ValueError("an accessor is absurd")
    if count and start + stride * (count - 1) + kind.itemsize * width > len(buffer):
        raise ValueError("it ends within an accessor")
    return np.ndarray((count, width), kind, buffer, start if count else 0, (stride, kind.itemsize))


def _triangles(document: dict[str, Any], buffers: list[Any], part: dict[str, Any], mode: int) -> np.ndarray:
    if "indices" in part:
        corners = _array(document, buffers, part["indices"])[:, 0].astype(np.int64)
    else:
        corners = np.arange(int(document["accessors"][part["attributes"]["POSITION"]]["count"]))
    if mode == _TRIANGLES:
        if len(corners) % 3:
            raise ValueError("a triangle is not whole")
        return corners.reshape(-1, 3)
    k = np.arange(max(len(corners) - 2, 0))
    if mode == _FAN:
        return corners[np.column_stack([np.zeros_like(k), k + 1, k + 2])].reshape(-1, 3)
    odd = k % 2
    return corners[np.column_stack([k, k + 1 + odd, k + 2 - odd])].reshape(-1, 3)
