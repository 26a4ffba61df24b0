"""glTF: triangles of a scene, at the places of its nodes and instances."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from apd_viewer.files.formats.parsed import Parsed
from apd_viewer.files.gltf.accessors import FAN, STRIP, TRIANGLES, numbers_of, triangles_of
from apd_viewer.files.gltf.containers import buffers_of, chunks_of, document_of
from apd_viewer.files.gltf.extensions import COMPRESSED, check_supported, compressed, extension_of
from apd_viewer.files.gltf.gltf_file import Block, GltfFile, plus
from apd_viewer.files.gltf.mesh_places import MeshPlace, mesh_places
from apd_viewer.files.gltf.scene import carried, has_other_scenes, one, parts, whole, world_of
from apd_viewer.files.gltf.textures import Piece
from apd_viewer.files.storage.neighbours import LARGEST, too_large
from apd_viewer.language import tr

if TYPE_CHECKING:
    from collections.abc import Iterator

MOST = LARGEST // 24  # vertices: a position is three doubles


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
    check_supported(document)
    buffers, world = buffers_of(document, blob, path), world_of(document)
    scene = _Scene(document, buffers)
    for place in mesh_places(document, buffers, world):
        scene.add(place)
    file = GltfFile(content, path.suffix.lower(), text, document, buffers, scene.blocks, scene.pieces)
    remarks = [*_of_places(scene.blocks)]
    if has_other_scenes(document, world):
        remarks.append(tr("The file has several scenes; only the one that it opens with is read."))
    return Parsed(np.vstack(scene.V), np.vstack(scene.F), file, tuple(remarks), "m")


def _of_places(blocks: list[Block]) -> Iterator[str]:
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
        self.blocks: list[Block] = []
        self.pieces: list[Piece] = []
        self._count = 0

    def add(self, place: MeshPlace) -> None:
        """Append the triangles of a mesh at its place."""
        blocks: dict[object, Block] = {}
        for part in parts(self._document, place.mesh):
            if (mode := part.get("mode", TRIANGLES)) not in (TRIANGLES, STRIP, FAN):
                continue
            block = self._block(place, part)
            shares = block.matrix is place.matrix and block.shift is None
            key = block.position if shares else json.dumps([part["attributes"], part.get("targets")])
            if key not in blocks:
                blocks[key] = block
                self._show(block)
            block = blocks[key]
            F = _outwards(triangles_of(self._document, self._buffers, part, mode), block.matrix)
            self.F.append(F + block.first)
            self.pieces.append(Piece(block.first, len(F), part))

    def _block(self, place: MeshPlace, part: dict[str, Any]) -> Block:
        """Vertices of a primitive, the next ones of the scene."""
        given = self._document, self._buffers, part
        position, normal = whole(part["attributes"], "POSITION"), part["attributes"].get("NORMAL")
        told = one(self._document, "accessors", position)
        packed = [name for name in COMPRESSED if extension_of(part, name) is not None]
        if packed and "bufferView" not in told:
            raise compressed(packed[0])
        if self._count + whole(told, "count") > MOST:
            raise too_large(tr("all its instances"))
        return Block(
            self._count,
            position,
            None if normal is None else whole(part["attributes"], "NORMAL"),
            part["attributes"].get("COLOR_0"),
            place.posed(*given),
            place.shift(*given, "POSITION"),
            None if normal is None else place.shift(*given, "NORMAL"),
        )

    def _show(self, block: Block) -> None:
        local = numbers_of(self._document, self._buffers, block.position)
        self.blocks.append(block)
        self.V.append(carried(block.matrix, plus(local, block.shift)))
        self._count += len(local)


def _outwards(F: np.ndarray, matrix: np.ndarray) -> np.ndarray:
    """Triangles (t, 3), turned round if a matrix of their vertices mirrors them."""
    with np.errstate(all="ignore"):  # absurd positions are refused later
        mirrors = np.linalg.det(matrix[..., :3, :3]) < 0.0
    if mirrors.ndim:
        mirrors = mirrors[F[:, 0]]
    return np.where(mirrors[..., None], F[:, [0, 2, 1]], F)
