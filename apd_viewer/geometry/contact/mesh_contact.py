"""Contact of a mesh, by what is held of it and how thick its walls are."""

from __future__ import annotations

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.contact.contact import Contact
from apd_viewer.geometry.contact.followers import Followers
from apd_viewer.geometry.energy.solve_mesh import SolveMesh
from apd_viewer.language import tr

# Walls keep this part of the diagonal of the bounding box apart, unless their thickness is known.
_THICKNESS = 1e-3
# In the same: with thicker walls every part of the surface is near every other.
_THICKEST = 0.05


def contact_of(
    shape: SolveMesh,
    fixed: np.ndarray,
    handle_of: np.ndarray,
    diagonal: float,
    thickness: float | None,
    followers: Followers | None = None,
) -> Contact:
    """Contact of what is connected with held vertices, and of what follows it.

    Parameters
    ----------
    shape : SolveMesh
    fixed : (k,) int array
        Held vertices.
    handle_of : (k,) int array
        Handle of each, counted from 1; 0 for the base.
    diagonal : float
        Of the bounding box, mesh units.
    thickness : float or None
        Distance that walls keep, mesh units; None for a thousandth of the diagonal.
    followers : Followers, optional
        Without, all connected parts that nothing holds are left out.

    Raises
    ------
    InputError
        If walls are too thick.
    """
    apart = _THICKNESS * diagonal if thickness is None else thickness
    if apart > _THICKEST * diagonal:
        raise InputError(
            tr("The wall thickness must be at most {most:.3g} here; check the unit.").format(
                most=_THICKEST * diagonal
            )
        )
    together = np.zeros(len(shape.V), np.int64)
    together[fixed] = handle_of + 1
    held, F = is_connected(shape, fixed), shape.F
    if followers is None:
        F = np.ascontiguousarray(F[held[F[:, 0]]])
    else:
        together[~held] = handle_of.max(initial=0) + 2 + shape.piece[~held]
    return Contact(shape.V, F, together, float(shape.L.diagonal().mean()), apart, followers)


def is_connected(shape: SolveMesh, fixed: np.ndarray) -> np.ndarray:
    """Mask (n,) of the vertices connected with the ``fixed`` ones (k,)."""
    return np.isin(shape.piece, shape.piece[fixed])
