"""glTF file rewritten with new positions, bounds and normals."""

import json
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.formats.polygon_mesh import linear_to_srgb, updated_normals
from apd_viewer.files.gltf.accessors import accessor_array, accessor_colors, accessor_numbers, write_rows
from apd_viewer.files.gltf.primitive_textures import PrimitiveTriangles, primitive_texture
from apd_viewer.files.gltf.scene import data_uri, matrix_products, rewritten_glb, transformed_positions
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.texture import Texture
from apd_viewer.language import tr


class VertexBlock(NamedTuple):
    """Vertices of one accessor in one mesh instance.

    Attributes
    ----------
    matrix : (4, 4) or (n, 4, 4) float array
        Matrix to world coordinates; with a skin, one for each vertex.
    position_shift, normal_shift : (n, 3) float array or None
        Displacements of the positions and of the normals by morph targets.
    """

    first_vertex: int
    position: int
    normal: int | None
    attributes: dict[str, Any]
    matrix: np.ndarray
    position_shift: np.ndarray | None
    normal_shift: np.ndarray | None


@dataclass(frozen=True)
class GltfFile:
    """Content of a GLB or glTF file, with its vertex blocks and primitives."""

    content: bytes
    suffix: str
    text: str
    document: dict[str, Any]
    buffers: list[bytes]
    blocks: list[VertexBlock]
    primitives: list[PrimitiveTriangles]

    @property
    def extras(self) -> tuple[str, ...]:
        """Names of the contents besides positions and triangles."""
        words = {
            "materials": tr("materials"),
            "textures": tr("textures"),
            "animations": tr("animations"),
            "skins": tr("skins"),
        }
        has = [what for name, what in words.items() if self.document.get(name)]
        if any("targets" in piece.primitive for piece in self.primitives):
            has.append(tr("morph targets"))
        if len({block.position for block in self.blocks}) < len(self.blocks):
            has.append(tr("instances"))
        attributes = {name for piece in self.primitives for name in piece.primitive["attributes"]}
        kinds = {
            "NORMAL": tr("normals"),
            "TEXCOORD_0": tr("texture coordinates"),
            "COLOR_0": tr("vertex colours"),
        }
        return (*has, *(what for name, what in kinds.items() if name in attributes))

    @property
    def colors(self) -> np.ndarray | None:
        """Vertex colours (n, 3) uint8; None unless every vertex block has them."""
        found = self.linear_colors
        return None if found is None else linear_to_srgb(found)

    @property
    def linear_colors(self) -> np.ndarray | None:
        """Vertex colours (n, 3) from 0 to 1 as stored; None unless every block has them."""
        return self._attribute("COLOR_0", accessor_colors)

    def vertex_values(self, name: str) -> np.ndarray | None:
        """Numbers (n,) of a custom attribute; None unless every vertex block has it."""
        found = self._attribute(f"_{name}", partial(accessor_numbers, width=1))
        return None if found is None else found[:, 0]

    def _attribute(self, name: str, read: Callable[..., np.ndarray]) -> np.ndarray | None:
        """Rows of a vertex attribute, whose name may be in capitals; None without."""
        named = [{own.upper(): at for own, at in block.attributes.items()} for block in self.blocks]
        if not named or not all(name.upper() in each for each in named):
            return None
        return np.vstack([read(self.document, self.buffers, each[name.upper()]) for each in named])

    def normals(self, mesh: Mesh) -> tuple[np.ndarray, np.ndarray] | None:
        """Normals (n, 3), zero where missing, and the vertex of each corner, (m, 3)."""
        N, found = np.zeros(mesh.V.shape), False
        for block in self.blocks:
            if block.normal is not None:
                own = with_offset(
                    accessor_numbers(self.document, self.buffers, block.normal), block.normal_shift
                )
                inverse = np.linalg.pinv(block.matrix[..., :3, :3])
                N[block.first_vertex : block.first_vertex + len(own)] = matrix_products(
                    inverse.swapaxes(-1, -2), own
                )
                found = True
        return (N, mesh.F) if found else None

    def texture(self, mesh: Mesh) -> Texture | None:
        """Base-colour textures of the materials."""
        return primitive_texture(self.document, self.buffers, self.primitives, mesh)

    def rewritten_content(self, mesh: Mesh, U: np.ndarray) -> bytes:
        """File content with positions ``U`` (n, 3), their bounds and rotated normals."""
        buffers = [bytearray(buffer) for buffer in self.buffers]
        written: dict[int, np.ndarray] = {}
        normals: dict[int, np.ndarray] = {}
        touched: list[int] = []
        for block in self.blocks:
            old = self._array(self.buffers, block.position).astype(np.float64)
            if not len(old):
                continue
            mine = slice(block.first_vertex, block.first_vertex + len(old))
            new, moved = old.copy(), (U[mine] != mesh.V[mine]).any(axis=1)
            if moved.any():
                matrix = block.matrix if block.matrix.ndim == 2 else block.matrix[moved]
                new[moved] = _local_positions(matrix, U[mine][moved])
                if block.position_shift is not None:
                    new[moved] -= block.position_shift[moved]
            if block.position in written:
                if np.abs(written[block.position] - new).max() > 1e-6 * np.ptp(old, axis=0).max():
                    raise InputError(
                        tr("The file uses one mesh in several places that now differ; choose another format.")
                    )
                continue
            written[block.position] = new
            if moved.any():
                if self._array(self.buffers, block.position).dtype != np.float32:
                    raise InputError(tr("The file stores rounded positions; choose another format."))
                touched.append(block.position)
                write_rows(self.document, buffers, block.position, moved, new)
            if block.normal is not None:
                after = self._array(self.buffers, block.normal)
                if moved.any():
                    F = mesh.F[((mine.start <= mesh.F) & (mine.stop > mesh.F)).all(axis=1)] - mine.start
                    after = self._normals_after(block.normal, block, old, new, F)
                if block.normal in normals and (normals[block.normal] != after).any():
                    raise InputError(
                        tr("The file shares its normals with other data; choose another format.")
                    )
                normals[block.normal] = after
        if any((self._array(buffers, k) != written[k].astype(np.float32)).any() for k in touched):
            raise InputError(tr("The file shares its positions with other data; choose another format."))
        for accessor, after in normals.items():
            turned = (after != self._array(self.buffers, accessor)).any(axis=1)
            if turned.any():
                write_rows(self.document, buffers, accessor, turned, after)
                touched.append(accessor)
        return self._file_content(buffers, touched)

    def _normals_after(
        self, accessor: int, block: VertexBlock, old: np.ndarray, new: np.ndarray, F: np.ndarray
    ) -> np.ndarray:
        """Stored normals (n, 3) of a block whose stored positions become ``new`` (n, 3)."""
        stored = self._array(self.buffers, accessor)
        if len(stored) != len(old):
            raise ValueError(tr("their number differs from that of the positions"))
        shapes = with_offset(old, block.position_shift), with_offset(new, block.position_shift)
        N = with_offset(accessor_numbers(self.document, self.buffers, accessor), block.normal_shift)
        after = updated_normals(*shapes, F, N, F)
        found, turn = stored.copy(), (after != N).any(axis=1)
        if block.normal_shift is not None:
            after = after - block.normal_shift
        if stored.dtype.kind == "i":
            after = np.rint(after * np.iinfo(stored.dtype).max)
        found[turn] = after[turn]
        return found

    def _array(self, buffers: list[Any], accessor: int) -> np.ndarray:
        return accessor_array(self.document, buffers, accessor, 3)

    def _file_content(self, buffers: list[bytearray], touched: list[int]) -> bytes:
        changes = []
        for accessor in touched:
            entry = self.document["accessors"][accessor]
            before, after = self._array(self.buffers, accessor), self._array(buffers, accessor)
            for bound, of in (("min", np.min), ("max", np.max)):
                value = of(after, axis=0)
                if bound in entry and not np.array_equal(of(before, axis=0), value):
                    changes.append((("accessors", accessor, bound), json.dumps(value.astype(float).tolist())))
        for k, buffer in enumerate(buffers):
            if buffer != self.buffers[k] and "uri" in self.document["buffers"][k]:
                changes.append(
                    (("buffers", k, "uri"), json.dumps(data_uri(self.document["buffers"][k]["uri"], buffer)))
                )
        text = with_replaced_values(self.text, changes)
        if self.suffix == ".gltf":
            return text.encode()
        own = buffers and "uri" not in self.document["buffers"][0]
        return rewritten_glb(self.content, None if text == self.text else text, buffers[0] if own else None)


