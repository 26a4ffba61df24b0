"""A window that tests use one after the other, each as if it had just been opened."""

from contextlib import contextmanager

import pytest
from driving import Mouse, idle, settle, show
from meshes import box
from PySide6.QtCore import QSettings
from PySide6.QtGui import QAction, QGuiApplication
from PySide6.QtWidgets import QAbstractButton, QApplication
from shiboken6 import isValid

from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.measuring.measurement_kind import MeasurementKind
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.model.history import History
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.state_store import Activity
from apd_viewer.ui.filing import file_controller
from apd_viewer.ui.filing.file_controller import UnsavedAnswer
from apd_viewer.ui.scene.surface_shading import Finish
from apd_viewer.ui.settings_page.preference_table import GROUPS
from apd_viewer.ui.shell import Shell
from apd_viewer.ui.tools.brush_tool import DEFAULT_RADIUS
from apd_viewer.ui.tools.tool_modes import FIRST_MODE, FIRST_TOOL
from apd_viewer.ui.workbench import Workbench

# Smaller than that of the first start: pictures drawn by the processor cost tests a third of their time.
SIZE, FIRST_SIZE = (960, 680), (1280, 800)


def open_window(qtbot, settings):
    """A window, shown and active, without a mesh."""
    window = Workbench(Shell(settings))
    window.shell.resize(*SIZE)
    show(qtbot, window.shell, window.canvas.viewport)
    activate(qtbot, window)
    return window


def activate(qtbot, window):
    """Have the keys go to a window, though another one may be open, or one of another process was."""

    def is_active():
        # Once more: X refuses a first time that is older than the last window that had the keys.
        window.shell.activateWindow()
        return window.shell.isActiveWindow()

    if not window.shell.isActiveWindow():
        qtbot.waitUntil(is_active)


def widened(qtbot, window):
    """The window as large as at a first start."""
    window.shell.resize(*FIRST_SIZE)
    return at_rest(qtbot, window)


def close_window(qtbot, window):
    """Close a window, and wait until it is gone."""
    window.shell.close()
    window.shell.deleteLater()
    qtbot.waitUntil(lambda: not isValid(window.shell))


def bottle_in(qtbot, window, painted):
    """The window with a painted mesh, read anew: a window tells meshes by their identity."""
    mesh, labels = painted.document.mesh, painted.document.labels
    return opened_in(qtbot, window, lambda: initial_state(open_mesh(mesh.path), labels))


def opened_in(qtbot, window, state):
    """The window with what ``state()`` is, drawn once."""
    window.shell.setUpdatesEnabled(False)
    window.session.files.open_result("bottle", state)
    idle(qtbot, window)
    window.shell.setUpdatesEnabled(True)
    return at_rest(qtbot, window)


def at_rest(qtbot, window):
    """The window once nothing is opened or drawn any more."""
    idle(qtbot, window)
    settle(qtbot, window.canvas.viewport)
    return window


