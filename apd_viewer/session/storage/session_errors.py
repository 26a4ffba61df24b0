"""Sentences on session files that cannot be read."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from apd_viewer.errors import InputError
from apd_viewer.language import tr


@contextmanager
def explaining_errors(path: Path) -> Iterator[None]:
    """Turn errors of reading into an InputError with a sentence."""
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