def _local_positions(matrix: np.ndarray, U: np.ndarray) -> np.ndarray:
    """Local coordinates of positions ``U`` (n, 3), by one matrix or one per vertex."""
    new = matrix_products(np.linalg.pinv(matrix[..., :3, :3]), U - matrix[..., :3, 3])
    if np.abs(new).max() > np.finfo(np.float32).max:
        raise InputError(tr("A node of the file scales a mesh to zero; choose another format."))
    if np.abs(transformed_positions(matrix, new) - U).max() > 1e-6 * np.abs(U).max():
        raise InputError(tr("A node of the file flattens a mesh; choose another format."))
    return new


def with_offset(X: np.ndarray, offset: np.ndarray | None) -> np.ndarray:
    """``X`` plus an offset; ``X`` itself if the offset is None."""
    return X if offset is None else X + offset


JsonPath: TypeAlias = tuple[str | int, ...]

_SPACE = re.compile(r"[ \t\r\n]*")
_DECODER = json.JSONDecoder()


def value_spans(text: str, paths: Sequence[JsonPath]) -> dict[JsonPath, tuple[int, int]]:
    """Start and end of the JSON values at ``paths``; missing ones are omitted."""
    found: dict[JsonPath, tuple[int, int]] = {}
    _find(text, _skip(text, 0), set(paths), (), found)
    return found


def with_replaced_values(text: str, changes: Sequence[tuple[JsonPath, str]]) -> str:
    """JSON text with the values at the paths of ``changes`` replaced."""
    found = value_spans(text, [path for path, _ in changes])
    for path, new in sorted(changes, key=lambda change: -found[change[0]][0]):
        begin, end = found[path]
        text = text[:begin] + new + text[end:]
    return text


def _find(
    text: str, at: int, wanted: set[JsonPath], here: JsonPath, found: dict[JsonPath, tuple[int, int]]
) -> int:
    """Search the JSON value at offset ``at`` for wanted paths; return its end."""
    if not any(path[: len(here)] == here for path in wanted):
        return _DECODER.raw_decode(text, at)[1]
    if text[at] not in "{[" or here in wanted:
        end = _DECODER.raw_decode(text, at)[1]
        if here in wanted:
            found[here] = at, end
        return end
    is_object, close, place = text[at] == "{", "}" if text[at] == "{" else "]", 0
    at = _skip(text, at + 1)
    while text[at] != close:
        key: str | int = place
        if is_object:
            key, at = _DECODER.raw_decode(text, at)
            at = _skip(text, _skip(text, at) + 1)  # skip the colon
        at = _skip(text, _find(text, at, wanted, (*here, key), found))
        if text[at] == ",":
            at = _skip(text, at + 1)
        place += 1
    return at + 1


def _skip(text: str, at: int) -> int:
    match = _SPACE.match(text, at)
    return match.end() if match else at