class KeptWindow:
    """A window and the way back to how it was opened; another one is opened once it was closed.

    Parameters
    ----------
    settings : QSettings
    """

    def __init__(self, settings):
        self._settings = settings
        self._window = None

    def opened(self, qtbot):
        """The window, active and without a mesh; its view may still show the last one."""
        if self._window is None:
            self._settings.clear()  # whatever the last window left: it begins as a new user's
            self._window = window = open_window(qtbot, self._settings)
            self._layout, self._size = window.shell.saveState(), window.shell.size()
            checkable = (*window.shell.findChildren(QAbstractButton), *window.shell.findChildren(QAction))
            drawn = window.canvas.viewport.renderer
            self._background = drawn.GetBackground(), drawn.GetBackground2(), drawn.GetGradientBackground()
            self._checked = {each: each.isChecked() for each in checkable if each.isCheckable()}
        self._window.shell.setUpdatesEnabled(True)
        self._window.shell.setEnabled(True)
        activate(qtbot, self._window)
        if (keys := self._window.shell.focusWidget()) is not None:
            keys.clearFocus()
        return self._window

    def reset(self, qtbot):
        """Close all that was opened, take back all that was chosen, and forget the mesh."""
        if self._window.shell.is_closed:
            self._window.shell.deleteLater()
            self._window = None
            return
        self._window.shell.setUpdatesEnabled(False)  # it is drawn with what the next test opens
        self._close_all()
        QApplication.processEvents()  # what was to come next comes now
        idle(qtbot, self._window)
        self._forget_mesh()
        self._restore_choices()
        # It stays the active window, to which Qt gives the keys that tests press in widgets of their own.
        self._window.shell.setEnabled(False)

    def _close_all(self):
        window, session = self._window, self._window.session
        while (popup := QApplication.activePopupWidget()) is not None:
            popup.close()
        window.edits.cancel_drag()
        session.gestures.cancel()
        session.jobs.cancel()
        if session.store.activity is Activity.REFINING:
            session.store.pause_or_resume()
        while window.help.close():
            pass
        for card in window.edits.text_entries.cards:
            card.close_card()
        window.findings.close()
        window.recovery.postpone_all()
        window.case_studies.close()
        for top in QApplication.topLevelWidgets():
            if top.isVisible() and not isinstance(top, Shell):
                top.close()

    def _forget_mesh(self):
        """Have the next mesh be the first one; answers about the last one come too late for another."""
        window, store, gestures = self._window, self._window.session.store, self._window.session.gestures
        store.jump_to(initial_state(Mesh(*box())))
        store.state, store.activity, store.seconds_per_iteration = None, Activity.IDLE, 0.0
        gestures.history = History()
        gestures.history.entries_dropped = window.session.saved_work.forget_unreachable
        window.session.saved_work.forget_unreachable()
        window.motion_preview.ghost.hide()  # of what was typed in a field without the keys
        window.next_step.has_moved = False
        window.invitation.show_text("")
        window.measurements.choose_kind(MeasurementKind.DISTANCE)
        window.tools.set_mode(FIRST_MODE)
        window.tools.choose_tool(FIRST_TOOL)
        window.signals.status_changed.emit()

    def _restore_choices(self):
        window, shell = self._window, self._window.shell
        self._settings.clear()
        window.preferences.values.restore_defaults(row for group in GROUPS for row in group.rows)
        window.help.shortcuts.reset_all()
        for each, on in sorted(self._checked.items(), key=lambda item: -item[1]):  # of one of several the one
            if isValid(each) and each.isChecked() != on:
                each.setChecked(on)
        looks = window.display_options  # its switches are off where the mesh has nothing of the kind
        looks.show_file_colors(False)
        looks.show_textures(False)
        looks.show_target(True)
        window.canvas.surface.shows_edges = False  # as a test may set it beside its switch
        looks.overlay.scales.clear()
        Mouse(window.display_options.legend).double_click((0, 0))  # puts the cards back
        window.actions_.display.no_overlay.trigger()
        window.actions_.display.finishes[Finish.CLAY].trigger()
        window.display_options.cutting_plane.slider.setValue(
            window.display_options.cutting_plane.slider.maximum() // 2
        )
        window.actions_.file.fill_recent(())
        bottom, top, has_gradient = self._background
        window.canvas.viewport.renderer.SetBackground(bottom)
        window.canvas.viewport.renderer.SetBackground2(top)
        window.canvas.viewport.renderer.SetGradientBackground(has_gradient)
        window.canvas.brush.size.radius = DEFAULT_RADIUS
        window.panel.obstacles.fields.along.setCurrentIndex(0)
        shell.showNormal()
        shell.resize(self._size)
        shell.restoreState(self._layout)
        window.panel.folded_sections = window.preferences.folded_sections
        window.panel.pages.setCurrentIndex(0)
        for page in (window.panel.deform, window.panel.measurements):
            page.verticalScrollBar().setValue(0)
        window.status.clearMessage()
        window.notice.hide()
        window.proposal.hide()
        QGuiApplication.clipboard().clear()

    def close(self):
        """Close it for good."""
        if self._window is not None:
            self._window.shell.close()
            self._window.shell.deleteLater()


def settings_in(folder):
    """Settings of a window, in a file in a folder."""
    return QSettings(str(folder / "settings.ini"), QSettings.Format.IniFormat)


@contextmanager
def lasting_window(settings):
    """Context with a window to be kept, which is closed without a file_controller."""
    kept = KeptWindow(settings)
    with pytest.MonkeyPatch.context() as patch:
        yield kept
        patch.setattr(file_controller, "ask_before_leaving", lambda *_: UnsavedAnswer.DISCARD)
        kept.close()
