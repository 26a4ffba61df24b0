"""Files of a timeline: its readings as a table, its shapes as an animation."""

import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from apd_viewer.files.animations.animation_files import ANIMATION_FORMATS, check_animation, write_animation
from apd_viewer.files.animations.animation_shapes import Animation
from apd_viewer.files.tables import Cell, write_table
from apd_viewer.session.model.obstacle_pair import obstacle_pair
from apd_viewer.session.model.state import State
from apd_viewer.session.model.timeline import Timeline
from apd_viewer.session.model.up_axis import UpAxis
from apd_viewer.session.quantities.units import Unit

# Named like the columns of the ``press`` command.
_COLUMNS = (
    *("step", "distance", "deflection", "load_low", "load_high", "volume", "volume_capped"),
    *("area_error", "settled", "load_low_newton", "load_high_newton"),
)
_OF_WALL = tuple(f"wall_{name}" for name in _COLUMNS[1:])
_TABLE = ".csv"
TIMELINE_FORMATS = (_TABLE, *ANIMATION_FORMATS)


def write_timeline(
    timeline: Timeline,
    path: Path,
    newtons: Sequence[tuple[float, float]],
    of_wall: bool = False,
    unit: Unit = Unit.NONE,
    up_axis: UpAxis = UpAxis.PLUS_Y,
) -> None:
    """Write readings or shapes of all steps, in the format of the suffix.

    Parameters
    ----------
    newtons : sequence of (float, float)
        Newtons per load at each step, for its state and for that of the Wall method; NaN if unknown.
    of_wall : bool
        Write the shapes solved by the Wall method, if there are any; a table has the readings of both.
    unit : Unit
        Unit of length of the mesh, a column of a table.
    up_axis : UpAxis
        Up axis of the view, for formats with an up axis.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    if path.suffix.lower() == _TABLE:
        pairs = zip(timeline.steps, newtons, strict=True)
        rows: list[list[Cell]] = [
            [k, *_row(step.state, a), *_row(step.wall_state, b), unit.symbol]
            for k, (step, (a, b)) in enumerate(pairs)
        ]
        write_table(path, (*_COLUMNS, *_OF_WALL, "unit"), rows)
        return
    check_animation(path)
    last = timeline.steps[-1].state.document
    with tempfile.TemporaryDirectory(prefix="apd-timeline-") as folder:
        files = [Path(folder, f"{k}.npy") for k in range(len(timeline.steps))]
        for file, step in zip(files, timeline.steps, strict=True):
            np.save(file, ((step.wall_state if of_wall else None) or step.state).frame.U)
        times = [float(k) for k in range(len(files))]
        animation = Animation(
            *(last.mesh, last.labels, last.member, files, times), unit=unit.value, up_frame=up_axis.frame
        )
        write_animation(animation, path)


def _row(state: State | None, newtons: float) -> list[float | None]:
    """Readings of a step; None or NaN if unknown."""
    if state is None:
        return [None] * len(_OF_WALL)
    pair, frame = obstacle_pair(state.document), state.frame
    plates = [np.nan] * 4 if pair is None else list(pair.reading(state))
    forces = [newtons * load for load in plates[-2:]]
    return [*plates, frame.volume, frame.volume_capped, frame.area_error, float(frame.settled), *forces]
