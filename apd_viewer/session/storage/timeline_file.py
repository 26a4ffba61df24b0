"""Files of a timeline: its readings as a table, its shapes as an animation."""

import tempfile
from pathlib import Path

import numpy as np

from apd_viewer.files.animations.animation_files import ANIMATION_FORMATS, check_animation, write_animation
from apd_viewer.files.animations.animation_shapes import Animation
from apd_viewer.files.tables import write_table
from apd_viewer.session.model.plate_pair import plate_pair
from apd_viewer.session.model.state import State
from apd_viewer.session.model.timeline import Timeline

_COLUMNS = "step", "distance", "deflection", "load_low", "load_high", "volume", "area_error", "settled"


_TABLE = ".csv"
TIMELINE_FORMATS = (_TABLE, *ANIMATION_FORMATS)


def write_timeline(timeline: Timeline, path: Path) -> None:
    """Write readings or shapes of all steps, in the format of the suffix.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    if path.suffix.lower() == _TABLE:
        write_table(path, _COLUMNS, [[k, *_row(step.state)] for k, step in enumerate(timeline.steps)])
        return
    check_animation(path)
    last = timeline.steps[-1].state.document
    with tempfile.TemporaryDirectory(prefix="apd-timeline-") as folder:
        files = [Path(folder, f"{k}.npy") for k in range(len(timeline.steps))]
        for file, step in zip(files, timeline.steps, strict=True):
            np.save(file, step.state.frame.U)
        times = [float(k) for k in range(len(files))]
        write_animation(Animation(last.mesh, last.labels, last.member, files, times), path)


def _row(state: State) -> list[float]:
    """Readings of a step; NaN for those unknown."""
    pair, frame = plate_pair(state.document), state.frame
    volume = frame.volume_capped if state.inspection.volume_capped is not None else frame.volume
    plates = [np.nan] * 4 if pair is None else pair.reading(state)
    return [*plates, np.nan if volume is None else volume, frame.area_error, float(frame.settled)]
