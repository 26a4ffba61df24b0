"""The dialog of volumes: the table of the report, kept up to date while one deforms."""

import pytest
from driving import idle
from PySide6.QtCore import Qt
from PySide6.QtGui import QGuiApplication
from PySide6.QtTest import QTest

from apd_viewer.geometry.analysis.hull_readings import PACKING
from apd_viewer.presentation.volume_text import PUBLISHED_VOLUMES
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.session.processes import shape_checker
from apd_viewer.session.quantities.units import Unit


@pytest.fixture
def measured_at_once(monkeypatch):
    """Shapes are measured without a pause."""
    monkeypatch.setattr(shape_checker, "FIRST_PAUSE", 0.0)


@pytest.fixture
def sample(qtbot, measured_at_once, new_bottle):
    """A window of its own on the bottle in centimetres."""
    window = new_bottle
    window.choose_unit(Unit.CENTIMETRE)
    window.actions_.simulate.volumes.trigger()
    qtbot.waitUntil(lambda: volume(window) in text(window))
    yield window
    window.reports.volumes.close()


def volume(window, symbol="cm³"):
    return f"{window.session.store.state.frame.volume:.1f} {symbol}"


def text(window):
    return window.reports.volumes.text.toPlainText()


def test_volumes_dialog_names_published_figures_with_their_sources_and_copies_them(sample):
    dialog = sample.reports.volumes
    for figure in (figure for figures in PUBLISHED_VOLUMES.values() for figure in figures):
        assert figure.words in text(sample)
        assert figure.source in text(sample)
    hull = sample.session.shape_checks.shape_check.hull
    assert volume(sample) in text(sample)
    assert f"{hull.volume / PACKING:.1f} cm³" in text(sample)
    QTest.mouseClick(dialog.copy, Qt.MouseButton.LeftButton)
    assert "Published" in QGuiApplication.clipboard().text()
    assert not dialog.text.textCursor().hasSelection()


def test_volumes_dialog_follows_the_shape_and_the_unit(qtbot, sample):
    rest = volume(sample)
    sample.session.handles.move_by(MOTIONS["TWIST"], "60", 0)
    idle(qtbot, sample)
    assert volume(sample) != rest
    qtbot.waitUntil(lambda: volume(sample) in text(sample))
    sample.panel.area.unit.chosen.emit(Unit.MILLIMETRE)
    qtbot.waitUntil(lambda: volume(sample, "mm³") in text(sample))
