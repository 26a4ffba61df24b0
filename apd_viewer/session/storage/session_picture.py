"""Picture stored in a session file, read without loading the session modules."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from apd_viewer.errors import InputError
from apd_viewer.files.storage.archive import Archive
from apd_viewer.files.storage.regular_files import open_regular_file
from apd_viewer.language import tr

PICTURE_MEMBER = "picture.png"
PICTURE_SIDE = 256  # largest side in pixels, as requested by file managers


def session_picture(path: Path) -> bytes | None:
    """PNG picture in a session file; None if there is none.

    Raises
    ------
    InputError
        If the file cannot be read, or is no session.
    """
    with explaining_errors(path), open_regular_file(path) as stream:
        archive = Archive(stream)
        return archive.content(PICTURE_MEMBER) if archive.has_member(PICTURE_MEMBER) else None


@contextmanager
def explaining_errors(path: Path) -> Iterator[None]:
    """Context converting read errors into InputErrors with a sentence."""
    try:
        yield
    except InputError:
        raise
    except (OSError, ValueError) as error:
        raise InputError(
            tr("{name} is not a valid session ({reason}); save it again or open another copy.").format(
                name=path.name, reason=getattr(error, "strerror", None) or error
            )
        ) from error
    except MemoryError as error:
        raise InputError(
            tr("{name} does not fit into memory; close other programs.").format(name=path.name)
        ) from error
