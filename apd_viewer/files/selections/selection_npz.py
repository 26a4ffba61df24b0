"""Selections as arrays of NumPy: everything, for scripts.

``labels`` (n,) and ``member`` (n,) are as in :class:`Selection`, ``handles`` and ``regions`` are names,
``areas`` are percentages, nan where an area is only measured, and ``digest`` is :attr:`Mesh.digest`. Only
``labels`` must be there.
"""

from __future__ import annotations

import io
import sys
import zipfile

import numpy as np

from apd_viewer.files.selections.selection import Selection, checked_labels, checked_member
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.language import tr

_KEYS = ("labels", "member", "handles", "regions", "areas", "digest")
_MOST_NAMES = 100


def selection_to_npz(mesh: Mesh, selection: Selection) -> bytes:
    """The file of a selection."""
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
    """Selection in a file; raises ValueError or InputError if not for ``mesh``."""
    n = len(mesh.V)
    arrays = _arrays(content, 32 * n + (1 << 23))
    if "labels" not in arrays:
        raise ValueError(tr("it has no array “labels”"))
    labels = checked_labels(arrays["labels"], n)
    member = checked_member(arrays["member"], n) if "member" in arrays else None
    handles, regions = (_names(arrays, key) for key in ("handles", "regions"))
    digest = arrays.get("digest", np.array(mesh.digest))
    return Selection.with_default_names(
        labels, member, handles, regions, _areas(arrays), _is(digest, mesh.digest)
    )


def _arrays(content: bytes, most: int) -> dict[str, np.ndarray]:
    """Arrays of a selection in the file, unless they unpack to too many bytes."""
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
    if codes.max(initial=0) > sys.maxunicode:  # Python would decode them to invalid text
        raise ValueError(tr("its “{key}” are damaged").format(key=key))
    return [str(name) for name in names]


def _areas(arrays: dict[str, np.ndarray]) -> list[float | None]:
    areas = arrays.get("areas", np.array([]))
    if areas.dtype.kind not in "iuf" or areas.ndim != 1 or len(areas) > _MOST_NAMES:
        raise ValueError(tr("its “areas” are not a list of numbers"))
    return [None if np.isnan(area) else float(area) for area in areas]


def _is(digest: np.ndarray, expected: str) -> bool:
    if digest.dtype.kind != "U" or digest.ndim != 0:
        raise ValueError(tr("its “digest” is not text"))
    return bool(digest == expected)
