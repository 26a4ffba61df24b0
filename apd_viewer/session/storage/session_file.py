"""Session files: the document, its shape and the view.

A session is an archive of ``session.json`` and arrays. A program opens every version up to its own; a newer
one holds what it knows nothing of, and is refused.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from importlib import metadata
from pathlib import Path

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.mesh_location import find_mesh
from apd_viewer.files.storage.archive import Archive, npy, write_archive
from apd_viewer.files.storage.json_fields import Fields
from apd_viewer.files.storage.reading import content_of
from apd_viewer.geometry.mesh.arrays import diagonal
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.language import tr
from apd_viewer.session.model.state import State, opened
from apd_viewer.session.model.view import SUFFIX, View
from apd_viewer.session.storage.session_errors import explained
from apd_viewer.session.storage.session_json import (
    document_of,
    document_said,
    frame_of,
    frame_said,
    view_of,
    view_said,
)
from apd_viewer.session.storage.session_meshes import TEXT, mesh_said, target_said, with_target
from apd_viewer.session.storage.session_picture import PICTURE

FORMAT, VERSION = "apd-session", 1
_CODES, _POSITIONS = ("labels", "member"), ("grip", "shape")
_WELD = "weld"  # for each vertex the one that it is welded to, where seams were welded
# In bounding-box diagonals; positions farther away are no shape of this mesh.
_FARTHEST = 1e8


def save_session(
    path: str | Path,
    state: State,
    view: View,
    embed: bool = False,
    at_once: bool = False,
    picture: bytes = b"",
    finish: Callable[[Path], object] = lambda _: None,
) -> bool:
    """Write a session to a file, whole or not at all.

    Parameters
    ----------
    path : path
        Ends in ``.apd``.
    state : State
    view : View
    embed : bool
        Whether to put copies of the mesh and of the target shape into it. There is one in any case where no
        file holds them.
    at_once : bool
        Whether it is wanted in a moment, and may be larger; see
        :func:`apd_viewer.files.storage.archive.write_archive`.
    picture : bytes
        A PNG file that shows the session in a file manager; empty for none.
    finish : callable
        Called last, see :func:`apd_viewer.files.storage.atomic_file.replacing`.

    Returns
    -------
    bool
        Whether there is a copy of the mesh in it.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    path = Path(path)
    if path.suffix.lower() != SUFFIX:
        raise InputError(
            tr("{name} does not have the ending of a session; use {ending}.").format(
                name=path.name, ending=SUFFIX
            )
        )
    document, mesh = state.document, state.document.mesh
    told, copy = mesh_said(mesh, path, embed)
    target, copy_of_target = target_said(document, path, embed)
    arrays = {"labels": document.labels, "member": document.member}
    if mesh.has_welded_seams:
        arrays[_WELD] = mesh.weld.representative
    positions = {"grip": document.grip, "shape": state.frame.U}
    # Rest positions are left out: once opened they are the mesh's own.
    arrays |= {name: X for name, X in positions.items() if X is not mesh.V}
    said = {
        "format": FORMAT,
        "version": VERSION,
        "program": _program(),
        "mesh": told,
        **({"target": target} if target else {}),
        "arrays": list(arrays),
        "document": document_said(document),
        "frame": frame_said(state.frame),
        "view": view_said(view),
    }
    text = json.dumps(said, indent=1, allow_nan=False).encode()
    members = {f"{name}.npy": npy(array) for name, array in arrays.items()}
    members |= {**copy, **copy_of_target, **({PICTURE: picture} if picture else {})}
    write_archive(path, {TEXT: text, **members}, at_once, finish)
    return bool(copy)


@cache
def _program() -> str:
    try:
        return metadata.version("apd-viewer")
    except metadata.PackageNotFoundError:
        return "unknown"


def open_session(path: str | Path) -> tuple[State, View]:
    """Open a session: the saved state, bit for bit, and its view.

    The mesh is looked for where it was, then by the way that leads there from the session, then beside the
    session, then in it; and so is the target shape, without which the session opens too.

    Raises
    ------
    InputError
        If there is no such file, it is no session, or its mesh is missing or another one.
    """
    path = Path(path)
    with explained(path):
        archive = Archive(_content(path))
        said = Fields.of(archive.content(TEXT), TEXT)
        _check_version(said, path)
        mesh = _welded(find_mesh(said.part("mesh"), path, archive), said, archive)
        state, arrays = opened(mesh), _arrays(said, archive, mesh)
        document = with_target(document_of(said.part("document"), mesh, arrays), said, path, archive)
        if document.volume is not None and not state.inspection.volume:
            raise ValueError(tr("its “volume” is damaged"))
        state = replace(state, document=document)
        frame = frame_of(said.part("frame"), state, arrays["shape"])
        return replace(state, frame=frame), view_of(said.part("view"))


def _content(path: Path) -> bytes:
    # os.path: Path raises on names that are too long.
    if not os.path.exists(path):  # noqa: PTH110
        raise InputError(tr("There is no file {path}; check the name.").format(path=path))
    if not path.is_file():
        raise InputError(tr("{path} is not a file; choose a session file.").format(path=path))
    return content_of(path)


def _check_version(said: Fields, path: Path) -> None:
    if said.text("format") != FORMAT:
        raise ValueError(tr("it is another type of file"))
    version = said.count("version")
    if version > VERSION:
        raise InputError(
            tr("{name} was saved by a newer version of the program; update apd-viewer to open it.").format(
                name=path.name
            )
        )
    if version < 1:
        raise ValueError(tr("its “version” is damaged"))


def _welded(mesh: Mesh, said: Fields, archive: Archive) -> Mesh:
    """The mesh with its seams welded as they were."""
    if _WELD not in said.texts("arrays", most=100):
        return mesh
    n = len(mesh.V)
    to = archive.array(_WELD, "<i8", (n,))
    if to.min() < 0 or (to > np.arange(n)).any() or (to[to] != to).any():
        raise ValueError(tr("“{name}” in it refers to a vertex that does not exist").format(name=_WELD))
    return mesh.joined(to)


def _arrays(said: Fields, archive: Archive, mesh: Mesh) -> dict[str, np.ndarray]:
    """Labels, regions and positions of all vertices, by their names."""
    there, n = said.texts("arrays", most=100), len(mesh.V)
    farthest = _FARTHEST * diagonal(mesh.V)
    arrays = {name: archive.array(name, "|u1", (n,)) for name in _CODES}
    for name in _POSITIONS:
        arrays[name] = archive.array(name, "<f8", (n, 3)) if name in there else mesh.V
        X = arrays[name]
        if not np.isfinite(X).all() or (np.abs(X - mesh.V) > farthest).any():
            raise ValueError(tr("“{name}” in it is not a shape of the mesh").format(name=name))
    return arrays
