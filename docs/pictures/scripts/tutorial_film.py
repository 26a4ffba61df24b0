"""A short film: the sample bottle is twisted by half a turn, wall against wall."""

import numpy as np
from picture_files import Film, pixels
from PIL import Image
from stage import Stage

from apd_viewer.session.posing.motion import MOTIONS


def draw(stage: Stage) -> Film:
    """Go on in equal steps, and take a picture of the view after each."""
    stage.size = (860, 700)
    stage.open_sample("bottle")
    count = 2 if stage.quick else 15
    frames = []
    for number in range(count + 1):
        if number:
            stage.window.session.handles.move_by(MOTIONS["TWIST"], f"{180 / count}deg", 0)
            stage.settle()
        frames.append(_small(pixels(stage.picture(stage.view_box.adjusted(100, 0, -60, 0)))))
    durations = np.full(len(frames), 140)
    durations[[0, -1]] = 900, 1600
    return Film(frames, durations.tolist())


def _small(picture: Image.Image) -> Image.Image:
    wide = 520
    return picture.resize((wide, round(wide * picture.height / picture.width)), Image.Resampling.LANCZOS)
