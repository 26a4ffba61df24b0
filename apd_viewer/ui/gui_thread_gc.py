"""Garbage collection confined to the GUI thread, which owns the Qt objects."""

import gc

from PySide6.QtCore import QObject, QTimer

INTERVAL = 500  # ms between two checks


class GuiThreadGC(QObject):
    """Collect cyclic garbage from a timer of the GUI thread.

    Python collects garbage on any allocating thread. A QTimer destroyed on a worker thread would crash the
    process.
    """

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        gc.disable()
        self._threshold = gc.get_threshold()
        self._timer = QTimer(self, timeout=self._check)
        self._timer.start(INTERVAL)

    def _check(self) -> None:
        counts = gc.get_count()
        for generation in (2, 1, 0):
            if counts[generation] > self._threshold[generation]:
                gc.collect(generation)
                return

    def close(self) -> None:
        """Enable Python's automatic garbage collection again."""
        self._timer.stop()
        gc.enable()
