"""Antialiasing affordable with the OpenGL at hand."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import QTimer

if TYPE_CHECKING:
    from pyvistaqt import QtInteractor

SOFTWARE_RENDERERS = (
    "llvmpipe",
    "softpipe",
    "swrast",
    "swiftshader",
    "software",
    "gdi generic",
    "basic render",
)
MULTISAMPLES = 8  # on a GPU; each sample costs a software renderer as much as a frame
IDLE_DELAY = 120  # ms without a draw, after which a software renderer draws once more, with smooth edges


class Antialiasing:
    """Multisampling on a GPU; in software, smooth edges once the scene rests.

    Parameters
    ----------
    viewport : QtInteractor

    Attributes
    ----------
    is_software : bool
        Whether OpenGL runs on the processor.
    smooths_next_draw : bool
        Whether a software renderer smooths edges in the next draw.
    idle_timer : QTimer
        Running between a draw without smooth edges and the one with them.
    """

    def __init__(self, viewport: QtInteractor) -> None:
        self._viewport = viewport
        self.is_software = self.smooths_next_draw = False
        self.idle_timer = QTimer(viewport, singleShot=True, interval=IDLE_DELAY)
        self.idle_timer.timeout.connect(self._smooth)

    def choose_samples(self, renderer: str) -> None:
        """Choose the samples by the name of the OpenGL renderer."""
        self.is_software = any(word in renderer.lower() for word in SOFTWARE_RENDERERS)
        self._viewport.ren_win.SetMultiSamples(0 if self.is_software else MULTISAMPLES)

    def begin_draw(self) -> None:
        """Set up the scene for a draw."""
        self._viewport.renderer.SetUseFXAA(self.smooths_next_draw)

    def end_draw(self) -> None:
        """Plan the draw with smooth edges if this one was without."""
        if self.is_software and not self.smooths_next_draw:
            self.idle_timer.start()
        self.smooths_next_draw = False

    def _smooth(self) -> None:
        self.smooths_next_draw = True
        self._viewport.update()
