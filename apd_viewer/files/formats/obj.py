"""Wavefront OBJ: vertices and faces in file order; coordinates updated in place.

Libraries split vertices at texture seams or drop some of them, so that a selection for the file would
no longer fit. Statements other than ``v`` and ``f`` are kept unchanged; only ``vn`` is rotated.
"""

import posixpath
import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import NamedTuple

import numpy as np

from apd_viewer.files.formats.polygon_mesh import ParsedMesh, Polygons, text_colors_to_uint8, updated_normals
from apd_viewer.files.formats.text import TextEdits, decoded_text, parse_numbers, with_line_feeds
from apd_viewer.files.formats.texture_images import joined_texture, sibling_image
from apd_viewer.files.storage.regular_files import sibling_content
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.texture import Texture
from apd_viewer.language import tr

_GAP = rb"(?:[ \t]|\\\r?\n)+"
# Searching for a literal line feed is much faster than for a line start.
_VECTOR = rb"\n[ \t]*%s" + _GAP + rb"(\S+)" + _GAP + rb"(\S+)" + _GAP + rb"(\S+)"
_POSITION, _NORMAL = (re.compile(_VECTOR % word) for word in (b"v", b"vn"))
_TEXTURE = re.compile(rb"\n[ \t]*vt" + 2 * (_GAP + rb"(\S+)"))
_COLORED = re.compile(rb"\n[ \t]*v" + 3 * (_GAP + rb"\S+") + 3 * (_GAP + rb"([^\s#]+)"))
_ANY_POSITION = re.compile(rb"\n[ \t]*v[ \t\r\n\\]")
_EXTRAS = (
    (tr("texture coordinates"), rb"vt"),
    (tr("normals"), rb"vn"),
    (tr("materials"), rb"usemtl"),
    (tr("groups"), rb"[go]"),
    (tr("smoothing groups"), rb"s"),
    (tr("lines"), rb"l"),
)


@dataclass(frozen=True)
class ObjFile:
    """The content of an OBJ file."""

    content: bytes
    suffix = ".obj"

    @property
    def extras(self) -> tuple[str, ...]:
        """Names of the contents besides positions and triangles."""
        has = [name for name, word in _EXTRAS if re.search(rb"^[ \t]*%s[ \t]" % word, self.content, re.M)]
        colours = re.search(rb"^[ \t]*v(?:[ \t]+[^\s#]+){6}", self.content, re.MULTILINE)
        return (*has, *([tr("vertex colours")] if colours else []))

    @property
    def colors(self) -> np.ndarray | None:
        """Vertex colours (n, 3) uint8; None unless each vertex has one."""
        text = _lines(self.content)
        first = _ANY_POSITION.search(text)
        if first is None or not _COLORED.match(text, first.start()):
            return None
        words = _COLORED.findall(text)
        if len(words) != len(_ANY_POSITION.findall(text)):
            return None
        return text_colors_to_uint8(parse_numbers([word for row in words for word in row]).reshape(-1, 3))

    def normals(self, mesh: Mesh) -> tuple[np.ndarray, np.ndarray] | None:
        """Normals (k, 3), and the normal index of each corner (m, 3); or None."""
        text = _lines(self.content)
        words = [word for row in _NORMAL.findall(text) for word in row]
        N = parse_numbers(words).reshape(-1, 3)
        return (N, _normal_of(text, mesh, len(N))) if words else None

    def texture(self, mesh: Mesh) -> Texture | None:
        """Texture from the material files beside the mesh."""
        text = _lines(self.content)
        words = [word for row in _TEXTURE.findall(text) for word in row]
        if not words or mesh.path is None:
            return None
        faces = parse_faces(text)
        names, image_of = material_images(text, mesh.path, faces)
        each = np.repeat(image_of, np.maximum(np.diff(faces.polygons.start) - 2, 0))
        if not (each >= 0).any():
            return None
        images = [sibling_image(name, mesh.path) for name in names]
        uv_of = faces.texture[faces.polygons.triangle_corners(mesh.V)]
        return joined_texture(parse_numbers(words).reshape(-1, 2), uv_of, each, images)

    def rewritten_content(self, mesh: Mesh, U: np.ndarray) -> bytes:
        """File content with positions ``U`` (n, 3) and rotated normals."""
        text, edits = _lines(self.content), TextEdits(self.content)
        edits.replace_numbers(_spans(_POSITION, text), mesh.V.ravel(), U.ravel())
        normals = [word for words in _NORMAL.findall(text) for word in words]
        if normals:
            N = parse_numbers(normals).reshape(-1, 3)
            new = updated_normals(mesh.V, U, mesh.F, N, _normal_of(text, mesh, len(N)))
            edits.replace_numbers(_spans(_NORMAL, text), N.ravel(), new.ravel())
        return edits.edited_content()


