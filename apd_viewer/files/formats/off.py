"""OFF and its variants: file order kept; coordinates updated in place."""

import re
from dataclasses import dataclass

import numpy as np

from apd_viewer.files.formats.ply_elements import PlyElement, with_one_row_per_line
from apd_viewer.files.formats.polygon_mesh import (
    ParsedMesh,
    Polygons,
    text_colors_to_uint8,
    trailing_bytes_remark,
    updated_normals,
)
from apd_viewer.files.formats.text import (
    TextEdits,
    content_lines,
    excerpt,
    parse_integers,
    parse_numbers,
    with_line_feeds,
)
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.language import tr

# Counts may follow the keyword without a space, as in ModelNet files.
_HEAD = re.compile(rb"(?:ST)?(C?)(N?)(4?n?)OFF(?![A-Za-z_])(.*)", re.DOTALL)
_COMMENT = re.compile(rb"#[^\n]*")


@dataclass(frozen=True)
class OffFile:
    """Content of an OFF file, and its vertex rows with their offsets."""

    content: bytes
    rows: list[tuple[int, bytes]]
    has_colours: bool
    has_normals: bool
    suffix = ".off"

    @property
    def extras(self) -> tuple[str, ...]:
        """Names of the contents besides positions and triangles."""
        return (tr("colours"),) * self.has_colours + (tr("normals"),) * self.has_normals

    @property
    def colors(self) -> np.ndarray | None:
        """Vertex colours (n, 3) uint8; None if there are none."""
        if not self.has_colours or not self.rows:
            return None
        first = 6 if self.has_normals else 3
        rows = [row.split()[first : first + 3] for _, row in self.rows]
        return text_colors_to_uint8(parse_numbers([word for row in rows for word in row]).reshape(-1, 3))

    def normals(self, _: Mesh) -> None:
        """None: normals are computed from the positions."""

    def texture(self, _: Mesh) -> None:
        """None: the format has no textures."""

    def rewritten_content(self, mesh: Mesh, U: np.ndarray) -> bytes:
        """File content with positions ``U`` (n, 3) and rotated normals."""
        edits = TextEdits(self.content)
        edits.replace_numbers(self._spans(0), mesh.V.ravel(), U.ravel())
        if self.has_normals:
            N = parse_numbers([word for _, row in self.rows for word in row.split()[3:6]]).reshape(-1, 3)
            edits.replace_numbers(
                self._spans(3), N.ravel(), updated_normals(mesh.V, U, mesh.F, N, mesh.F).ravel()
            )
        return edits.edited_content()

    def _spans(self, first: int) -> list[tuple[int, int]]:
        """Spans of the three words from index ``first`` in each vertex row."""
        pattern = re.compile(rb"\s*(?:\S+\s+){%d}(\S+)\s+(\S+)\s+(\S+)" % first)
        spans = []
        for start, row in self.rows:
            match = pattern.match(row)
            assert match is not None  # always found: all rows were parsed on reading
            spans += [(start + match.start(k), start + match.end(k)) for k in (1, 2, 3)]
        return spans


def read_off(content: bytes) -> ParsedMesh:
    """Positions (n, 3) and triangles (m, 3) of an OFF file.

    Raises
    ------
    ValueError
        If the file cannot be understood or ends too early.
    """
    text = with_line_feeds(content)
    try:
        return _read(content, text)
    except ValueError:
        whole = _one_row_a_line(text)
        if whole is None:
            raise
    return _read(content, whole)


def _read(content: bytes, text: bytes) -> ParsedMesh:
    head, n, m, rows = _header(list(content_lines(text)))
    if n < 0 or m < 0 or len(rows) < n + m:
        raise ValueError(
            tr("it ends before its last face: its header declares {n:,} vertices and {m:,} faces").format(
                n=n, m=m
            )
        )
    vertices, has_normals = rows[:n], bool(head[2])
    if any(len(row.split()) < (6 if has_normals else 3) for _, row in vertices):
        raise ValueError(tr("a vertex has fewer than three coordinates"))
    polygons = Polygons.from_faces([_polygon(row) for _, row in rows[n : n + m]])
    V = parse_numbers([word for _, row in vertices for word in row.split()[:3]]).reshape(-1, 3)
    file = OffFile(content, vertices, bool(head[1]), has_normals)
    return ParsedMesh(
        V, polygons.triangles(V), file, trailing_bytes_remark(sum(len(row) for _, row in rows[n + m :]))
    )


def _one_row_a_line(text: bytes) -> bytes | None:
    """Wrapped text rewritten with one row per line, for a file without colours."""
    text = _COMMENT.sub(lambda match: b" " * len(match[0]), text)
    head, n, m, rows = _header(list(content_lines(text)))
    numbers_of_a_row = ("x", "y", "z", "nx", "ny", "nz")[: 6 if head[2] else 3]
    vertex = PlyElement("vertex", n, [(name, None, "f8") for name in numbers_of_a_row])
    elements = vertex, PlyElement("face", m, [("vertices", "u4", "i8")])
    return with_one_row_per_line(text, rows[0][0], elements) if rows else None


def _header(rows: list[tuple[int, bytes]]) -> tuple[re.Match[bytes], int, int, list[tuple[int, bytes]]]:
    """Header match, vertex and face counts, and the rows after the header."""
    head = _HEAD.fullmatch(rows[0][1].strip()) if rows else None
    if head is None:
        raise ValueError(tr("it does not start with OFF"))
    counts = head[4].split()
    if counts[:1] == [b"BINARY"]:
        raise ValueError(tr("it is a binary OFF file, which is not supported"))
    if head[3]:
        raise ValueError(tr("its points do not have three coordinates"))
    if not counts:
        counts, rows = rows[1][1].split() if len(rows) > 1 else [], rows[1:]
    if len(counts) < 2:
        raise ValueError(tr("the numbers of vertices and faces are missing"))
    n, m = parse_integers(counts[:2])
    return head, n, m, rows[1:]


def _polygon(line: bytes) -> list[int]:
    """Vertex indices of a face line; a colour may follow them."""
    words = line.split()
    (count,) = parse_integers(words[:1])
    if count < 0 or len(words) < 1 + count:
        raise ValueError(tr("a face is incomplete: {text}").format(text=excerpt(line)))
    return parse_integers(words[1 : 1 + count])
