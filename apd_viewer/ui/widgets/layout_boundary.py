"""Boundary within which changed texts lay out widgets anew."""

from PySide6.QtCore import QEvent, QSize
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QWidget


class LayoutBoundary(QWidget):
    """Frame of one widget, which tells its parent of new size hints alone.

    In Qt a label with another text of the same size has every layout around it made anew, that of the main
    window last. It repaints the separators, and so the whole window is composed once more for each text.
    """

    def __init__(self, content: QWidget) -> None:
        super().__init__()
        content.setParent(self)
        self.setFocusProxy(content)
        self.setSizePolicy(content.sizePolicy())
        self.setMinimumSize(content.minimumSize())
        self._content = content
        self._told = self._hints

    @property
    def _hints(self) -> tuple[QSize, QSize]:
        return self._content.sizeHint(), self._content.minimumSizeHint()

    def sizeHint(self) -> QSize:
        """Size hint of the content."""
        return self._content.sizeHint()

    def minimumSizeHint(self) -> QSize:
        """Minimum size hint of the content."""
        return self._content.minimumSizeHint()

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Fill the frame."""
        super().resizeEvent(event)
        self._content.setGeometry(self.rect())

    def event(self, event: QEvent) -> bool:
        """Tell the parent of new size hints."""
        if event.type() == QEvent.Type.LayoutRequest and self._hints != self._told:
            self._told = self._hints
            self.updateGeometry()
        return super().event(event)