def _lines(content: bytes) -> bytes:
    """Content with line feeds as line ends, and one more at the start and the end."""
    return b"\n%s\n" % with_line_feeds(content)


def _spans(pattern: re.Pattern[bytes], text: bytes) -> Iterator[tuple[int, int]]:
    """Spans of matched numbers in the content without its leading line feed."""
    for match in pattern.finditer(text):
        yield from ((match.start(k) - 1, match.end(k) - 1) for k in (1, 2, 3))


def _normal_of(text: bytes, mesh: Mesh, count: int) -> np.ndarray:
    """Normal index (m, 3) of each triangle corner, from 0; -1 where missing."""
    faces = parse_faces(text)
    own = np.where(faces.normal < count, faces.normal, -1)
    return own[faces.polygons.triangle_corners(mesh.V)]


def read_obj(content: bytes) -> ParsedMesh:
    """Positions (n, 3) and triangles (m, 3) of an OBJ file; polygons are split.

    Raises
    ------
    ValueError
        If a ``v`` or ``f`` line cannot be understood; the message says which.
    """
    text = _lines(content)
    words = _POSITION.findall(text)
    if len(words) != len(_ANY_POSITION.findall(text)):
        raise ValueError(tr("a vertex has fewer than three coordinates"))
    try:
        V = np.fromiter(map(float, chain.from_iterable(words)), np.float64, 3 * len(words)).reshape(-1, 3)
    except ValueError as error:
        raise ValueError(_syntax_error_sentence(text)) from error
    return ParsedMesh(V, parse_faces(text).polygons.triangles(V), ObjFile(content))


def _syntax_error_sentence(text: bytes) -> str:
    """Error sentence for the first vertex with a malformed number."""
    for match in _POSITION.finditer(text):
        try:
            [float(word) for word in match.groups()]
        except ValueError:
            break
    line = text.count(b"\n", 0, match.start() + 1)
    return tr("line {line} is not valid: {text}").format(
        line=line, text=match[0].strip().decode(errors="replace")[:60]
    )


_LIBRARY = re.compile(rb"\n[ \t]*mtllib[ \t]+([^\n#]+)")
_USED = re.compile(rb"\n[ \t]*usemtl[ \t]+([^\n#]+)")
_NEW = re.compile(rb"\n[ \t]*newmtl[ \t]+([^\n#]+)")
_IMAGE = re.compile(rb"\n[ \t]*map_Kd[ \t]+([^\n#]+)", re.IGNORECASE)
_OPTIONS = re.compile(r"^(?:-(?:s|o|t)(?:\s+[-+.\deE]+){1,3}\s+|-mm(?:\s+\S+){2}\s+|-\w+\s+\S+\s+)*")


class ObjFaces(NamedTuple):
    """Polygons, with normal and texture-coordinate indices (c,) of their corners.

    Indices start at 0; missing ones are -1.
    """

    polygons: Polygons
    normal: np.ndarray
    texture: np.ndarray


def material_images(text: bytes, mesh: Path, faces: ObjFaces) -> tuple[list[str], np.ndarray]:
    """Images of the materials, and the image index of each polygon (p,); -1 is none.

    The images are named relative to the folder of ``mesh``; raises InputError if a material file is outside.
    """
    named = _named_images(text, mesh)
    paths = sorted(set(named.values()))
    uses = list(_USED.finditer(text))
    start = np.array([match.start() for match in uses], dtype=np.int64)
    image = [paths.index(named[name]) if (name := _name(use)) in named else -1 for use in uses]
    begins = np.array([match.start() for match in _FACE_BEGINS.finditer(text)], dtype=np.int64)
    count = len(faces.polygons.start) - 1
    if len(begins) != count:
        return [], np.full(count, -1)
    return paths, np.array([-1, *image])[np.searchsorted(start, begins)]


def _named_images(text: bytes, mesh: Path) -> dict[str, str]:
    """Image path of each material, by material name."""
    named = {}
    for library, content in _libraries(text, mesh).items():
        said = b"\n" + with_line_feeds(decoded_text(content)[0])
        folder = posixpath.dirname(library.replace("\\", "/"))
        begins = [*_NEW.finditer(said)]
        for match, end in zip(begins, [*(m.start() for m in begins[1:]), len(said)], strict=True):
            found = _IMAGE.search(said, match.end() - 1, end)
            if found is not None:
                image = _OPTIONS.sub("", _decoded_name(found[1])).replace("\\", "/")
                named[_name(match)] = posixpath.join(folder, image)
    return named


