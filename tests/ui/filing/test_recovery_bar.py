"""Recovery of the work of a killed program."""

import numpy as np
import pytest
from driving import idle
from PySide6.QtCore import Qt

from apd_viewer.files.samples import open_sample
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.model.view import View
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.session.storage.recovery_file import claim_path
from apd_viewer.session.storage.session_file import save_session


@pytest.fixture
def left(folder):
    """What a program has left that is dead: the duck, painted anew."""
    state = initial_state(*open_sample("duck"))
    document = state.document.with_label(np.arange(100), 0)
    path, lock = claim_path(folder)
    save_session(path, state.updated(document), View())
    lock.release()
    return document


def click(qtbot, button):
    qtbot.mouseClick(button, Qt.MouseButton.LeftButton)


def test_recovery_bar_restores_what_was_left_as_one_step_and_keeps_it_safe(qtbot, started, folder, left):
    window = started()
    assert "duck.obj" in window.recovery.text
    before = window.session.store.state
    click(qtbot, window.recovery.restore)
    qtbot.waitUntil(lambda: window.session.store.state is not before)
    idle(qtbot, window)
    np.testing.assert_array_equal(window.session.store.state.document.labels, left.labels)
    assert window.recovery.isHidden()
    window.session.gestures.undo()
    assert window.session.store.state is before
    window.shell.close()
    assert list(folder.iterdir()) == []


def test_recovery_bar_covers_no_hint_however_long_it_is(qtbot, started, left):
    window = started()
    bar, hint = window.recovery, window.invitation
    tops = []
    for words in (1, 8, 60):
        hint.show_text(" ".join(["Bereichsauswahl"] * words))
        assert hint.isVisible()
        assert not bar.geometry().intersects(hint.geometry())
        assert bar.geometry().top() > 0
        tops.append(bar.geometry().top())
    assert tops[0] > tops[-1]


def test_recovery_bar_discards_for_good(qtbot, started, folder, left):
    window = started()
    click(qtbot, window.recovery.discard)
    assert window.recovery.isHidden()
    assert list(folder.iterdir()) == []


def test_recovery_bar_offers_again_what_is_put_off(qtbot, started, left):
    window = started()
    click(qtbot, window.recovery.later)
    assert window.recovery.isHidden()
    window.shell.close()
    assert "duck.obj" in started().recovery.text


def test_recovery_bar_does_not_offer_the_work_of_another_window(qtbot, started, folder):
    first = started()
    first.session.handles.move_by(MOTIONS["TWIST"], "20", 0)
    qtbot.waitUntil(lambda: list(folder.glob("*.apd")) != [])
    assert started().recovery.isHidden()


def test_autosave_leaves_nothing_after_a_clean_end(qtbot, started, folder):
    window = started()
    assert window.recovery.isHidden()
    window.session.handles.move_by(MOTIONS["TWIST"], "20", 0)
    qtbot.waitUntil(lambda: list(folder.glob("*.apd")) != [])
    idle(qtbot, window)
    window.shell.close()
    assert list(folder.iterdir()) == []
