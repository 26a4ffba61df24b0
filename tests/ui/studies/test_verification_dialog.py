"""The dialog that runs the cases with exact answers: rows one after the other, figures, copy and cancel."""

from dataclasses import replace

import pytest
from driving import work_off
from PySide6.QtGui import QGuiApplication
from study_driving import click, finish

from apd_viewer.verification import case_table
from apd_viewer.verification.case_table import CASES


@pytest.fixture
def window(kept_window):
    """The window of all tests of the file."""
    return kept_window


@pytest.fixture
def dialog(window):
    window.actions_.help["verify"].trigger()
    dialog = window.runs.dialogs["verify"]
    yield dialog
    dialog.close()


def texts(item):
    return [item.text(column) for column in range(item.columnCount())]


@pytest.fixture
def ended(qtbot, here, monkeypatch, dialog):
    """The dialog after a run of two cases, one of them coarse and the other not set up."""
    cases = {"K": CASES["K"], "G": replace(CASES["G"], resolutions=(4, 6))}
    monkeypatch.setattr(case_table, "CASES", cases)
    click(dialog.run.start)
    finish(qtbot, dialog)
    return dialog


def test_verification_dialog_has_each_quantity_below_its_case_and_the_reason_of_what_is_missing(ended):
    table = ended.table
    missing, wound = (table.topLevelItem(k) for k in range(table.topLevelItemCount()))
    assert texts(missing)[0].startswith("K  ")
    assert [texts(missing.child(k))[0][:7] for k in range(missing.childCount())] == ["Not yet"]
    volume = texts(wound.child(0))
    assert volume[:2] == ["volume", "2.5637"]
    assert volume[3].startswith("−")
    assert "of 2 quantities are within their bar." in ended.summary.text()


def test_verification_dialog_shows_the_figure_of_the_chosen_case(ended):
    assert ended.figure is None, "the first case could not be set up"
    ended.table.setCurrentItem(ended.table.topLevelItem(1).child(1))
    assert ended.figure.has_picture
    assert "Slit sphere" in ended.figure.accessibleName()


def test_verification_table_is_copied_as_spreadsheets_take_it(ended):
    click(ended.copy)
    lines = QGuiApplication.clipboard().text().splitlines()
    assert lines[0].split("\t")[:2] == ["quantity", "exact"]
    assert len(lines) == 6
    assert lines[4].split("\t")[:2] == ["volume", "2.5637"]


def test_verification_dialog_begins_again_with_an_empty_table(qtbot, ended):
    click(ended.run.start)
    finish(qtbot, ended)
    assert ended.table.topLevelItemCount() == 2


def test_verification_dialog_is_cancelled_while_the_command_runs(qtbot, dialog):
    click(dialog.run.start)
    qtbot.waitUntil(lambda: dialog.run.command.is_running, timeout=60_000)
    assert not dialog.copy.isEnabled()
    click(dialog.run.cancel)
    assert not dialog.run.is_running
    assert dialog.run.message.text().startswith("Cancelled")
    work_off()
    assert dialog.table.topLevelItemCount() == 0
