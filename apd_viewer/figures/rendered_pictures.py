"""Rendered pictures of shapes, if this machine has OpenGL."""

import json
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.figures.fonts import font_file
from apd_viewer.files.storage.atomic_file import replacing_file
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.language import tr

# Run with -c instead of -m, which would import from the current folder.
_START = """
import sys
sys.path[:] = sys.argv[2:]
from apd_viewer.figures.drawing import main
main(sys.argv[1])
"""
_NO_ARROWS = np.zeros((0, 2, 3))
_LOOK, _UP = (0.55, 0.28, 1.0), (0.0, 1.0, 0.0)
_FLAGS = getattr(subprocess, "CREATE_NO_WINDOW", 0)  # exists only on Windows


class Picture(NamedTuple):
    """Picture of several shapes side by side.

    Attributes
    ----------
    path : Path
        PNG file.
    shapes : sequence of (n, 3) float array, or of paths of .npy files
    captions : sequence of sequence of str
        Title and further lines of each shape.
    colors : sequence of (n, 3) uint8 arrays
        Colours of the first shapes instead of their area change, such as of one at rest, which has none.
    """

    path: Path
    shapes: Sequence[np.ndarray | Path]
    captions: Sequence[Sequence[str]]
    colors: Sequence[np.ndarray] = ()


def check_picture(path: Path) -> None:
    """Raise InputError unless ``path`` names a picture."""
    if path.suffix.lower() != ".png":
        raise InputError(tr("{name} does not have the ending of a picture; use .png.").format(name=path.name))


def no_pictures_reason() -> str:
    """Reason for missing pictures of shapes, as a sentence."""
    return tr("The shapes were not drawn: off-screen OpenGL is not available (on Debian, install libegl1).")


def write_shape(U: np.ndarray, path: Path) -> None:
    """Write a shape (n, 3) to a .npy file for the drawing process."""
    np.save(path, U)


def draw_shapes(
    mesh: Mesh,
    pictures: Sequence[Picture],
    size: tuple[int, int],
    view_direction: tuple[float, float, float] = _LOOK,
    up: tuple[float, float, float] = _UP,
    legend: bool = True,
    on_drawn: Callable[[int], object] = lambda _: None,
    letters: float = 1.0,
    arrows: np.ndarray = _NO_ARROWS,
) -> bool:
    """Draw pictures of several shapes in one view; False without OpenGL.

    Parameters
    ----------
    mesh : Mesh
        Mesh of the triangles, with the rest areas for comparison.
    size : (int, int)
        Pixels.
    view_direction, up : (float, float, float)
        Direction from the shape to the viewer, and up direction.
    legend : bool
        Whether to draw the colour legend below the first shape.
    on_drawn : callable
        Called with the number of finished pictures.
    letters : float
        Size of the letters over the usual one.
    arrows : (k, 2, 3) float array
        Tails and tips of arrows beside each shape.

    Raises
    ------
    InputError
        If a file cannot be written.
    """
    with tempfile.TemporaryDirectory(prefix="apd-viewer-") as name:
        folder = Path(name)
        np.save(folder / "faces.npy", mesh.F)
        np.save(folder / "rest.npy", mesh.V)
        said = {
            "size": size,
            "look": view_direction,
            "up": up,
            "legend": tr("local area change, %") if legend else "",
            "letters": letters,
            "arrows": arrows.tolist(),
            "font": None if (font := font_file()) is None else str(font),
            "pictures": [_picture_job(picture, number, folder) for number, picture in enumerate(pictures)],
        }
        (folder / "job.json").write_text(json.dumps(said), encoding="utf-8")
        if not _run(folder, len(pictures), on_drawn):
            return False
        for number, picture in enumerate(pictures):
            with replacing_file(picture.path) as scratch:
                scratch.write_bytes((folder / f"{number}.png").read_bytes())
    return True


def _picture_job(picture: Picture, number: int, folder: Path) -> dict[str, object]:
    paths = []
    for column, shape in enumerate(picture.shapes):
        path = shape if isinstance(shape, Path) else folder / f"{number}-{column}.npy"
        if not isinstance(shape, Path):
            np.save(path, shape)
        paths.append(str(path))
    paints = [str(folder / f"{number}-paint-{column}.npy") for column in range(len(picture.colors))]
    for paint, colors in zip(paints, picture.colors, strict=True):
        np.save(paint, colors)
    return {
        "path": str(folder / f"{number}.png"),
        "shapes": paths,
        "words": picture.captions,
        "paints": paints,
    }


def _run(folder: Path, count: int, drawn: Callable[[int], object]) -> bool:
    command = [sys.executable, "-c", _START, str(folder), *sys.path]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, creationflags=_FLAGS
    ) as process:
        try:
            assert process.stdout is not None
            for done, _ in enumerate(process.stdout, start=1):
                drawn(done)
        except BaseException:  # including KeyboardInterrupt
            process.kill()
            raise
    return process.returncode == 0 and all((folder / f"{number}.png").exists() for number in range(count))
