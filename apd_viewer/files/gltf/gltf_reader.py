"""glTF: triangles of a scene, at the places of its nodes and instances."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from apd_viewer.files.formats.parsed_mesh import ParsedMesh
from apd_viewer.files.gltf.accessors import FAN, STRIP, TRIANGLES, accessor_numbers, primitive_triangles
from apd_viewer.files.gltf.containers import glb_chunks, parse_document, read_buffers
from apd_viewer.files.gltf.gltf_file import GltfFile, VertexBlock, with_offset
from apd_viewer.files.gltf.mesh_instances import (
    COMPRESSED,
    MeshInstance,
    check_supported,
    compressed_error,
    extension_fields,
    mesh_instances,
)
from apd_viewer.files.gltf.primitive_textures import PrimitiveTriangles
from apd_viewer.files.gltf.scene import (
    document_entry,
    has_other_scenes,
    mesh_primitives,
    transformed_positions,
    whole_number,
    world_matrices,
)
from apd_viewer.files.storage.sibling_files import LARGEST_FILE, too_large_error
from apd_viewer.language import tr

if TYPE_CHECKING:
    from collections.abc import Iterator

MOST_VERTICES = LARGEST_FILE // 24  # vertices: a position is three doubles


def read_gltf(content: bytes, path: Path) -> ParsedMesh:
    """Positions (n, 3) and triangles (m, 3) of the scene in a GLB or glTF file.

    Raises
    ------
    ValueError
        If the file cannot be understood or ends too early.
    """
    is_binary = path.suffix.lower() == ".glb"
    said, blob = glb_chunks(content) if is_binary else (content, None)
    text, document = parse_document(said)
    check_supported(document)
    buffers, world = read_buffers(document, blob, path), world_matrices(document)
    scene = _Scene(document, buffers)
    for place in mesh_instances(document, buffers, world):
        scene.add(place)
    file = GltfFile(content, path.suffix.lower(), text, document, buffers, scene.blocks, scene.pieces)
    remarks = [*_of_places(scene.blocks)]
    if has_other_scenes(document, world):
        remarks.append(tr("The file has several scenes; only the one that it opens with is read."))
    return ParsedMesh(np.vstack(scene.V), np.vstack(scene.F), file, tuple(remarks), "m")


def _of_places(blocks: list[VertexBlock]) -> Iterator[str]:
    most = max(Counter(block.position for block in blocks).values(), default=0)
    if most > 1:
        yield tr(
            "The file shows one mesh in {n:,} places; a shape in which they differ can be exported in "
            "another format only."
        ).format(n=most)


class _Scene:
    """Vertices and triangles of the places of a scene, one after another."""

    def __init__(self, document: dict[str, Any], buffers: list[bytes]) -> None:
        self._document, self._buffers = document, buffers
        self.V, self.F = [np.empty((0, 3))], [np.empty((0, 3), dtype=np.int64)]
        self.blocks: list[VertexBlock] = []
        self.pieces: list[PrimitiveTriangles] = []
        self._count = 0

    def add(self, place: MeshInstance) -> None:
        """Append the triangles of a mesh at its place."""
        blocks: dict[object, VertexBlock] = {}
        for part in mesh_primitives(self._document, place.mesh):
            if (mode := part.get("mode", TRIANGLES)) not in (TRIANGLES, STRIP, FAN):
                continue
            block = self._block(place, part)
            shares = block.matrix is place.matrix and block.position_shift is None
            key = block.position if shares else json.dumps([part["attributes"], part.get("targets")])
            if key not in blocks:
                blocks[key] = block
                self._show(block)
            block = blocks[key]
            F = _outwards(primitive_triangles(self._document, self._buffers, part, mode), block.matrix)
            self.F.append(F + block.first_vertex)
            self.pieces.append(PrimitiveTriangles(block.first_vertex, len(F), part))

    def _block(self, place: MeshInstance, primitive: dict[str, Any]) -> VertexBlock:
        """Vertices of a primitive, the next ones of the scene."""
        given = self._document, self._buffers, primitive
        position, normal = (
            whole_number(primitive["attributes"], "POSITION"),
            primitive["attributes"].get("NORMAL"),
        )
        told = document_entry(self._document, "accessors", position)
        packed = [name for name in COMPRESSED if extension_fields(primitive, name) is not None]
        if packed and "bufferView" not in told:
            raise compressed_error(packed[0])
        if self._count + whole_number(told, "count") > MOST_VERTICES:
            raise too_large_error(tr("all its instances"))
        return VertexBlock(
            self._count,
            position,
            None if normal is None else whole_number(primitive["attributes"], "NORMAL"),
            primitive["attributes"].get("COLOR_0"),
            place.vertex_matrices(*given),
            place.morph_displacement(*given, "POSITION"),
            None if normal is None else place.morph_displacement(*given, "NORMAL"),
        )

    def _show(self, block: VertexBlock) -> None:
        local = accessor_numbers(self._document, self._buffers, block.position)
        self.blocks.append(block)
        self.V.append(transformed_positions(block.matrix, with_offset(local, block.position_shift)))
        self._count += len(local)


def _outwards(F: np.ndarray, matrix: np.ndarray) -> np.ndarray:
    """Triangles (t, 3), turned round if a matrix of their vertices mirrors them."""
    with np.errstate(all="ignore"):  # absurd positions are refused later
        mirrors = np.linalg.det(matrix[..., :3, :3]) < 0.0
    if mirrors.ndim:
        mirrors = mirrors[F[:, 0]]
    return np.where(mirrors[..., None], F[:, [0, 2, 1]], F)
