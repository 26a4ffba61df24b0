"""View settings as plain values, independent of a window."""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from apd_viewer.session.model.up_axis import UpAxis
from apd_viewer.session.quantities.wall import NO_WALL, WallText

SESSION_SUFFIX = ".apd"  # suffix of session files

Point3: TypeAlias = tuple[float, float, float]


@dataclass(frozen=True)
class CameraPose:
    """Position and direction of the camera.

    Attributes
    ----------
    position, focal, up : tuple of 3 floats
        Mesh units; ``up`` is a direction.
    angle : float
        Vertical view angle, radians.
    """

    position: Point3
    focal: Point3
    up: Point3
    angle: float


@dataclass(frozen=True, eq=False)
class RegionImage:
    """Image file laid on a region.

    Attributes
    ----------
    name : str
        Name of the file.
    content : bytes
        Of the file.
    inside : (n,) bool array
        Vertices of the region when it was laid.
    up_axis : UpAxis
        Up axis of the view then, by which it is upright.
    """

    name: str
    content: bytes
    inside: np.ndarray
    up_axis: UpAxis


@dataclass(frozen=True)
class View:
    """View settings of a session file.

    Attributes
    ----------
    camera : CameraPose or None
        Camera; None shows the whole mesh.
    unit : str
        Value of a :class:`apd_viewer.session.quantities.units.Unit`: its symbol, with a question mark
        where it is a guess.
    wall : WallText
        Wall of the mesh, as typed.
    overlay : str or None
        What the colours show, by the value of a :class:`Measure`; empty where they show
        what is painted, None where nothing is said of them.
    up_axis : UpAxis or None
        Up axis; None if not stored.
    image : RegionImage or None
        On a region of the mesh.
    """

    camera: CameraPose | None = None
    unit: str = ""
    wall: WallText = NO_WALL
    overlay: str | None = None
    up_axis: UpAxis | None = None
    image: RegionImage | None = None
