"""The head of an animal stretched without and with calm parts kept, coloured by local area change."""

from meshes_by_code import animal, animal_labels, within
from pairs import side_by_side
from PySide6.QtGui import QImage
from stage import Stage

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.presentation.scales import Measure


def draw(stage: Stage) -> QImage:
    """Pull the head by a fifth of the animal's length, twice."""
    V, F = animal(1.2 if stage.quick else 0.5)
    labels = animal_labels(V, within(V, (14.0, 23.5, -9.0), (30.0, 40.0, 9.0)))
    pictures, words = [], []
    for calm in (False, True):
        stage.open_mesh(Mesh(V, F), labels)
        session = stage.window.session
        session.settings.set_contact(False)
        session.settings.change(calm=calm)
        stage.twist("6", "MOVE_X")
        stage.overlay(Measure.AREA)
        stage.look(0.25, 0.25, 1.0)
        pictures.append(stage.scene(380, 340))
        words.append(f"Calm parts {'kept' if calm else 'free'}")
    return side_by_side(pictures, words)
