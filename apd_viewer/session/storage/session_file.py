"""Session files: the document, its shape and the view.

A session is an archive of ``session.json`` and arrays. All versions up to the program's own can be opened;
newer ones may have unknown contents, and are refused.
"""

import json
import os
from collections.abc import Callable, Collection
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files import mesh_location
from apd_viewer.files.known_file import FileState, KnownFile
from apd_viewer.files.mesh_location import MissingMesh
from apd_viewer.files.storage.archive import Archive, npy_content, write_archive
from apd_viewer.files.storage.json_fields import JsonFields
from apd_viewer.files.storage.regular_files import open_regular_file, read_content
from apd_viewer.geometry.analysis.target_shape import TargetShape
from apd_viewer.geometry.energy.wall_map import WallMap
from apd_viewer.geometry.mesh.arrays import diagonal
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.installation import program_version
from apd_viewer.language import tr
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.state import State, initial_state
from apd_viewer.session.model.timeline import NO_TIMELINE, OpenedFile, Timeline
from apd_viewer.session.model.view import SESSION_SUFFIX, View
from apd_viewer.session.quantities.wall_distribution import WallDistribution
from apd_viewer.session.storage import session_json
from apd_viewer.session.storage.session_picture import PICTURE_MEMBER, explaining_errors
from apd_viewer.session.storage.timeline_json import ArrayReader, timeline_from_json, timeline_to_json

SESSION_FORMAT, SESSION_VERSION = "apd-session", 1
_CODES, _POSITIONS = ("labels", "member"), ("grip", "shape")
_WELD = "weld"  # array of the vertex to which each vertex is welded, if seams were welded
_IMAGE_MEMBER, _IMAGED = "region-image", "imaged"  # file of the image on a region, and array of its vertices
# Means of wall maps, and arrays of their triangles; what may be beside the thickness, by its name.
_MEANS, _MAP = "thicknesses", "thickness"
_BESIDE = {"moduli": "young", "yield_radii": "yield_radius"}
_MOST_MAPS = 1000
_MOST_ARRAYS = 4 * _MOST_MAPS  # earlier versions listed those of the maps, too
# Farthest valid positions, in bounding-box diagonals of the mesh.
_FARTHEST = 1e8


