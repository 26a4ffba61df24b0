"""Antialiasing affordable with the OpenGL at hand."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import QTimer

if TYPE_CHECKING:
    from pyvistaqt import QtInteractor

SOFTWARE = ("llvmpipe", "softpipe", "swrast", "swiftshader", "software", "gdi generic", "basic render")
SAMPLES = 8  # on a GPU; each sample costs a software renderer as much as a frame
STILL = 120  # ms without a draw, after which a software renderer draws once more, with smooth edges


class Antialiasing:
    """Multisampling on a GPU; in software, smooth edges once the scene rests.

    Parameters
    ----------
    viewport : QtInteractor

    Attributes
    ----------
    software : bool
        Whether OpenGL runs on the processor.
    next : bool
        Whether a software renderer smooths edges in the next draw.
    still : QTimer
        Running between a draw without smooth edges and the one with them.
    """

    def __init__(self, viewport: QtInteractor) -> None:
        self._viewport = viewport
        self.software = self.next = False
        self.still = QTimer(viewport, singleShot=True, interval=STILL)
        self.still.timeout.connect(self._smooth)

    def choose(self, renderer: str) -> None:
        """Choose the samples by the name of the OpenGL renderer."""
        self.software = any(word in renderer.lower() for word in SOFTWARE)
        self._viewport.ren_win.SetMultiSamples(0 if self.software else SAMPLES)

    def begin_draw(self) -> None:
        """Set up the scene for a draw."""
        self._viewport.renderer.SetUseFXAA(self.next)

    def end_draw(self) -> None:
        """Plan the draw with smooth edges if this one was without."""
        if self.software and not self.next:
            self.still.start()
        self.next = False

    def _smooth(self) -> None:
        self.next = True
        self._viewport.update()
