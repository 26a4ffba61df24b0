"""Area, volume and energy of the bottle twisted by 0 to 180 degrees, by every method."""

from pathlib import Path

from stage import Stage

from apd_viewer.__main__ import main
from apd_viewer.files.mesh_writing import save_mesh


def draw(stage: Stage) -> Path:
    """Run the sweep of the page."""
    mesh, labels = stage.sample("bottle")
    path, selection = stage.folder / "bottle.obj", stage.folder / "bottle.sel"
    save_mesh(mesh, mesh.V, path)
    selection.write_text("\n".join(map(str, labels.tolist())) + "\n", encoding="utf-8")
    steps = ["--steps", "1", "--iterations", "3"] if stage.quick else ["--steps", "18"]
    words = [str(path), "--selection", str(selection), "--twist", "180deg"]
    assert main(["sweep", *words, *steps, "-o", str(stage.folder / "out")]) == 0
    return stage.folder / "out" / "sweep.png"
