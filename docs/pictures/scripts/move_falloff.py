"""A single vertex pulled without and with falloff."""

from meshes_by_code import sheet
from pairs import side_by_side
from PySide6.QtGui import QImage
from stage import Stage

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.posing.motion import MOTIONS


def draw(stage: Stage) -> QImage:
    """Pull the middle of a sheet up, twice."""
    V, F = sheet(30 if stage.quick else 56)
    labels = 1 - 1 * ((abs(V[:, [0, 2]]) > 9.5).any(axis=1))
    middle = int((V**2).sum(axis=1).argmin())
    labels[middle] = 2
    pictures = []
    for falloff in (0.0, 7.0):
        stage.open_mesh(Mesh(V, F), labels.astype("uint8"))
        session = stage.window.session
        session.settings.set_contact(False)
        session.settings.change(method="arap")
        session.settings.set_falloff(0, falloff)
        session.handles.move_by(MOTIONS["MOVE_Y"], "4", 0)
        stage.settle()
        stage.look(0.5, 0.55, 1.0)
        pictures.append(stage.scene(360, 260))
    return side_by_side(pictures, ["No falloff: a spike", "Falloff of 7 cm: a smooth bump"])
