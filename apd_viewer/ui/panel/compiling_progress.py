"""Progress of the compilation at the first start on a computer, in the status bar."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QHBoxLayout, QLabel, QProgressBar, QWidget

from apd_viewer.language import tr

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
        self.hide()

    def follow(self, share: float | None) -> None:
        """Show the share of the kernels compiled so far, if that is known, until it is 1."""
        self.setVisible(share is not None and share < 1.0)
        if share is not None:
            self.bar.setValue(round(_SCALE * share))
