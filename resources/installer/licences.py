"""Licences of the libraries in the self-contained program."""

from __future__ import annotations

import re
import sys
from importlib import metadata
from pathlib import Path

_TEXT = re.compile(r"licen[cs]e|copying|notice|authors", re.IGNORECASE)
_RULE = "=" * 80
_INTRODUCTION = """\
APD Viewer is under the MIT licence. It comes with Python and the libraries below, each under its own licence.
Qt and PySide6 are used under the LGPL version 3; their sources are at https://download.qt.io, and their
libraries, which are files of their own here, may be replaced."""


def libraries() -> list[metadata.Distribution]:
    """The program's requirements, and theirs, on this system; by name."""
    # Here: it is there where PyInstaller is.
    from packaging.requirements import Requirement

    found: dict[str, metadata.Distribution] = {}
    waiting = ["apd-viewer", "imageio-ffmpeg"]
    while waiting:
        name = re.sub(r"[-_.]+", "-", waiting.pop()).lower()
        if name in found:
            continue
        try:
            found[name] = metadata.distribution(name)
        except metadata.PackageNotFoundError:
            continue
        for line in found[name].requires or ():
            requirement = Requirement(line)
            if requirement.marker is None or requirement.marker.evaluate({"extra": ""}):
                waiting.append(requirement.name)
    del found["apd-viewer"]
    return [found[name] for name in sorted(found)]


def licence(library: metadata.Distribution) -> str:
    """Short name of its licence: as it says, or the title of its text."""
    said = library.metadata
    classes = [line for line in said.get_all("Classifier") or () if line.startswith("License ::")]
    named = "; ".join(line.split(" :: ")[-1] for line in classes)
    title = next((text.strip() for text in texts(library)), "see its text")
    return said.get("License-Expression") or named or (said.get("License") or title).split("\n")[0]


def texts(library: metadata.Distribution) -> list[str]:
    """Texts of its licences, as it carries them."""
    files = [file for file in library.files or () if ".dist-info/" in str(file) and _TEXT.search(file.name)]
    return [Path(file.locate()).read_text(encoding="utf-8", errors="replace") for file in files]


def write(path: Path) -> None:
    """Write the licences of Python and of all libraries into one file."""
    parts = [_INTRODUCTION, f"{_RULE}\nPython {sys.version.split()[0]} (PSF-2.0)\n{_RULE}\n{_python()}"]
    for library in libraries():
        title = f"{library.metadata['Name']} {library.version} ({licence(library)})"
        parts.append("\n".join([_RULE, title, _RULE, *texts(library)]))
    path.write_text("\n\n".join(parts) + "\n", encoding="utf-8")


def _python() -> str:
    folder = Path(sys.base_prefix)
    for place in (folder / "LICENSE.txt", Path(metadata.__file__).parents[1] / "LICENSE.txt"):
        if place.is_file():
            return place.read_text(encoding="utf-8")
    return "See https://docs.python.org/3/license.html."
