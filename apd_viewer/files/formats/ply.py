"""PLY, text or binary: file order kept; coordinates updated in place."""

import re
import struct
from dataclasses import dataclass, replace

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.formats import ply_elements, polygon_mesh
from apd_viewer.files.formats.polygon_mesh import ParsedMesh
from apd_viewer.files.formats.text import TextEdits, parse_numbers
from apd_viewer.files.formats.texture_images import joined_texture, sibling_image
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.texture import Texture
from apd_viewer.language import in_quotes, tr

_NORMAL, _COLORS = ("nx", "ny", "nz"), ("red", "green", "blue")
_UV = (("s", "t"), ("u", "v"), ("texture_u", "texture_v"))
_EXTRAS = {"red": tr("colours"), "nx": tr("normals"), "s": tr("texture coordinates")}
_EXTRAS |= {"alpha": tr("transparency")}


@dataclass(frozen=True)
class PlyFile:
    """Content and layout of a PLY file; ``text`` has one row per line."""

    content: bytes
    text: bytes
    order: str
    elements: list[ply_elements.PlyElement]
    starts: list[int]  # byte offsets of the elements
    suffix = ".ply"

    @property
    def extras(self) -> tuple[str, ...]:
        """Names of the contents besides positions and triangles."""
        names = {name for element in self.elements for name in element.names}
        found = [what for name, what in _EXTRAS.items() if name in names]
        known = {*ply_elements.AXES, *_NORMAL, *ply_elements.INDEX_PROPERTIES, *_EXTRAS, "green", "blue", "t"}
        return (*found, *map(in_quotes, sorted(names - known)))

    @property
    def colors(self) -> np.ndarray | None:
        """Vertex colours (n, 3) uint8; None if there are none."""
        if not set(_COLORS) <= set(self._scalars):
            return None
        kind = np.dtype(self._scalars[_COLORS[0]])
        return polygon_mesh.colors_to_uint8(
            self.columns(self._vertex, _COLORS), 1.0 if kind.kind == "f" else float(np.iinfo(kind).max)
        )

    def normals(self, mesh: Mesh) -> tuple[np.ndarray, np.ndarray] | None:
        """Vertex normals (n, 3), and the vertex of each corner (m, 3); or None."""
        return (self.columns(self._vertex, _NORMAL), mesh.F) if set(_NORMAL) <= set(self._scalars) else None

    def texture(self, mesh: Mesh) -> Texture | None:
        """Texture from an image named in a comment and per-vertex coordinates."""
        named = re.search(rb"[\r\n]comment TextureFile[ \t]+([^\r\n]+)", self.content[: self.starts[0]])
        uv = next((names for names in _UV if set(names) <= set(self._scalars)), None)
        if named is None or uv is None or mesh.path is None:
            return None
        name = named[1].decode("utf-8", errors="replace").strip()
        image = sibling_image(name, mesh.path)
        return joined_texture(
            self.columns(self._vertex, uv), mesh.F, np.zeros(len(mesh.F), dtype=np.int64), [image]
        )

    def rewritten_content(self, mesh: Mesh, U: np.ndarray) -> bytes:
        """File content with positions ``U`` (n, 3) and rotated normals."""
        at, kinds = self._vertex, self._scalars
        if any(kinds[axis][0] != "f" for axis in ply_elements.AXES):
            raise InputError(tr("The file stores integer coordinates only; choose another format."))
        new: dict[tuple[str, ...], np.ndarray] = {ply_elements.AXES: U}
        if all(kinds.get(name, "")[:1] == "f" for name in _NORMAL):
            N = self.columns(at, _NORMAL)
            new[_NORMAL] = polygon_mesh.updated_normals(mesh.V, U, mesh.F, N, mesh.F)
        if not self.order:
            return self._text(at, new)
        body = bytearray(self.content)
        for names, values in new.items():
            old = self.columns(at, names)
            for axis, name in enumerate(names):
                self._write(body, name, values[:, axis], values[:, axis] != old[:, axis])
        return bytes(body)

    @property
    def _vertex(self) -> int:
        """Index of the vertex element."""
        return next(k for k, element in enumerate(self.elements) if element.name == "vertex")

    @property
    def _scalars(self) -> dict[str, str]:
        """Types of the scalar vertex properties, by name."""
        return {name: kind for name, length, kind in self.elements[self._vertex].properties if not length}

    def _write(self, body: bytearray, name: str, values: np.ndarray, which: np.ndarray) -> None:
        element, start, kind = self.elements[self._vertex], self.starts[self._vertex], self._scalars[name]
        if not element.has_lists:
            table = np.frombuffer(body, element.row_dtype(self.order), element.rows, start)
            table[name][which] = values[which]
            return
        for row, offsets in enumerate(ply_elements.row_offsets(self.content, start, element, self.order)):
            if which[row]:
                struct.pack_into(
                    self.order + ply_elements.STRUCT_CODES[kind], body, offsets[name], values[row]
                )

    def columns(self, element_index: int, names: tuple[str, ...]) -> np.ndarray:
        """Columns of an element, (rows, len(names)) float array."""
        element, start = self.elements[element_index], self.starts[element_index]
        if not self.order:
            places = [element.names.index(name) for name in names]
            words = None if element.has_lists else ply_elements.uniform_rows(self.text, start, element)
            if words is not None and len(words[0]) >= len(element.names):
                return parse_numbers([row[c] for row in words for c in places]).reshape(-1, len(names))
            rows = ply_elements.text_rows(self.text, start, element)
            return parse_numbers([row[c][0] for row in rows for c in places]).reshape(-1, len(names))
        if not element.has_lists:
            table = np.frombuffer(self.content, element.row_dtype(self.order), element.rows, start)
            columns = np.empty((element.rows, len(names)))
            with np.errstate(invalid="ignore"):  # NaN coordinates are rejected later
                for k, name in enumerate(names):
                    columns[:, k] = table[name]
            return columns
        codes = {name: self.order + ply_elements.STRUCT_CODES[kind] for name, _, kind in element.properties}
        return np.array(
            [
                [struct.unpack_from(codes[name], self.content, offsets[name])[0] for name in names]
                for offsets in ply_elements.row_offsets(self.content, start, element, self.order)
            ]
        ).reshape(-1, len(names))

    def property_values(self, kind: str, name: str) -> np.ndarray | None:
        """Scalar property of an element such as "vertex"; None if there is none."""
        for at, element in enumerate(self.elements):
            scalars = [own for own, length, _ in element.properties if not length]
            if element.name == kind and name in scalars:
                return self.columns(at, (name,))[:, 0]
        return None

    def _text(self, at: int, new: dict[tuple[str, ...], np.ndarray]) -> bytes:
        element, start = self.elements[at], self.starts[at]
        edits = TextEdits(self.content)
        rows = list(ply_elements.text_rows(self.text, start, element))
        for names, values in new.items():
            columns = [element.names.index(name) for name in names]
            cells = [row[c] for row in rows for c in columns]
            old = parse_numbers([word for word, _ in cells])
            edits.replace_numbers([span for _, span in cells], old, values.ravel())
        return edits.edited_content()


