"""Location of a session's mesh, stored in the session and resolved on opening."""

import contextlib
import os
from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath, PureWindowsPath
from typing import Any
from weakref import WeakKeyDictionary

from apd_viewer.errors import InputError
from apd_viewer.files.known_file import file_stamp
from apd_viewer.files.mesh_formats import CAD_FORMATS, MESH_FORMATS
from apd_viewer.files.meshes import open_mesh, read_mesh
from apd_viewer.files.samples import SAMPLES, resource_path
from apd_viewer.files.storage.archive import Archive, npy_content
from apd_viewer.files.storage.json_fields import JsonFields
from apd_viewer.geometry.mesh.arrays import check_mesh, frozen
from apd_viewer.geometry.mesh.mesh import BakedOrigin, Mesh
from apd_viewer.language import tr

# Path of a mesh copy in an archive, without neighbouring files.
_NOWHERE = Path(os.devnull)
_ARRAYS = ("V", "F")
_REST = "rest.npy"  # array of rest positions, if different from those in the file
# File stamps of meshes when last verified; rereading a large file takes a second.
_found: WeakKeyDictionary[Mesh, tuple[int, ...] | None] = WeakKeyDictionary()


@dataclass(frozen=True, eq=False)
class MissingMesh:
    """Mesh of a session not found on disk.

    Attributes
    ----------
    description : dict
        Description by :func:`mesh_location_to_json`.
    reason : str
        Sentence for people.
    """

    description: dict[str, Any]
    reason: str


def mesh_location_to_json(mesh: Mesh, session: Path) -> dict[str, Any]:
    """JSON description of a mesh's location, relative to the session file."""
    fields = {"name": mesh.name, "vertices": len(mesh.V), "faces": len(mesh.F), "digest": mesh.digest}
    if mesh.path is None:
        return fields
    path, folder = os.path.abspath(mesh.path), os.path.abspath(session.parent)  # noqa: PTH100
    fields |= {"path": path, "sample": next((name for name in SAMPLES if _sample(name) == path), None)}
    with contextlib.suppress(ValueError):  # no relative path leads to another drive
        fields["relative"] = Path(os.path.relpath(path, folder)).as_posix()
    return fields


def _sample(name: str) -> str:
    return os.path.abspath(resource_path(f"{name}.obj"))  # noqa: PTH100


def is_mesh_in_file(mesh: Mesh) -> bool:
    """True if the mesh's file still contains it; reread only after a change."""
    if mesh.path is None or isinstance(mesh.origin, BakedOrigin):
        return False
    if mesh.path.suffix.lower() in CAD_FORMATS:  # another version of a library divides it otherwise
        return False
    stamp = file_stamp(mesh.path)
    # A .gltf may keep its arrays in another file.
    if stamp is None or (_found.get(mesh) == stamp and mesh.path.suffix.lower() != ".gltf"):
        return stamp is not None
    with contextlib.suppress(InputError):
        if open_mesh(mesh.path).digest == mesh.digest:
            _found[mesh] = stamp
            return True
    return False


def mesh_members(mesh: Mesh, prefix: str = "") -> dict[str, bytes]:
    """Archive members of a mesh: its file content or its arrays.

    Their names begin with ``prefix``, to distinguish several meshes in an archive.
    """
    return {f"{prefix}{name}": content for name, content in _members(mesh).items()}


def _members(mesh: Mesh) -> dict[str, bytes]:
    if isinstance(mesh.origin, BakedOrigin):
        return {**_members(mesh.origin.mesh), _REST: npy_content(mesh.V)}
    if mesh.origin is not None:
        name = f"mesh{mesh.origin.suffix}"
        # Some formats cannot be written, and a glTF file may need neighbouring files.
        with contextlib.suppress(ValueError):
            content = mesh.origin.rewritten_content(mesh, mesh.V)
            if read_mesh(_NOWHERE / name, content).digest == mesh.digest:
                return {name: content}
    return {"V.npy": npy_content(mesh.V), "F.npy": npy_content(mesh.F)}


