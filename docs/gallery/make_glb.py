"""Make the sample bottle, wrung and crushed, as an animation that viewers of glTF in a browser play.

    python docs/gallery/make_glb.py bottle.glb

It takes some minutes: contact keeps the walls apart in each of the 24 steps.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parent), str(Path(__file__).resolve().parents[1] / "pictures")]

from sample_files import bottle  # noqa: E402

from apd_viewer.__main__ import main  # noqa: E402
from apd_viewer.files.meshes import open_mesh  # noqa: E402
from apd_viewer.files.selections.selection_files import read_selection_file  # noqa: E402
from apd_viewer.session.model.document_parts import with_selection  # noqa: E402
from apd_viewer.session.model.state import initial_state  # noqa: E402
from apd_viewer.session.model.view import View  # noqa: E402
from apd_viewer.session.storage.session_file import save_session  # noqa: E402

_MOTION = ("--twist", "180deg", "--push", "40%")


def write_bottle(path: Path, steps: int = 24, vertices: int = 3000) -> None:
    """Write the animation, in metres, of a bottle with about as many vertices."""
    with tempfile.TemporaryDirectory(prefix="apd-gallery-") as name:
        folder = Path(name)
        bottle(folder, vertices)
        mesh = open_mesh(folder / "bottle.obj")
        state = initial_state(mesh)
        painted = with_selection(state.document, read_selection_file(folder / "bottle.sel", mesh))
        # Sessions have a unit, and OBJ has none.
        save_session(folder / "bottle.apd", state.updated(painted), View(unit="cm"))
        sweep = ["sweep", str(folder / "bottle.apd"), *_MOTION, "--contact", "--methods", "local"]
        words = ["--steps", str(steps), "-o", str(folder / "out"), "--animation", str(path)]
        assert main([*sweep, *words]) == 0


if __name__ == "__main__":
    write_bottle(Path(sys.argv[1]))
