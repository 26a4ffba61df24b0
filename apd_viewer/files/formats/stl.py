"""STL, text or binary: three vertices per triangle; coordinates updated in place."""

import re
from dataclasses import dataclass

import numpy as np

from apd_viewer.files.formats.polygon_mesh import ParsedMesh, trailing_bytes_remark
from apd_viewer.files.formats.text import TextEdits, parse_numbers, with_line_feeds
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.language import tr

_HEAD = 84  # header bytes of a binary file; the last four hold the facet count
_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
# For lower-case text with blanked solid names, since a name may contain any keyword.
_NAME = re.compile(rb"solid([^\n]*?)(?=\bfacet\s+normal\s+[-+.\d]|\n|\Z)")
_VERTEX = re.compile(rb"\bvertex\s+(\S+)\s+(\S+)\s+(\S+)")
_NORMAL = re.compile(rb"\bfacet\s+normal\s+(\S+)\s+(\S+)\s+(\S+)")
_FACETS, _VERTICES = re.compile(rb"\bfacet(?<!end facet)\b"), re.compile(rb"\bvertex\b")
_END = re.compile(rb"\bend[ \t_]*(loop|facet|solid)")
_LOOP = re.compile(rb"(?i)\bouter\s+loop\b")


@dataclass(frozen=True)
class StlFile:
    """Content of an STL file, and its facet count if binary."""

    content: bytes
    facets: int | None
    suffix = ".stl"

    @property
    def extras(self) -> tuple[str, ...]:
        """Names of the contents besides positions and triangles."""
        if self.facets is None:
            return ()
        rows = np.frombuffer(self.content, _FACET, self.facets, _HEAD)
        return (tr("facet attributes"),) if rows["attribute"].any() else ()

    @property
    def colors(self) -> None:
        """None: the format has no vertex colours."""
        return

    def normals(self, _: Mesh) -> None:
        """None: face normals follow from the positions."""

    def texture(self, _: Mesh) -> None:
        """None: the format has no textures."""

    def rewritten_content(self, mesh: Mesh, U: np.ndarray) -> bytes:
        """File content with positions ``U`` (3 m, 3) and updated normals."""
        moved = (mesh.V != U).any(axis=1).reshape(-1, 3).any(axis=1)
        if self.facets is not None:
            body = bytearray(self.content)
            facets = np.frombuffer(body, _FACET, self.facets, _HEAD)
            corners = U.reshape(-1, 3, 3)
            facets["corners"][moved] = corners[moved]
            had = moved & facets["normal"].any(axis=1)
            # Normals follow from the corners as rounded to single precision.
            facets["normal"][had] = _normals(facets["corners"][had].astype(np.float64))
            return bytes(body)
        text, edits = _with_blank_names(self.content), TextEdits(self.content)
        edits.replace_numbers(_spans(_VERTEX, text), mesh.V.ravel(), U.ravel())
        old = _numbers(_NORMAL, text)
        if len(old) == len(moved):
            new, had = old.copy(), moved & old.any(axis=1)
            new[had] = _normals(U.reshape(-1, 3, 3)[had])
            edits.replace_numbers(_spans(_NORMAL, text), old.ravel(), new.ravel())
        return edits.edited_content()


def _normals(corners: np.ndarray) -> np.ndarray:
    """Unit normals (k, 3) of triangles (k, 3, 3); zero for degenerate triangles."""
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(across, axis=1, keepdims=True)
    return np.divide(across, size, out=np.zeros_like(across), where=size > 0.0)


def _spans(pattern: re.Pattern[bytes], content: bytes) -> list[tuple[int, int]]:
    return [match.span(k) for match in pattern.finditer(content) for k in (1, 2, 3)]


def _numbers(pattern: re.Pattern[bytes], content: bytes) -> np.ndarray:
    return parse_numbers([word for words in pattern.findall(content) for word in words]).reshape(-1, 3)


def is_binary_stl(content: bytes) -> bool:
    """True if the size fits the declared number of binary facets."""
    return len(content) >= _HEAD and len(content) == _HEAD + _declared_count(content) * _FACET.itemsize


def _declared_count(content: bytes) -> int:
    return int.from_bytes(content[_HEAD - 4 : _HEAD], "little")


def read_stl(content: bytes) -> ParsedMesh:
    """Positions (3 m, 3) and triangles (m, 3) of all solids in an STL file.

    Raises
    ------
    ValueError
        If the file cannot be understood, ends too early, or has more facets than it declares.
    """
    # Some binary files start with "solid" too, and some texts have null bytes after a name.
    if is_binary_stl(content) or (b"\0" in content[_HEAD:] and not _LOOP.search(content)):
        m, remarks = _binary(content)
        V = np.empty((3 * m, 3))
        with np.errstate(invalid="ignore"):  # NaN coordinates are rejected later
            V.reshape(-1, 3, 3)[...] = np.frombuffer(content, _FACET, m, _HEAD)["corners"]
        return ParsedMesh(V, np.arange(3 * m).reshape(-1, 3), StlFile(content, m), remarks)
    V, remarks = _text(_with_blank_names(content))
    return ParsedMesh(V, np.arange(len(V)).reshape(-1, 3), StlFile(content, None), remarks)


def _binary(content: bytes) -> tuple[int, tuple[str, ...]]:
    """Facet count of a binary file, and remarks on trailing bytes."""
    m, size = _declared_count(content), _FACET.itemsize
    there, more = divmod(max(len(content) - _HEAD, 0), size)
    rest = content[_HEAD + m * size :]
    is_count_wrong = bool(there) if m == 0 else not more and any(rest)  # trailing zeros are padding
    if there < m or is_count_wrong:
        raise ValueError(
            tr("it declares {declared:,} facets and has {there:,}").format(declared=m, there=there)
        )
    return m, trailing_bytes_remark(len(rest))


def _with_blank_names(content: bytes) -> bytes:
    """Lower-case text of the same length with the names of the solids blanked."""
    return _NAME.sub(lambda match: b"solid" + b" " * len(match[1]), with_line_feeds(content).lower())


def _text(content: bytes) -> tuple[np.ndarray, tuple[str, ...]]:
    """Facet corners (3 m, 3) of a text file, and a remark on a missing endsolid."""
    V, facets = _numbers(_VERTEX, content), len(_FACETS.findall(content))
    ends = {match[1] for match in _END.finditer(content, content.rfind(b"vertex"))}
    if len(V) != 3 * facets or len(V) != len(_VERTICES.findall(content)) or (facets and not ends):
        raise ValueError(tr("a facet is incomplete"))
    said = tr("The file lacks a final endsolid; if facets are missing, export it again.")
    return V, () if b"solid" in ends or not facets else (said,)
