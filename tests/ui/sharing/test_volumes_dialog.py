"""The dialog of volumes: the table of the report, kept up to date while one deforms."""

import pytest
from driving import idle
from PySide6.QtCore import Qt
from PySide6.QtGui import QGuiApplication
from PySide6.QtTest import QTest

from apd_viewer.geometry.analysis.hull_readings import PACKING
from apd_viewer.presentation.volume_text import PUBLISHED_FIGURES, VolumeName
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.session.processes import shape_checker
from apd_viewer.session.quantities.units import Unit


@pytest.fixture
def measured(monkeypatch):
    """Shapes are measured as soon as they rest."""
    monkeypatch.setattr(shape_checker, "FIRST_PAUSE", 0.0)


@pytest.fixture
def dialog(qtbot, measured, sample):
    """The dialog on the sample bottle in centimetres."""
    sample.choose_unit(Unit.CENTIMETRE)
    sample.actions_.simulate.volumes.trigger()
    qtbot.waitUntil(lambda: "500.0" in text(sample), timeout=20_000)
    yield sample.reports.volumes
    sample.reports.volumes.close()


def text(window):
    return window.reports.volumes.text.toPlainText()


def test_volumes_dialog_names_every_published_figure_and_its_source(dialog):
    shown = dialog.text.toPlainText()
    for figure in (figure for figures in PUBLISHED_FIGURES.values() for figure in figures):
        assert figure.words in shown
        assert figure.source in shown


def test_volumes_dialog_has_the_volume_of_the_hull_over_the_packing(dialog, sample):
    state = sample.session.store.state
    hull = sample.session.shape_checks.shape_check.hull
    assert f"{state.frame.volume:.1f} cm³" in dialog.text.toPlainText()
    assert f"{hull.volume / PACKING:.1f} cm³" in dialog.text.toPlainText()
    assert VolumeName.BULK in PUBLISHED_FIGURES


def test_volumes_dialog_follows_the_shape_and_the_unit(qtbot, dialog, sample):
    sample.session.handles.move_by(MOTIONS["TWIST"], "60", 0)
    idle(qtbot, sample)
    volume = f"{sample.session.store.state.frame.volume:.1f} cm³"
    assert volume != "500.0 cm³"
    qtbot.waitUntil(lambda: volume in text(sample), timeout=20_000)
    sample.panel.area.unit.chosen.emit(Unit.MILLIMETRE)
    qtbot.waitUntil(lambda: "500.0 mm³" in text(sample))


def test_volumes_dialog_copies_its_table(dialog):
    QTest.mouseClick(dialog.copy, Qt.MouseButton.LeftButton)
    assert "Published" in QGuiApplication.clipboard().text()
    assert not dialog.text.textCursor().hasSelection()
