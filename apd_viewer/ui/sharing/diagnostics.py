"""Diagnostics for bug reports: versions, OpenGL, log, last crash."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

from apd_viewer import log
from apd_viewer.files.storage.regular_files import read_bytes
from apd_viewer.redaction import redacted_text

_LINES = 100  # of the log


def diagnostics(opengl: str) -> str:
    """Diagnostics as text, without the user's folders and meshes.

    Parameters
    ----------
    opengl : str
        Vendor, renderer and version of the OpenGL in use.
    """
    parts = {
        "Versions": [*log.version_lines(), f"OpenGL {opengl}"],
        "Log": _last_lines(),
        "Last crash": _last_crash(),
    }
    return "\n\n".join("\n".join([f"{title}:", *(lines or ["none"])]) for title, lines in parts.items())


def _last_lines() -> list[str]:
    """End of this process's log; empty if there is none."""
    file = log.current_file()
    return [] if file is None else _lines(file)[-_LINES:]


def _last_crash() -> list[str]:
    """Last crash of any process, after its file name; empty if none."""
    for path in sorted(log.log_folder().glob("*.crash"), reverse=True):  # named by their time
        if lines := _lines(path):
            return [path.name, *lines]
    return []


def _lines(path: Path) -> list[str]:
    with suppress(OSError):
        return redacted_text(read_bytes(path).decode(errors="replace")).splitlines()
    return []
