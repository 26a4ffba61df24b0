"""Contact of a mesh from its held vertices and wall thickness, and its readings."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.contact.contact import Contact, Followers
from apd_viewer.geometry.contact.contact_obstacles import Obstacle
from apd_viewer.geometry.energy.solve_mesh import SolveMesh
from apd_viewer.geometry.mesh.arrays import check_argument, frozen
from apd_viewer.geometry.pose.frame import FrameContact
from apd_viewer.language import tr

# Default distance kept between walls, as a fraction of the bounding-box diagonal.
_THICKNESS = 1e-3
# Largest distance in diagonals: beyond it nearly all parts of the surface would be in range.
_THICKEST = 0.05


def mesh_contact(
    solve_mesh: SolveMesh,
    fixed: np.ndarray,
    handle_of: np.ndarray,
    diagonal: float,
    thickness: float | None,
    followers: Followers | None = None,
    obstacles: Sequence[Obstacle] = (),
    softness: float = 1.0,
    touches: bool = True,
) -> Contact:
    """Contact of components with held vertices, their followers, and obstacles.

    Parameters
    ----------
    solve_mesh : SolveMesh
    fixed : (k,) int array
        Held vertices.
    handle_of : (k,) int array
        Handle of each, counted from 1; 0 for the base.
    diagonal : float
        Of the bounding box, mesh units.
    thickness : float or None
        Distance that walls keep, mesh units; None for a thousandth of the diagonal.
    followers : Followers, optional
        Without, all connected parts that nothing holds are left out, unless nothing is held at all.
    obstacles : sequence of Obstacle

    softness : float
        Factor of the gaps' stiffness, for walls that give way more than the cells of Eq. 1.
    touches : bool
        Without, nothing touches.

    Raises
    ------
    InputError
        If walls are too thick.
    """
    apart = contact_thickness(diagonal, thickness)
    together = np.zeros(len(solve_mesh.V), np.int64)
    together[fixed] = handle_of + 1
    held, F = solve_mesh.is_connected_to(fixed), solve_mesh.F
    if followers is None:
        F = np.ascontiguousarray(F[held[F[:, 0]]])
    else:
        together[~held] = handle_of.max(initial=0) + 2 + solve_mesh.component[~held]
    if not touches:
        F = F[:0]
    stiffness = softness * float(solve_mesh.L.diagonal().mean())
    return Contact(solve_mesh.V, F, together, stiffness, apart, followers, obstacles)


def contact_thickness(diagonal: float, thickness: float | None) -> float:
    """Distance kept between walls, as given or from the diagonal, mesh units.

    Raises
    ------
    InputError
        If walls are too thick, or no thicker than nothing.
    """
    if thickness is None:
        return _THICKNESS * diagonal
    check_argument("thickness", thickness)
    if thickness > _THICKEST * diagonal:
        raise InputError(
            tr("The wall thickness must be at most {most:.3g} here; check the unit.").format(
                most=_THICKEST * diagonal
            )
        )
    return float(thickness)


def contact_readings(contact: Contact, U: np.ndarray, shifts: np.ndarray) -> dict[str, Any]:
    """Contact readings and obstacle loads at ``U`` (n, 3), as arguments of a frame.

    Parameters
    ----------
    contact : Contact
    U : (n, 3) float array
        Either end of the last collision-free step.
    shifts : (o, 3) float array
        Displacements reached by the obstacles.
    """
    contact.accept_shape(U)
    contact.quarter_gradient(U)
    least = float(contact.least_gap) if contact.touching_pairs else None
    carried = np.flatnonzero((contact.followers.exempt_groups > 0).any(axis=0))
    touch = FrameContact(
        int(contact.touching_pairs), least, len(np.union1d(contact.exempt_vertices, carried))
    )
    return {"contact": touch, "loads": frozen(contact.loads), "shifts": frozen(shifts.copy())}
