"""Has every shape that has come to rest examined, and knows what was found of the one on screen."""

from __future__ import annotations

from typing import TYPE_CHECKING

from apd_viewer.session.examiner import Examiner, Shape
from apd_viewer.session.stage import Activity, Listener, Stage

if TYPE_CHECKING:
    import numpy as np

    from apd_viewer.geometry.examination import Examination
    from apd_viewer.geometry.mesh import Mesh
    from apd_viewer.session.gestures import Gestures


class Examining:
    """Follows the stage, and tells the listener when more or less is known.

    Parameters
    ----------
    stage : Stage
    gestures : Gestures
    listener : Listener

    Attributes
    ----------
    found : Examination or None
        Of the shape on screen; None while it moves, and until it has been examined.
    at_rest : Examination or None
        Of the mesh as it was opened.
    """

    def __init__(self, stage: Stage, gestures: Gestures, listener: Listener) -> None:
        self._stage = stage
        self._gestures = gestures
        self._listener = listener
        self._examiner = Examiner(listener.wake)
        self._mesh: Mesh | None = None
        self._U: np.ndarray | None = None
        self.found: Examination | None = None
        self.at_rest: Examination | None = None

    @property
    def under_way(self) -> bool:
        """Whether the shape on screen is at rest, and will be known."""
        return self._U is not None and self.found is None

    def follow(self) -> None:
        """Look whether there is another shape at rest."""
        state = self._stage.state
        if state is None:
            return
        mesh = state.document.mesh
        if mesh is not self._mesh:
            self._mesh, self.at_rest = mesh, None
        rests = self._gestures.before is None and self._stage.activity is not Activity.REFINING
        U = state.frame.U if rests else None
        if U is not self._U:
            self._U, self.found = U, None
            self._examiner.forget()
            self._go_on()
            self._listener.examined()

    def receive(self) -> None:
        """Take in what was found."""
        answer = self._examiner.take()
        if answer is None or self._mesh is None:
            return
        shape, found = answer
        if shape.U is self._mesh.V:
            self.at_rest = found
        if shape.U is self._U:
            self.found = found
        self._go_on()
        self._listener.examined()

    def close(self) -> None:
        """End what is under way."""
        self._examiner.close()

    def _go_on(self) -> None:
        """Ask for what is not known yet: first of the mesh at rest, which all others are compared with."""
        if self._U is None or self._mesh is None:
            return
        if self._U is self._mesh.V and self.at_rest is not None:
            self.found = self.at_rest
        if self.found is None:
            self._examiner.ask(Shape(self._mesh.V if self.at_rest is None else self._U, self._mesh.joined_F))
