"""Opens and closes the comparison window."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING

from apd_viewer.language import tr
from apd_viewer.presentation.scales import Measure, usual
from apd_viewer.ui.compare.comparison_window import ComparisonWindow
from apd_viewer.ui.widgets.theme import LIGHT, Theme

if TYPE_CHECKING:
    from PySide6.QtGui import QAction

    from apd_viewer.session.model.state import State
    from apd_viewer.session.quantities.units import Unit
    from apd_viewer.session.store import Store
    from apd_viewer.ui.overlays.display_options import Looks
    from apd_viewer.ui.overlays.notice import Notice
    from apd_viewer.ui.preferences.preferences import Preferences
    from apd_viewer.ui.tools.canvas import Canvas

_AT_REST = tr("All methods agree on a mesh at rest; move a handle first, then compare.")


class Comparing:
    """The single comparison window, on the document at its opening.

    Parameters
    ----------
    canvas : Canvas
        From where it is looked at.
    looks : Looks
        Whose scale is used.
    memory : Preferences
    notice : Notice
        Where to say why there is nothing to compare.
    store : Store

    Attributes
    ----------
    window : ComparisonWindow or None
    """

    def __init__(
        self, canvas: Canvas, looks: Looks, memory: Preferences, notice: Notice, store: Store
    ) -> None:
        self._canvas, self._looks, self._memory, self._notice = canvas, looks, memory, notice
        self._store = store
        self._views: Mapping[str, QAction] = {}
        self._frame: QAction | None = None
        self._theme = LIGHT
        self.window: ComparisonWindow | None = None

    def lend_keys(self, views: Mapping[str, QAction], frame: QAction) -> None:
        """Give the window, once open, the shortcuts for turning and framing.

        Parameters
        ----------
        views : mapping of str to QAction
            By the direction from which they look, as in Look.along.
        frame : QAction
        """
        self._views, self._frame = views, frame

    def open(self) -> None:
        """Compare methods on the current document, or say the missing step."""
        if (state := self._store.state) is None:
            return
        if sentence := _why_not(state):
            self._notice.fail(sentence)
            return
        if self.window is None:
            self.window = self._made()
        window, comparison = self.window, self.window.comparison
        window.show()
        if comparison is None or comparison.document is not state.document:
            window.compare(state, self._store.unit)
        window.raise_()
        window.activateWindow()

    def _made(self) -> ComparisonWindow:
        scale = self._looks.heat.scales.get(Measure.AREA) or usual(Measure.AREA, 1.0)
        window = ComparisonWindow(self._memory, scale, self._canvas.viewport.look.eye)
        window.set_theme(self._theme)
        window.again_asked.connect(self._again)
        window.closed.connect(self._forget)
        for axis, action in self._views.items():
            window.give_keys(action.shortcuts(), partial(window.linked.look_along, axis))
        if self._frame is not None:
            window.give_keys(self._frame.shortcuts(), window.linked.frame)
        return window

    def _again(self) -> None:
        if (state := self._store.state) is None or self.window is None:
            return
        if sentence := _why_not(state):
            self.window.refuse(sentence)
        else:
            self.window.compare(state, self._store.unit)

    def _forget(self) -> None:
        window, self.window = self.window, None
        if window is not None:
            window.deleteLater()

    def measure_in(self, unit: Unit) -> None:
        """Write lengths in another unit, if the current mesh is compared."""
        state = self._store.state
        if state is not None and self.window is not None and self.window.is_of(state.document.mesh):
            self.window.measure_in(unit)

    def set_theme(self, theme: Theme) -> None:
        """Recolour the parts beyond the style sheet's reach."""
        self._theme = theme
        if self.window is not None:
            self.window.set_theme(theme)

    def close(self) -> None:
        """Close the window."""
        if self.window is not None:
            self.window.close()


def _why_not(state: State) -> str | None:
    """Missing step before a comparison, as a sentence; None if none."""
    return state.document.problem or (_AT_REST if state.is_at_rest else None)
