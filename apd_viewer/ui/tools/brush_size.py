"""Radius of the brush."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QObject, Signal

if TYPE_CHECKING:
    from apd_viewer.ui.scene.surface import Hit
    from apd_viewer.ui.scene.viewport import Viewport

SMALLEST_RADIUS, LARGEST_RADIUS, DEFAULT_RADIUS = 4.0, 200.0, 24.0


class BrushSize(QObject):
    """Radius of the brush, in pixels or in units of the mesh.

    Parameters
    ----------
    viewport : Viewport

    Attributes
    ----------
    changed : Signal()
        The radius is another one, or in another unit.
    """

    changed = Signal()

    def __init__(self, viewport: Viewport) -> None:
        super().__init__(viewport)
        self._viewport = viewport
        self._radius = DEFAULT_RADIUS
        self._length: float | None = None

    @property
    def radius(self) -> float:
        """Radius of the brush in logical pixels, from 4 to 200."""
        return self._radius

    @radius.setter
    def radius(self, radius: float) -> None:
        radius = float(np.clip(radius, SMALLEST_RADIUS, LARGEST_RADIUS))
        if radius != self._radius or self._length is not None:
            self._radius, self._length = radius, None
            self._say()

    def set_radius(self, radius: float) -> None:
        """Set the radius in pixels."""
        self.radius = radius

    @property
    def length(self) -> float | None:
        """Radius in mesh units at any zoom; None while it is in pixels."""
        return self._length

    @length.setter
    def length(self, length: float | None) -> None:
        if length != self._length:
            self._length = length
            self._say()

    def scale(self, factor: float) -> None:
        """Scale the radius by a factor."""
        if self._length is None:
            self.radius = self._radius * factor
        else:
            self.length = self._length * factor

    def radius_on_mesh(self, hit: Hit) -> float:
        """Radius on the mesh, in its units, at a hit."""
        if self._length is not None:
            return self._length
        return self._radius * self._viewport.camera_controller.camera.world_per_pixel(hit.point)

    def dab_spacing(self, hit: Hit | None) -> float:
        """Largest spacing of dabs without a gap, in pixels."""
        if self._length is None or hit is None:
            return max(self._radius / 2, SMALLEST_RADIUS)
        return max(
            self._length / (2 * self._viewport.camera_controller.camera.world_per_pixel(hit.point)), 1.0
        )

    def _say(self) -> None:
        self._viewport.tool_layer.update()
        self.changed.emit()
