"""Sessions saved again to files changed by others meanwhile."""

from __future__ import annotations

from pathlib import Path

from apd_viewer.errors import InputError
from apd_viewer.files.known_file import FileState, KnownFile
from apd_viewer.language import tr
from apd_viewer.session.model.state import State
from apd_viewer.session.model.view import View
from apd_viewer.session.storage.session_file import save_session


class ChangedFileError(InputError):
    """Refusal to replace a file changed elsewhere.

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
    known: KnownFile | None, path: Path, state: State, view: View, embed: bool = False, picture: bytes = b""
) -> tuple[bool, KnownFile]:
    """Save a session, unless its file has changed.

    Looks before the work and once more right before the file is replaced. A file that has gone is written
    anew. ``known`` is None where anything may be replaced.

    Returns
    -------
    bool
        Whether there is a copy of the mesh in it.
    KnownFile
        The file as it was written.

    Raises
    ------
    FileChangedError
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
    embedded = save_session(path, state, view, embed, picture=picture, finish=finish)
    return embedded, written[0]