def read_ply(content: bytes) -> ParsedMesh:
    """Positions (n, 3) and triangles (m, 3) of a PLY file.

    Raises
    ------
    ValueError
        If the file cannot be understood or ends too early.
    """
    order, elements, start = ply_elements.read_header(content)
    file = PlyFile(content, content, order, elements, [])
    try:
        return _read(file, start)
    except ValueError:
        text = None if order else ply_elements.with_one_row_per_line(content, start, elements)
        if text is None:
            raise
    return _read(replace(file, text=text, starts=[]), start)


def _read(file: PlyFile, start: int) -> ParsedMesh:
    text, order, faces = file.text, file.order, []
    V, origin = np.empty((0, 3)), None
    for at, element in enumerate(file.elements):
        if order and element.rows * element.least_row_size > len(text) - start:
            raise ValueError(ply_elements.truncation_message(element))
        file.starts.append(start)
        if element.name == "vertex":
            V, origin = file.columns(at, ply_elements.AXES), file
        if element.name in ("face", "tristrips") and element.rows:
            found, start = ply_elements.read_faces(text, start, element, order)
            faces.append(found if element.name == "face" else ply_elements.faces_of_strips(found))
        elif not order:
            start = ply_elements.text_end(text, start, element)
        elif not element.has_lists:
            start += element.rows * element.row_dtype(order).itemsize
        else:
            for offsets in ply_elements.row_offsets(text, start, element, order):
                start = offsets[""]
    rest = text[start:] if order else text[start:].strip()
    return ParsedMesh(
        V,
        polygon_mesh.concatenated_polygons(faces).triangles(V),
        origin,
        polygon_mesh.trailing_bytes_remark(len(rest)),
    )


def ply_content(V: np.ndarray, F: np.ndarray, colors: np.ndarray | None) -> bytes:
    """Binary PLY file of a mesh, with colours (n, 3) if there are any."""
    rows = np.zeros(len(V), dtype=[("at", "<f8", 3), *([] if colors is None else [("color", "u1", 3)])])
    rows["at"] = V
    of_vertex = [f"property double {axis}" for axis in "xyz"]
    if colors is not None:
        rows["color"] = colors
        of_vertex += [f"property uchar {name}" for name in ("red", "green", "blue")]
    faces = np.zeros(len(F), dtype=[("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, F
    head = ["ply", "format binary_little_endian 1.0", f"element vertex {len(V)}", *of_vertex]
    head += [f"element face {len(F)}", "property list uchar int vertex_indices", "end_header", ""]
    return "\n".join(head).encode() + rows.tobytes() + faces.tobytes()
