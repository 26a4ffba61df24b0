"""The sample bottle, its label kept, while it is twisted by a ring of the gizmo."""

import numpy as np
from PySide6.QtGui import QImage
from stage import Stage

from apd_viewer.session.quantities.units import Unit


def draw(stage: Stage) -> QImage:
    """Paint a label, keep its area, twist by 60 degrees, and drag the ring a little farther."""
    stage.open_sample("bottle")
    stage.window.choose_unit(Unit.CENTIMETRE)
    session, mesh = stage.window.session, stage.state.document.mesh
    session.parts.add_region()
    session.parts.rename_region(0, "Label")
    session.gestures.begin()
    session.painting.paint_region(np.flatnonzero(np.abs(mesh.V[:, 1] - 11.0) < 2.6), 1)
    session.painting.end_stroke("Paint region")
    session.settings.set_region_area(0, 100.0)
    stage.twist("75deg")
    way = stage.along_ring(1, 0.3, 0.8, 3)
    stage.drag(way, let_go=False)
    stage.trail(stage.along_ring(1, 0.3, 0.8, 16))
    stage.cursor(way[-1], pressed=True)
    return stage.picture()
