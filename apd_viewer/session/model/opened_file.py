"""Content of an opened file: a state with its view and timeline."""

from pathlib import Path
from typing import NamedTuple

from apd_viewer.session.model.state import State
from apd_viewer.session.model.timeline import NO_TIMELINE, Timeline
from apd_viewer.session.model.view import View


class OpenedFile(NamedTuple):
    """State, view and timeline read from an opened file.

    Attributes
    ----------
    view : View or None
        None where only a session knows it.
    timeline : Timeline
        Empty where the file has one shape.
    animation : Path or None
        File to be opened for mesh and shapes together, if there are several.
    """

    state: State
    view: View | None = None
    timeline: Timeline = NO_TIMELINE
    animation: Path | None = None
