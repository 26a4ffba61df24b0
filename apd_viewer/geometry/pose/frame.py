"""Frame of a deformation: a shape and its readings."""

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from apd_viewer.geometry.mesh.arrays import frozen

# Relative accuracy of area and volume targets; the paper's method has
# its own tolerance.
TARGET_ACCURACY = 1e-9
# Obstacle displacements where there are no obstacles.
NO_SHIFTS = frozen(np.zeros((0, 3)))


class FrameContact(NamedTuple):
    """Contact of a shape with itself and with obstacles.

    Attributes
    ----------
    pairs : int
        Pairs of a vertex and a triangle, or of two edges, nearer than the contact distance.
    least_gap : float or None
        Least gap of these pairs, mesh units; None without any.
    exempt : int
        Vertices partly exempt from contact: near triangles crossing or touching at rest, or in loose parts,
        which may cross the surface carrying them.
    """

    pairs: int
    least_gap: float | None
    exempt: int


@dataclass(frozen=True, eq=False)
class Frame:
    """The shape after one iteration, and its readings.

    Attributes
    ----------
    U : (n, 3) float array
        Deformed positions in the order of the file, mesh units, read-only.
    iteration : int
        Iterations since the targets were last set.
    area, area_error : float
        Total area, and ``area / rest area - 1``.
    volume : float or None
        Enclosed volume; None if the surface is not closed.
    handle_drift : float
        Distance between the requested and the actual centroid of a handle; the largest for several handles.
    converged : bool
        True if the shape has settled and meets all targets.
    settled : bool
        True if further iterations would change nothing, converged or not.
    regions : tuple of float
        Area of each region.
    local_change : float
        Largest relative change of the area of a triangle, up or down.
    largest_edge_strain : float
        Strain of the edge with the largest relative change of length: 0.1 stretched by 10 %, -0.1 shortened.
    mean_edge_strain : float
        Mean of the edges' absolute strains, weighted by the rest area of the triangles at each.
    volume_capped : float or None
        Volume with flat caps over the openings; None for a surface without openings.
    unreached : str or None
        Sentence on targets out of reach in this pose, and the values reached.
    energy : float or None
        Energy minimised by the method, squared lengths: Eq. 1 with undirected edges counted twice, and the
        terms of the material; without the coupling of "sr-arap". None where that is not known.
    stable : bool or None
        True at a minimum of the energy as far as examined, False on a saddle; None if not examined.
    saddle_escapes : int
        Number of energy saddles left since the targets were last set.
    total : int
        Iterations since the deformation was made.
    gap : float or None
        Measure of convergence in multiples of its tolerance; None while unknown. Above 1 the shape has not
        converged; below, the search for a lower minimum may still continue.
    seconds_left : float or None
        Expected seconds to convergence, if previews were shown while the matrix was factored.
    share_reached : float
        Fraction of the path from rest to the targets completed, as far as contact allows.
    contact : FrameContact or None
        None without contact.
    loads : (o, 3) float array
        Forces on the obstacles, energy per length, for a material of stiffness 1. For a settled shape, they
        are the negative derivatives of its energy with respect to the shifts. Read-only.
    shifts : (o, 3) float array
        Displacements of the obstacles, mesh units, read-only; contact may have stopped them.

    Examples
    --------
    >>> import apd_viewer
    >>> V, F = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], [[0, 1, 2], [1, 3, 2]]
    >>> solver = apd_viewer.Deformation(V, F, [0, 1, 2], method="arap")
    >>> solver.aim([[0, 0, 0], [1, 0, 0], [0, 1, 0]])
    >>> frame = solver.step()
    >>> frame.iteration, frame.U.shape
    (1, (4, 3))
    """

    U: np.ndarray
    iteration: int
    area: float
    area_error: float
    volume: float | None
    handle_drift: float
    converged: bool
    settled: bool = True
    regions: tuple[float, ...] = ()
    local_change: float = 0.0
    largest_edge_strain: float = 0.0
    mean_edge_strain: float = 0.0
    volume_capped: float | None = None
    unreached: str | None = None
    energy: float | None = None
    stable: bool | None = None
    saddle_escapes: int = 0
    total: int = 0
    gap: float | None = None
    seconds_left: float | None = None
    share_reached: float = 1.0
    contact: FrameContact | None = None
    loads: np.ndarray = field(default_factory=lambda: NO_SHIFTS)
    shifts: np.ndarray = field(default_factory=lambda: NO_SHIFTS)
