"""Makes a window show all that it can: rows of every list, and each dialog."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import trimesh
from PySide6.QtCore import QSize
from PySide6.QtGui import QImage
from PySide6.QtWidgets import QApplication, QWidget

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.presentation.report_page import ReportHeading
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.state import State, initial_state
from apd_viewer.ui.sharing.picture_dialog import PictureDialog, PictureSettings
from apd_viewer.ui.sharing.report_dialogs import ReportDialog
from apd_viewer.ui.workbench import Workbench

# What adds a row, shows a card or opens a dialog. The handle is moved first, so that methods differ.
_MOVES = "nudge:(-1,0,0)"
_SHOWN = (
    *("add_region", "keep_pose", "add_floor", "sweep", "study", "press", "paper", "verify", "settings"),
    *("compare_methods", "export_animation", "measure:AREA", "cut", "compare", "choose_by_numbers"),
    *("findings", "shortcuts"),
)


class _NoPictures:
    """In the place of a view without pixels."""

    view_size = QSize(640, 480)
    has_legend = has_gizmo = True

    def picture(self, wish: PictureSettings) -> QImage:
        """Nothing."""
        return QImage(wish.size, QImage.Format.Format_RGB32)

    def check_size(self, _: QSize) -> None:
        """Any size will do."""


def can() -> State:
    """A closed can, held at its bottom and gripped at its top."""
    made = trimesh.creation.cylinder(1.0, 4.0, sections=12).subdivide()
    labels = np.zeros(len(made.vertices), np.uint8)
    labels[made.vertices[:, 2] < -1.9] = 1
    labels[made.vertices[:, 2] > 1.9] = 2
    return initial_state(Mesh(made.vertices, made.faces), labels)


def show_all(window: Workbench, wait: Callable[[Callable[[], object]], object]) -> None:
    """Open the can, and each list, card and dialog; ``wait`` runs events until a condition holds."""
    window.session.files.open_result("can", can)
    store = window.session.store
    wait(lambda: store.state is not None and window.session.jobs.current is None)
    actions = {entry.name: entry.action for entry in window.actions_.entries}
    actions[_MOVES].trigger()
    wait(lambda: _document(window).is_posed and not store.required_state().is_at_rest)
    for name in _SHOWN:
        actions[name].trigger()
    wait(lambda: _document(window).obstacles and _document(window).poses)
    window.picture_dialog = PictureDialog(window.shell, _NoPictures(), PictureSettings(QSize(640, 480)))
    window.report_dialog = ReportDialog(window.shell, ReportHeading(), "bottle.obj")


def _document(window: Workbench) -> Document:
    return window.session.store.required_state().document


def widgets() -> list[QWidget]:
    """All widgets of all windows, each once, without what Qt makes of its own accord."""
    found = {}
    for top in QApplication.topLevelWidgets():
        for widget in (top, *top.findChildren(QWidget)):
            found[id(widget)] = widget
    return list(found.values())
