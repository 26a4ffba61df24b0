"""The same twist with three stiffnesses."""

from pairs import side_by_side
from PySide6.QtGui import QImage
from stage import Stage

_STIFFNESSES = (0.0, 1e-4, 1e-2)


def draw(stage: Stage) -> QImage:
    """Twist the bottle by 110 degrees."""
    pictures = []
    for stiffness in _STIFFNESSES:
        stage.open_sample("bottle")
        stage.window.session.settings.change(stiffness=stiffness)
        stage.twist("110deg")
        stage.look(0.42, 0.25, 0.85)
        pictures.append(stage.scene(200, 330))
    return side_by_side(pictures, [f"Stiffness {value:g}" for value in _STIFFNESSES])
