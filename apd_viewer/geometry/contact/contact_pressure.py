"""Contact pressure between the walls of a mesh."""

from functools import cached_property

import numpy as np

from apd_viewer.geometry.contact.contact import Contact
from apd_viewer.geometry.contact.mesh_contact import mesh_contact
from apd_viewer.geometry.energy.solve_mesh import SolveMesh
from apd_viewer.geometry.linalg.threads import cores_for
from apd_viewer.geometry.mesh.arrays import diagonal
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.operators import vertex_areas
from apd_viewer.geometry.pose.constraints import FREE, HANDLE


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
