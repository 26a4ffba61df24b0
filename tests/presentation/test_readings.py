"""Readings as words."""

from dataclasses import replace

import numpy as np
import pytest
from driven_session import bar

from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.pose.constraints import HANDLE
from apd_viewer.geometry.pose.transforms import scaled_about, shifted, turned_about
from apd_viewer.presentation.readings import motion
from apd_viewer.session.model.state import opened
from apd_viewer.session.quantities.units import Unit

X = np.array([1.0, 0.0, 0.0])


@pytest.fixture
def painted():
    """A bar with a handle."""
    document = opened(bar()).document
    return replace(document, labels=frozen(np.full(len(document.labels), HANDLE, dtype=np.uint8)))


@pytest.mark.parametrize(
    ("moves", "turns", "grows", "said"),
    [
        (0.0, 0.0, 1.0, "at rest"),
        (0.5, 0.0, 1.0, "moved 0.5000\u00a0mm"),
        (0.0, 60.0, 1.0, "rotated +60.0°"),
        (0.0, -60.0, 1.0, "rotated −60.0°"),
        (0.0, 0.0, 1.2, "scaled by 1.20"),
        (0.5, 60.0, 0.5, "moved 0.5000\u00a0mm, rotated +60.0°, scaled by 0.50"),
    ],
)
def test_a_motion_says_what_it_has(painted, moves, turns, grows, said):
    centre, angle = painted.centre(0), np.deg2rad(turns)
    pose = shifted(moves * X) @ turned_about(centre, X, angle) @ scaled_about(centre, grows)
    moved = replace(painted, handles=(painted.handles[0].moved(pose),))
    assert motion(moved, 0, Unit.MILLIMETRE, 1.0) == said
