"""The time left of a large mesh, against the time that it took, with the real solver process."""

import time

import numpy as np
import pytest
from driven_session import Driven
from meshes import sphere

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, HANDLE
from apd_viewer.presentation.time_left import TimeLeftEstimate
from apd_viewer.session.posing.motion import MOTIONS

pytestmark = [pytest.mark.usefixtures("processes"), pytest.mark.alone]

MINUTES = 5.0


def test_time_left_estimate_knows_the_time_left_before_half_of_the_way_to_the_minimum(empty: Driven):
    """Nothing can be told until the matrix is analysed, and that is up to 0.43 of a solve of six seconds."""
    ball, F = sphere(7)
    V = ball * [1.0, 1.0, 2.0]
    empty.files.open_mesh(Mesh(V, F))
    empty.until(lambda: empty.jobs.current is None, 60.0)
    empty.stroke(np.flatnonzero(V[:, 2] < -1.68), BASE)
    empty.stroke(np.flatnonzero(V[:, 2] > 1.68), HANDLE)
    empty.settings.change(stiffness=1e-3)
    empty.handles.move_by(MOTIONS["MOVE_Z"], "0.04", 0)
    seen = empty.store.state.frame
    empty.until(lambda: empty.store.state.frame is not seen, 60.0)  # decimated, and on its way
    began, forecast, said = time.monotonic(), TimeLeftEstimate(0.0), []

    def arrived() -> bool:
        nonlocal seen
        frame, now = empty.store.state.frame, time.monotonic() - began
        if frame is not seen:
            seen = frame
            forecast.add_sample(now, frame.gap, frame.seconds_left)
        said.append((now, forecast.seconds_left(now)))
        return frame.gap is not None and frame.gap <= 1.0

    empty.until(arrived, 60.0 * MINUTES)
    end = said[-1][0]
    left = next(left for now, left in said if now >= 0.45 * end)
    assert left is not None
    assert 0.4 <= left / (0.55 * end) <= 2.5  # the pace of a machine changes on the way, too
