"""Selections on disk, in five formats by suffix.

=======  ==================================================  =========================================
suffix   format                                              content
=======  ==================================================  =========================================
.json    ids of vertices, by part                            everything
.npz     NumPy archive, an array for each content            everything
.ply     PLY with the vertex properties below                labels and regions, no names, no areas
.sel     format of the survey, one number per line           labels
.dmat    dense matrix of libigl, one group per vertex        labels, of handles that hold a vertex
=======  ==================================================  =========================================

``apd_label`` is 0 base, 1 free, 2 handle, 3 the next handle and so on; ``apd_region``, which may be left
out, is 0 in no region, 1 in the first one and so on. Any program that keeps the properties of vertices may
have written the file; positions and faces are ignored.

``labels`` (n,) and ``member`` (n,) are as in :class:`Selection`, ``handles`` and ``regions`` are names,
``areas`` are percentages, nan where an area is only measured, and ``digest`` is :attr:`Mesh.digest`. Only
``labels`` must be there.

As in libigl's tutorial -1 is free. Of the other groups the lowest is the base, and the others are the
handles in order. We write 0 for the base and 1, 2 and so on for the handles. The first line has the numbers
of columns and rows; where both are 0, another such line and the numbers in binary follow.
"""

import io
import re
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.formats.ply import PlyFile, read_ply
from apd_viewer.files.formats.text import parse_numbers
from apd_viewer.files.selections.selection import (
    Selection,
    check_vertex_count,
    checked_labels,
    checked_member,
    selection_from_json,
    selection_to_json,
)
from apd_viewer.files.selections.survey_formats import labels_to_sel, read_selection
from apd_viewer.files.storage.atomic_file import replacing_file
from apd_viewer.files.storage.regular_files import one_line_message, read_content
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE, MOST_HANDLES
from apd_viewer.language import tr

_SIZES = re.compile(rb"\s*(\d{1,18})[ \t]+(\d{1,18})[ \t]*(?:\r\n|\n|\r)")
_FREE = -1
_LARGEST = 2.0**31  # upper limit of group numbers


def labels_to_dmat(labels: np.ndarray) -> bytes:
    """DMAT file content of labels (n,), as text."""
    groups = np.arange(256) - 1
    groups[FREE], groups[BASE] = _FREE, 0
    return "\n".join([f"1 {len(labels)}", *map(str, groups[labels].tolist()), ""]).encode()


