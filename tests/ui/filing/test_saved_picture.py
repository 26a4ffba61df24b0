"""Sessions saved in the window carry a small picture of the view."""

import numpy as np
import pytest
from driving import idle
from PySide6.QtCore import QSize
from PySide6.QtGui import QImage

from apd_viewer.session.storage.session_picture import PICTURE_SIDE, session_picture
from apd_viewer.ui.filing import file_dialogs
from apd_viewer.ui.scene.scene_picture import scene_picture, small_picture


@pytest.fixture
def saved(qtbot, bottle, tmp_path, monkeypatch):
    """Saves the session of the window, and returns its file."""
    path = tmp_path / "s.apd"
    monkeypatch.setattr(file_dialogs, "ask_where_to_save_session", lambda *_: (path, True))

    def save():
        bottle.actions_.file.save.trigger()
        idle(qtbot, bottle)
        return path

    return save


def covered(image):
    """Where a picture shows anything, (h, w) bool."""
    alpha = image.convertToFormat(QImage.Format.Format_Alpha8)
    lines = np.frombuffer(alpha.constBits(), dtype=np.uint8).reshape(alpha.height(), -1)
    return lines[:, : alpha.width()] > 0


def test_small_picture_is_of_what_the_view_shows_and_of_nothing_around_it(bottle, saved):
    image = QImage.fromData(session_picture(saved()), "PNG")
    assert max(image.width(), image.height()) == PICTURE_SIDE
    whole = covered(scene_picture(bottle.canvas.viewport, QSize(1200, 800), transparent=True))
    shape = whole.any(axis=1).sum() / whole.any(axis=0).sum()
    assert image.height() / image.width() == pytest.approx(shape, rel=0.05)
    inside = covered(image)
    for edge in (inside[:2], inside[-2:], inside[:, :2], inside[:, -2:]):
        assert edge.any()
    foot, neck = (image.pixelColor(image.width() // 2, y) for y in (image.height() - 8, 8))
    assert foot.blue() > 2 * foot.red()
    assert neck.red() > 2 * neck.blue()


def test_small_picture_of_a_view_of_nothing_shows_nothing(window):
    image = QImage.fromData(small_picture(window.canvas.viewport, 64), "PNG")
    assert max(image.width(), image.height()) == 64
    assert not covered(image).any()


def test_save_writes_the_same_file_for_the_same_session_twice(saved):
    first = saved().read_bytes()
    assert saved().read_bytes() == first


def test_small_picture_is_none_without_opengl(bottle, saved, monkeypatch):
    view = bottle.canvas.viewport
    monkeypatch.setattr(view.ren_win, "GetReadyForRendering", lambda: False)
    assert small_picture(view, 64) == b""
    monkeypatch.undo()
    assert small_picture(view, 64).startswith(b"\x89PNG")
