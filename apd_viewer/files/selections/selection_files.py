"""Selections on disk, in five formats by suffix.

=======  ==================================================  =========================================
suffix   what it is                                          what it holds
=======  ==================================================  =========================================
.json    our own: ids of vertices, by part                   everything
.npz     NumPy's: an array a thing                           everything
.ply     PLY with the vertex properties of selection_ply     labels and regions, no names, no areas
.sel     the survey's: a number a line                       labels
.dmat    libigl's dense matrix: a group a vertex             labels, of handles that hold a vertex
=======  ==================================================  =========================================
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.selections.selection import Selection
from apd_viewer.files.selections.selection_dmat import labels_to_dmat, selection_from_dmat
from apd_viewer.files.selections.selection_json import selection_from_json, selection_to_json
from apd_viewer.files.selections.selection_npz import selection_from_npz, selection_to_npz
from apd_viewer.files.selections.selection_ply import selection_from_ply, selection_to_ply
from apd_viewer.files.selections.survey_formats import labels_to_sel, read_selection
from apd_viewer.files.storage.atomic_file import replacing_file
from apd_viewer.files.storage.regular_files import one_line_message, read_content
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.language import tr

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

    A file for another number of vertices is refused, and so is one that names another number of triangles.
    One that was made for other positions is not, for a deformed copy keeps its selection: see
    :attr:`Selection.same_mesh`.

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
    mesh : Mesh
    selection : Selection

    Raises
    ------
    InputError
        If the file cannot be written, or would be read with other labels.

    Returns
    -------
    tuple of str
        What the format cannot hold of this selection and was left out, in words.
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
    return _dropped(selection, there)


def _is_file_of(mesh: Mesh, path: Path) -> bool:
    try:
        return mesh.path is not None and path.samefile(mesh.path)
    except OSError:  # one of them is missing
        return False


def _dropped(selection: Selection, written: Selection) -> tuple[str, ...]:
    """Contents of the selection missing from ``written``."""
    renamed, fewer = _lost(selection.handles, written.handles)
    lost = (tr("handle names"),) * renamed + (tr("empty handles"),) * fewer
    if not np.array_equal(selection.member, written.member):
        return (*lost, tr("regions"))
    renamed, fewer = _lost(selection.regions, written.regions)
    lost += (tr("region names"),) * renamed + (tr("empty regions"),) * fewer
    if selection.areas[: len(written.areas)] != written.areas:
        lost += (tr("region targets"),)
    return lost


def _lost(names: tuple[str, ...], written: tuple[str, ...]) -> tuple[bool, bool]:
    """True if ``written`` has fewer or other names."""
    return names[: len(written)] != written, len(written) < len(names)
