"""The Settings page: each row does what it says, at once or after a restart, and is kept."""

import logging
import os
import sys

import meshes
import pytest
from driving import idle
from PySide6.QtCore import QSettings, Qt
from PySide6.QtTest import QTest

from apd_viewer import language
from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.model.up_axis import UpAxis
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.preferences.preference_values import PreferenceValues
from apd_viewer.ui.settings_page import preference_table as table, settings_dialog
from apd_viewer.ui.settings_page.settings_dialog import SettingsDialog
from apd_viewer.ui.shell import Shell
from apd_viewer.ui.tools.tool_modes import SelectionMode
from apd_viewer.ui.widgets.theme import DARK

OTHER = {  # a value besides the default, as the page writes it
    "language": "English",
    "scheme": "Dark",
    "navigation": "Blender",
    "default_unit": "Inches (in)",
    "default_up_axis": "+Z",
    "selection_mode": "Lasso",
    "brush_radius": "40",
    "autosave": "Off",
    "undo_memory": "64 MiB",
    "threads": table.THREADS.allowed.options[-1].title,  # on a single core there is no other
}


@pytest.fixture
def window(kept_window):
    """The window of all tests of this file."""
    return kept_window


@pytest.fixture(autouse=True)
def chosen_language(tmp_path, monkeypatch):
    """The file that keeps the language, in a folder of the test."""
    path = tmp_path / "config" / "language"
    monkeypatch.setattr(language, "language_file", lambda: path)
    return path


@pytest.fixture
def page(qtbot, window):
    """The page, opened by its keys."""
    window.shell.activateWindow()
    qtbot.waitUntil(window.shell.isActiveWindow)
    QTest.keyClick(window.shell, Qt.Key.Key_Comma, Qt.KeyboardModifier.ControlModifier)
    dialog = window.settings_page.dialog
    # Until then the keys are shortcuts of the window.
    qtbot.waitUntil(dialog.isActiveWindow)
    return dialog


def control(page, preference):
    return page.findChild(object, preference.name)


def choose(page, preference, title):
    """Choose a value with the keys."""
    field = control(page, preference)
    field.setFocus()
    if preference is table.BRUSH_RADIUS:
        field.selectAll()
        QTest.keyClicks(field, title)
        QTest.keyClick(field, Qt.Key.Key_Return)
        return
    place = field.findText(title)
    assert place >= 0, title
    while field.currentIndex() != place:
        QTest.keyClick(field, Qt.Key.Key_Down if field.currentIndex() < place else Qt.Key.Key_Up)


def opened(qtbot, window, folder, name):
    mesh = Mesh(*meshes.sphere(1))
    save_mesh(mesh, mesh.V, folder / name)
    window.files.open_path(folder / name)
    idle(qtbot, window)


def test_settings_dialog_has_each_setting_do_what_it_says_and_keeps_it(
    qtbot, window, page, settings, tmp_path, chosen_language
):
    assert set(OTHER) == {preference.name for preference in table.PREFERENCES}
    assert not page.restore.isEnabled(), "all are at their defaults"
    for preference in table.PREFERENCES:
        choose(page, preference, OTHER[preference.name])
    assert window.shell.theme is DARK
    assert window.actions_.view.schemes[Qt.ColorScheme.Dark].isChecked()
    assert window.canvas.selection_mode is SelectionMode.LASSO
    assert window.canvas.viewport.navigation.preset.title == "Blender"
    assert window.actions_.select.modes[SelectionMode.LASSO].isChecked()
    assert window.canvas.brush.size.radius == 40.0
    assert window.session.autosave.interval is None
    assert window.session.gestures.history.most_bytes == 64 * 2**20
    assert chosen_language.read_text() == "en"
    opened(qtbot, window, tmp_path, "new.obj")
    assert window.panel.unit is Unit.INCH
    assert window.canvas.viewport.camera_controller.camera.up_axis is UpAxis.PLUS_Z
    settings.sync()
    again = PreferenceValues(QSettings(settings.fileName(), QSettings.Format.IniFormat))
    for preference in table.PREFERENCES:
        assert again[preference] == window.preferences.values[preference]
        assert preference is table.THREADS or again[preference] != preference.default
    shell = Shell(settings)
    assert (shell.theme, shell.canvas.selection_mode) == (DARK, SelectionMode.LASSO)
    shell.close()
    shell.deleteLater()

    page.restore.click()
    for preference in table.PREFERENCES:
        assert window.preferences.values[preference] == preference.default
        assert settings.value(preference.name) is None
    assert control(page, table.UNDO_MEMORY).currentText() == "512 MiB"
    assert not page.restore.isEnabled()
    assert control(page, table.BRUSH_RADIUS).value() == window.canvas.brush.size.radius == 24.0
    assert not chosen_language.exists()
    opened(qtbot, window, tmp_path, "newer.obj")
    assert window.panel.unit is Unit.NONE
    assert window.canvas.viewport.camera_controller.camera.up_axis is UpAxis.PLUS_Y