def find_mesh(description: JsonFields, session: Path, archive: Archive, prefix: str = "") -> Mesh:
    """Find a mesh by its description: in its file or as a copy in the archive.

    Parameters
    ----------
    description : JsonFields
        Description by :func:`mesh_location_to_json`, with the members of a copy in "embedded".
    archive : Archive
        Read from there.
    prefix : str
        Of the members that hold the copy.

    Raises
    ------
    InputError
        If there is no such mesh any more; the message says where it was looked for.
    ValueError
        If what was written down is damaged.
    """
    name, digest = _file_name(description), description.text("digest")
    places, problems = _candidate_paths(description, session, name), []
    there = [path for path in places if os.path.isfile(path)]  # noqa: PTH113  # Path raises on long names
    for path in there:
        stamp = file_stamp(path)
        try:
            mesh = open_mesh(path)
        except InputError as error:
            problems.append(str(error))
            continue
        if mesh.digest == digest:
            _found[mesh] = stamp
            return mesh
        problems.append(_changed_mesh_sentence(mesh, description, session))
    if description.has_value("embedded"):
        return _embedded_mesh(description, there[0] if there else session.parent / name, archive, prefix)
    if problems:
        raise InputError(problems[0])
    looked = tr(" and ").join(str(path) for path in places)
    raise InputError(
        tr(
            "{name}, a mesh of {session}, is missing (looked for at {looked}); put it in the "
            "folder of the session."
        ).format(name=name, session=session.name, looked=looked)
    )


def _file_name(description: JsonFields) -> str:
    """File name of the mesh without folders, from a path of any operating system."""
    name = PureWindowsPath(PurePosixPath(description.text("name")).name).name
    if not name or "\0" in name:
        raise ValueError(tr("its “name” is damaged"))
    return name


def _candidate_paths(description: JsonFields, session: Path, name: str) -> list[Path]:
    """Candidate paths of the mesh's file."""
    folder = Path(os.path.abspath(session.parent))  # noqa: PTH100
    places = [Path(description.text("path"))] if description.has_value("path") else []
    if description.has_value("relative"):
        places.append(Path(os.path.normpath(folder / description.text("relative"))))
    places.append(folder / name)
    if description.has_value("sample") and description.text("sample") in SAMPLES:
        places.append(Path(_sample(description.text("sample"))))
    return list(dict.fromkeys(places))


def _changed_mesh_sentence(mesh: Mesh, description: JsonFields, session: Path) -> str:
    before = description.count("vertices")
    change = tr("it has been changed")
    if len(mesh.V) != before:
        change = tr("it has {n:,} vertices instead of {before:,}").format(n=len(mesh.V), before=before)
    return tr(
        "{path} is not the mesh that {session} was saved with ({change}); restore the original "
        "file there or in the folder of the session."
    ).format(path=mesh.path, session=session.name, change=change)


def _embedded_mesh(description: JsonFields, path: Path, archive: Archive, prefix: str) -> Mesh:
    """Mesh copied into the archive, with ``path`` as its nominal file."""
    members = [name.removeprefix(prefix) for name in description.texts("embedded", len(_ARRAYS) + 1)]
    rest = members[-1:] == [_REST]
    members = members[:-1] if rest else members
    try:
        if members == [f"{name}.npy" for name in _ARRAYS]:
            V, F = (
                archive.array(prefix + name, kind, (description.count(of), 3))
                for name, kind, of in (("V", "<f8", "vertices"), ("F", "<i8", "faces"))
            )
            mesh = Mesh(V, F, path if description.has_value("path") else None)
        elif len(members) == 1 and members[0] in [f"mesh{suffix}" for suffix in MESH_FORMATS]:
            mesh = replace(read_mesh(_NOWHERE / members[0], archive.content(prefix + members[0])), path=path)
        else:
            raise ValueError(tr("its “embedded” is damaged"))
        if rest:
            V = archive.array(f"{prefix}rest", "<f8", mesh.V.shape)
            check_mesh(V, mesh.F)
            mesh = mesh.baked(frozen(V))
    except InputError:
        raise ValueError(tr("its copy of the mesh is damaged")) from None
    if mesh.digest != description.text("digest"):
        raise ValueError(tr("its copy of the mesh is a different mesh"))
    return mesh
