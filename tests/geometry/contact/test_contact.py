"""Contact at a place and ahead of it."""

import numpy as np
import pytest

from apd_viewer.geometry.contact.contact import Contact

CORNERS = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.3, 1.0, 0.0]])
TWO = np.array([[0, 1, 2], [3, 4, 5]])


def apart(height):
    """Two triangles, one above the other."""
    return np.vstack([CORNERS, CORNERS[::-1] * [0.9, 0.8, 1.0] + [0.05, 0.1, height]])


def test_contact_stands_where_it_is_and_not_where_it_has_looked():
    """A free way that is not gone, then one that is refused: energy and forces are those of the start."""
    contact, U = Contact(apart(2.0), TWO, np.zeros(6, np.int64), 1.0, 0.2), apart(0.1)
    contact.start_at(U)
    energy, force = contact.energy_at(U), contact.quarter_gradient(U)
    assert energy > 0.0
    assert np.abs(force).max() > 0.0
    assert contact.trial_fractions(apart(0.15)) is None
    assert contact.trial_fractions(apart(-0.1)) is not None
    assert contact.energy_at(U) == pytest.approx(energy, rel=1e-12)
    assert np.allclose(contact.quarter_gradient(U), force, rtol=1e-12)
