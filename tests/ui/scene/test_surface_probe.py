"""The ring that marks one place on several shapes."""

from dataclasses import replace

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtGui import QImage, QPainter

from apd_viewer.ui.compare.method_view import ProbedPoint, SurfaceProbe


def painted(pointer, view):
    """Whether anything is drawn."""
    image = QImage(view.size(), QImage.Format.Format_ARGB32)
    image.fill(Qt.GlobalColor.transparent)
    with QPainter(image) as painter:
        pointer.paint(painter)
    return np.frombuffer(image.constBits(), np.uint8).any()


def test_surface_probe_marks_a_place_in_front_of_the_camera_and_not_behind_it(view, surface):
    pointer = SurfaceProbe(view, surface)
    pointer.marked_point = ProbedPoint(0, np.array([1.0, 0.0, 0.0]))
    point, eye = surface.U[surface.surface_index.F[0, 0]], view.camera_controller.camera
    towards = eye.position - eye.focal
    view.camera_controller.camera = replace(eye, focal=point, position=point + towards)
    assert painted(pointer, view)
    view.camera_controller.camera = replace(eye, focal=point - 2 * towards, position=point - towards)
    assert not painted(pointer, view)
