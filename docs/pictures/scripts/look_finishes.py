"""The sample bottle in clay, clear PET, foil and fabric."""

from pairs import side_by_side
from PySide6.QtGui import QImage
from stage import Stage

from apd_viewer.ui.scene.surface_shading import Finish

_NAMES = {Finish.CLAY: "Clay", Finish.PET: "PET", Finish.FOIL: "Foil", Finish.FABRIC: "Fabric"}


def draw(stage: Stage) -> QImage:
    """Show the bottle from the same side in each finish."""
    stage.open_sample("bottle")
    stage.twist("60deg")
    pictures = []
    for finish in _NAMES:
        stage.window.display_options.choose_finish(finish)
        stage.settle()
        pictures.append(stage.scene(190, 420))
    return side_by_side(pictures, list(_NAMES.values()))
