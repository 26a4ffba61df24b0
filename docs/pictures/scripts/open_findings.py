"""The mesh check of a mesh that is not clean, and where the hole is."""

from meshes_by_code import unclean
from PySide6.QtGui import QImage
from stage import Stage

from apd_viewer.geometry.mesh.mesh import Mesh


def draw(stage: Stage) -> QImage:
    """Click the badge, then the first entry of the list."""
    stage.size = (900, 640)
    stage.open_mesh(Mesh(*unclean(900 if stage.quick else 2500)))
    health = stage.window.findings
    health.badge.click()
    stage.pause(50)
    health.list.rows[0].chosen.emit()
    stage.settle()
    stage.mark(health.badge)
    stage.callout("Ctrl+I, or a click here", health.badge, (-40, -58))
    return stage.picture()