def selection_from_dmat(content: bytes, mesh: Mesh) -> Selection:
    """Parse a selection; raises ValueError or InputError if it does not fit ``mesh``."""
    columns, rows, start = _head(content, 0)
    binary = columns == rows == 0 and len(content) > start
    if binary:
        columns, rows, start = _head(content, start)
    if columns != 1:
        raise ValueError(tr("it has {columns:,} columns instead of one").format(columns=columns))
    check_vertex_count(rows, len(mesh.V))
    if binary:
        groups = np.frombuffer(content[start:], "<f8", (len(content) - start) // 8)
    else:
        groups = parse_numbers(content[start:].split())
    if len(groups) != rows:
        raise ValueError(tr("it has {n:,} numbers, but declares {rows:,}").format(n=len(groups), rows=rows))
    return Selection.with_default_names(_labels(groups))


def _head(content: bytes, start: int) -> tuple[int, int, int]:
    """Column and row counts, and the offset of the following line."""
    head = _SIZES.match(content, start)
    if head is None:
        raise ValueError(tr("it does not start with the numbers of columns and rows"))
    return int(head[1]), int(head[2]), head.end()


def _labels(groups: np.ndarray) -> np.ndarray:
    """Labels (n,) from the group number of each vertex, (n,) floats."""
    whole = np.isfinite(groups) & (groups == np.rint(groups))
    if not (whole & (groups >= _FREE) & (groups < _LARGEST)).all():
        raise InputError(tr("It has a number other than -1 (free), 0, 1, 2 and so on; correct it."))
    held = groups != _FREE
    present, order = np.unique(groups[held], return_inverse=True)
    if len(present) > 1 + MOST_HANDLES:
        raise InputError(
            tr("It has {n:,} groups, but the limit is a base and {most} handles; merge some.").format(
                n=len(present), most=MOST_HANDLES
            )
        )
    labels = np.full(len(groups), FREE, dtype=np.uint8)
    labels[held] = np.array([BASE, *range(HANDLE, HANDLE + MOST_HANDLES)])[order]
    return labels


_KEYS = ("labels", "member", "handles", "regions", "areas", "digest")
_MOST_NAMES = 100


def selection_to_npz(mesh: Mesh, selection: Selection) -> bytes:
    """NPZ file content of a selection."""
    stream = io.BytesIO()
    np.savez_compressed(
        stream,
        labels=selection.labels,
        member=selection.member,
        handles=np.array(selection.handles, dtype=np.str_),
        regions=np.array(selection.regions, dtype=np.str_),
        areas=np.array([np.nan if area is None else area for area in selection.areas], dtype=np.float64),
        digest=np.array(mesh.digest),
    )
    return stream.getvalue()


def selection_from_npz(content: bytes, mesh: Mesh) -> Selection:
    """Parse a selection; raises ValueError or InputError if it does not fit ``mesh``."""
    n = len(mesh.V)
    arrays = _arrays(content, 32 * n + (1 << 23))
    if "labels" not in arrays:
        raise ValueError(tr("it has no array “labels”"))
    labels = checked_labels(arrays["labels"], n)
    member = checked_member(arrays["member"], n) if "member" in arrays else None
    handles, regions = (_names(arrays, key) for key in ("handles", "regions"))
    digest = arrays.get("digest", np.array(mesh.digest))
    return Selection.with_default_names(
        labels, member, handles, regions, _areas(arrays), _has_digest(digest, mesh.digest)
    )


def _arrays(content: bytes, most: int) -> dict[str, np.ndarray]:
    """Arrays of an NPZ selection; raises ValueError if damaged or too large."""
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            size = sum(entry.file_size for entry in archive.infolist())
        if size <= most:
            with np.load(io.BytesIO(content), allow_pickle=False) as file:
                return {key: np.asarray(file[key]) for key in _KEYS if key in file.files}
    except Exception as error:  # zipfile and NumPy raise many kinds of errors
        raise ValueError(tr("it is not an NPZ archive, or it is damaged")) from error
    raise ValueError(tr("it would unpack to {size:,} bytes").format(size=size))


def _names(arrays: dict[str, np.ndarray], key: str) -> list[str]:
    names = arrays.get(key, np.array([], dtype=np.str_))
    if names.dtype.kind != "U" or names.ndim != 1 or len(names) > _MOST_NAMES:
        raise ValueError(tr("its “{key}” are not a list of names").format(key=key))
    codes = np.frombuffer(names.astype(names.dtype.newbyteorder("<")).tobytes(), "<u4")
    if codes.max(initial=0) > sys.maxunicode:  # such code points would decode to invalid text
        raise ValueError(tr("its “{key}” are damaged").format(key=key))
    return [str(name) for name in names]


def _areas(arrays: dict[str, np.ndarray]) -> list[float | None]:
    areas = arrays.get("areas", np.array([]))
    if areas.dtype.kind not in "iuf" or areas.ndim != 1 or len(areas) > _MOST_NAMES:
        raise ValueError(tr("its “areas” are not a list of numbers"))
    return [None if np.isnan(area) else float(area) for area in areas]


def _has_digest(digest: np.ndarray, expected: str) -> bool:
    if digest.dtype.kind != "U" or digest.ndim != 0:
        raise ValueError(tr("its “digest” is not text"))
    return bool(digest == expected)


_LABEL, _REGION = "apd_label", "apd_region"
_HEAD = f"""ply
format binary_little_endian 1.0
comment {_LABEL}: 0 base, 1 free, 2 handle, 3 the next handle; {_REGION}: 0 none
element vertex {{}}
property double x
property double y
property double z
property uchar {_LABEL}
property uchar {_REGION}
element face {{}}
property list uchar int vertex_indices
end_header
"""


def selection_to_ply(mesh: Mesh, selection: Selection) -> bytes:
    """PLY file content of ``mesh`` with labels and regions as vertex properties."""
    rows = np.empty(len(mesh.V), dtype=[("V", "<f8", (3,)), (_LABEL, "u1"), (_REGION, "u1")])
    rows["V"], rows[_LABEL], rows[_REGION] = mesh.V, selection.labels, selection.member
    faces = np.empty(len(mesh.F), dtype=[("count", "u1"), ("corners", "<i4", (3,))])
    faces["count"], faces["corners"] = 3, mesh.F
    return _HEAD.format(len(rows), len(faces)).encode() + rows.tobytes() + faces.tobytes()


def selection_from_ply(content: bytes, mesh: Mesh) -> Selection:
    """Parse a selection; raises ValueError or InputError if it does not fit ``mesh``."""
    file = read_ply(content).origin
    if not isinstance(file, PlyFile):
        raise ValueError(tr("it has no vertices"))
    at = next(k for k, element in enumerate(file.elements) if element.name == "vertex")
    there = {name for name, length, kind in file.elements[at].properties if not length and kind[0] in "iu"}
    if _LABEL not in there:
        raise InputError(
            tr("Its vertices have no integer property “{name}”; choose a file with a selection.").format(
                name=_LABEL
            )
        )
    n = len(mesh.V)
    check_vertex_count(file.elements[at].rows, n)
    labels = checked_labels(file.columns(at, (_LABEL,))[:, 0], n)
    member = checked_member(file.columns(at, (_REGION,))[:, 0], n) if _REGION in there else None
    return Selection.with_default_names(labels, member)


_READERS: dict[str, Callable[[bytes, Mesh], Selection]] = {
    ".json": selection_from_json,
    ".npz": selection_from_npz,
    ".ply": selection_from_ply,
    ".dmat": selection_from_dmat,
}
_WRITERS: dict[str, Callable[[Mesh, Selection], bytes]] = {
    ".json": selection_to_json,
    ".npz": selection_to_npz,
    ".ply": selection_to_ply,
    ".sel": lambda _, selection: labels_to_sel(selection.labels),
    ".dmat": lambda _, selection: labels_to_dmat(selection.labels),
}
SELECTION_FORMATS = tuple(_WRITERS)


def read_selection_file(path: str | Path, mesh: Mesh) -> Selection:
    """Read a selection on ``mesh``; unknown suffixes are read as ``.sel``.

    A file for another number of vertices or triangles is refused. A file for other positions is accepted,
    since selections also fit deformed copies: see
    :attr:`Selection.is_for_same_mesh`.

    Raises
    ------
    InputError
        If there is no such file, or it does not hold a selection for ``mesh``.
    """
    path = Path(path)
    read = _READERS.get(path.suffix.lower())
    if read is None:
        return Selection.with_default_names(read_selection(path, len(mesh.V)))
    content = read_content(path)
    try:
        return read(content, mesh)
    except InputError as error:
        raise InputError(f"{path.name}: {one_line_message(error)}") from error
    except MemoryError as error:
        raise InputError(
            tr("{name} does not fit into memory; choose another file.").format(name=path.name)
        ) from error
    except ValueError as error:
        raise InputError(
            tr("{name} is not a valid selection ({reason}); choose another file.").format(
                name=path.name, reason=one_line_message(error)
            )
        ) from error


def write_selection(path: str | Path, mesh: Mesh, selection: Selection) -> tuple[str, ...]:
    """Write a selection on ``mesh`` in the format of the suffix.

    Parameters
    ----------
    path : path
        Replaced only once the new file is whole and was read again.

    Raises
    ------
    InputError
        If the file cannot be written, or would be read with other labels.

    Returns
    -------
    tuple of str
        Contents of the selection left out, as the format cannot hold them, in words.
    """
    path = Path(path)
    write = _WRITERS.get(path.suffix.lower())
    if write is None:
        raise InputError(
            tr("{name} does not have a supported ending; use {endings}.").format(
                name=path.name, endings=", ".join(SELECTION_FORMATS)
            )
        )
    if _is_file_of(mesh, path):
        raise InputError(tr("{name} is the mesh file; choose another name.").format(name=path.name))
    if len(selection.labels) != len(mesh.V):
        raise InputError(
            tr("The selection has {n:,} vertices, but the mesh has {other:,}; nothing was written.").format(
                n=len(selection.labels), other=len(mesh.V)
            )
        )
    content = write(mesh, selection)
    with replacing_file(path) as scratch:
        scratch.write_bytes(content)
        there = read_selection_file(scratch, mesh)
        if not np.array_equal(there.labels, selection.labels):
            raise InputError(
                tr(
                    "{name} cannot store an empty base or handle, so its labels would change; choose .json."
                ).format(name=path.name)
            )
    return _lost_contents(selection, there)


def _is_file_of(mesh: Mesh, path: Path) -> bool:
    try:
        return mesh.path is not None and path.samefile(mesh.path)
    except OSError:  # one of the two files is missing
        return False


def _lost_contents(selection: Selection, written: Selection) -> tuple[str, ...]:
    """Names of selection contents missing from ``written``."""
    renamed, fewer = _lost_names(selection.handles, written.handles)
    lost = (tr("handle names"),) * renamed + (tr("empty handles"),) * fewer
    if not np.array_equal(selection.member, written.member):
        return (*lost, tr("regions"))
    renamed, fewer = _lost_names(selection.regions, written.regions)
    lost += (tr("region names"),) * renamed + (tr("empty regions"),) * fewer
    if selection.areas[: len(written.areas)] != written.areas:
        lost += (tr("region targets"),)
    return lost


def _lost_names(names: tuple[str, ...], written: tuple[str, ...]) -> tuple[bool, bool]:
    """Flags for renamed and for missing entries in ``written``."""
    return names[: len(written)] != written, len(written) < len(names)