def save_session(
    path: str | Path,
    state: State,
    view: View,
    embed: bool = False,
    is_urgent: bool = False,
    picture: bytes = b"",
    finish: Callable[[Path], object] = lambda _: None,
    timeline: Timeline = NO_TIMELINE,
) -> bool:
    """Write a session to a file atomically.

    Parameters
    ----------
    path : path
        Ends in ``.apd``.
    embed : bool
        Whether to put copies of the mesh and of the target shape into it. There is one in any case where no
        file holds them.
    is_urgent : bool
        Whether it is wanted in a moment, and may be larger; see
        :func:`apd_viewer.files.storage.archive.write_archive`.
    picture : bytes
        A PNG file that shows the session in a file manager; empty for none.
    finish : callable
        Called last, see :func:`apd_viewer.files.storage.atomic_file.replacing_file`.
    timeline : Timeline
        What is kept of it, see :func:`apd_viewer.session.storage.timeline_json.saved_timeline`.

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
    if path.suffix.lower() != SESSION_SUFFIX:
        raise InputError(
            tr("{name} does not have the ending of a session; use {ending}.").format(
                name=path.name, ending=SESSION_SUFFIX
            )
        )
    document, mesh = state.document, state.document.mesh
    told, copy = mesh_to_json(mesh, path, embed)
    target, copy_of_target = target_to_json(document, path, embed)
    arrays = {"labels": document.labels, "member": document.member}
    if mesh.has_welded_seams:
        arrays[_WELD] = mesh.weld.representative
    positions = {"grip": document.initial_positions, "shape": state.frame.U}
    # Rest positions are left out: they are restored from the mesh.
    arrays |= {name: X for name, X in positions.items() if X is not mesh.V}
    if view.image is not None:
        arrays[_IMAGED] = view.image.inside.astype(np.uint8)
    maps = _used_maps(state, view, timeline)
    means_beside, arrays_of_maps = _stored_maps(maps)
    steps, arrays_of_steps = timeline_to_json(timeline, state) if timeline.steps else (None, {})
    said = {
        "format": SESSION_FORMAT,
        "version": SESSION_VERSION,
        "program": program_version(),
        "mesh": told,
        **({"target": target} if target else {}),
        "arrays": list(arrays),
        **({_MEANS: list(map(float, maps)), **means_beside} if maps else {}),
        "document": session_json.document_to_json(document),
        "frame": session_json.frame_to_json(state.frame, len(document.obstacles)),
        "view": session_json.view_to_json(view),
        **({"timeline": steps} if steps else {}),
    }
    text = json.dumps(said, indent=1, allow_nan=False).encode()
    arrays_of_all = arrays | arrays_of_maps | arrays_of_steps
    members = {f"{name}.npy": npy_content(array) for name, array in arrays_of_all.items()}
    members |= {**copy, **copy_of_target, **({PICTURE_MEMBER: picture} if picture else {})}
    members |= {_IMAGE_MEMBER: view.image.content} if view.image is not None else {}
    write_archive(path, {JSON_MEMBER: text, **members}, is_urgent, finish)
    return bool(copy)


def open_session(path: str | Path) -> tuple[State, View]:
    """Open a session: the saved state, bit for bit, and its view.

    The mesh is searched at its absolute path, at its path relative to the session, beside the session, and
    then inside it; likewise the target shape, which may be missing.

    Raises
    ------
    InputError
        If there is no such file, it is no session, or its mesh is missing or another one.
    """
    found = _opened(Path(path), with_timeline=False)
    return found.state, found.view or View()


def open_session_file(path: Path) -> OpenedFile:
    """Open a session as :func:`open_session` does, with its timeline."""
    return _opened(path, with_timeline=True)


def _opened(path: Path, with_timeline: bool) -> OpenedFile:
    with explaining_errors(path):
        archive = Archive(_content(path))
        said = JsonFields.parse(archive.content(JSON_MEMBER), JSON_MEMBER)
        _check_version(said, path)
        mesh = _welded_mesh(mesh_location.find_mesh(said.nested_fields("mesh"), path, archive), said, archive)
        state, arrays = initial_state(mesh), _arrays(said, archive, mesh)
        maps = _maps(said, archive, len(mesh.F))
        document = session_json.document_from_json(said.nested_fields("document"), mesh, arrays, maps)
        document = with_target(document, said, path, archive)
        if document.settings.volume is not None and not state.inspection.volume:
            raise ValueError(tr("its “volume” is damaged"))
        state = replace(state, document=document)
        frame = session_json.frame_from_json(said.nested_fields("frame"), state, arrays["shape"])
        state, timeline = replace(state, frame=frame), NO_TIMELINE
        if with_timeline and said.has_value("timeline"):
            read = _array_reader(archive, state)
            timeline, state = timeline_from_json(said.nested_fields("timeline"), state, read, maps)
        return OpenedFile(state, _view(said.nested_fields("view"), archive, len(mesh.V), maps), timeline)


def _view(fields: JsonFields, archive: Archive, n: int, maps: session_json.WallMaps) -> View:
    view = session_json.view_from_json(fields, maps)
    if not fields.has_value("image"):
        return view
    inside, content = archive.array(_IMAGED, "|u1", (n,)), archive.content(_IMAGE_MEMBER)
    return replace(view, image=session_json.image_from_json(fields.nested_fields("image"), content, inside))


def _used_maps(state: State, view: View, timeline: Timeline) -> list[WallMap]:
    """Wall maps of wall and settings, each once."""
    steps = (each for step in timeline.steps for each in (step.state, step.wall_result))
    used = [each.document.settings.wall_thickness for each in (state, *steps) if each is not None]
    if isinstance(view.wall.thickness, WallDistribution):
        used.append(view.wall.thickness.thickness)
    return list({each.digest: each for each in used if isinstance(each, WallMap)}.values())


def _stored_maps(maps: Collection[WallMap]) -> tuple[dict[str, list[float]], dict[str, np.ndarray]]:
    """Means of what is beside the thickness of wall maps, 0 for none, and all arrays."""
    arrays = {f"{_MAP}-{k}": each.triangles for k, each in enumerate(maps)}
    means: dict[str, list[float]] = {}
    for key, name in _BESIDE.items():
        found = {k: told for k, each in enumerate(maps) if (told := getattr(each, name)) is not None}
        arrays |= {f"{name}-{k}": each.triangles for k, each in found.items()}
        means |= {key: [float(found.get(k, 0.0)) for k in range(len(maps))]} if found else {}
    return means, arrays


def _maps(fields: JsonFields, archive: Archive, m: int) -> dict[str, WallMap]:
    """Wall maps of a session, by their digests; raises ValueError if damaged."""

    def read(mean: float, member: str, *beside: WallMap | None) -> WallMap:
        triangles = archive.array(member, "<f8", (m,))
        if not (mean > 0.0 and (triangles > 0.0).all() and np.isfinite(triangles).all()):
            raise ValueError(tr("its “wall” is damaged"))
        return WallMap(mean, triangles, *beside)

    means = [float(mean) for mean in fields.arrays(_MEANS, _MOST_MAPS)]
    beside: list[list[WallMap | None]] = [[] for _ in means]
    for key, name in _BESIDE.items():
        told = dict(enumerate(map(float, fields.arrays(key, len(means)))))
        for k, each in enumerate(beside):
            each.append(read(told[k], f"{name}-{k}") if told.get(k) else None)
    found = [read(mean, f"{_MAP}-{k}", *beside[k]) for k, mean in enumerate(means)]
    return {each.digest: each for each in found}


def _content(path: Path) -> bytes:
    # os.path: Path raises on names that are too long.
    if not os.path.exists(path):  # noqa: PTH110
        raise InputError(tr("There is no file {path}; check the name.").format(path=path))
    if not path.is_file():
        raise InputError(tr("{path} is not a file; choose a session file.").format(path=path))
    return read_content(path)


def _check_version(fields: JsonFields, path: Path) -> None:
    if fields.text("format") != SESSION_FORMAT:
        raise ValueError(tr("it is another type of file"))
    version = fields.count("version")
    if version > SESSION_VERSION:
        raise InputError(
            tr("{name} was saved by a newer version of the program; update apd-viewer to open it.").format(
                name=path.name
            )
        )
    if version < 1:
        raise ValueError(tr("its “version” is damaged"))


def _welded_mesh(mesh: Mesh, fields: JsonFields, archive: Archive) -> Mesh:
    """Mesh with its seams welded as in the session."""
    if _WELD not in fields.texts("arrays", _MOST_ARRAYS):
        return mesh
    n = len(mesh.V)
    to = archive.array(_WELD, "<i8", (n,))
    if to.min() < 0 or (to > np.arange(n)).any() or (to[to] != to).any():
        raise ValueError(tr("“{name}” in it refers to a vertex that does not exist").format(name=_WELD))
    return mesh.welded_to(to)


def _arrays(fields: JsonFields, archive: Archive, mesh: Mesh) -> dict[str, np.ndarray]:
    """Labels, regions and positions of all vertices, by array name."""
    there, n = fields.texts("arrays", _MOST_ARRAYS), len(mesh.V)
    arrays = {name: archive.array(name, "|u1", (n,)) for name in _CODES}
    for name in _POSITIONS:
        arrays[name] = archive.array(name, "<f8", (n, 3)) if name in there else mesh.V
        _check_shape(arrays[name], mesh, name)
    return arrays


def _check_shape(X: np.ndarray, mesh: Mesh, name: str) -> None:
    farthest = _FARTHEST * diagonal(mesh.V)
    if not np.isfinite(X).all() or (np.abs(X - mesh.V) > farthest).any():
        raise ValueError(tr("“{name}” in it is not a shape of the mesh").format(name=name))


def _array_reader(archive: Archive, state: State) -> ArrayReader:
    """Reader of the arrays of a timeline; each is read once."""
    mesh, document = state.document.mesh, state.document
    own = {
        "labels": document.labels,
        "grip": document.initial_positions,
        "shape": state.frame.U,
        "rest": mesh.V,
    }
    known = {(name, "|u1" if name == "labels" else "<f8"): array for name, array in own.items()}

    def read(name: str, kind: str) -> np.ndarray:
        if (name, kind) not in known:
            n = len(mesh.V)
            found = archive.array(name, kind, (n,) if kind == "|u1" else (n, 3))
            if kind != "|u1":
                _check_shape(found, mesh, name)
            known[name, kind] = found
        return known[name, kind]

    return read


class ChangedFileError(InputError):
    """Error for a file changed elsewhere and therefore not replaced.

    Attributes
    ----------
    current_file : KnownFile
        The file as it was found, to be replaced by whoever agrees.
    """

    def __init__(self, path: Path) -> None:
        super().__init__(
            tr(
                "{name} was not saved: it has been changed elsewhere since it was opened or saved here. "
                "Save under another name, or open it again."
            ).format(name=path.name)
        )
        self.current_file = KnownFile(path)


def save_if_unchanged(
    known: KnownFile | None,
    path: Path,
    state: State,
    view: View,
    embed: bool = False,
    picture: bytes = b"",
    timeline: Timeline = NO_TIMELINE,
) -> tuple[bool, KnownFile]:
    """Save a session unless its file has been changed elsewhere.

    Checks before the work and again just before replacing the file. A missing file is written again.
    ``known`` is None if any file may be replaced.

    Returns
    -------
    bool
        Whether there is a copy of the mesh in it.
    KnownFile
        The file as it was written.

    Raises
    ------
    ChangedFileError
        If the file holds something else.
    InputError
        If the file cannot be written.
    """
    written: list[KnownFile] = []

    def check() -> None:
        if known is not None and known.check_content() is FileState.CHANGED:
            raise ChangedFileError(path)

    def finish(scratch: Path) -> None:
        written.append(KnownFile(path, scratch))
        check()

    check()
    embedded = save_session(path, state, view, embed, picture=picture, finish=finish, timeline=timeline)
    return embedded, written[0]


JSON_MEMBER = "session.json"  # archive member with everything except arrays
_OF_TARGET = "target-"  # prefix of the archive members of the target shape


def mesh_to_json(
    mesh: Mesh, session: Path, embed: bool, prefix: str = ""
) -> tuple[dict[str, Any], dict[str, bytes]]:
    """JSON location of a mesh, and the archive members of its copy, if any."""
    copy = (
        mesh_location.mesh_members(mesh, prefix) if embed or not mesh_location.is_mesh_in_file(mesh) else {}
    )
    return {**mesh_location.mesh_location_to_json(mesh, session), "embedded": list(copy) or None}, copy


def target_to_json(
    document: Document, session: Path, embed: bool
) -> tuple[dict[str, Any] | None, dict[str, bytes]]:
    """Location and copy of the target shape; the old location if it is missing."""
    if document.target_shape is not None:
        return mesh_to_json(document.target_shape.mesh, session, embed, _OF_TARGET)
    missing = document.missing_target_shape
    return None if missing is None else missing.description, {}


def has_mesh(path: Path, mesh: Mesh) -> bool:
    """True if the session at ``path`` contains the mesh, or finds its file unchanged."""
    if mesh_location.is_mesh_in_file(mesh):
        return True
    try:
        with open_regular_file(path) as stream:
            archive = Archive(stream)
            said = JsonFields.parse(archive.content(JSON_MEMBER), JSON_MEMBER).nested_fields("mesh")
            return (
                said.has_value("embedded")
                or mesh_location.find_mesh(said, path, archive).digest == mesh.digest
            )
    except (OSError, ValueError):
        return False


def with_target(document: Document, fields: JsonFields, path: Path, archive: Archive) -> Document:
    """Document with its target shape, or with the reason for a missing one."""
    if not fields.has_value("target"):
        return document
    told = fields.nested_fields("target")
    try:
        target = TargetShape(mesh_location.find_mesh(told, path, archive, _OF_TARGET))
    except InputError as error:
        return replace(document, missing_target_shape=MissingMesh(told.raw_object, str(error)))
    return replace(document, target_shape=target)
