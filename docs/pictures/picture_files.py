"""Pictures as WebP files: small, and the same bytes for the same picture."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
from PIL import Image, ImageSequence
from PySide6.QtGui import QImage

from apd_viewer.files.storage.atomic_file import replacing_file

_QUALITY, _FILM_QUALITY = 90, 72


class Film(NamedTuple):
    """Pictures one after another, each shown for so many milliseconds."""

    pictures: list[Image.Image]
    durations: list[int]


Drawn = QImage | Image.Image | Film | Path


def write_picture(drawn: Drawn, path: Path) -> None:
    """Write what a script has drawn, whole or not at all; a path is that of a drawing as PNG."""
    with replacing_file(path) as scratch:
        if isinstance(drawn, Film):
            first, *others = drawn.pictures
            film = {"save_all": True, "append_images": others, "duration": drawn.durations, "loop": 0}
            first.save(scratch, "WEBP", quality=_FILM_QUALITY, method=6, **film)
        elif isinstance(drawn, Path):
            with Image.open(drawn) as image:
                image.convert("RGB").save(scratch, "WEBP", lossless=True, method=6)
        else:
            still(drawn).save(scratch, "WEBP", quality=_QUALITY, method=6)


def still(drawn: QImage | Image.Image | Film | Path) -> Image.Image:
    """A picture of Pillow; of a film its last one."""
    if isinstance(drawn, Film):
        return drawn.pictures[-1]
    if isinstance(drawn, Path):
        with Image.open(drawn) as image:
            return image.convert("RGB")
    return drawn if isinstance(drawn, Image.Image) else pixels(drawn)


def pixels(image: QImage) -> Image.Image:
    """A picture of Qt as one of Pillow."""
    rgba = image.convertToFormat(QImage.Format.Format_RGBA8888)
    rows = np.frombuffer(rgba.constBits(), np.uint8).reshape(rgba.height(), rgba.bytesPerLine())
    return Image.fromarray(rows[:, : 4 * rgba.width()].reshape(rgba.height(), rgba.width(), 4).copy())


def film_of_gif(path: Path, width: int) -> Film:
    """A GIF, so many pixels wide."""
    with Image.open(path) as gif:
        frames = [frame.convert("RGB") for frame in ImageSequence.Iterator(gif)]
        durations = [frame.info.get("duration", 100) for frame in ImageSequence.Iterator(gif)]
    size = width, round(width * frames[0].height / frames[0].width)
    return Film([frame.resize(size, Image.Resampling.LANCZOS) for frame in frames], durations)
