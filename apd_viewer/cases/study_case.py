"""Case of a study: its inputs, and the key of its result."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from functools import cache, cached_property
from importlib import metadata
from pathlib import Path
from typing import Any

# Of what is computed and how it is stored: raised when results of earlier versions no longer count.
RESULTS_VERSION = 2
_FOLDER = 16  # characters of a digest that name a folder

CaseSetting = float | int | bool | str


@dataclass(frozen=True)
class InputFile:
    """File needed by a case, known by its content.

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
        """Its digest and its name, for JSON."""
        return {"digest": self.digest, "name": self.path.name}

    @classmethod
    def from_json(cls, fields: dict[str, str], inputs: Path) -> InputFile:
        """The source again, with its copy in a folder of inputs.

        Raises ValueError if that would be elsewhere.
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
        What is painted; None in a session.
    motion : tuple of str
        Steps in words, each written in one way only; none for the motion of a session.
    unit : str
        Of the mesh; empty where that is not known, or a session says it.
    steps : int
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
    def contact_by_default(self) -> bool:
        """True if the plan leaves contact to the default by vertex count."""
        return not isinstance(dict(self.settings).get("contact", False), bool)

    @property
    def input_files(self) -> tuple[InputFile, ...]:
        """Files needed by it."""
        return (self.mesh,) if self.selection is None else (self.mesh, self.selection)

    @property
    def to_json(self) -> dict[str, Any]:
        """All of it for JSON."""
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
        """The case again, with its files in a folder of inputs.

        Raises
        ------
        ValueError, TypeError, KeyError, AttributeError
            If it says something else.
        """
        selection = fields["selection"] and InputFile.from_json(fields["selection"], inputs)
        mesh, settings = InputFile.from_json(fields["mesh"], inputs), tuple(fields["settings"].items())
        return cls(mesh, selection, tuple(fields["motion"]), fields["unit"], fields["steps"], settings)


def input_path(inputs: Path, digest: str, name: str) -> Path:
    """Path of the copy of a file in a folder of inputs."""
    return inputs / digest[:_FOLDER] / name


@cache
def _program() -> str:
    try:
        return metadata.version("apd-viewer")
    except metadata.PackageNotFoundError:
        return "unknown"