def test_settings_dialog_is_one_follows_the_window_and_is_named_for_screen_readers(qtbot, window, page):
    window.actions_.settings.trigger()
    assert window.shell.findChildren(SettingsDialog) == [page]
    window.actions_.view.schemes[Qt.ColorScheme.Dark].trigger()
    assert control(page, table.COLOR_SCHEME).currentText() == "Dark"
    for preference in table.PREFERENCES:
        field = control(page, preference)
        assert field.accessibleName() == preference.title
        assert field.accessibleDescription() == preference.note
        assert field.toolTip()
    restarts = [p for p in table.PREFERENCES if "after a restart" in p.note]
    assert restarts == [table.LANGUAGE, table.THREADS]
    field = control(page, table.BRUSH_RADIUS)
    field.setFocus()
    field.selectAll()
    QTest.keyClicks(field, "5000")
    QTest.keyClick(field, Qt.Key.Key_Return)
    assert window.canvas.brush.size.radius == 24.0, "out of range"
    page.shortcuts.click()
    assert window.settings_page.dialog is None
    assert window.help.sheet.isVisible()
    window.actions_.settings.trigger()
    QTest.keyClick(window.settings_page.dialog, Qt.Key.Key_Escape)
    assert window.settings_page.dialog is None


def test_connect_language_reports_a_language_that_cannot_be_stored(window, page, chosen_language):
    chosen_language.parent.write_text("a file in place of the folder")
    choose(page, table.LANGUAGE, "English")
    assert "cannot be stored" in window.notice.text


def test_preference_values_log_what_cannot_be_read_and_use_the_defaults(settings, caplog):
    bad = {"scheme": "9", "default_unit": "furlong", "default_up_axis": "up", "brush_radius": "nan"}
    bad |= {
        "autosave": ["1", "2"],
        "undo_memory": "-1",
        "threads": "0.5",
        "selection_mode": "",
        "language": "?",
        "navigation": "Doom",
    }
    assert set(bad) == set(OTHER)
    for name, value in bad.items():
        settings.setValue(name, value)
    values = PreferenceValues(settings)
    with caplog.at_level(logging.WARNING):
        for preference in table.PREFERENCES:
            assert values[preference] == preference.default
            assert values[preference] == preference.default
    assert [record.args[0] for record in caplog.records] == [p.name for p in table.PREFERENCES]
    values.choose(table.UNIT, Unit.NONE)
    assert PreferenceValues(settings)[table.UNIT] is Unit.NONE


def test_up_axes_leave_samples_and_prescribed_axes_theirs_whatever_the_setting(qtbot, window, tmp_path):
    window.preferences.values.choose(table.UP_AXIS, UpAxis.MINUS_X)
    opened(qtbot, window, tmp_path, "new.glb")
    assert window.canvas.viewport.camera_controller.camera.up_axis is UpAxis.PLUS_Y
    window.session.files.open_sample("duck")
    idle(qtbot, window)
    assert window.canvas.viewport.camera_controller.camera.up_axis is UpAxis.PLUS_Y


@pytest.mark.parametrize(("threads", "before", "after"), [(0, None, None), (2, None, "2"), (2, "3", "3")])
def test_limit_threads_takes_effect_before_numba_is_loaded(monkeypatch, threads, before, after):
    monkeypatch.delitem(sys.modules, "numba", raising=False)
    monkeypatch.setenv("NUMBA_NUM_THREADS", before or "")
    if before is None:
        monkeypatch.delenv("NUMBA_NUM_THREADS")
    settings_dialog.limit_threads(threads)
    assert os.environ.get("NUMBA_NUM_THREADS") == after
