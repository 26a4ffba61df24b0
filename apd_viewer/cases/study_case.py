"""Study case: its inputs with their copies, and the key of its result."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from apd_viewer.errors import InputError
from apd_viewer.files.meshes import check_readable
from apd_viewer.files.storage.atomic_file import make_folder, replacing_file
from apd_viewer.files.storage.regular_files import read_bytes, read_content
from apd_viewer.installation import program_version
from apd_viewer.language import tr
from apd_viewer.session.model.view import SESSION_SUFFIX
from apd_viewer.session.storage.session_file import open_session, save_session

# Version of the computation and its stored results; incremented to invalidate earlier results.
RESULTS_VERSION = 3
_FOLDER = 16  # characters of the digest in the folder name

CaseSetting = float | int | bool | str
# The buffers of a .gltf file may be in separate files, which would not be copied with it.
_IN_PARTS = ".gltf"


@dataclass(frozen=True)
class InputFile:
    """Input file of a case, identified by its content.

    Attributes
    ----------
    digest : str
        SHA-256 of its bytes, hexadecimal.
    suffix : str
        In lower case, with its dot.
    path : Path
        Copy of it, of the same name in a folder named by its content; perhaps not to be seen from other
        machines.
    """

    digest: str
    suffix: str
    path: Path

    @property
    def to_json(self) -> dict[str, str]:
        """Digest and file name for JSON."""
        return {"digest": self.digest, "name": self.path.name}

    @classmethod
    def from_json(cls, fields: dict[str, str], inputs: Path) -> InputFile:
        """Input file from its JSON fields, with its copy in the folder ``inputs``.

        Raises ValueError for a path outside that folder.
        """
        if not fields["digest"].isalnum() or Path(fields["name"]).name != fields["name"]:
            raise ValueError
        path = input_path(inputs, fields["digest"], fields["name"])
        return cls(fields["digest"], path.suffix.lower(), path)


@dataclass(frozen=True)
class StudyCase:
    """Inputs of one deformation.

    Attributes
    ----------
    mesh : InputFile
        A mesh, or a session with its mesh in it.
    selection : InputFile or None
        Painted vertices; None in a session.
    motion : tuple of str
        Steps in words, each written in one way only; none for the motion of a session.
    unit : str
        Unit of the mesh; empty if unknown, or stored in a session.
    settings : tuple of (str, setting)
        What differs from what is usual, or from the session, by name. Of a mesh always ``contact``, too: yes,
        no, or the number of vertices up to which.
    """

    mesh: InputFile
    selection: InputFile | None
    motion: tuple[str, ...]
    unit: str
    steps: int
    settings: tuple[tuple[str, CaseSetting], ...] = ()

    @cached_property
    def key(self) -> str:
        """Key of the result: a digest of all inputs and of the program version."""
        said = {
            "results": RESULTS_VERSION,
            "program": program_version(),
            "mesh": [self.mesh.digest, self.mesh.suffix],
            "selection": self.selection and [self.selection.digest, self.selection.suffix],
            "motion": self.motion,
            "unit": self.unit,
            "steps": self.steps,
            "settings": sorted(self.settings),
        }
        return hashlib.sha256(json.dumps(said).encode()).hexdigest()[:32]

    @property
    def contact_by_default(self) -> bool:
        """True if the plan leaves contact to the default by vertex count."""
        return not isinstance(dict(self.settings).get("contact", False), bool)

    @property
    def input_files(self) -> tuple[InputFile, ...]:
        """Input files of the case."""
        return (self.mesh,) if self.selection is None else (self.mesh, self.selection)

    @property
    def to_json(self) -> dict[str, Any]:
        """All inputs for JSON."""
        return {
            "mesh": self.mesh.to_json,
            "selection": self.selection and self.selection.to_json,
            "motion": list(self.motion),
            "unit": self.unit,
            "steps": self.steps,
            "settings": dict(self.settings),
        }

    @classmethod
    def from_json(cls, fields: dict[str, Any], inputs: Path) -> StudyCase:
        """Case from its JSON fields, with its files in the folder ``inputs``.

        Raises
        ------
        ValueError, TypeError, KeyError, AttributeError
            If it says something else.
        """
        selection = fields["selection"] and InputFile.from_json(fields["selection"], inputs)
        mesh, settings = InputFile.from_json(fields["mesh"], inputs), tuple(fields["settings"].items())
        return cls(mesh, selection, tuple(fields["motion"]), fields["unit"], fields["steps"], settings)


def input_path(inputs: Path, digest: str, name: str) -> Path:
    """Path of an input file's copy in the folder ``inputs``."""
    return inputs / digest[:_FOLDER] / name


class InputFiles:
    """Copies of meshes, selections and sessions, each made once, renewed if damaged.

    A study thus keeps its inputs if the original files change, and its folder can be moved.

    Parameters
    ----------
    folder : Path
        Folder of the copies, created with the first one.
    keeps_copies : bool
        Whether copies are made; without, files are only read.
    """

    def __init__(self, folder: Path, keeps_copies: bool = True) -> None:
        self._folder, self._keep = folder, keeps_copies
        self._known: dict[tuple[str, Path], InputFile | str] = {}

    def mesh(self, path: Path) -> InputFile:
        """Copy of a mesh or session file; raises InputError."""
        return self._find("mesh", path, self._read_mesh)

    def selection(self, path: Path) -> InputFile:
        """Copy of a selection file; raises InputError."""
        return self._find("selection", path, lambda there: self._copy(read_content(there), there))

    def _find(self, kind: str, path: Path, read: Callable[[Path], InputFile]) -> InputFile:
        key = kind, path
        if key not in self._known:
            try:
                self._known[key] = read(path)
            except InputError as error:
                self._known[key] = str(error)
        found = self._known[key]
        if isinstance(found, str):
            raise InputError(found)
        return found

    def _read_mesh(self, path: Path) -> InputFile:
        check_readable(path, (SESSION_SUFFIX,))
        suffix = path.suffix.lower()
        if suffix == _IN_PARTS:
            raise InputError(
                tr("{name} may have parts in other files; save it as .glb.").format(name=path.name)
            )
        content = read_content(path)
        if suffix != SESSION_SUFFIX:
            return self._copy(content, path)
        source = self._source(content, path)
        if not _can_be_opened(source.path):
            # Saved with its mesh embedded, as the session may refer to a file elsewhere.
            state, view = open_session(path)
            if self._keep:
                make_folder(source.path.parent)
                save_session(source.path, state, view, embed=True)
        return source

    def _copy(self, content: bytes, path: Path) -> InputFile:
        source = self._source(content, path)
        if self._keep and not (source.path.is_file() and read_bytes(source.path) == content):
            make_folder(source.path.parent)
            with replacing_file(source.path) as scratch:
                scratch.write_bytes(content)
        return source

    def _source(self, content: bytes, path: Path) -> InputFile:
        digest = hashlib.sha256(content).hexdigest()
        return InputFile(digest, path.suffix.lower(), input_path(self._folder, digest, path.name))


def _can_be_opened(path: Path) -> bool:
    """True if a session file exists and can be opened."""
    try:
        return bool(open_session(path))
    except InputError:
        return False
