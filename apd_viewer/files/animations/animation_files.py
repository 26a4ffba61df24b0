"""Animation file formats, selected by suffix.

Point caches have no triangles: they are played back on the imported mesh file.
"""

import os
import struct
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from importlib.util import find_spec
from pathlib import Path
from typing import BinaryIO
from xml.etree import ElementTree

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.animations.animation_shapes import Animation
from apd_viewer.files.animations.morph_targets import write_morph_targets
from apd_viewer.files.mesh_formats import SERIES
from apd_viewer.files.mesh_writing import check_writable
from apd_viewer.files.storage.atomic_file import replacing_file
from apd_viewer.installation import missing_extra
from apd_viewer.language import tr

# Header: signature, version, point count, first frame, frames per sample, sample count.
PC2_HEADER = struct.Struct("<12siiffi")
_RATE = 24.0  # shapes per second, Blender's default frame rate


def write_pc2(animation: Animation, path: Path) -> None:
    """Write the shapes as PC2, one per frame from frame 0; raises InputError."""
    points = len(animation.blender_vertex_order)
    with replacing_file(path) as scratch, scratch.open("wb") as stream:
        stream.write(PC2_HEADER.pack(b"POINTCACHE2\0", 1, points, 0.0, 1.0, len(animation)))
        _write_points(animation, stream, "<f4")


def write_mdd(animation: Animation, path: Path) -> None:
    """Write the shapes as MDD, 24 per second from time 0; raises InputError."""
    count = len(animation)
    with replacing_file(path) as scratch, scratch.open("wb") as stream:
        stream.write(struct.pack(">ii", count, len(animation.blender_vertex_order)))
        stream.write((np.arange(count) / _RATE).astype(">f4").tobytes())
        _write_points(animation, stream, ">f4")


def _write_points(animation: Animation, stream: BinaryIO, kind: str) -> None:
    for U in animation:
        stream.write(U[animation.blender_vertex_order].astype(kind).tobytes())


_WRITERS = {".pc2": write_pc2, ".mdd": write_mdd, ".glb": write_morph_targets}
USD_FORMATS = (".usda", ".usdc", ".usdz")
ANIMATION_FORMATS = (*_WRITERS, *USD_FORMATS, SERIES)


def check_animation(path: Path) -> None:
    """Raise InputError unless an animation can be written to ``path``."""
    if path.suffix.lower() in USD_FORMATS and find_spec("pxr") is None:
        raise missing_extra(tr("{kind} files").format(kind="USD"), "usd")
    check_writable(path)
    if os.path.isdir(path):  # noqa: PTH112
        raise InputError(
            tr("{path} cannot be written (it is a folder); choose another name.").format(path=path)
        )
    beside = path.with_suffix("")
    if path.suffix.lower() == SERIES and beside.exists() and not beside.is_dir():
        raise InputError(
            tr("{name} needs a folder {folder} beside it, which is a file; choose another name.").format(
                name=path.name, folder=beside.name
            )
        )


def write_animation(animation: Animation, path: Path) -> None:
    """Write the shapes in the format of the suffix, one of ``ANIMATION_FORMATS``.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    kind = path.suffix.lower()
    if kind == SERIES:
        # Imported here: VTK is slow to import, and no other format needs it.
        from apd_viewer.files.animations.paraview_series import write_series

        write_series(animation, path)
    elif kind in USD_FORMATS:
        # Imported here: the extra may be missing.
        from apd_viewer.files.animations.usd_stage import write_usd

        write_usd(animation, path)
    else:
        _WRITERS[kind](animation, path)


@contextmanager
def replacing_series(paths: Sequence[Path]) -> Iterator[None]:
    """Context deleting the VTU files of replaced series at ``paths`` on exit.

    Only files in the folder of the series are deleted: a PVD of another program may list any files.
    """
    before = _series_files(paths)
    yield
    for path in before - _series_files(paths):
        with suppress(OSError):  # a file that cannot be deleted does no harm
            path.unlink()


def _series_files(paths: Sequence[Path]) -> set[Path]:
    series = [path for path in paths if path.suffix.lower() == ".pvd" and path.is_file()]
    return {file for path in series for file in _files(path)}


def _files(path: Path) -> list[Path]:
    try:
        rows = list(ElementTree.parse(path).iter("DataSet"))
    except (OSError, ElementTree.ParseError, LookupError, ValueError):  # also of an unknown encoding
        return []
    files = [path.parent / row.get("file", "") for row in rows]
    return [file for file in files if file.parent == path.with_suffix("") and file.suffix == ".vtu"]
