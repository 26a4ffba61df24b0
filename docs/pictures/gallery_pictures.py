"""Pictures of the gallery: both shapes of a session, or a figure that the code writes."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import ink
from pairs import side_by_side
from picture_files import Film, film_of_gif
from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QImage

from apd_viewer.session.storage.session_file import open_session
from apd_viewer.ui.scene.scene_picture import OffscreenScene
from apd_viewer.ui.scene.shading import Shading

if TYPE_CHECKING:
    from stage import Stage

GALLERY = Path(__file__).resolve().parents[1] / "gallery"
sys.path.insert(0, str(GALLERY))

from entries import ENTRIES  # noqa: E402
from entry import Entry, run_code  # noqa: E402

PREFIX = "gallery_"
_VERTICES = 3000
_BOX = 205, 240  # of a shape, logical pixels
_WIDE = 640  # pixels of a film


def gallery_names() -> list[str]:
    """Names of the pictures."""
    return [PREFIX + name for name in ENTRIES]


def gallery_drawer(name: str) -> Callable[[Stage], QImage | Path | Film]:
    """What draws the picture of a name."""
    entry = ENTRIES[name.removeprefix(PREFIX)]
    return (lambda stage: _figure(entry, stage)) if entry.figure else (lambda stage: _shapes(entry, stage))


def _shapes(entry: Entry, stage: Stage) -> QImage:
    """Open the session in the window; both of its shapes, at one scale."""
    path = GALLERY / "sessions" / f"{entry.name}.apd"
    stage.open(lambda: open_session(path)[0])
    stage.look(*entry.look)
    state = stage.state
    studio = OffscreenScene(stage.window.canvas.viewport, state, False, Shading.SMOOTH)
    scale = 1 if stage.quick else 2
    pictures = [_fitted(studio.painted_picture(U), scale) for U in (state.document.mesh.V, state.frame.U)]
    return side_by_side(pictures, ["Rest", "Deformed"])


def _fitted(picture: QImage, scale: int) -> QImage:
    """A picture in the middle of a box: all cards of the gallery have one size."""
    keep, smooth = Qt.AspectRatioMode.KeepAspectRatio, Qt.TransformationMode.SmoothTransformation
    fit = picture.scaled(QSize(*_BOX) * scale, keep, smooth)
    return ink.centred(fit, *_BOX, scale)


def _figure(entry: Entry, stage: Stage) -> Path | Film:
    """Run the code and take the figure that it writes."""
    entry.files(stage.folder, 900 if stage.quick else _VERTICES)
    run_code(entry.quick_code if stage.quick else entry.code, entry.language, stage.folder)
    path = stage.folder / entry.figure
    return film_of_gif(path, _WIDE) if path.suffix == ".gif" else path
