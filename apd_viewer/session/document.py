"""What the user has said, and the shape that answers it: frozen values, replaced and never edited."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.constraints import FREE, Constraints, constraints, what_is_missing
from apd_viewer.geometry.deformation import DEFAULT_METHOD, DEFAULT_TOLERANCE, Frame
from apd_viewer.geometry.inspection import Inspection, inspect
from apd_viewer.geometry.mesh import Mesh, frozen

IDENTITY = frozen(np.eye(4))


@dataclass(frozen=True, eq=False)
class Document:
    """Everything that the user said, nothing derived. Compared by identity; arrays are read-only.

    Attributes
    ----------
    mesh : Mesh
    labels : (n,) uint8 array of BASE, FREE and HANDLE
    grip : (n, 3) float array
        Positions when the labels were last changed: what base and handle were gripped at.
    pose : (4, 4) float array
        Motion of the handle since then.
    method : str
    tolerance : float
        Relative error of the area that is accepted.
    """

    mesh: Mesh
    labels: np.ndarray
    grip: np.ndarray
    pose: np.ndarray = field(default_factory=lambda: IDENTITY)
    method: str = DEFAULT_METHOD
    tolerance: float = DEFAULT_TOLERANCE

    @property
    def problem(self) -> str | None:
        """What must be painted before the handle can move, as a sentence; None if nothing."""
        return what_is_missing(self.labels)

    def constraints(self) -> Constraints:
        """Held vertices and where they are held; raises InputError where ``problem`` says why."""
        return constraints(self.labels, self.grip, [self.pose])

    def regripped(self, U: np.ndarray) -> Document:
        """The same document, with base and handle gripped where they are at ``U`` (n, 3)."""
        return replace(self, grip=U, pose=IDENTITY)

    def painted(self, ids: np.ndarray, label: int) -> Document:
        """The same document with the vertices ``ids``, and those at the same places, labelled."""
        inverse = self.mesh.weld.inverse
        covered = np.zeros(len(self.mesh.weld.first), dtype=bool)
        covered[inverse[ids]] = True
        return replace(self, labels=frozen(np.where(covered[inverse], np.uint8(label), self.labels)))


@dataclass(frozen=True, eq=False)
class State:
    """A document and the shape that belongs to it: what undo brings back.

    Attributes
    ----------
    document : Document
    inspection : Inspection
        Readings of the mesh at rest.
    frame : Frame
        The latest shape, and its readings.
    """

    document: Document
    inspection: Inspection
    frame: Frame

    @property
    def arrays(self) -> tuple[np.ndarray, ...]:
        """The large arrays that keeping this state keeps; most are shared with other states."""
        document = self.document
        return document.mesh.V, document.mesh.F, document.labels, document.grip, self.frame.U


def opened(mesh: Mesh, labels: np.ndarray | None = None) -> State:
    """A mesh at rest, with ``labels`` (n,) or nothing painted."""
    if labels is None:
        labels = frozen(np.full(len(mesh.V), FREE, dtype=np.uint8))
    inspection = inspect(mesh)
    if inspection.area <= 0.0:
        raise InputError(f"{mesh.name} has no area: all its faces are degenerate; export it again.")
    return State(Document(mesh, labels, mesh.V), inspection, rest_frame(mesh, inspection))


def rest_frame(mesh: Mesh, inspection: Inspection) -> Frame:
    """The rest shape as a frame: nothing is left to iterate."""
    return Frame(
        U=mesh.V,
        iteration=0,
        area=inspection.area,
        area_error=0.0,
        volume=inspection.volume,
        handle_drift=0.0,
        converged=True,
    )
