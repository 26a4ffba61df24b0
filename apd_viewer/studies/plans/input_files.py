"""Files needed by cases, kept in the folder of the study."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path

from apd_viewer.errors import InputError
from apd_viewer.files.meshes import check_readable
from apd_viewer.files.storage.atomic_file import make_folder, replacing_file
from apd_viewer.files.storage.regular_files import read_bytes, read_content
from apd_viewer.language import tr
from apd_viewer.session.model.view import SESSION_SUFFIX
from apd_viewer.session.storage.session_file import open_session, save_session
from apd_viewer.studies.plans.case import InputFile, input_path

# Its buffers may be in files beside it, which do not travel with it.
_IN_PARTS = ".gltf"


class InputFiles:
    """Copies of meshes, selections and sessions, each made once, and again if damaged.

    A study goes on with what it began with where a file is changed meanwhile, and can be taken elsewhere.

    Parameters
    ----------
    folder : Path
        For the copies; made when the first is.
    keeps_copies : bool
        Whether copies are made; without, files are only read.
    """

    def __init__(self, folder: Path, keeps_copies: bool = True) -> None:
        self._folder, self._keep = folder, keeps_copies
        self._known: dict[tuple[str, Path], InputFile | str] = {}

    def mesh(self, path: Path) -> InputFile:
        """A mesh or a session; raises InputError."""
        return self._once("mesh", path, self._read_mesh)

    def selection(self, path: Path) -> InputFile:
        """Read a selection file once; raises InputError."""
        return self._once("selection", path, lambda there: self._kept(read_content(there), there))

    def _once(self, kind: str, path: Path, read: Callable[[Path], InputFile]) -> InputFile:
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
            return self._kept(content, path)
        source = self._source(content, path)
        if not _opens(source.path):
            # With its mesh in it, which may be elsewhere.
            state, view = open_session(path)
            if self._keep:
                make_folder(source.path.parent)
                save_session(source.path, state, view, embed=True)
        return source

    def _kept(self, content: bytes, path: Path) -> InputFile:
        source = self._source(content, path)
        if self._keep and not (source.path.is_file() and read_bytes(source.path) == content):
            make_folder(source.path.parent)
            with replacing_file(source.path) as scratch:
                scratch.write_bytes(content)
        return source

    def _source(self, content: bytes, path: Path) -> InputFile:
        digest = hashlib.sha256(content).hexdigest()
        return InputFile(digest, path.suffix.lower(), input_path(self._folder, digest, path.name))


def _opens(path: Path) -> bool:
    """True if a session is there and whole."""
    try:
        return bool(open_session(path))
    except InputError:
        return False