def _libraries(text: bytes, mesh: Path) -> dict[str, bytes]:
    """Contents of the material libraries that exist, by name; a line may list several."""
    found: dict[str, bytes] = {}
    for said in dict.fromkeys(map(_decoded_name, _LIBRARY.findall(text))):
        whole = sibling_content(said, mesh)
        names = [said] if whole is not None else said.split()
        found |= {
            name: content
            for name in names
            if (content := whole if name == said else sibling_content(name, mesh)) is not None
        }
    return found


def _name(match: re.Match[bytes]) -> str:
    return _decoded_name(match[1])


def _decoded_name(name: bytes) -> str:
    return name.decode("utf-8", errors="replace").strip()


_FACE = re.compile(rb"\nf[ \t]([^\n]*)")
_FACE_BEGINS = re.compile(rb"\n[ \t]*f[ \t]")
_CORNER, _NUMBER = re.compile(rb"\d+(?:/\d*){0,2}"), re.compile(rb"\d+")
_BEYOND = 1 << 62  # upper clamp of texture and normal indices, above any valid one


def parse_faces(text: bytes) -> ObjFaces:
    """Faces of an OBJ text with a line feed before and after it.

    Raises
    ------
    ValueError
        If an ``f`` line cannot be understood; the message says which.
    """
    alike = _uniform_faces(text)
    if alike is not None:
        return alike
    corners = list(_corners(text))
    normal, texture = (
        np.array([min(max(k, -1), _BEYOND) for face in corners for k in face[at]], dtype=np.int64)
        for at in (1, 2)
    )
    return ObjFaces(Polygons.from_faces([face[0] for face in corners]), normal, texture)


def _uniform_faces(text: bytes) -> ObjFaces | None:
    """Fast path for faces all written in one form; None for mixed forms."""
    face = None if b"\\\n" in text or b"\\\r\n" in text else _FACE.search(text)
    corners = face[1].split() if face else []
    if not corners or not _CORNER.fullmatch(corners[0]):
        return None
    alike = rb"\nf" + (rb"[ \t]+" + _NUMBER.sub(rb"\\d+", corners[0])) * len(corners) + rb"(?=[ \t]*\r?\n)"
    faces = re.findall(alike, text)
    if len(faces) != len(_FACE_BEGINS.findall(text)):
        return None
    joined = b"".join(faces).replace(b"/", b" ").replace(b"\nf", b"")
    # Overflowing indices become the largest integer, beyond the vertices of any file.
    values = np.fromstring(joined, np.int64, sep=" ").reshape(-1, len(_NUMBER.findall(corners[0]))) - 1
    words, none = corners[0].split(b"/"), np.full(len(values), -1)
    normal = values[:, -1] if len(words) == 3 and words[2] else none
    texture = values[:, 1] if len(words) > 1 and words[1] else none
    return ObjFaces(Polygons.from_array(values[:, 0].reshape(-1, len(corners))), normal, texture)


def _corners(text: bytes) -> Iterator[tuple[list[int], list[int], list[int]]]:
    """Vertex, normal and texture-coordinate indices per face, from 0; -1 is none."""
    counts = {"v": 0, "vn": 0, "vt": 0}
    for number, line in _statements(text[1:].decode("utf-8", errors="replace")):
        kind, _, rest = line.partition(" ")
        if kind in counts:
            counts[kind] += 1
        elif kind == "f":
            try:
                words = [word.split("/") for word in rest.split()]
                corners = [_index(word[0], counts["v"]) for word in words]
                normals = [_index(word[2], counts["vn"]) if word[2:] and word[2] else -1 for word in words]
                texture = [_index(word[1], counts["vt"]) if word[1:] and word[1] else -1 for word in words]
            except ValueError as error:
                raise ValueError(
                    tr("line {line} is not valid: {text}").format(line=number, text=line[:60])
                ) from error
            yield corners, normals, texture


def _statements(text: str) -> Iterator[tuple[int, str]]:
    """Statements with line numbers; continued lines joined, comments dropped."""
    held, first = "", 0
    for number, line in enumerate(text.split("\n"), start=1):
        words = line.partition("#")[0].replace("\t", " ").strip()
        first = first if held else number
        held += words
        if held.endswith("\\"):
            held = held[:-1] + " "
        else:
            yield first, held
            held = ""
    if held:
        yield first, held


def _index(word: str, count: int) -> int:
    """Zero-based index for a word such as ``7``, or ``-1`` for the last element."""
    number = int(word)
    return number - 1 if number > 0 else count + number if number < 0 else -1
