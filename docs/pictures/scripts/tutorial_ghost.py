"""Half a turn is typed, and a ghost shows the way that the handle will go."""

from PySide6.QtGui import QImage
from stage import Stage


def draw(stage: Stage) -> QImage:
    """Type 180deg and do not press Enter."""
    stage.open_sample("bottle")
    stage.type_motion("180deg")
    stage.settle()
    field = stage.window.panel.handles.motion
    stage.mark(field.choice, field.relation, field.amount)
    stage.callout("Ctrl+M, then 180deg", field.amount, (-300, -40))
    return stage.picture()
