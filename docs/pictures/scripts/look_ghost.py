"""The rest shape as a ghost around the duck, and the duck cut by a plane."""

from pairs import side_by_side
from PySide6.QtGui import QImage
from stage import Stage


def draw(stage: Stage) -> QImage:
    """Bend the duck, show the ghost, then the section."""
    stage.open_sample("duck")
    stage.window.session.settings.set_contact(False)
    stage.twist("35deg", "BEND_Z")
    looks = stage.window.display_options
    looks.show_ghost(True)
    stage.look(-0.5, 0.3, 1.0)
    pictures = [stage.scene(380, 300)]
    looks.show_ghost(False)
    looks.cutting_plane.show_card(True)
    stage.settle()
    pictures.append(stage.scene(380, 300))
    return side_by_side(pictures, ["Rest shape as a ghost (A)", "Cut by a plane (S)"])
