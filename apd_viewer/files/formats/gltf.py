"""glTF: triangles of a scene, and the same file with new coordinates."""

from __future__ import annotations

import base64
import json
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.formats.gltf_arrays import (
    FAN,
    STRIP,
    TRIANGLES,
    array_of,
    buffers_of,
    chunks_of,
    colors_of,
    document_of,
    positions_of,
    triangles_of,
)
from apd_viewer.files.formats.gltf_scene import a_list, carried, parts, placed, whole
from apd_viewer.files.formats.gltf_textures import Piece, texture_of
from apd_viewer.files.formats.json_spans import spans
from apd_viewer.files.formats.parsed import Parsed, turned
from apd_viewer.files.formats.vertex_colors import encoded
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.texture import Texture
from apd_viewer.language import tr

_COMPRESSED = ("KHR_draco_mesh_compression", "EXT_meshopt_compression")


class _Block(NamedTuple):
    """Vertices of one accessor as shown by one node."""

    first: int
    position: int
    normal: int | None
    color: object
    matrix: np.ndarray


@dataclass(frozen=True)
class GltfFile:
    """Content of a GLB or glTF file, with the owners of its vertices."""

    content: bytes
    suffix: str
    text: str
    document: dict[str, Any]
    buffers: list[bytes]
    blocks: list[_Block]
    pieces: list[Piece]

    @property
    def extras(self) -> tuple[str, ...]:
        """Contents besides positions and triangles, in words."""
        words = {
            "materials": tr("materials"),
            "textures": tr("textures"),
            "animations": tr("animations"),
            "skins": tr("skins"),
        }
        has = [what for name, what in words.items() if self.document.get(name)]
        meshes = {_mesh_of(self.document, node) for node in placed(self.document)}
        attributes = {
            name for mesh in meshes for part in parts(self.document, mesh) for name in part["attributes"]
        }
        kinds = {
            "NORMAL": tr("normals"),
            "TEXCOORD_0": tr("texture coordinates"),
            "COLOR_0": tr("vertex colours"),
        }
        return (*has, *(what for name, what in kinds.items() if name in attributes))

    @property
    def colors(self) -> np.ndarray | None:
        """Vertex colours, (n, 3) uint8, if every part has them."""
        if not self.blocks or any(block.color is None for block in self.blocks):
            return None
        return encoded(np.vstack([colors_of(self.document, self.buffers, b.color) for b in self.blocks]))

    def normals(self, mesh: Mesh) -> tuple[np.ndarray, np.ndarray] | None:
        """Normals (n, 3), zero where missing, and the vertex of each corner, (m, 3)."""
        N, found = np.zeros(mesh.V.shape), False
        for block in self.blocks:
            if block.normal is not None:
                own = positions_of(self.document, self.buffers, block.normal)
                inverse = np.linalg.pinv(block.matrix[:3, :3])
                N[block.first : block.first + len(own)] = own @ inverse
                found = True
        return (N, mesh.F) if found else None

    def texture(self, mesh: Mesh) -> Texture | None:
        """Base-colour textures of the materials."""
        return texture_of(self.document, self.buffers, self.pieces, mesh)

    def rewritten(self, mesh: Mesh, U: np.ndarray) -> bytes:
        """File content with positions ``U`` (n, 3), their bounds and turned normals."""
        buffers = [bytearray(buffer) for buffer in self.buffers]
        written: dict[int, np.ndarray] = {}
        touched: list[int] = []
        for block in self.blocks:
            old = self._array(self.buffers, block.position).astype(np.float64)
            if not len(old):
                continue
            mine = slice(block.first, block.first + len(old))
            new, moved = old.copy(), (U[mine] != mesh.V[mine]).any(axis=1)
            if moved.any():
                new[moved] = _local(block.matrix, U[mine][moved])
            if block.position in written:
                if np.abs(written[block.position] - new).max() > 1e-6 * np.ptp(old, axis=0).max():
                    raise InputError(
                        tr("The file uses one mesh in several places that now differ; choose another format.")
                    )
                continue
            if self._array(self.buffers, block.position).dtype != np.float32:
                raise InputError(tr("The file stores rounded positions; choose another format."))
            written[block.position] = new
            if not moved.any():
                continue
            touched.append(block.position)
            self._array(buffers, block.position)[moved] = new[moved]
            if block.normal is None or block.normal in written:
                continue
            N = self._array(self.buffers, block.normal)
            if len(N) != len(old):
                raise ValueError(tr("their number differs from that of the positions"))
            if N.dtype == np.float32:
                F = mesh.F[((mine.start <= mesh.F) & (mine.stop > mesh.F)).all(axis=1)] - mine.start
                written[block.normal] = turned(old, new, F, N.astype(np.float64), F)
                self._array(buffers, block.normal)[...] = written[block.normal]
        if any((self._array(buffers, k) != written[k].astype(np.float32)).any() for k in touched):
            raise InputError(tr("The file shares its positions with other data; choose another format."))
        return self._packed(buffers, touched)

    def _array(self, buffers: list[Any], accessor: int) -> np.ndarray:
        return array_of(self.document, buffers, accessor, 3)

    def _packed(self, buffers: list[bytearray], touched: list[int]) -> bytes:
        text, changes = self.text, []
        for accessor in touched:
            told = self.document["accessors"][accessor]
            before, after = self._array(self.buffers, accessor), self._array(buffers, accessor)
            for bound, of in (("min", np.min), ("max", np.max)):
                value = of(after, axis=0)
                if bound in told and not np.array_equal(of(before, axis=0), value):
                    changes.append((("accessors", accessor, bound), json.dumps(value.astype(float).tolist())))
        for k, buffer in enumerate(buffers):
            if buffer != self.buffers[k] and "uri" in self.document["buffers"][k]:
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
        if buffers and rest and "uri" not in self.document["buffers"][0]:
            rest[8 : 8 + len(buffers[0])] = buffers[0]
        start = struct.pack("<4sIII4s", b"glTF", 2, head + len(said) + len(rest), len(said), b"JSON")
        return start + said + bytes(rest)

    def _uri(self, k: int, buffer: bytearray) -> str:
        uri = self.document["buffers"][k]["uri"]
        if not uri.startswith("data:"):
            raise InputError(
                tr("The coordinates are in a separate file, {uri}; pack both into a GLB first.").format(
                    uri=uri
                )
            )
        return uri.partition(",")[0] + "," + base64.b64encode(buffer).decode()


