"""Progress of the compilation at the first start on a computer, in the status bar."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import Qt, QTimer
from PySide6.QtWidgets import QHBoxLayout, QLabel, QProgressBar, QWidget

from apd_viewer.language import tr

if TYPE_CHECKING:
    from apd_viewer.session.store import Store

_TICK = 500  # ms
_SCALE = 1000
_WIDTH = 88


class CompilingProgress(QWidget):
    """A thin bar, shown while the solver compiles."""

    def __init__(self) -> None:
        super().__init__(toolTip=tr("The first shapes may wait for it; at later starts nothing does."))
        self.bar = QProgressBar(maximum=_SCALE, textVisible=False, objectName="thin")
        self.bar.setFixedWidth(_WIDTH)
        row = QHBoxLayout(self, spacing=0)
        row.setContentsMargins(8, 0, 0, 0)
        row.addWidget(self.bar, 0, Qt.AlignmentFlag.AlignVCenter)
        row.addWidget(QLabel(tr("compiling for this computer, only once…")))
        self._store: Store | None = None
        self._timer = QTimer(self, interval=_TICK)
        self._timer.timeout.connect(self._show)
        self.hide()

    def watch(self, store: Store) -> None:
        """Show what the solver of a session tells, until all is compiled."""
        if store is not self._store:
            self._store = store
            self._timer.start()

    def _show(self) -> None:
        share = self._store.compiled if self._store else None
        self.setVisible(share is not None and share < 1.0)
        if share is not None:
            self.bar.setValue(round(_SCALE * share))
            if share == 1.0:
                self._timer.stop()
