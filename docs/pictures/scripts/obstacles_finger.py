"""A sphere pushed into the side of a bottle that stands on a floor."""

import numpy as np
from PySide6.QtGui import QImage
from stage import Stage

from apd_viewer.session.model.named_obstacle import NamedObstacle, ObstacleKind


def draw(stage: Stage) -> QImage:
    """Put a floor and a sphere, and push the sphere by two centimetres."""
    stage.open_sample("bottle")
    session = stage.window.session
    session.settings.change(stiffness=2e-3)
    stage.look(0.85, 0.28, 0.75)
    stage.window.obstacles.add_floor()
    stage.settle()
    place = np.array([5.2, 12.6, 0.0])
    ball = NamedObstacle("Sphere", ObstacleKind.SPHERE, place, radius=1.6)
    stage.window.obstacles._add(ball)
    stage.settle()
    session.obstacles.move(1, np.array([-2.4, 0.0, 0.0]))
    stage.settle()
    return stage.picture()
