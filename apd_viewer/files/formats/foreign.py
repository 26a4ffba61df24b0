"""Formats read by a library and not written back."""

from __future__ import annotations

import io
import warnings
import zipfile

import numpy as np

from apd_viewer.files.formats.parsed import Parsed
from apd_viewer.files.storage.archive import BROKEN, most_unpacked
from apd_viewer.language import tr

_MOST = 1 << 31  # bytes; a larger archive is broken or malicious


def read_3mf(content: bytes) -> Parsed:
    """Positions (n, 3) and triangles (m, 3) of all objects of a 3MF build.

    Raises
    ------
    ValueError
        If the file cannot be understood.
    """
    import trimesh  # here, because it takes longer to import than all the rest of a headless run

    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            size = sum(entry.file_size for entry in archive.infolist())
            bursts = size > min(_MOST, most_unpacked(len(content)))
            declares = not bursts and any(map(_declares_entities, map(archive.read, archive.infolist())))
    except BROKEN as error:  # or its compression is unknown
        raise ValueError(tr("it is not an archive, or it is damaged")) from error
    if bursts:
        raise ValueError(tr("it would unpack to {size:,} bytes").format(size=size))
    if declares:
        raise ValueError(tr("a part of it declares XML entities, which 3MF does not allow"))
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            scene = trimesh.load_scene(io.BytesIO(content), file_type="3mf", process=False)
            placed = [scene.graph[node] for node in scene.graph.nodes_geometry]
            V, F, count = [np.empty((0, 3))], [np.empty((0, 3), dtype=np.int64)], 0
            for M, name in placed:
                part = scene.geometry[name]
                V.append(np.asarray(part.vertices, dtype=np.float64) @ M[:3, :3].T + M[:3, 3])
                F.append(np.asarray(part.faces, dtype=np.int64) + count)
                count += len(part.vertices)
    except MemoryError:
        raise
    except Exception as error:  # it raises many kinds of errors
        raise ValueError(tr("the contents of its archive are damaged")) from error
    return Parsed(np.vstack(V), np.vstack(F), None)


def _declares_entities(part: bytes) -> bool:
    """True if an XML part has a document type, which could name files."""
    return b"<!DOCTYPE" in part.replace(b"\0", b"")  # in UTF-16, too
