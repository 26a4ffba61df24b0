"""The mesh and the target shape of a session: their places and copies."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from apd_viewer.errors import InputError
from apd_viewer.files.mesh_location import MissingMesh, copy_of, find_mesh, is_there, whereabouts
from apd_viewer.files.storage.archive import Archive
from apd_viewer.files.storage.json_fields import Fields
from apd_viewer.files.storage.reading import opened
from apd_viewer.geometry.analysis.target_shape import TargetShape

if TYPE_CHECKING:
    from pathlib import Path

    from apd_viewer.geometry.mesh.mesh import Mesh
    from apd_viewer.session.model.document import Document

TEXT = "session.json"  # member with all that is said in words
_OF_TARGET = "target-"  # members of the target shape begin with it


def mesh_said(
    mesh: Mesh, session: Path, embed: bool, prefix: str = ""
) -> tuple[dict[str, Any], dict[str, bytes]]:
    """Place of a mesh, and the members of its copy, if there is to be one."""
    copy = copy_of(mesh, prefix) if embed or not is_there(mesh) else {}
    return {**whereabouts(mesh, session), "embedded": list(copy) or None}, copy


def target_said(
    document: Document, session: Path, embed: bool
) -> tuple[dict[str, Any] | None, dict[str, bytes]]:
    """Place and copy of the target shape; the old place if it is missing."""
    if document.target is not None:
        return mesh_said(document.target.mesh, session, embed, _OF_TARGET)
    missing = document.missing_target
    return None if missing is None else missing.told, {}


def keeps_mesh(path: Path, mesh: Mesh) -> bool:
    """True if the session at ``path`` has the mesh, or still finds it."""
    if is_there(mesh):
        return True
    try:
        with opened(path) as stream:
            archive = Archive(stream)
            said = Fields.of(archive.content(TEXT), TEXT).part("mesh")
            return said.says("embedded") or find_mesh(said, path, archive).digest == mesh.digest
    except (OSError, ValueError):
        return False


def with_target(document: Document, said: Fields, path: Path, archive: Archive) -> Document:
    """The document with its target shape, or with the reason why it is missing."""
    if not said.says("target"):
        return document
    told = said.part("target")
    try:
        target = TargetShape(find_mesh(told, path, archive, _OF_TARGET))
    except InputError as error:
        return replace(document, missing_target=MissingMesh(told.whole, str(error)))
    return replace(document, target=target)
