"""OFF and its kin: vertices and faces in file order; new coordinates in place."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from apd_viewer.files.formats.parsed import Parsed, turned
from apd_viewer.files.formats.polygons import Polygons
from apd_viewer.files.formats.text import Edits, lines, numbers, plain, shown, whole_numbers
from apd_viewer.files.formats.vertex_colors import guessed
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.language import tr

_HEAD = re.compile(rb"((?:ST)?(C?)(N?)OFF)\b(.*)", re.DOTALL)


@dataclass(frozen=True)
class OffFile:
    """Content of an OFF file, and the spans of its vertices."""

    content: bytes
    rows: list[tuple[int, bytes]]
    has_colours: bool
    has_normals: bool
    suffix = ".off"

    @property
    def extras(self) -> tuple[str, ...]:
        """Contents besides positions and triangles, in words."""
        return (tr("colours"),) * self.has_colours + (tr("normals"),) * self.has_normals

    @property
    def colors(self) -> np.ndarray | None:
        """Vertex colours, (n, 3) uint8, if it has any."""
        if not self.has_colours or not self.rows:
            return None
        first = 6 if self.has_normals else 3
        rows = [row.split()[first : first + 3] for _, row in self.rows]
        return guessed(numbers([word for row in rows for word in row]).reshape(-1, 3))

    def normals(self, _: Mesh) -> None:
        """None: those of the faces follow from the positions."""

    def texture(self, _: Mesh) -> None:
        """None: the format has no textures."""

    def rewritten(self, mesh: Mesh, U: np.ndarray) -> bytes:
        """File content with positions ``U`` (n, 3) and turned normals."""
        edits = Edits(self.content)
        edits.numbers(self._spans(0), mesh.V.ravel(), U.ravel())
        if self.has_normals:
            N = numbers([word for _, row in self.rows for word in row.split()[3:6]]).reshape(-1, 3)
            edits.numbers(self._spans(3), N.ravel(), turned(mesh.V, U, mesh.F, N, mesh.F).ravel())
        return edits.done()

    def _spans(self, first: int) -> list[tuple[int, int]]:
        """Spans of three words of every row."""
        pattern = re.compile(rb"\s*(?:\S+\s+){%d}(\S+)\s+(\S+)\s+(\S+)" % first)
        spans = []
        for start, row in self.rows:
            match = pattern.match(row)
            assert match is not None  # it was read
            spans += [(start + match.start(k), start + match.end(k)) for k in (1, 2, 3)]
        return spans


def read_off(content: bytes) -> Parsed:
    """Positions (n, 3) and triangles (m, 3) of an OFF file.

    Raises
    ------
    ValueError
        If the file cannot be understood or ends too early.
    """
    rows = list(lines(plain(content)))
    head = _HEAD.fullmatch(rows[0][1].strip()) if rows else None
    if head is None:
        raise ValueError(tr("it does not start with OFF"))
    if head[4].split()[:1] == [b"BINARY"]:
        raise ValueError(tr("it is a binary OFF file, which is not supported"))
    counts = head[4].split()
    if not counts:
        counts, rows = rows[1][1].split() if len(rows) > 1 else [], rows[1:]
    if len(counts) < 2:
        raise ValueError(tr("the numbers of vertices and faces are missing"))
    n, m = whole_numbers(counts[:2])
    if n < 0 or m < 0 or len(rows) < 1 + n + m:
        raise ValueError(
            tr("it ends before its last face: its header declares {n:,} vertices and {m:,} faces").format(
                n=n, m=m
            )
        )
    vertices, has_normals = rows[1 : 1 + n], bool(head[3])
    if any(len(row.split()) < (6 if has_normals else 3) for _, row in vertices):
        raise ValueError(tr("a vertex has fewer than three coordinates"))
    polygons = Polygons.of([_polygon(row) for _, row in rows[1 + n : 1 + n + m]])
    V = numbers([word for _, row in vertices for word in row.split()[:3]]).reshape(-1, 3)
    return Parsed(V, polygons.triangles(V), OffFile(content, vertices, bool(head[2]), has_normals))


def _polygon(line: bytes) -> list[int]:
    """Vertices of a face: their number, then they; a colour may follow."""
    words = line.split()
    (count,) = whole_numbers(words[:1])
    if count < 0 or len(words) < 1 + count:
        raise ValueError(tr("a face is incomplete: {text}").format(text=shown(line)))
    return whole_numbers(words[1 : 1 + count])
