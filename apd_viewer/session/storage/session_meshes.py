"""Locations and copies of the mesh and the target shape of a session."""

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

JSON_MEMBER = "session.json"  # archive member with everything except arrays
_OF_TARGET = "target-"  # prefix of the archive members of the target shape


def mesh_to_json(
    mesh: Mesh, session: Path, embed: bool, prefix: str = ""
) -> tuple[dict[str, Any], dict[str, bytes]]:
    """JSON location of a mesh, and the archive members of its copy, if any."""
    copy = mesh_members(mesh, prefix) if embed or not is_mesh_in_file(mesh) else {}
    return {**mesh_location_to_json(mesh, session), "embedded": list(copy) or None}, copy


def target_to_json(
    document: Document, session: Path, embed: bool
) -> tuple[dict[str, Any] | None, dict[str, bytes]]:
    """Location and copy of the target shape; the old location if it is missing."""
    if document.target_shape is not None:
        return mesh_to_json(document.target_shape.mesh, session, embed, _OF_TARGET)
    missing = document.missing_target_shape
    return None if missing is None else missing.description, {}


def has_mesh(path: Path, mesh: Mesh) -> bool:
    """True if the session at ``path`` contains the mesh, or still finds it."""
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
    """Document with its target shape, or with the reason for a missing one."""
    if not fields.has_value("target"):
        return document
    told = fields.nested_fields("target")
    try:
        target = TargetShape(find_mesh(told, path, archive, _OF_TARGET))
    except InputError as error:
        return replace(document, missing_target_shape=MissingMesh(told.raw, str(error)))
    return replace(document, target_shape=target)
