"""The mesh and the target shape of a session: their places and copies."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from apd_viewer.errors import InputError
from apd_viewer.files.mesh_location import (
    MissingMesh,
    find_mesh,
    is_mesh_in_file,
    mesh_location_to_json,
    mesh_members,
)
from apd_viewer.files.storage.archive import Archive
from apd_viewer.files.storage.json_fields import JsonFields
from apd_viewer.files.storage.regular_files import open_regular
from apd_viewer.geometry.analysis.target_shape import TargetShape
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.model.document import Document

JSON_MEMBER = "session.json"  # member with all that is said in words
_OF_TARGET = "target-"  # members of the target shape begin with it


def mesh_to_json(
    mesh: Mesh, session: Path, embed: bool, prefix: str = ""
) -> tuple[dict[str, Any], dict[str, bytes]]:
    """Place of a mesh, and the members of its copy, if there is to be one."""
    copy = mesh_members(mesh, prefix) if embed or not is_mesh_in_file(mesh) else {}
    return {**mesh_location_to_json(mesh, session), "embedded": list(copy) or None}, copy


def target_to_json(
    document: Document, session: Path, embed: bool
) -> tuple[dict[str, Any] | None, dict[str, bytes]]:
    """Place and copy of the target shape; the old place if it is missing."""
    if document.target_shape is not None:
        return mesh_to_json(document.target_shape.mesh, session, embed, _OF_TARGET)
    missing = document.missing_target_shape
    return None if missing is None else missing.description, {}


def has_mesh(path: Path, mesh: Mesh) -> bool:
    """True if the session at ``path`` has the mesh, or still finds it."""
    if is_mesh_in_file(mesh):
        return True
    try:
        with open_regular(path) as stream:
            archive = Archive(stream)
            said = JsonFields.parse(archive.content(JSON_MEMBER), JSON_MEMBER).nested_fields("mesh")
            return said.has_value("embedded") or find_mesh(said, path, archive).digest == mesh.digest
    except (OSError, ValueError):
        return False


def with_target(document: Document, fields: JsonFields, path: Path, archive: Archive) -> Document:
    """The document with its target shape, or with the reason why it is missing."""
    if not fields.has_value("target"):
        return document
    told = fields.nested_fields("target")
    try:
        target = TargetShape(find_mesh(told, path, archive, _OF_TARGET))
    except InputError as error:
        return replace(document, missing_target_shape=MissingMesh(told.raw, str(error)))
    return replace(document, target_shape=target)
