"""Effects of the preferences on a window and its session."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction

from apd_viewer.language import choose_language, tr
from apd_viewer.session.session import Session
from apd_viewer.ui.preferences.preference_values import PreferenceValues
from apd_viewer.ui.settings_page.preference_table import (
    AUTOSAVE,
    BRUSH_RADIUS,
    COLOR_SCHEME,
    LANGUAGE,
    SELECTION_MODE,
    UNDO_MEMORY,
)
from apd_viewer.ui.tools.brush_tool import BrushSize
from apd_viewer.ui.tools.tool_choice import ToolChoice


def limit_threads(threads: int) -> None:
    """Limit the parallel kernels of this process and its children; 0 does not.

    It has to come before numba, which reads the number once: a script that has used numba keeps its own, and
    so does whoever sets the variable.
    """
    if threads and "numba" not in sys.modules:
        os.environ.setdefault("NUMBA_NUM_THREADS", str(threads))


def connect_preferences(
    values: PreferenceValues, session: Session, tools: ToolChoice, brush: BrushSize
) -> None:
    """Have session and tools follow the preferences."""
    values.follow(UNDO_MEMORY, session.gestures.limit_memory)
    values.follow(AUTOSAVE, session.autosave.set_interval)
    values.follow(SELECTION_MODE, tools.set_mode)
    values.follow(BRUSH_RADIUS, brush.set_radius)


def connect_menu(values: PreferenceValues, schemes: dict[Qt.ColorScheme, QAction]) -> None:
    """Have the menu show the colour scheme."""
    values.follow(COLOR_SCHEME, lambda scheme: schemes[scheme].setChecked(True))


def connect_language(values: PreferenceValues, show_failure: Callable[[str], object]) -> None:
    """Have the next start use the chosen language; ``show_failure`` says a sentence."""

    def keep(name: str) -> None:
        try:
            choose_language(name)
        except OSError as error:
            reason = error.strerror or str(error)
            show_failure(tr("The language cannot be stored ({reason}).").format(reason=reason))

    values.on_change(LANGUAGE, keep)
