"""Case of a study: its inputs, and the key of its result."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from functools import cache
from importlib import metadata
from pathlib import Path

# Of what is computed and how it is stored: raised when results of earlier versions no longer count.
RESULTS_VERSION = 1

Setting = float | int | bool | str


@dataclass(frozen=True)
class Source:
    """File needed by a case, known by its content.

    Attributes
    ----------
    digest : str
        SHA-256 of its bytes, hexadecimal.
    suffix : str
        In lower case, with its dot.
    path : Path
        Copy of it, named by its content; perhaps not to be seen from other machines.
    """

    digest: str
    suffix: str
    path: Path


@dataclass(frozen=True)
class StudyCase:
    """Inputs of one deformation.

    Attributes
    ----------
    mesh : Source
        A mesh, or a session with its mesh in it.
    selection : Source or None
        What is painted; None in a session.
    motion : tuple of str
        Steps in words, each written in one way only; none for the motion of a session.
    unit : str
        Of the mesh; empty where that is not known, or a session says it.
    steps : int
    settings : tuple of (str, setting)
        What differs from what is usual, or from the session, by name.
    """

    mesh: Source
    selection: Source | None
    motion: tuple[str, ...]
    unit: str
    steps: int
    settings: tuple[tuple[str, Setting], ...] = ()

    @property
    def key(self) -> str:
        """Name of its result: a digest of all its inputs and of the program's version."""
        said = {
            "results": RESULTS_VERSION,
            "program": _program(),
            "mesh": [self.mesh.digest, self.mesh.suffix],
            "selection": self.selection and [self.selection.digest, self.selection.suffix],
            "motion": self.motion,
            "unit": self.unit,
            "steps": self.steps,
            "settings": sorted(self.settings),
        }
        return hashlib.sha256(json.dumps(said).encode()).hexdigest()[:32]

    @property
    def sources(self) -> tuple[Source, ...]:
        """Files needed by it."""
        return (self.mesh,) if self.selection is None else (self.mesh, self.selection)


@cache
def _program() -> str:
    try:
        return metadata.version("apd-viewer")
    except metadata.PackageNotFoundError:
        return "unknown"
