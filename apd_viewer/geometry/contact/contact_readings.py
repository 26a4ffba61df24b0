"""Readings of a surface in contact."""

from typing import Any

import numpy as np

from apd_viewer.geometry.contact.contact import Contact
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.pose.frame import FrameContact


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
