"""Text for a report of a defect: versions, OpenGL, the end of the log, the last crash."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

from apd_viewer import log
from apd_viewer.redaction import redacted

_LINES = 100  # of the log


def diagnostics(opengl: str) -> str:
    """Return all that helps to find a defect, without a folder of the user and without a mesh.

    Parameters
    ----------
    opengl : str
        Vendor, renderer and version of the OpenGL in use.
    """
    parts = {
        "Versions": [*log.versions(), f"OpenGL {opengl}"],
        "Log": _last_lines(),
        "Last crash": _last_crash(),
    }
    return "\n\n".join("\n".join([f"{title}:", *(lines or ["none"])]) for title, lines in parts.items())


def _last_lines() -> list[str]:
    """End of the log of this process; empty where none is written."""
    file = log.current_file()
    return [] if file is None else _lines(file)[-_LINES:]


def _last_crash() -> list[str]:
    """The last crash of any process, after the name of its file; empty if none is kept."""
    for path in sorted(log.folder().glob("*.crash"), reverse=True):  # named by their time
        if lines := _lines(path):
            return [path.name, *lines]
    return []


def _lines(path: Path) -> list[str]:
    with suppress(OSError):
        return redacted(path.read_text(encoding="utf-8", errors="replace")).splitlines()
    return []
