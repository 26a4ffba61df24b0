"""Controller of the comparison window."""

from collections.abc import Mapping
from functools import partial

from PySide6.QtGui import QAction

from apd_viewer.language import tr
from apd_viewer.presentation.scales import Measure
from apd_viewer.session.model.state import State
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.state_store import StateStore
from apd_viewer.ui.compare.comparison_window import ComparisonWindow
from apd_viewer.ui.overlays.display_options import DisplayOptions
from apd_viewer.ui.overlays.notice import Notice
from apd_viewer.ui.preferences.preferences import Preferences
from apd_viewer.ui.tools.canvas import Canvas
from apd_viewer.ui.widgets.theme import LIGHT, Theme

_AT_REST = tr("All methods agree on a mesh at rest; move a handle first, then compare.")


class CompareController:
    """Controller of the single comparison window on the current document.

    Parameters
    ----------
    canvas : Canvas
        Canvas with the camera to start from.
    display_options : DisplayOptions
        Display options with the scale in use.
    notice : Notice
        Notice for the reason of a refused comparison.
    """

    def __init__(
        self,
        canvas: Canvas,
        display_options: DisplayOptions,
        preferences: Preferences,
        notice: Notice,
        store: StateStore,
    ) -> None:
        self._canvas, self._looks, self._memory, self._notice = canvas, display_options, preferences, notice
        self._store = store
        self._views: Mapping[str, QAction] = {}
        self._frame: QAction | None = None
        self._theme = LIGHT
        self.window: ComparisonWindow | None = None

    def set_shortcuts(self, views: Mapping[str, QAction], frame: QAction) -> None:
        """Set the comparison window's shortcuts for view directions and framing.

        Parameters
        ----------
        views : mapping of str to QAction
            By the name of the view, as in :meth:`Camera.standard_view`.
        """
        self._views, self._frame = views, frame

    def open(self) -> None:
        """Compare methods on the current document, or report a missing step."""
        if (state := self._store.state) is None:
            return
        if sentence := _refusal(state):
            self._notice.show_failure(sentence)
            return
        if self.window is None:
            self.window = self._make_window()
        window, comparison = self.window, self.window.comparison
        window.show()
        if comparison is None or comparison.document is not state.document:
            window.compare(state, self._store.unit, self._store.solution)
        window.raise_()
        window.activateWindow()

    def _make_window(self) -> ComparisonWindow:
        scale = self._looks.overlay.scales.get(Measure.AREA)
        window = ComparisonWindow(self._memory, scale, self._canvas.viewport.camera_controller.camera)
        window.set_theme(self._theme)
        for view in window.linked.views.values():
            view.viewport.navigation.preset = self._canvas.viewport.navigation.preset
        window.repeat_requested.connect(self._repeat)
        window.closed.connect(self._forget)
        for axis, action in self._views.items():
            window.add_shortcuts(action.shortcuts(), partial(window.linked.show_standard_view, axis))
        if self._frame is not None:
            window.add_shortcuts(self._frame.shortcuts(), window.linked.frame_shapes)
        return window

    def _repeat(self) -> None:
        if (state := self._store.state) is None or self.window is None:
            return
        if sentence := _refusal(state):
            self.window.show_refusal(sentence)
        else:
            self.window.compare(state, self._store.unit, self._store.solution)

    def _forget(self) -> None:
        window, self.window = self.window, None
        if window is not None:
            window.deleteLater()

    def set_unit(self, unit: Unit) -> None:
        """Change the unit of lengths, if the current mesh is being compared."""
        state = self._store.state
        if state is not None and self.window is not None and self.window.is_comparing(state.document.mesh):
            self.window.set_unit(unit)

    def set_theme(self, theme: Theme) -> None:
        """Apply the theme to the parts not covered by the style sheet."""
        self._theme = theme
        if self.window is not None:
            self.window.set_theme(theme)

    def close(self) -> None:
        """Close the window."""
        if self.window is not None:
            self.window.close()


def _refusal(state: State) -> str | None:
    """Sentence about the step missing before a comparison; None if there is none."""
    return state.document.paint_problem or (_AT_REST if state.is_at_rest else None)
