"""Changed texts in a dock, and how often the window around them is laid out."""

import pytest
from PySide6.QtCore import QEvent, QObject, Qt
from PySide6.QtWidgets import QDockWidget, QLabel, QMainWindow, QSizePolicy, QVBoxLayout, QWidget

from apd_viewer.ui.widgets.box_layouts import LayoutBoundary


class Layouts(QObject):
    """Counts how often a window is laid out, and how often it is composed."""

    def __init__(self, window):
        super().__init__(window)
        self.laid_out = self.composed = 0
        window.installEventFilter(self)

    def eventFilter(self, _window, event):
        self.laid_out += event.type() == QEvent.Type.LayoutRequest
        self.composed += event.type() == QEvent.Type.UpdateRequest
        return False


@pytest.fixture
def label(qtbot):
    """A label in a dock."""
    window, dock, content, label = QMainWindow(), QDockWidget(), QWidget(), QLabel("0.397 l")
    QVBoxLayout(content).addWidget(label)
    dock.setWidget(LayoutBoundary(content))
    window.setCentralWidget(QWidget())
    window.addDockWidget(Qt.DockWidgetArea.RightDockWidgetArea, dock)
    window.show()
    qtbot.waitExposed(window)
    qtbot.wait(50)
    yield label
    window.close()
    window.deleteLater()


def test_layout_boundary_keeps_a_text_of_the_same_width_within(qtbot, label):
    seen = Layouts(label.window())
    for text in ("0.396 l", "0.395 l", "0.394 l"):
        label.setText(text)
        qtbot.wait(20)
    assert (seen.laid_out, seen.composed) == (0, 3)


def test_layout_boundary_gives_a_wider_text_its_room(qtbot, label):
    seen, text = Layouts(label.window()), 8 * "0.396 l and "
    label.setText(text)
    qtbot.waitUntil(lambda: label.width() >= label.fontMetrics().horizontalAdvance(text))
    assert seen.laid_out


def test_layout_boundary_is_as_large_as_its_content_may_be():
    content = QLabel("0.396 l")
    content.setMinimumSize(300, 200)
    content.setSizePolicy(QSizePolicy.Policy.Minimum, QSizePolicy.Policy.Expanding)
    boundary = LayoutBoundary(content)
    assert boundary.minimumSize() == content.minimumSize()
    assert boundary.sizePolicy() == content.sizePolicy()
    assert boundary.minimumSizeHint() == content.minimumSizeHint()
    assert boundary.sizeHint() == content.sizeHint()
