"""Settings kept by the program of version 0.1.0; never make them anew."""

import shutil
from pathlib import Path

import pytest
from PySide6.QtCore import QSettings, Qt
from PySide6.QtWidgets import QDockWidget, QMainWindow

from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.wall import WallText
from apd_viewer.ui.preferences.preferences import Preferences
from apd_viewer.ui.settings_page.preference_table import COLOR_SCHEME
from apd_viewer.ui.shell import Shell

OLD = Path(__file__).with_name("version-1.ini")
PARTS = Path("/parts")


@pytest.fixture
def memory(tmp_path):
    """The old settings, in a file that may be written to."""
    path = shutil.copy(OLD, tmp_path / "settings.ini")
    return Preferences(QSettings(str(path), QSettings.Format.IniFormat))


def test_preferences_read_all_that_version_0_1_0_kept(memory):
    assert memory.recent_files == [PARTS / "a, b.apd", PARTS / "Büste 2.ply", PARTS / "bar.obj"]
    assert memory.last_folder == PARTS
    assert memory.folded_sections == ["Method", "Regions"]
    assert memory.plots == ["area", "energy"]
    assert memory.compared_methods == ["exact", "local"]
    assert memory.units == {PARTS / "Büste 2.ply": Unit.NONE, PARTS / "bar.obj": Unit.CENTIMETRE}
    assert memory.walls == {
        PARTS / "a, b.apd": WallText("", "1.2"),
        PARTS / "bar.obj": WallText("0.3mm", "1380 kg/m3"),
    }
    assert memory.shortcuts == {"undo": "Ctrl+U", "paint": "Shift+P, Q", "open": ""}
    assert memory.display_options == {"overlay": "bending", "ghost": "on", "edges": "off", "area": "40 0"}
    assert memory.has_seen_tour
    assert memory.values[COLOR_SCHEME] is Qt.ColorScheme.Dark


@pytest.mark.parametrize(
    "titles", [["Size and mass", "Method"], ["Größe und Masse", "Verfahren"], ["尺寸和质量", "方法"]]
)
def test_panel_folded_keeps_sections_folded_that_were_folded_in_any_language(qtbot, settings, titles):
    """The titles were kept as they were shown; from now on their names are."""
    settings.setValue("folded", titles)
    shell = Shell(settings)
    qtbot.addWidget(shell)
    assert shell.panel.folded_sections == ["Method", "Size and mass"]
    shell.close()
    assert Preferences(settings).folded_sections == ["Method", "Size and mass"]


def test_shell_does_not_restore_a_dock_without_a_study(qtbot, settings):
    first = Shell(settings)
    qtbot.addWidget(first)
    first.show()
    first.docks["study"].show()
    first.docks["plots"].show()
    first.close()
    second = Shell(settings)
    qtbot.addWidget(second)
    second.show()
    assert second.docks["plots"].isVisible()
    assert not second.docks["study"].isVisible()
    second.close()


@pytest.mark.parametrize(
    "names", [("readings", "history", "plots"), ("readings", "plots", "study", "timeline")]
)
def test_shell_keeps_the_panel_of_a_layout_that_knew_one_page(qtbot, settings, names):
    old = QMainWindow()
    qtbot.addWidget(old)
    for name in names:
        old.addDockWidget(Qt.DockWidgetArea.LeftDockWidgetArea, QDockWidget(name, old, objectName=name))
    settings.setValue("layout", old.saveState())
    shell = Shell(settings)
    qtbot.addWidget(shell)
    shell.show()
    assert shell.dockWidgetArea(shell.docks["readings"]) is Qt.DockWidgetArea.LeftDockWidgetArea
    assert shell.panel.area.percent.isVisible()
    assert shell.panel.method.method.isVisible()
    shell.close()
