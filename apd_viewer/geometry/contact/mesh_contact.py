"""Contact of a mesh with held vertices, its readings and its pressure."""

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.contact.contact import Contact, Followers
from apd_viewer.geometry.contact.contact_obstacles import Obstacle
from apd_viewer.geometry.energy.solve_mesh import SolveMesh
from apd_viewer.geometry.linalg.threads import cores_for
from apd_viewer.geometry.mesh.arrays import check_argument, diagonal, frozen
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.operators import vertex_areas
from apd_viewer.geometry.pose.constraints import FREE, HANDLE
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


class ContactPressure:
    """Contact pressure between the walls of a painted mesh.

    Parameters
    ----------
    mesh : Mesh
    labels : (n,) int array
        See :func:`apd_viewer.geometry.pose.constraints.constraints`; something must be held.
    thickness : float or None
        Distance that walls keep, mesh units; see :func:`mesh_contact`.
    """

    def __init__(self, mesh: Mesh, labels: np.ndarray, thickness: float | None) -> None:
        self._weld, self._labels, self._thickness = mesh.weld, labels, thickness
        self._shape = SolveMesh(mesh.V[mesh.weld.first], mesh.weld.inverse[mesh.F])

    @cached_property
    def _contact(self) -> Contact:
        shape, fixed = self._shape, np.flatnonzero(self._labels != FREE)
        held, first = np.unique(self._weld.inverse[fixed], return_index=True)
        handle_of = np.maximum(self._labels[fixed[first]].astype(np.int64) - HANDLE + 1, 0)
        return mesh_contact(shape, held, handle_of, diagonal(shape.V[shape.F.ravel()]), self._thickness)

    @cached_property
    def _has_contact(self) -> np.ndarray:
        """Mask of the vertices subject to contact."""
        held = np.unique(self._weld.inverse[np.flatnonzero(self._labels != FREE)])
        regarded = self._shape.is_connected_to(held)
        regarded[self._contact.exempt_vertices] = False
        return regarded

    def relative_pressure(self, U: np.ndarray) -> np.ndarray:
        """Contact pressure (n,) at ``U`` (n, 3), relative to its maximum.

        The pressure is the force of the gaps on a vertex over a third of the area around it. It is NaN for
        vertices without contact, and 0 everywhere if nothing touches.
        """
        U, F = np.ascontiguousarray(U[self._weld.first]), self._shape.F
        with cores_for(len(U)):
            self._contact.start_at(U)
            force = np.linalg.norm(self._contact.quarter_gradient(U), axis=1)
            area = vertex_areas(U, F)
        pressure = np.divide(force, area, out=np.zeros(len(U)), where=area > 0.0)
        pressure = np.where(self._has_contact, pressure / (pressure.max() or 1.0), np.nan)
        return pressure[self._weld.inverse]