def _local(matrix: np.ndarray, U: np.ndarray) -> np.ndarray:
    """Local positions (n, 3) of ``U`` under the inverse matrix."""
    new = (U - matrix[:3, 3]) @ np.linalg.pinv(matrix[:3, :3]).T
    if np.abs(new).max() > np.finfo(np.float32).max:
        raise InputError(tr("A node of the file scales a mesh to zero; choose another format."))
    if np.abs(carried(matrix, new) - U).max() > 1e-6 * np.abs(U).max():
        raise InputError(tr("A node of the file flattens a mesh; choose another format."))
    return new


def read_gltf(content: bytes, path: Path) -> Parsed:
    """Positions (n, 3) and triangles (m, 3) of the scene in a GLB or glTF file.

    Raises
    ------
    ValueError
        If the file cannot be understood or ends too early.
    """
    is_binary = path.suffix.lower() == ".glb"
    said, blob = chunks_of(content) if is_binary else (content, None)
    text, document = document_of(said)
    compressed = [name for name in _COMPRESSED if name in a_list(document, "extensionsRequired")]
    if compressed:
        raise ValueError(
            tr("it is compressed ({extension}), which is not supported").format(extension=compressed[0])
        )
    buffers = buffers_of(document, blob, path)
    V, F, blocks, count = [np.empty((0, 3))], [np.empty((0, 3), dtype=np.int64)], [], 0
    pieces: list[Piece] = []
    for node, matrix in sorted(
        placed(document).items(), key=lambda item: (_mesh_of(document, item[0]), item[0])
    ):
        first: dict[int, int] = {}
        for part in parts(document, _mesh_of(document, node)):
            mode = part.get("mode", TRIANGLES)
            if mode not in (TRIANGLES, STRIP, FAN):
                continue
            position, normal = whole(part["attributes"], "POSITION"), part["attributes"].get("NORMAL")
            if position not in first:
                local = positions_of(document, buffers, position)
                first[position] = count
                normal = None if normal is None else whole(part["attributes"], "NORMAL")
                color = part["attributes"].get("COLOR_0")
                blocks.append(_Block(count, position, normal, color, matrix))
                V.append(carried(matrix, local))
                count += len(local)
            F.append(triangles_of(document, buffers, part, mode) + first[position])
            pieces.append(Piece(first[position], len(F[-1]), part))
    file = GltfFile(content, path.suffix.lower(), text, document, buffers, blocks, pieces)
    return Parsed(np.vstack(V), np.vstack(F), file)


def _mesh_of(document: dict[str, Any], node: int) -> int:
    return whole(document["nodes"][node], "mesh")
