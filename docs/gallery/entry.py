"""An entry of the gallery: its words, its files, the code that makes it, and its session."""

from __future__ import annotations

import contextlib
import io
import os
import shlex
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from gallery_states import state_after
from sample_files import bottle

from apd_viewer.__main__ import main
from apd_viewer.session.model.state import State
from apd_viewer.session.model.view import View
from apd_viewer.session.storage.session_file import save_session


@dataclass(frozen=True)
class Entry:
    """What the gallery shows of one deformation.

    Attributes
    ----------
    name : str
        Of its picture and its session.
    title, sentence : str
    code : str
        At most five lines: commands, or Python with ``np`` and ``apd_viewer`` at hand.
    files : callable
        ``files(folder, count)`` writes the files that it needs, meshes of about ``count`` vertices.
    as_command : str
        The same deformation as a command, where ``code`` is in Python; of several commands the last one
        that deforms.
    state : callable or None
        ``state(folder, names)``: the state for the session, where no command says it; ``names`` are those
        that the Python lines have left.
    look : (float, float, float)
        From the shape to the viewer.
    figure : str
        A picture written by the code, to be shown instead of the shapes.
    steps : tuple of (str, str)
        What a test replaces in the code, to be quick.
    unit : str
        Of the mesh.
    """

    name: str
    title: str
    sentence: str
    code: str
    files: Callable[[Path, int], None] = bottle
    as_command: str = ""
    state: Callable[[Path, dict[str, Any]], State] | None = None
    look: tuple[float, float, float] = (0.5, 0.3, 0.85)
    figure: str = ""
    steps: tuple[tuple[str, str], ...] = ()
    unit: str = "cm"

    @property
    def language(self) -> str:
        """Name of the language of its code, as of a code block."""
        return "sh" if self.code.startswith("apd-viewer") else "python"

    def run(self, folder: Path, count: int, quickly: bool = False) -> State:
        """Write the files, run the code, and return the state for the session."""
        self.files(folder, count)
        names = run_code(self.quick_code if quickly else self.code, self.language, folder)
        if self.state is not None:
            return self.state(folder, names)
        lines = (self.as_command or self.code).splitlines()
        command = next(line for line in reversed(lines) if line.startswith("apd-viewer deform"))
        with within(folder):
            return state_after(shlex.split(command)[2:], getattr(names.get("result"), "U", None))

    @property
    def quick_code(self) -> str:
        """The code with fewer steps."""
        code = self.code
        for usual, fewer in self.steps:
            assert usual in code
            code = code.replace(usual, fewer)
        return code

    def save(self, state: State, folder: Path) -> Path:
        """Write the session, with its mesh in it."""
        path = folder / f"{self.name}.apd"
        document = state.document
        # In no folder of this machine.
        mesh = replace(document.mesh, path=Path(path.anchor) / document.mesh.name)
        state = replace(state, document=replace(document, mesh=mesh))
        save_session(path, state, View(unit=self.unit), embed=True)
        return path


def run_code(code: str, language: str, folder: Path) -> dict[str, Any]:
    """Run lines in a folder; the names that Python lines leave."""
    # As in a script of the reader's.
    import numpy as np

    import apd_viewer

    names: dict[str, Any] = {"np": np, "apd_viewer": apd_viewer, "Path": Path, "__name__": "__gallery__"}
    with within(folder), contextlib.redirect_stdout(io.StringIO()) as said:
        if language == "python":
            exec(compile(code, "gallery", "exec"), names)
        else:
            for line in code.replace("\\\n", " ").splitlines():
                if main(shlex.split(line)[1:]):
                    raise RuntimeError(f"{line}: {said.getvalue()}")
    return names


@contextlib.contextmanager
def within(folder: Path) -> Iterator[None]:
    """Work in a folder."""
    before = Path.cwd()
    os.chdir(folder)
    try:
        yield
    finally:
        os.chdir(before)
